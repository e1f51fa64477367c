// The layout of scenes: whatever parses is laid out to the same tree, and once for all.
#include "fuzz/target.h"
#include "parser/parse.h"

#include <algorithm>

using namespace abbe;

namespace {

struct Reading {
    SourceMap sources;
    std::shared_ptr<schema::Document> document;
    bool wellFormed = false;

    explicit Reading(std::string text) {
        Diagnostics diagnostics;
        const FileId file = sources.add("fuzz.scene", std::move(text));
        document = parse(sources, file, {}, diagnostics);
        wellFormed =
            std::ranges::none_of(diagnostics.all(), [](const Diagnostic& d) { return d.code.starts_with("E01"); }) &&
            std::ranges::none_of(diagnostics.all(), [](const Diagnostic& d) { return d.code == "E0412"; });
    }
};

std::size_t countOf(const schema::NodeRange& nodes) {
    std::size_t count = 0;
    for (const schema::Node node : nodes) count += 1 + countOf(node.children());
    return count;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text = fuzz::bytesOf(data, size);
    const Reading reading(text);
    if (!reading.wellFormed) return 0;
    const std::string once = layOut(text);
    const Reading again(once);
    fuzz::require(again.wellFormed, "the layout has syntax errors");
    fuzz::require(sameMeaning(*reading.document, *again.document), "the layout means something else");
    fuzz::require(layOut(once) == once, "the layout is not final");
    const Reading upgraded(layOut(withEdition(text)));
    fuzz::require(upgraded.wellFormed && countOf(upgraded.document->roots()) == countOf(reading.document->roots()) + 1,
                  "the edition is not one node more");
    return 0;
}
