#include "schema/describe.h"
#include "schema/spectrum_reader.h"
#include "schema/suggest.h"
#include "spectrum/named_spectra.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

constexpr int kReferenceKinds = static_cast<int>(Kind::render) + 1;
constexpr int kReferenceDimensions = static_cast<int>(Dimension::pixels) + 1;

constexpr std::string_view kMade = "*Made by `abbe reference pages docs/reference` from the tables that the program "
                                   "reads scenes with.*\n\n";

// Rows are lines of their own, and bars would end a cell.
std::string tableCell(std::string_view text) {
    std::string cell;
    for (const char c : text) {
        if (c == '|') cell += '\\';
        cell += c;
    }
    return cell;
}

std::string inCode(std::string_view text) { return text.empty() ? std::string() : fmt::format("`{}`", text); }

std::string kdlBlock(std::string_view example) { return fmt::format("```kdl\n{}\n```\n\n", example); }

// One row of a table of properties.
struct PropertyRow {
    std::string name, takes, unit, range, standard, meaning, example;

    std::string text() const {
        return fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", name, tableCell(takes), unit, range,
                           tableCell(standard), tableCell(meaning), tableCell(example));
    }
};

constexpr std::string_view kPropertyHead =
    "| property | takes | [unit](units.md) | range | default | meaning | example |\n|---|---|---|---|---|---|---|\n";

// The commonest units of each quantity; the others are on their own page.
std::string unitCell(const FieldInfo& field) {
    constexpr std::size_t most = 3;
    std::string text;
    for (const Dimension d : field.dimensions) {
        const auto names = spellings(d);
        for (std::size_t i = 0; i < std::min(most, names.size()); ++i)
            text += fmt::format("{}{}", text.empty() ? "" : " ", inCode(names[i]));
        if (names.size() > most) text += " …";
    }
    return text;
}

std::string takesCell(const FieldInfo& field) {
    if (field.type != FieldType::choice || field.choices.empty()) return describeField(field);
    std::string words;
    for (const std::string_view choice : field.choices)
        words += fmt::format("{}`{}`", words.empty() ? "" : ", ", choice);
    return words;
}

PropertyRow rowOf(const FieldInfo& field, std::string_view inside = {}) {
    PropertyRow row;
    row.name = inside.empty() ? inCode(field.name) : fmt::format("`{} {{ {} }}`", inside, field.name);
    row.takes = takesCell(field);
    row.unit = unitCell(field);
    row.range = describeRange(field);
    row.standard = field.required ? "must be given" : inCode(field.defaultText);
    row.meaning = field.doc;
    if (!field.group.empty()) row.meaning += fmt::format(" At most one way to state the {}.", field.group);
    if (!field.note.empty()) row.meaning += fmt::format(" ({})", field.note);
    row.example = inCode(field.example);
    return row;
}

PropertyRow rowOf(const FieldKey& key, const FieldInfo& field) {
    PropertyRow row;
    row.name = fmt::format("`{} {}=`", field.name, key.name);
    for (const std::string_view choice : key.choices)
        row.takes += fmt::format("{}`{}`", row.takes.empty() ? "" : ", ", choice);
    if (row.takes.empty()) row.takes = key.number || field.type == FieldType::weighted ? "a number" : "a word or text";
    row.meaning = key.doc;
    return row;
}

std::string propertyTable(const TypeInfo& type) {
    if (type.fields.empty()) return {};
    std::string text(kPropertyHead);
    for (const FieldInfo& field : type.fields) {
        text += rowOf(field).text();
        for (const FieldKey& key : field.keys) text += rowOf(key, field).text();
        for (const FieldInfo& inner : field.block) text += rowOf(inner, field.name).text();
    }
    return text + "\n";
}

