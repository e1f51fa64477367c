#include "schema/describe.h"

#include "base/diagnostic_catalogue.h"
#include "schema/measure.h"
#include "schema/preset_library.h"
#include "schema/spectrum_reader.h"
#include "schema/suggest.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

std::string describeUntextured(const FieldInfo&);

constexpr int kDimensions = static_cast<int>(Dimension::pixels) + 1;

std::string dimensionList(const FieldInfo& field) {
    std::string text;
    for (const Dimension d : field.dimensions) text += fmt::format("{}{}", text.empty() ? "" : " or ", describe(d));
    return text;
}

std::string_view roleText(SpectrumRole role) {
    switch (role) {
    case SpectrumRole::albedo:
        return "a spectrum from 0 to 1";
    case SpectrumRole::unbounded:
        return "a spectrum of at least 0";
    case SpectrumRole::emission:
        return "a spectrum of emission";
    case SpectrumRole::index:
        return "a refractive index";
    case SpectrumRole::shape:
        return "a spectrum of which only the shape matters";
    }
    return {};
}

bool isPlain(const FieldInfo& field) {
    return field.dimensions.empty() || (field.dimensions.size() == 1 && field.dimensions[0] == Dimension::none);
}

std::string unitsText(const FieldInfo& field) {
    std::vector<std::string_view> units;
    for (const Dimension d : field.dimensions) units.insert(units.end(), spellings(d).begin(), spellings(d).end());
    return quotedList(units, "or");
}

std::string bareText(const FieldInfo& field) {
    switch (field.dimensions[0]) {
    case Dimension::none:
    case Dimension::fraction:
        return "a plain number";
    case Dimension::length:
        return "the header's length";
    case Dimension::angle:
        return "deg";
    default:
        return std::string(siUnit(field.dimensions[0]));
    }
}

std::string line(std::string_view label, const std::string& text) {
    return text.empty() ? std::string() : fmt::format("  {:<9} {}\n", label, text);
}

std::string words(const std::vector<std::string_view>& list) { return quotedList(list); }

std::string explainField(const TypeInfo& type, const FieldInfo& field) {
    std::string text = fmt::format("{} {}: {}\n", keyword(type.kind), type.name, field.name);
    if (!field.doc.empty()) text += fmt::format("  {}\n", field.doc);
    text += line("takes", describeField(field));
    if (!isPlain(field)) {
        text += line("units", unitsText(field));
        text += line("unitless", bareText(field));
    }
    text += line("default", field.required ? "none, it must be given" : field.defaultText);
    text += line("range", describeRange(field));
    if (!field.group.empty())
        text += line("one of", fmt::format("the ways to state the {}; give at most one", field.group));
    for (const FieldKey& key : field.keys)
        text += line("key", fmt::format("{}= {}{}", key.name, key.doc,
                                        key.choices.empty() ? "" : " (" + words(key.choices) + ")"));
    for (const FieldInfo& inner : field.block) {
        const std::string range = describeRange(inner);
        text += line("block", fmt::format("{}: {} ({}{}{})", inner.name, inner.doc, describeField(inner),
                                          range.empty() ? "" : ", ", range));
    }
    text += line("example", std::string(field.example));
    text += line("elsewhere", words(field.synonyms));
    text += line("note", std::string(field.note));
    return text;
}

std::string explainType(const TypeInfo& type) {
    std::string text =
        fmt::format("{} {}{}\n  {}\n", keyword(type.kind), type.name, type.isDefault ? " (the default)" : "", type.doc);
    text += line("example", std::string(type.example));
    std::size_t width = 0;
    for (const FieldInfo& field : type.fields) width = std::max(width, field.name.size());
    for (const FieldInfo& field : type.fields) {
        const std::string_view doc = field.doc;
        const std::string_view mark = field.required ? "*" : " ";
        text += fmt::format("  {}{:<{}}  {}\n", mark, field.name, width,
                            doc.empty() ? describeField(field) : std::string(doc));
    }
    return text;
}

std::string explainKind(const TypeTable& table, Kind kind) {
    std::string text = fmt::format("{}\n", keyword(kind));
    for (const TypeInfo* type : table.of(kind))
        text += fmt::format("  {:<14} {}{}\n", type->name, type->doc, type->isDefault ? " The default." : "");
    if (kind == Kind::spectrum) {
        text += "  A spectrum is a plain number (the same at every wavelength), a name, or one of these:\n";
        for (const SpectrumForm& form : spectrumForms()) text += fmt::format("  {:<14} {}\n", form.name, form.doc);
        text += line("example", "spectrum paint rgb 0.8 0.2 0.1");
    }
    if (kind == Kind::group)
        text += "  Definitions with a transform in common: `group name { transform { … }; shape … }`.\n";
    if (kind == Kind::object)
        text += "  Definitions that are shown only where an `instance` places them: `object name { … }`.\n";
    if (kind == Kind::instance) text += "  Places an object: `instance name { transform { … } }`.\n";
    if (kind == Kind::atmosphere)
        text +=
            "  Places a medium everywhere: `medium haze homogeneous { extinction 0.02 per-km }`, `atmosphere haze`.\n";
    if (kind == Kind::instances) text += "  Places an object many times: `instances name { points \"file.ply\" }`.\n";
    return text;
}

