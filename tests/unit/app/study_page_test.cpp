#include "pages/page_text.h"
#include "pages/study_page.h"

#include <doctest/doctest.h>

using namespace abbe;

namespace {

std::string encoded(std::string_view text) {
    return base64({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

} // namespace

TEST_CASE("base64 of RFC 4648, section 10") {
    CHECK(encoded("") == "");
    CHECK(encoded("f") == "Zg==");
    CHECK(encoded("fo") == "Zm8=");
    CHECK(encoded("foo") == "Zm9v");
    CHECK(encoded("foobar") == "Zm9vYmFy");
    CHECK(encoded("\xff\xfe") == "//4=");
}

TEST_CASE("the page of a study is whole, holds the study and loads nothing") {
    const std::string page = studyPage(R"({"scene":{"name":"</script><b>&\u00b5"}})");
    CHECK(page.find(R"({"scene":{"name":"\u003c/script>\u003cb>&\u00b5"}})") != std::string::npos);
    CHECK(page.starts_with("<!doctype html>"));
    CHECK(page.ends_with("</html>\n"));
    for (const char* mark :
         {"@STYLE@", "@SCRIPT@", "@STUDY@", "https:", "@import", "url(http", "<link rel=\"stylesheet", "src=\"http"}) {
        INFO(mark);
        CHECK(page.find(mark) == std::string::npos);
    }
    std::size_t scripts = 0;
    for (std::size_t at = 0; (at = page.find("</script", at)) != std::string::npos; ++at) ++scripts;
    CHECK(scripts == 2);
}
