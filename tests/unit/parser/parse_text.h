// Helpers of the parser tests: texts in memory and short descriptions of what came out.
#pragma once

#include "base/diagnostic_format.h"
#include "parser/parse.h"
#include "support/print_document.h"

#include <fmt/format.h>
#include <memory>
#include <string>
#include <vector>

namespace abbe::test {

struct Parsed {
    std::unique_ptr<SourceMap> sources = std::make_unique<SourceMap>();
    FileId file = FileId::none;
    Diagnostics diagnostics;
    std::shared_ptr<schema::Document> document;

    schema::Node root(std::size_t i = 0) const {
        auto next = document->roots().begin();
        while (i-- > 0) ++next;
        return *next;
    }
    std::string printed() const { return print(*document); }
    std::string errors() const { return formatShort(diagnostics, *sources); }
    // "E0105@3-7 E0106@9-11"
    std::string codes() const {
        std::string list;
        for (const Diagnostic& d : diagnostics.all())
            list += fmt::format("{}{}@{}-{}", list.empty() ? "" : " ", d.code, d.span.begin, d.span.end);
        return list;
    }
};

inline Parsed parseText(std::string text, const std::vector<std::string>& overrides = {}) {
    Parsed parsed;
    parsed.file = parsed.sources->add("test.scene", std::move(text));
    ParseOptions options;
    for (const std::string& o : overrides)
        if (auto given = readOverride(*parsed.sources, o, parsed.diagnostics)) options.overrides.push_back(*given);
    parsed.document = parse(*parsed.sources, parsed.file, options, parsed.diagnostics);
    return parsed;
}

// What the first node of a text without mistakes prints as.
inline std::string printedText(std::string text) {
    const Parsed parsed = parseText(std::move(text));
    return parsed.diagnostics.all().empty() ? parsed.printed() : parsed.errors();
}

} // namespace abbe::test