std::string explainUnits() {
    std::string text = "A unit is a word after the number: `35 mm`. Each dimension has these:\n";
    for (int i = 1; i < kDimensions; ++i) {
        const auto d = static_cast<Dimension>(i);
        text += fmt::format("  {:<22} {}\n", describe(d), quotedList(spellings(d), "or"));
    }
    return text;
}

std::string explainUnit(const Unit& unit) {
    std::string text = fmt::format("{}: {}\n", unit.name, describe(unit.dimension));
    if (unit.scale != 1) text += line("is", fmt::format("{:.9g} {}", unit.scale, siUnit(unit.dimension)));
    return text + line("others", quotedList(spellings(unit.dimension)));
}

std::string explainForm(const SpectrumForm& form) {
    std::string text = fmt::format("spectrum: {}\n  {}\n", form.name, form.doc);
    text += line("example", std::string(form.example));
    std::string roles;
    for (const SpectrumRole role : {SpectrumRole::albedo, SpectrumRole::unbounded, SpectrumRole::emission,
                                    SpectrumRole::index, SpectrumRole::shape})
        if (fits(form.form, role)) roles += fmt::format("{}{}", roles.empty() ? "" : "; ", roleText(role));
    return text + line("fits", roles);
}

std::vector<std::string> split(std::string_view query) {
    std::vector<std::string> parts(1);
    for (const char c : query) {
        if (c != '.' && c != ' ')
            parts.back() += c;
        else if (!parts.back().empty())
            parts.emplace_back();
    }
    if (parts.size() > 1 && parts.back().empty()) parts.pop_back();
    return parts;
}

// Everything that a single word can be; several texts if it is several things.
std::string explainWord(const TypeTable& table, std::string_view word) {
    std::string text;
    if (const CodeInfo* code = findCode(word))
        return fmt::format("{}: {}\n  {}\n", code->code, code->title, code->explanation);
    if (word == "units") return explainUnits();
    if (word == "codes") return diagnosticsMarkdown();
    if (const PresetLibrary* presets = table.presets()) {
        if (word == "presets") return presetListText(*presets);
        if (word == "library") return presetMarkdown(*presets);
        text = presetText(*presets, word);
    }
    if (const auto kind = findKind(word)) text += explainKind(table, *kind);
    for (const TypeInfo& type : table.all())
        if (type.name == word && keyword(type.kind) != word) text += explainType(type);
    if (const SpectrumForm* form = findSpectrumForm(word)) text += explainForm(*form);
    if (const auto unit = findUnit(word)) text += explainUnit(*unit);
    if (!text.empty()) return text;
    for (const TypeInfo& type : table.all())
        if (const FieldInfo* field = type.find(word)) text += explainField(type, *field);
    return text;
}

// `kind.type`, `kind.property`, `kind.type.property`, `type.property`.
std::string explainPath(const TypeTable& table, const std::vector<std::string>& parts) {
    if (parts[0] == "unit") {
        const auto unit = findUnit(parts[1]);
        return unit ? explainUnit(*unit) : std::string();
    }
    if (parts[0] == "preset" && table.presets()) return presetText(*table.presets(), parts[1]);
    std::string text;
    for (const TypeInfo& type : table.all()) {
        const bool ofKind = keyword(type.kind) == parts[0];
        if (ofKind && type.name == parts[1] && parts.size() == 2) text += explainType(type);
        const bool named =
            ofKind ? parts.size() == 2 || type.name == parts[1] : type.name == parts[0] && parts.size() == 2;
        if (!named) continue;
        if (const FieldInfo* field = type.find(parts.back())) text += explainField(type, *field);
    }
    return text;
}

