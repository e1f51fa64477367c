// The syntax of scenes: text to tree to text.
#include "base/diagnostic_format.h"
#include "fuzz/target.h"
#include "parser/foreign_file.h"
#include "parser/parse.h"
#include "support/print_document.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    SourceMap sources;
    Diagnostics diagnostics;
    const std::string text = fuzz::bytesOf(data, size);
    parser::recogniseForeign(text, "fuzz.scene");
    const FileId file = sources.add("fuzz.scene", text);
    const auto document = parse(sources, file, {}, diagnostics);
    for (const Diagnostic& d : diagnostics.all())
        fuzz::require(d.span.begin <= d.span.end && d.span.end <= size, "a place outside of the text");
    formatHuman(diagnostics, sources);
    formatJson(diagnostics, sources);
    // What was understood prints as a text that means the same.
    const std::string printed = test::print(*document);
    Diagnostics second;
    const FileId again = sources.add("printed.scene", printed);
    fuzz::require(diagnostics.errorCount() > 0 || test::print(*parse(sources, again, {}, second)) == printed,
                  "what was understood prints as something else");
    return 0;
}
