// The report of `abbe study` as one page of HTML that needs no server and loads nothing: findings in words, plots of
// error against time and samples, tables, pictures at equal time, the cost report and the effects. It is drawn in the
// browser by the scripts of pages/data/study_page, which are part of the page as the data are.
#pragma once

#include <string>
#include <string_view>

namespace abbe {

// `json` is a study ("abbe-study/1"); whatever is absent or null in it is left out of the page. It is written into the
// page as it stands, so that the page saves the same figures.
std::string studyPage(std::string_view json);

} // namespace abbe
