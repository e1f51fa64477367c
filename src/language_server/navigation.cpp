#include "language_server/features.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::lsp {

using schema::Kind;

Json View::location(Span span) const {
    if (span.file == analysis.file()) return {{"uri", uri}, {"range", toJson(range(span))}};
    const std::string_view text = analysis.sources().text(span.file);
    const TextLines other(text);
    const Range there{other.position(text, span.begin, encoding), other.position(text, span.end, encoding)};
    return {{"uri", uriOf(std::string(analysis.sources().path(span.file)))}, {"range", toJson(there)}};
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

// Renaming.

namespace {

bool isParameter(const Meaning& m) { return m.sense == Sense::parameter || m.sense == Sense::parameterUse; }

// The word without the `$` of a parameter and the quotes of a text: what an editor puts into its field.
Span nameSpan(const Meaning& m, std::string_view text) {
    Span span = m.span;
    const std::string_view written = text.substr(span.begin, span.end - span.begin);
    if (m.sense == Sense::parameterUse && written.starts_with('$')) ++span.begin;
    return span;
}

const Meaning& renamed(const View& view, std::size_t offset) {
    const Meaning* const meaning = view.analysis.meaningAt(offset);
    const bool named =
        meaning && (meaning->sense == Sense::name || meaning->sense == Sense::reference || isParameter(*meaning));
    if (!named)
        throw RequestError(ErrorCode::requestFailed, "only the names of definitions and parameters can be renamed");
    const auto all = view.analysis.occurrences(*meaning);
    const bool defined = std::ranges::any_of(
        all, [](const Meaning& m) { return m.sense == Sense::name || m.sense == Sense::parameter; });
    if (!defined)
        throw RequestError(ErrorCode::requestFailed, fmt::format("`{}` is not defined in this file", meaning->text));
    return *meaning;
}

bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

// As DefinitionReader has it: other names stand in quotes.
bool isName(std::string_view name) {
    constexpr std::string_view kInside = "0123456789.:-";
    return !name.empty() && isLetter(name[0]) &&
           std::ranges::all_of(name, [&](char c) { return isLetter(c) || kInside.find(c) != std::string_view::npos; });
}

constexpr std::string_view kKeywords[] = {"true", "false", "null", "inf", "nan"};

std::string written(const Meaning& of, const std::string& name) {
    const bool keyword = std::ranges::find(kKeywords, name) != std::end(kKeywords);
    if (isName(name) && !keyword) return name;
    if (isParameter(of))
        throw RequestError(ErrorCode::requestFailed,
                           "the name of a parameter begins with a letter and holds letters, digits and `_ . : -`");
    std::string text = "\"";
    for (const char c : name) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            throw RequestError(ErrorCode::requestFailed, "a name stands on one line, without control characters");
        if (c == '"' || c == '\\') text += '\\';
        text += c;
    }
    return text + '"';
}

void refuseTaken(const View& view, const Meaning& of, const std::string& name) {
    const auto refuse = [&](std::string_view what) {
        throw RequestError(ErrorCode::requestFailed, fmt::format("`{}` is {}", name, what));
    };
    if (isParameter(of)) {
        const auto& all = view.analysis.document().parameters;
        if (std::ranges::find(all, name, &schema::Document::Parameter::name) != all.end())
            refuse("the name of another parameter");
        return;
    }
    const auto& tree = view.analysis.tree();
    if (tree.find(of.kind, name)) refuse(fmt::format("the name of another {}", keyword(of.kind)));
    if (view.analysis.language().types.find(of.kind, name)) refuse(fmt::format("a type of {}", keyword(of.kind)));
    const bool spectral = of.kind == Kind::spectrum || of.kind == Kind::texture;
    const Kind other = of.kind == Kind::spectrum ? Kind::texture : Kind::spectrum;
    if (spectral && tree.find(other, name)) refuse(fmt::format("the name of a {}", keyword(other)));
}

// The edits of one file, from its begin to its end.
struct Replacement {
    Span span;
    std::string text;
};

std::string replaced(std::string_view text, const std::vector<Replacement>& edits) {
    std::string out;
    std::size_t at = 0;
    for (const Replacement& edit : edits) {
        out += text.substr(at, edit.span.begin - at);
        out += edit.text;
        at = edit.span.end;
    }
    return out += text.substr(at);
}

// A name may be near to a type, or stand where a type could: what the scene then says must be the same.
void refuseChange(const View& view, const Meaning& of, const std::string& name, const std::vector<Replacement>& edits) {
    const Analysis after(view.analysis.language(), std::string(view.analysis.sources().path(view.analysis.file())),
                         replaced(view.analysis.text(), edits));
    Meaning same = of;
    same.text = name;
    if (after.errorCount() <= view.analysis.errorCount() && after.occurrences(same).size() == edits.size()) return;
    throw RequestError(ErrorCode::requestFailed,
                       fmt::format("with the name `{}` the scene would mean something else", name));
}

} // namespace

Json renamable(const View& view, std::size_t offset) {
    const Meaning& meaning = renamed(view, offset);
    return {{"range", toJson(view.range(nameSpan(meaning, view.analysis.text())))}, {"placeholder", meaning.text}};
}

Json rename(const View& view, std::size_t offset, const std::string& newName) {
    const Meaning& meaning = renamed(view, offset);
    std::string name = newName;
    if (isParameter(meaning) && name.starts_with('$')) name.erase(0, 1);
    if (name.empty()) throw RequestError(ErrorCode::requestFailed, "a name is not empty");
    Json edits = Json::array();
    if (name != meaning.text) {
        refuseTaken(view, meaning, name);
        const std::string text = written(meaning, name);
        std::vector<Replacement> replacements;
        for (const Meaning& m : view.analysis.occurrences(meaning))
            replacements.push_back({nameSpan(m, view.analysis.text()), text});
        refuseChange(view, meaning, name, replacements);
        for (const Replacement& r : replacements) edits.push_back(toJson(TextEdit{view.range(r.span), r.text}));
    }
    return {{"changes", {{view.uri, std::move(edits)}}}};
}

} // namespace abbe::lsp
