#include "language_server/features.h"
#include "schema/describe.h"
#include "schema/preset_library.h"
#include "schema/spectrum_reader.h"
#include "schema/suggest.h"
#include "spectrum/named_spectra.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::lsp {

using schema::FieldInfo;
using schema::Kind;

namespace {

std::string row(std::string_view label, std::string_view text) {
    return text.empty() ? std::string() : fmt::format("* {}: {}\n", label, text);
}

std::string example(std::string_view text) {
    return text.empty() ? std::string() : fmt::format("\n```kdl\n{}\n```\n", text);
}

std::string oneLine(std::string_view text) {
    constexpr std::size_t kLongest = 120;
    text = text.substr(0, text.find_first_of("\r\n"));
    if (text.size() <= kLongest) return std::string(text);
    std::size_t end = kLongest;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0u) == 0x80u) --end;
    return std::string(text.substr(0, end)) + "…";
}

} // namespace

std::string fieldMarkdown(const FieldInfo& field, const std::string& title) {
    std::string text = fmt::format("**{}**: {}\n\n", title, field.doc);
    text += row("takes", schema::describeField(field));
    if (const auto units = schema::unitsOf(field); !units.empty()) {
        text += row("units", schema::quotedList(units, "or"));
        text += row("without a unit", schema::meaningWithoutUnit(field.dimensions[0]));
    }
    const std::string_view none = field.required ? "none, it must be given" : "";
    text += row("default", field.defaultText.empty() ? std::string(none) : fmt::format("`{}`", field.defaultText));
    text += row("range", schema::describeRange(field));
    if (!field.group.empty()) text += row("one of", fmt::format("the ways to state the {}", field.group));
    for (const schema::FieldKey& key : field.keys)
        text += row(fmt::format("`{}=`", key.name), key.doc.empty() ? schema::quotedList(key.choices, "or") : key.doc);
    for (const FieldInfo& inner : field.block) text += row(fmt::format("block: `{}`", inner.name), inner.doc);
    text += row("elsewhere called", schema::quotedList(field.synonyms));
    text += row("note", field.note);
    return text + example(field.example);
}

namespace {

class HoverText {
  public:
    explicit HoverText(const View& view) : view_(view), types_(view.analysis.language().types) {}

    std::string of(const Meaning& m) const {
        switch (m.sense) {
        case Sense::kind:
            return kind(m);
        case Sense::type:
            return m.type ? fmt::format("**{} {}**: {}\n{}", keyword(m.kind), m.type->name, m.type->doc,
                                        example(m.type->example))
                          : "";
        case Sense::property:
            return property(m);
        case Sense::key:
            return key(m);
        case Sense::word:
            return m.field ? fieldMarkdown(*m.field, std::string(m.field->name)) : "";
        case Sense::unit:
            return unit(m.text);
        case Sense::form:
            return form(m.text);
        case Sense::data:
            return data(m);
        case Sense::file:
            return file(m);
        case Sense::name:
        case Sense::reference:
            return name(m);
        case Sense::parameter:
        case Sense::parameterUse:
            return parameter(m.text);
        }
        return {};
    }

  private:
    std::string kind(const Meaning& m) const {
        if (schema::findKind(m.text)) {
            const schema::KindText& about = schema::kindText(m.kind);
            return fmt::format("`{}`\n\n{}\n{}", about.head, about.doc, example(about.example));
        }
        for (const schema::LanguageWord& word : schema::languageWords())
            if (word.name == m.text) return fmt::format("**{}**: {}\n{}", word.name, word.doc, example(word.example));
        return {};
    }

    std::string property(const Meaning& m) const {
        if (!m.field) return {};
        if (m.field->name == m.text) {
            const std::string of = m.type ? fmt::format("{} {}: ", keyword(m.type->kind), m.type->name) : "";
            return fieldMarkdown(*m.field, fmt::format("{}{}", of, m.text));
        }
        for (const schema::LanguageWord& word : schema::languageWords()) { // a step
            if (word.name == m.text) return fmt::format("**{}**: {}\n{}", word.name, word.doc, example(word.example));
            for (const schema::WordPart& part : word.parts)
                if (part.name == m.text && word.name == "transform")
                    return fmt::format("**{}**: {}\n\n{}{}", part.name, part.doc, row("takes", part.takes),
                                       example(part.example));
        }
        return fieldMarkdown(*m.field, std::string(m.field->name));
    }

    std::string key(const Meaning& m) const {
        if (m.field) {
            for (const schema::FieldKey& known : m.field->keys)
                if (known.name == m.text)
                    return fmt::format(
                        "**{}=**: {}\n{}", known.name, known.doc,
                        known.choices.empty() ? "" : "\n" + row("one of", schema::quotedList(known.choices, "or")));
            return fieldMarkdown(*m.field, std::string(m.field->name));
        }
        for (const schema::LanguageWord& word : schema::languageWords()) // of the header
            for (const schema::WordPart& part : word.parts)
                if (word.name == "scene" && part.name.substr(0, part.name.size() - 1) == m.text)
                    return fmt::format("**{}**: {}\n\n{}{}{}", part.name, part.doc, row("takes", part.takes),
                                       row("default", part.defaultText), example(part.example));
        return {};
    }