std::string typeTable(const TypeInfo& type) {
    std::string arguments;
    for (const FieldInfo& field : type.fields)
        if (field.argument >= 0) arguments += fmt::format("{}`{}`", arguments.empty() ? "" : ", then ", field.name);
    if (!arguments.empty()) arguments = fmt::format("Behind the type may stand its {}.\n\n", arguments);
    return arguments + kdlBlock(type.example) + propertyTable(type);
}

std::string typeSection(const TypeInfo& type) {
    return fmt::format("## {} {}\n\n{}{}\n\n", keyword(type.kind), type.name, type.doc,
                       type.isDefault ? " The default." : "") +
           typeTable(type);
}

std::string typeIndex(const std::vector<const TypeInfo*>& types) {
    std::string text = "| type | |\n|---|---|\n";
    for (const TypeInfo* type : types)
        text += fmt::format("| [`{0}`](#{1}-{0}) | {2}{3} |\n", type->name, keyword(type->kind), tableCell(type->doc),
                            type->isDefault ? " The default." : "");
    return text + "\n";
}

std::string nameList(std::string_view title, const std::vector<std::string_view>& names) {
    std::string text = fmt::format("**{}**:", title);
    for (const std::string_view name : names) text += fmt::format(" `{}`", name);
    return text + "\n\n";
}

std::string spectrumSection() {
    std::string text = "A plain number, the same at every wavelength; the name of a `spectrum`; or one of these forms. "
                       "[values.md](../language/values.md#spectra) says more.\n\n"
                       "| form | fits | meaning | example |\n|---|---|---|---|\n";
    for (const SpectrumForm& form : spectrumForms()) {
        std::string roles;
        for (const SpectrumRole role : {SpectrumRole::albedo, SpectrumRole::unbounded, SpectrumRole::emission,
                                        SpectrumRole::index, SpectrumRole::shape, SpectrumRole::tint})
            if (fits(form.form, role)) roles += fmt::format("{}{}", roles.empty() ? "" : "; ", describe(role));
        text += fmt::format("| `{}` | {} | {} | {} |\n", form.name, roles, tableCell(form.doc),
                            tableCell(inCode(form.example)));
    }
    return text + "\n" + nameList("illuminant", illuminantNames()) + nameList("measured", measuredNames()) +
           nameList("glass", glassNames()) + nameList("metal", metalNames());
}

// Pages that explain a kind with pictures and reasons.
std::string furtherReading(Kind kind) {
    switch (kind) {
    case Kind::camera:
        return "Explained in [cameras.md](../cameras.md) and [motion.md](../language/motion.md).\n\n";
    case Kind::light:
        return "Explained in [lights.md](../language/lights.md).\n\n";
    case Kind::shape:
        return "Explained in [shapes.md](../language/shapes.md), [values.md](../language/values.md#curves-and-points) "
               "and [deformation.md](../language/deformation.md).\n\n";
    case Kind::material:
        return "Explained in [materials.md](../language/materials.md); ready-made ones are in "
               "[the library](../materials_library.md).\n\n";
    case Kind::medium:
    case Kind::volume:
    case Kind::phase:
    case Kind::atmosphere:
        return "Explained in [media.md](../language/media.md).\n\n";
    case Kind::texture:
        return "Explained in [textures.md](../language/textures.md).\n\n";
    case Kind::film:
        return "Explained in [output.md](../output.md).\n\n";
    case Kind::render:
        return "Explained in [command_line.md](../command_line.md) and [architecture.md](../architecture.md).\n\n";
    default:
        return "Explained in [values.md](../language/values.md#definitions-and-names).\n\n";
    }
}

std::string kindPage(const TypeTable& table, Kind kind) {
    const KindText& about = kindText(kind);
    const auto types = table.of(kind);
    std::string text = fmt::format("# {}\n\n{}{} Written `{}`.\n\n", keyword(kind), kMade, about.doc, about.head);
    if (types.size() == 1) return text + furtherReading(kind) + typeTable(*types[0]);
    text += kdlBlock(about.example) + furtherReading(kind);
    if (kind == Kind::spectrum) return text + spectrumSection();
    if (!types.empty()) text += typeIndex(types);
    for (const TypeInfo* type : types) text += typeSection(*type);
    if (types.empty() && kind != Kind::atmosphere)
        text += "Takes a `transform` ([scene.md](scene.md#transform)), `visible-to` as a [shape](shape.md)" +
                std::string(kind == Kind::instance ? ".\n" : " and definitions.\n");
    return text;
}

