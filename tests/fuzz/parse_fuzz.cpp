// libFuzzer target of the scene parser; not built by default:
//   clang++ -std=c++20 -g -O1 -march=x86-64-v3 -fsanitize=fuzzer,address,undefined -Isrc -I. tests/fuzz/parse_fuzz.cpp
//       parser/*.cpp src/base/*.cpp src/schema/{document,unit,suggest,type}.cpp -lfmt -ltbb -o parse_fuzz
//   ./parse_fuzz -max_len=4096 corpus tests/language/good tests/language/bad
#include "base/diagnostic_format.h"
#include "parser/parse.h"
#include "parser/print.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    abbe::SourceMap sources;
    abbe::Diagnostics diagnostics;
    const abbe::FileId file = sources.add("fuzz.scene", std::string(reinterpret_cast<const char*>(data), size));
    const auto document = abbe::parse(sources, file, {}, diagnostics);
    for (const abbe::Diagnostic& d : diagnostics.all())
        if (d.span.begin > d.span.end || d.span.end > size) std::abort();
    abbe::formatHuman(diagnostics, sources);
    abbe::formatJson(diagnostics, sources);
    // What was understood prints as a text that means the same.
    const std::string printed = abbe::print(*document);
    abbe::Diagnostics second;
    const abbe::FileId again = sources.add("printed.scene", printed);
    if (diagnostics.errorCount() == 0 && abbe::print(*abbe::parse(sources, again, {}, second)) != printed) std::abort();
    return 0;
}