std::string suggestion(const TypeTable& table, std::string_view word) {
    std::vector<std::string_view> names = {"units"};
    for (int i = 0; i <= static_cast<int>(Kind::render); ++i) names.push_back(keyword(static_cast<Kind>(i)));
    for (int i = 0; i < kDimensions; ++i)
        names.insert(names.end(), spellings(static_cast<Dimension>(i)).begin(),
                     spellings(static_cast<Dimension>(i)).end());
    for (const SpectrumForm& form : spectrumForms()) names.push_back(form.name);
    for (const CodeInfo& code : allCodes()) names.push_back(code.code);
    if (table.presets())
        for (const Preset& preset : table.presets()->all()) names.push_back(preset.name);
    for (const TypeInfo& type : table.all()) {
        names.push_back(type.name);
        for (const FieldInfo& field : type.fields) names.push_back(field.name);
        if (const FieldInfo* field = suggestField(type, word); field && !type.find(word))
            return fmt::format("did you mean `{}.{}`?\n", keyword(type.kind), field->name);
    }
    const auto meant = nearest(word, names);
    return meant.empty() ? "ask for a kind, a type, a property, a unit or a code: `camera.lens`, `units`, `E0310`\n"
                         : didYouMean(meant) + "\n";
}

} // namespace

std::string describeField(const FieldInfo& field) {
    return describeUntextured(field) + (field.texturable ? ", or a texture" : "");
}

namespace {

std::string describeUntextured(const FieldInfo& field) {
    switch (field.type) {
    case FieldType::integer:
        return "a whole number";
    case FieldType::number:
    case FieldType::quantity:
        return isPlain(field) ? "a number" : dimensionList(field);
    case FieldType::vector2:
        return isPlain(field) ? "two numbers" : fmt::format("two numbers, each {}", dimensionList(field));
    case FieldType::vector3:
        return isPlain(field) ? "three numbers" : fmt::format("three numbers, each {}", dimensionList(field));
    case FieldType::toggle:
        return "`on` or `off`";
    case FieldType::choice:
        return field.choices.empty() ? "a word" : "one of " + quotedList(field.choices, "or");
    case FieldType::text:
        return "a text";
    case FieldType::file:
        return "the name of a file";
    case FieldType::points:
        return "points, three numbers each, in a line or in rows";
    case FieldType::numbers:
        return isPlain(field) ? "numbers, in a line or in rows" : fmt::format("numbers, each {}", dimensionList(field));
    case FieldType::sharpRow:
        return "vertex numbers from 0, perhaps `sharpness=`; may be repeated";
    case FieldType::namedNumbers:
        return "a name and numbers, in the line or in rows; may be repeated";
    case FieldType::indexRows:
        return "a row of vertex numbers from 0 on for each face";
    case FieldType::spectrum:
        return std::string(roleText(field.role)) + (isPlain(field) ? "" : ", " + dimensionList(field));
    case FieldType::complexIndex:
        return "`metal NAME`, or a block with the spectra `n` and `k`";
    case FieldType::reference:
        return fmt::format("the name of a {0}, or an inline {0}", keyword(field.referenceKind));
    case FieldType::weighted:
        return fmt::format("the name of a {0}, or an inline {0}, perhaps `weight=`; may be repeated",
                           keyword(field.referenceKind));
    case FieldType::stop:
        return "a number and a spectrum or texture; may be repeated";
    case FieldType::transform:
        return field.canMove
                   ? "a block of `translate`, `rotate`, `scale`, `matrix` and `look-at`, or keys `at TIME { … }`"
                   : "a block of `translate`, `rotate`, `scale`, `matrix` and `look-at`";
    case FieldType::table:
        return field.namedRows ? "a block of rows" : "a unit and a block of rows";
    case FieldType::moments:
        return "a time and a block; may be repeated, in the order of time";
    case FieldType::place:
        return fmt::format("{}, or `on=` and the name of a shape", dimensionList(field));
    }
    return {};
}

} // namespace

std::string describeRange(const FieldInfo& field) {
    if (!std::isfinite(field.lower) && !std::isfinite(field.upper)) return {};
    const Dimension d = field.dimensions.empty() ? Dimension::none : field.dimensions[0];
    const bool angle = d == Dimension::angle;
    // Bounds of several dimensions are the same number in each of their SI units.
    const std::string_view unit = field.dimensions.size() > 1 ? "" : angle ? "deg" : siUnit(d);
    const std::string text = rangeText(field.lower, field.upper, angle ? findUnit("deg")->scale : 1, unit);
    return text.substr(std::string_view("must be ").size());
}

Explanation explain(const TypeTable& table, std::string_view query) {
    const auto parts = split(query);
    const std::string text = parts.size() == 1 ? explainWord(table, parts[0]) : explainPath(table, parts);
    if (!text.empty()) return {true, text};
    return {false, fmt::format("nothing is named `{}`; {}", query, suggestion(table, parts.back()))};
}

} // namespace abbe::schema