std::string wordsPage() {
    std::string text = fmt::format("# Words of their own\n\n{}What is neither kind, type nor property. "
                                   "[values.md](../language/values.md) explains them.\n\n",
                                   kMade);
    for (const LanguageWord& word : languageWords()) {
        text += fmt::format("## {}\n\n{}\n\n{}", word.name, word.doc, kdlBlock(word.example));
        if (word.parts.empty()) continue;
        text += "| | takes | default | meaning | example |\n|---|---|---|---|---|\n";
        for (const WordPart& part : word.parts)
            text += fmt::format("| `{}` | {} | {} | {} | `{}` |\n", part.name, part.takes, inCode(part.defaultText),
                                part.doc, part.example);
        text += "\n";
    }
    return text;
}

std::string unitsPage() {
    std::string text =
        fmt::format("# Units\n\n{}A unit is a word after the number: `35 mm`. Several numbers share one: "
                    "`sensor 36 24 mm`.\n\n| quantity | units | a number without one |\n|---|---|---|\n",
                    kMade);
    for (int i = 1; i < kReferenceDimensions; ++i) {
        const auto d = static_cast<Dimension>(i);
        std::string names;
        for (const std::string_view name : spellings(d)) names += fmt::format("{}`{}`", names.empty() ? "" : " ", name);
        text += fmt::format("| {} | {} | {} |\n", describe(d), names, meaningWithoutUnit(d));
    }
    return text;
}

std::string indexPage(const TypeTable& table) {
    std::string text = fmt::format(
        "# Reference of the scene language\n\n{}Every kind, type and property with its unit, range, default "
        "and an example; `abbe explain camera.lens` prints the same. Syntax and the meaning of things are "
        "explained in [../language](../language/README.md).\n\n| page | what for | types |\n|---|---|---|\n",
        kMade);
    for (int i = 0; i < kReferenceKinds; ++i) {
        const auto kind = static_cast<Kind>(i);
        const std::string_view name = keyword(kind);
        std::string types;
        if (const auto all = table.of(kind); all.size() > 1)
            for (const TypeInfo* type : all)
                types +=
                    fmt::format("{}[{}]({}.md#{}-{})", types.empty() ? "" : ", ", type->name, name, name, type->name);
        text += fmt::format("| [`{0}`]({0}.md) | {1} | {2} |\n", name, tableCell(kindText(kind).doc), types);
    }
    return text +
           "| [`scene`, `param`, `transform`, `at`](scene.md) | The first line of a file, values with names, how "
           "things are placed and moved. | |\n"
           "| [units](units.md) | What may stand behind a number. | |\n"
           "| [diagnostics](../language/diagnostics.md) | Every error and warning. | |\n"
           "| [the library](../materials_library.md) | Materials that come with the program. | |\n";
}

} // namespace

std::vector<ReferencePage> referencePages(const TypeTable& table) {
    std::vector<ReferencePage> pages{{"README.md", indexPage(table)}};
    for (int i = 0; i < kReferenceKinds; ++i) {
        const auto kind = static_cast<Kind>(i);
        pages.push_back({fmt::format("{}.md", keyword(kind)), kindPage(table, kind)});
    }
    pages.push_back({"scene.md", wordsPage()});
    pages.push_back({"units.md", unitsPage()});
    for (ReferencePage& page : pages) // one empty line at most, none at the end
        while (page.text.ends_with("\n\n")) page.text.pop_back();
    return pages;
}

} // namespace abbe::schema
