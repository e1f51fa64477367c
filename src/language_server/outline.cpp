#include "language_server/features.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace abbe::lsp {

using schema::Kind;
using schema::Node;

namespace {

// Numbers of the protocol.
int symbolKind(Kind kind) {
    constexpr int kModule = 2, kNamespace = 3, kClass = 5, kProperty = 7, kInterface = 11, kConstant = 14, kObject = 19,
                  kEvent = 24;
    switch (kind) {
    case Kind::camera:
    case Kind::film:
    case Kind::render:
        return kInterface;
    case Kind::light:
        return kEvent;
    case Kind::group:
        return kNamespace;
    case Kind::object:
        return kModule;
    case Kind::material:
    case Kind::phase:
    case Kind::medium:
    case Kind::atmosphere:
        return kClass;
    case Kind::spectrum:
        return kConstant;
    case Kind::texture:
        return kProperty;
    default:
        return kObject;
    }
}

constexpr int kParameterSymbol = 13;

// What stands behind the kind: "ball sphere".
std::string headOf(const Node& node) {
    std::string text;
    const std::size_t count = node.allNumbers() ? 0 : std::min<std::size_t>(node.valueCount(), 3);
    for (std::size_t i = 0; i < count; ++i) {
        const schema::Value value = node.value(i);
        if (!value.isText() || (i > 0 && value.kind != schema::ValueKind::word)) break; // a file
        text += fmt::format("{}{}", text.empty() ? "" : " ", value.text);
    }
    return text;
}

class Outline {
  public:
    explicit Outline(const View& view) : view_(view) {}

    Json read() {
        Json all = block(view_.analysis.document().roots());
        for (const auto& p : view_.analysis.document().parameters)
            all.push_back({{"name", fmt::format("${}", p.name)},
                           {"detail", p.defaultText},
                           {"kind", kParameterSymbol},
                           {"range", toJson(view_.range(p.nameSpan))},
                           {"selectionRange", toJson(view_.range(p.nameSpan))}});
        return all;
    }

  private:
    Json block(schema::NodeRange nodes) {
        Json symbols = Json::array();
        for (const Node node : nodes)
            if (const auto kind = schema::findKind(node.name())) symbols.push_back(symbol(node, *kind));
        return symbols;
    }

    Json symbol(const Node& node, Kind kind) {
        const std::string head = headOf(node);
        Span name = node.nameSpan();
        if (!head.empty() && !node.value(0).use.valid()) name = node.value(0).span;
        Json json = {{"name", head.empty() ? std::string(node.name()) : head},
                     {"detail", node.name()},
                     {"kind", symbolKind(kind)},
                     {"range", toJson(view_.range(node.span()))},
                     {"selectionRange", toJson(view_.range(name))}};
        if (isContainer(kind)) json["children"] = block(node.children());
        return json;
    }

    const View& view_;
};

void foldBlocks(const View& view, schema::NodeRange nodes, Json& out) {
    for (const Node node : nodes) {
        if (!node.hasBlock()) continue;
        const Range range = view.range(node.span());
        const Position head = view.range(node.headSpan()).end;
        if (range.end.line > head.line) { // the line of the closing brace stays in sight
            const bool brace = view.analysis.text()[node.span().end - 1] == '}';
            const std::uint32_t last = range.end.line - (brace ? 1 : 0);
            if (last > head.line) out.push_back({{"startLine", head.line}, {"endLine", last}});
        }
        foldBlocks(view, node.children(), out);
    }
}

bool beginsComment(const View& view, std::size_t line) {
    const std::string_view text = view.analysis.text();
    const std::size_t first = text.find_first_not_of(" \t", view.lines.begin(line));
    return first != std::string_view::npos && text.substr(first, 2) == "//";
}

void foldComments(const View& view, Json& out) {
    for (std::size_t line = 0; line < view.lines.count(); ++line) {
        const std::size_t first = line;
        while (line < view.lines.count() && beginsComment(view, line)) ++line;
        if (line > first + 1) out.push_back({{"startLine", first}, {"endLine", line - 1}, {"kind", "comment"}});
    }
}

constexpr auto kTokenTypes = std::to_array<std::string_view>(
    {"keyword", "type", "variable", "property", "parameter", "enumMember", "function", "string"});

// Places in kTokenTypes.
std::uint32_t tokenType(Sense sense) {
    switch (sense) {
    case Sense::kind:
        return 0;
    case Sense::type:
        return 1;
    case Sense::name:
    case Sense::reference:
        return 2;
    case Sense::property:
    case Sense::key:
        return 3;
    case Sense::parameter:
    case Sense::parameterUse:
        return 4;
    case Sense::unit:
    case Sense::word:
    case Sense::data:
        return 5;
    case Sense::form:
        return 6;
    case Sense::file:
        return 7;
    }
    return 0;
}

} // namespace

Json symbols(const View& view) { return Outline(view).read(); }

Json foldings(const View& view) {
    Json out = Json::array();
    foldBlocks(view, view.analysis.document().roots(), out);
    foldComments(view, out);
    return out;
}

Json links(const View& view) {
    Json out = Json::array();
    for (const Meaning& m : view.analysis.meanings()) {
        if (m.sense != Sense::file || m.span.file != view.analysis.file()) continue;
        const auto path = view.analysis.tree().directory / std::string(m.text);
        std::error_code error;
        if (!std::filesystem::is_regular_file(path, error)) continue;
        out.push_back({{"range", toJson(view.range(m.span))},
                       {"target", uriOf(std::filesystem::absolute(path, error).lexically_normal())}});
    }
    return out;
}

Json semanticLegend() { return {{"tokenTypes", kTokenTypes}, {"tokenModifiers", {"declaration"}}}; }

// Five numbers a word: lines and columns from the one before, length, type, modifiers.
Json semanticTokens(const View& view) {
    std::vector<std::uint32_t> data;
    Position last;
    for (const Meaning& m : view.analysis.meanings()) {
        const Range range = view.range(m.span);
        if (m.span.file != view.analysis.file() || range.start.line != range.end.line) continue;
        const std::uint32_t lines = range.start.line - last.line;
        const std::uint32_t columns = range.start.character - (lines == 0 ? last.character : 0);
        const bool declares = m.sense == Sense::name || m.sense == Sense::parameter;
        data.insert(data.end(), {lines, columns, range.end.character - range.start.character, tokenType(m.sense),
                                 declares ? 1u : 0u});
        last = range.start;
    }
    return {{"data", std::move(data)}};
}

} // namespace abbe::lsp
