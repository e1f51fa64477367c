// Texts that are computed, between parameters that refer to each other: a finite value, or faults that point into them.
#include "schema/expression.h"

#include "base/diagnostic_format.h"
#include "fuzz/target.h"
#include "parser/parse.h"

#include <cmath>

using namespace abbe;

// The bytes are lines: the first one is computed, and the others are the values of `$a`, `$b`, and so on.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    SourceMap sources;
    Diagnostics diagnostics;
    std::string scene = "scene 1\nrender { noise ", parameters, line;
    char name = 'a';
    bool first = true;
    const std::string text = fuzz::bytesOf(data, size) + "\n";
    for (const char c : text) {
        if (c != '\n') {
            if (c == '"' || c == '\\') line += '\\';
            line += c;
            continue;
        }
        if (first)
            scene += "\"" + line + "\" }\n";
        else if (name <= 'z')
            scene += std::string("param ") + name++ + " \"" + line + "\"\n";
        first = false;
        line.clear();
    }
    const FileId file = sources.add("fuzz.scene", scene);
    const std::shared_ptr<const schema::Document> document = parse(sources, file, {}, diagnostics);
    schema::ParameterScopes scopes;
    scopes.add(file, document);
    for (const schema::Node node : document->roots())
        for (const schema::Node child : node.children())
            for (std::size_t i = 0; i < child.valueCount(); ++i) {
                const schema::Value value = child.value(i);
                if (!schema::isComputed(value)) continue;
                Diagnostics found;
                const auto amount = schema::compute(value, &scopes, found);
                fuzz::require(amount.has_value() != found.hasErrors(), "neither a value nor a fault, or both");
                fuzz::require(!amount || std::isfinite(amount->value), "a value that is not finite");
                diagnostics.addAll(found);
            }
    for (const Diagnostic& d : diagnostics.all())
        fuzz::require(d.span.begin <= d.span.end && d.span.end <= sources.text(d.span.file).size(),
                      "a place outside of the text");
    formatHuman(diagnostics, sources);
    return 0;
}
