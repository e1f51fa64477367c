// The HTML page of `abbe compare --html`.
#pragma once

namespace abbe {

// With the marks @TITLE@ (HTML text), @FACTS@ (JSON inside a script element) and @DATA@ (script elements); described in
// app/compare_page.h.
extern const char* const kComparePageTemplate;

} // namespace abbe
