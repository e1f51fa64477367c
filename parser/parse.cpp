#include "parser/parse.h"

#include "parser/brace_plan.h"
#include "parser/parameters.h"
#include "parser/source_text.h"
#include "parser/tree_reader.h"

#include <algorithm>
#include <span>

namespace abbe {

namespace {

constexpr std::size_t kLongest = std::size_t{64} << 20; // bytes of a text whose braces are looked at

bool mayBeOfBraces(const Diagnostic& d) {
    return d.code == "E0110" || d.code == "E0111" || d.code == "E0121" || d.code == "E0123" || d.code == "E0101";
}

bool isOfBraces(const Diagnostic& d) { return d.code == "E0110" || d.code == "E0111"; }

// One reading of a text: the tree, where it uses parameters, and what is wrong.
struct Reading {
    std::shared_ptr<schema::Document> document = std::make_shared<schema::Document>();
    std::vector<parser::ParameterUse> uses;
    Diagnostics found;

    Reading(FileId file, std::string_view text, const parser::BracePlan* plan, std::uint32_t maxDepth) {
        document->file = file;
        document->source = plan ? document->intern(plan->text) : text;
        const char* const begin = document->source.data();
        if (plan) found = plan->found;
        parser::SyntaxErrors errors({file, begin, begin + text.size()}, found);
        if (!plan && !parser::checkCharacters(errors)) return;
        const auto implied = plan ? std::span(plan->implied) : std::span<const parser::ImpliedBrace>();
        parser::TreeReader reader(errors, *document, maxDepth, implied);
        reader.read();
        uses = reader.uses();
    }
};

// Where braces do not agree, the text is read again as indentation says that it was meant, if it then holds together.
Reading readAsMeant(FileId file, std::string_view text, std::uint32_t maxDepth) {
    Reading asWritten(file, text, nullptr, maxDepth);
    if (text.size() > kLongest || std::ranges::none_of(asWritten.found.all(), mayBeOfBraces)) return asWritten;
    const auto plan = parser::planBraces({file, text.data(), text.data() + text.size()});
    if (!plan) return asWritten;
    Reading asMeant(file, text, &*plan, maxDepth);
    const auto own = std::span(asMeant.found.all()).subspan(plan->found.all().size());
    return std::ranges::any_of(own, isOfBraces) ? std::move(asWritten) : std::move(asMeant);
}

} // namespace

std::shared_ptr<schema::Document> parse(const SourceMap& sources, FileId file, const ParseOptions& options,
                                        Diagnostics& diagnostics) {
    const Reading reading = readAsMeant(file, sources.text(file), options.maxDepth);
    diagnostics.addAll(reading.found);
    parser::ParameterTable parameters(*reading.document, diagnostics);
    parameters.override(options, sources);
    parameters.substitute(reading.uses);
    return reading.document;
}

} // namespace abbe