    static std::string unit(std::string_view word) {
        const auto unit = schema::findUnit(word);
        if (!unit) return {};
        const std::string is =
            unit->scale == 1 ? "" : fmt::format("{:.9g} {}", unit->scale, schema::siUnit(unit->dimension));
        return fmt::format("**{}**: {}\n\n{}{}", unit->name, schema::describe(unit->dimension), row("is", is),
                           row("others", schema::quotedList(schema::spellings(unit->dimension))));
    }

    static std::string form(std::string_view word) {
        const schema::SpectrumForm* const form = schema::findSpectrumForm(word);
        return form ? fmt::format("**{}**: {}\n{}", form->name, form->doc, example(form->example)) : "";
    }

    std::string data(const Meaning& m) const {
        if (m.type && types_.presets())
            for (const schema::Preset& preset : types_.presets()->all())
                if (preset.name == m.text && preset.kind == m.type->kind)
                    return fmt::format("**preset {}** ({}): {}\n\n{}", preset.name, preset.group, preset.doc,
                                       row("from", preset.source));
        if (const auto metal = findMetal(m.text); metal && !findGlass(m.text))
            return fmt::format(
                "**metal {}**\n\n{}{}", metal->name, row("from", metal->source),
                row("wavelengths", fmt::format("{:.0f} to {:.0f} nm", metal->nm.front(), metal->nm.back())));
        if (const auto glass = findGlass(m.text))
            return fmt::format("**glass {}**\n\n{}{}", glass->name, row("from", glass->source),
                               row("wavelengths", fmt::format("{:.0f} to {:.0f} nm", glass->minNm, glass->maxNm)));
        auto spectrum = findIlluminant(m.text);
        if (!spectrum) spectrum = findMeasured(m.text);
        if (!spectrum) return {};
        const double last = spectrum->firstNm + spectrum->stepNm * static_cast<double>(spectrum->values.size() - 1);
        return fmt::format("**{}**\n\n{}{}", spectrum->name, row("from", spectrum->source),
                           row("wavelengths", fmt::format("{:.0f} to {:.0f} nm", spectrum->firstNm, last)));
    }

    std::string file(const Meaning& m) const {
        const auto path = view_.analysis.tree().directory / std::string(m.text);
        std::error_code error;
        const auto bytes = std::filesystem::file_size(path, error);
        const std::string size = error ? "there is no such file" : fmt::format("{} bytes", bytes);
        return fmt::format("`{}`: {}\n", path.lexically_normal().string(), size) +
               (m.field ? "\n" + fieldMarkdown(*m.field, std::string(m.field->name)) : "");
    }

    // The place of a definition, and its first line.
    std::string name(const Meaning& m) const {
        const schema::Definition* const d = view_.analysis.tree().find(m.kind, m.text);
        if (!d) return fmt::format("no {} is named `{}`\n", keyword(m.kind), m.text);
        const std::size_t uses = view_.analysis.occurrences(m).size() - 1;
        const SourceMap& sources = view_.analysis.sources();
        const LineColumn at = sources.lineColumn(d->span.file, d->span.begin);
        const std::string_view line = sources.text(d->span.file).substr(d->span.begin);
        return fmt::format("**{} `{}`**{}: {}\n\n* defined on line {}, used {} times\n{}", keyword(m.kind), m.text,
                           d->type ? fmt::format(", {}", d->type->name) : "",
                           d->type ? d->type->doc : schema::kindText(m.kind).doc, at.line, uses,
                           example(oneLine(line)));
    }

    std::string parameter(std::string_view name) const {
        for (const auto& p : view_.analysis.document().parameters)
            if (p.name == name)
                return fmt::format("**${}**{}{}\n\n* value: `{}`\n* on the command line: `-D {}=…`\n", name,
                                   p.doc.empty() ? "" : ": ", p.doc, p.defaultText, name);
        return fmt::format("no parameter is named `{}`\n", name);
    }

    const View& view_;
    const schema::TypeTable& types_;
};

bool holds(const Range& range, Position at) {
    const auto before = [](Position a, Position b) {
        return a.line != b.line ? a.line < b.line : a.character < b.character;
    };
    return !before(at, range.start) && !before(range.end, at);
}

} // namespace

Json hover(const View& view, std::size_t offset, std::span<const Finding> findings) {
    std::string text;
    const Meaning* const meaning = view.analysis.meaningAt(offset);
    if (meaning) text = HoverText(view).of(*meaning);
    const Position at = view.lines.position(view.analysis.text(), offset, view.encoding);
    for (const Finding& finding : findings)
        if (const CodeInfo* const code = holds(finding.range, at) ? findCode(finding.code) : nullptr)
            text += fmt::format("{}**{}**: {}\n\n{}\n", text.empty() ? "" : "\n---\n", code->code, code->title,
                                code->explanation);
    if (text.empty()) return nullptr;
    Json result = {{"contents", {{"kind", "markdown"}, {"value", text}}}};
    if (meaning) result["range"] = toJson(view.range(meaning->span));
    return result;
}

} // namespace abbe::lsp
