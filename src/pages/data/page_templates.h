// Pages of HTML, put together by the build from the folders beside this file: plain JavaScript, nothing loaded from
// anywhere. Text from outside enters by textContent alone.
#pragma once

namespace abbe {

// With the mark @STUDY@: JSON inside a script element.
extern const char* const kStudyPageTemplate;
// With the marks @TITLE@, @FACTS@ and @DATA@, in this order.
extern const char* const kComparePageTemplate;

} // namespace abbe
