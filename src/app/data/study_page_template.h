// The HTML page of `abbe study`, put together by the build from app/data/study_page.
#pragma once

namespace abbe {

// With the mark @STUDY@: JSON inside a script element.
extern const char* const kStudyPageTemplate;

} // namespace abbe
