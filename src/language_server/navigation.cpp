#include "language_server/documents.h"
#include "language_server/features.h"

#include <filesystem>

namespace abbe::lsp {

Json View::location(Span span) const {
    if (span.file == analysis.file()) return {{"uri", uri}, {"range", toJson(range(span))}};
    const std::filesystem::path path(analysis.sources().path(span.file));
    const OpenText* const open = workspace ? workspace->find(path) : nullptr;
    return {{"uri", open ? open->uri() : uriOf(path)}, {"range", toJson(rangeIn(analysis, span, encoding))}};
}

Range rangeIn(const Analysis& analysis, Span span, Encoding encoding) {
    const std::string_view text = analysis.sources().text(span.file);
    const TextLines& lines = analysis.lines(span.file);
    return {lines.position(text, span.begin, encoding), lines.position(text, span.end, encoding)};
}

Json definitionOf(const View& view, std::size_t offset) {
    const Meaning* const meaning = view.analysis.meaningAt(offset);
    if (!meaning) return nullptr;
    if (meaning->sense == Sense::file) {
        const auto path = view.analysis.tree().directory / std::string(meaning->text);
        std::error_code error;
        if (!std::filesystem::is_regular_file(path, error)) return nullptr;
        return {{"uri", uriOf(std::filesystem::absolute(path, error).lexically_normal())}, {"range", toJson(Range{})}};
    }
    Json locations = Json::array();
    for (const Meaning& m : view.analysis.occurrences(*meaning))
        if (m.sense == Sense::name || m.sense == Sense::parameter) locations.push_back(view.location(m.span));
    return locations;
}

Json referencesTo(const View& view, std::size_t offset, bool withDefinition) {
    const Meaning* const meaning = view.analysis.meaningAt(offset);
    Json locations = Json::array();
    if (!meaning) return locations;
    for (const Meaning& m : view.analysis.occurrences(*meaning))
        if (withDefinition || (m.sense != Sense::name && m.sense != Sense::parameter))
            locations.push_back(view.location(m.span));
    return locations;
}

Json highlights(const View& view, std::size_t offset) {
    constexpr int kRead = 2, kWrite = 3;
    const Meaning* const meaning = view.analysis.meaningAt(offset);
    Json found = Json::array();
    if (!meaning) return found;
    for (const Meaning& m : view.analysis.occurrences(*meaning))
        if (m.span.file == view.analysis.file())
            found.push_back({{"range", toJson(view.range(m.span))},
                             {"kind", m.sense == Sense::name || m.sense == Sense::parameter ? kWrite : kRead}});
    return found;
}

} // namespace abbe::lsp
