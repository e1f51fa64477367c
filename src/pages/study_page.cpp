#include "pages/study_page.h"

#include "base/check.h"
#include "pages/data/page_templates.h"
#include "pages/page_text.h"

namespace abbe {

std::string studyPage(std::string_view json) {
    const std::string_view page = kStudyPageTemplate, mark = "@STUDY@";
    const std::size_t at = page.find(mark);
    ABBE_CHECK(at != std::string_view::npos);
    return std::string(page.substr(0, at)) + scriptEscaped(json) + std::string(page.substr(at + mark.size()));
}

} // namespace abbe
