#include "schema/describe.h"

#include "base/diagnostic.h"
#include "schema/definition_reader.h"
#include "schema/json_text.h"
#include "schema/measure.h"
#include "schema/preset_library.h"
#include "schema/spectrum_reader.h"
#include "schema/suggest.h"
#include "spectrum/named_spectra.h"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace abbe::schema {

namespace {

std::string dimensionList(const FieldInfo& field) {
    std::string text;
    for (const Dimension d : field.dimensions) text += fmt::format("{}{}", text.empty() ? "" : " or ", describe(d));
    return text;
}

bool isPlain(const FieldInfo& field) {
    return field.dimensions.empty() || (field.dimensions.size() == 1 && field.dimensions[0] == Dimension::none);
}

std::string describeUntextured(const FieldInfo& field) {
    switch (field.type) {
    case FieldType::integer:
        return "a whole number";
    case FieldType::number:
    case FieldType::quantity:
        return (isPlain(field) ? "a number" : dimensionList(field)) +
               (field.choices.empty() ? "" : ", or " + quotedList(field.choices, "or"));
    case FieldType::vector2:
        return isPlain(field) ? "two numbers" : fmt::format("two numbers, each {}", dimensionList(field));
    case FieldType::vector3:
        return isPlain(field) ? "three numbers" : fmt::format("three numbers, each {}", dimensionList(field));
    case FieldType::toggle:
        return "`on` or `off`";
    case FieldType::choice:
        return field.choices.empty() ? "a word" : "one of " + quotedList(field.choices, "or");
    case FieldType::words:
        return "one or several of " + quotedList(field.choices, "or");
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
        return std::string(describe(field.role)) + (isPlain(field) ? "" : ", " + dimensionList(field));
    case FieldType::complexIndex:
        return "`metal NAME`, or a block with the spectra `n` and `k`";
    case FieldType::reference:
        return fmt::format("the name of a {0}, or an inline {0}", keyword(field.referenceKind));
    case FieldType::weighted:
        return fmt::format("the name of a {0}, or an inline {0}, perhaps `{1}=`{2}", keyword(field.referenceKind),
                           field.keys.empty() ? "weight" : field.keys[0].name,
                           field.repeats ? "; may be repeated" : "");
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

std::string_view describe(SpectrumRole role) {
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
    case SpectrumRole::tint:
        return "a colour of light, 1 where it is white";
    }
    return {};
}

std::string describeField(const FieldInfo& field) {
    return describeUntextured(field) + (field.texturable ? ", or a texture" : "");
}

std::string describeRange(const FieldInfo& field) {
    // The largest number there is says nothing.
    constexpr double kLargest = std::numeric_limits<double>::max();
    const double upper = field.upper < kLargest ? field.upper : std::numeric_limits<double>::infinity();
    if (!std::isfinite(field.lower) && !std::isfinite(upper)) return {};
    const Dimension d = field.dimensions.empty() ? Dimension::none : field.dimensions[0];
    const bool angle = d == Dimension::angle;
    // Bounds of several dimensions are the same number in each of their SI units.
    const std::string_view unit = field.dimensions.size() > 1 ? "" : angle ? "deg" : siUnit(d);
    const std::string text = rangeText(field.lower, upper, angle ? findUnit("deg")->scale : 1, unit);
    return text.substr(std::string_view("must be ").size());
}

std::vector<std::string_view> unitsOf(const FieldInfo& field) {
    std::vector<std::string_view> units;
    for (const Dimension d : field.dimensions) units.insert(units.end(), spellings(d).begin(), spellings(d).end());
    return units;
}

std::string_view meaningWithoutUnit(Dimension d) {
    switch (d) {
    case Dimension::none:
    case Dimension::fraction:
        return "a plain number";
    case Dimension::length:
        return "the header's length";
    case Dimension::angle:
        return "deg";
    default:
        return siUnit(d);
    }
}

namespace {

constexpr std::array kFieldTypes = {"integer",   "number",   "quantity", "vector2",      "vector3",   "toggle",
                                    "choice",    "words",    "text",     "file",         "points",    "numbers",
                                    "indexRows", "sharpRow", "spectrum", "complexIndex", "reference", "transform",
                                    "table",     "place",    "moments",  "weighted",     "stop",      "namedNumbers"};
constexpr std::array kRoles = {"albedo", "unbounded", "emission", "index", "shape", "tint"};
constexpr std::array kDimensionIds = {"none",        "length",     "angle",        "time",
                                      "temperature", "power",      "luminousFlux", "luminousIntensity",
                                      "illuminance", "irradiance", "luminance",    "inverseLength",
                                      "stops",       "fraction",   "pixels"};

const char* id(FieldType type) { return kFieldTypes[static_cast<std::size_t>(type)]; }
const char* id(SpectrumRole role) { return kRoles[static_cast<std::size_t>(role)]; }
const char* id(Dimension d) { return kDimensionIds[static_cast<std::size_t>(d)]; }

std::string jsonField(const FieldInfo& field) {
    std::string out =
        fmt::format(R"({{"name":{},"type":"{}","doc":{})", jsonText(field.name), id(field.type), jsonText(field.doc));
    out += fmt::format(R"(,"dimensions":{})", jsonArray(field.dimensions, [](Dimension d) { return jsonText(id(d)); }));
    if (!field.example.empty()) out += fmt::format(R"(,"example":{})", jsonText(field.example));
    if (!field.defaultText.empty()) out += fmt::format(R"(,"default":{})", jsonText(field.defaultText));
    if (std::isfinite(field.lower)) out += fmt::format(R"(,"minimum":{})", field.lower);
    if (std::isfinite(field.upper)) out += fmt::format(R"(,"maximum":{})", field.upper);
    if (field.type == FieldType::spectrum || field.type == FieldType::stop)
        out += fmt::format(R"(,"role":"{}")", id(field.role));
    if (field.type == FieldType::reference || field.type == FieldType::weighted)
        out += fmt::format(R"(,"kind":"{}")", keyword(field.referenceKind));
    if (!field.choices.empty()) out += fmt::format(R"(,"choices":{})", jsonArray(field.choices, jsonText));
    if (!field.synonyms.empty()) out += fmt::format(R"(,"synonyms":{})", jsonArray(field.synonyms, jsonText));
    if (!field.keys.empty())
        out += fmt::format(R"(,"keys":{})", jsonArray(field.keys, [](const FieldKey& key) {
                               return fmt::format(R"({{"name":{},"doc":{},"choices":{}}})", jsonText(key.name),
                                                  jsonText(key.doc), jsonArray(key.choices, jsonText));
                           }));
    if (!field.note.empty()) out += fmt::format(R"(,"note":{})", jsonText(field.note));
    if (field.repeats || field.type == FieldType::moments) out += R"(,"repeats":true)";
    if (field.tiles) out += R"(,"tiles":true)";
    if (field.canMove) out += R"(,"keyed":true)";
    if (!field.block.empty()) out += fmt::format(R"(,"block":{})", jsonArray(field.block, jsonField));
    if (!field.group.empty()) out += fmt::format(R"(,"group":{})", jsonText(field.group));
    if (field.required) out += R"(,"required":true)";
    if (field.argument >= 0) out += fmt::format(R"(,"argument":{})", field.argument);
    if (field.texturable) out += R"(,"texturable":true)";
    return out + "}";
}

std::string jsonType(const TypeInfo& type) {
    return fmt::format(R"({{"kind":"{}","name":{},"doc":{},"example":{},"default":{},"fields":{}}})",
                       keyword(type.kind), jsonText(type.name), jsonText(type.doc), jsonText(type.example),
                       type.isDefault ? "true" : "false", jsonArray(type.fields, jsonField));
}

std::string jsonUnits() {
    std::string out = "[";
    for (std::size_t i = 1; i < kDimensionIds.size(); ++i)
        for (const std::string_view name : spellings(static_cast<Dimension>(i)))
            out += fmt::format(R"({}{{"name":{},"dimension":"{}","scale":{}}})", out.size() > 1 ? "," : "",
                               jsonText(name), kDimensionIds[i], findUnit(name)->scale);
    return out + "]";
}

std::string jsonDimensions() {
    std::string out = "[";
    for (std::size_t i = 0; i < kDimensionIds.size(); ++i) {
        const auto d = static_cast<Dimension>(i);
        out +=
            fmt::format(R"({}{{"name":"{}","doc":{},"si":{},"without_unit":{}}})", out.size() > 1 ? "," : "",
                        kDimensionIds[i], jsonText(describe(d)), jsonText(siUnit(d)), jsonText(meaningWithoutUnit(d)));
    }
    return out + "]";
}

std::string jsonKinds() {
    std::string out = "[";
    for (int i = 0; i <= static_cast<int>(Kind::render); ++i) {
        const KindText& kind = kindText(static_cast<Kind>(i));
        out += fmt::format(R"({}{{"name":"{}","doc":{},"head":{},"example":{}}})", out.size() > 1 ? "," : "",
                           keyword(kind.kind), jsonText(kind.doc), jsonText(kind.head), jsonText(kind.example));
    }
    return out + "]";
}

std::string jsonWord(const LanguageWord& word) {
    const auto part = [](const WordPart& p) {
        return fmt::format(R"({{"name":{},"doc":{},"takes":{},"default":{},"example":{}}})", jsonText(p.name),
                           jsonText(p.doc), jsonText(p.takes), jsonText(p.defaultText), jsonText(p.example));
    };
    return fmt::format(R"({{"name":{},"doc":{},"example":{},"parts":{}}})", jsonText(word.name), jsonText(word.doc),
                       jsonText(word.example), jsonArray(word.parts, part));
}

// What has a name because it comes with the program.
std::string jsonNames() {
    return fmt::format(R"({{"illuminant":{},"measured":{},"glass":{},"metal":{},"rgb_space":{}}})",
                       jsonArray(illuminantNames(), jsonText), jsonArray(measuredNames(), jsonText),
                       jsonArray(glassNames(), jsonText), jsonArray(metalNames(), jsonText),
                       jsonArray(rgbSpaceWords(), jsonText));
}

std::string jsonPresets(const TypeTable& table) {
    const auto preset = [](const Preset& p) {
        return fmt::format(R"({{"kind":"{}","name":{},"group":{},"doc":{},"source":{}}})", keyword(p.kind),
                           jsonText(p.name), jsonText(p.group), jsonText(p.doc), jsonText(p.source));
    };
    return table.presets() ? jsonArray(table.presets()->all(), preset) : "[]";
}

std::string jsonCode(const CodeInfo& code) {
    return fmt::format(R"({{"code":{},"title":{},"explanation":{}}})", jsonText(code.code), jsonText(code.title),
                       jsonText(code.explanation));
}

} // namespace

std::string diagnosticsMarkdown() {
    std::string text = "# Diagnostics\n\nEvery message has a stable code. `abbe explain E0310` explains one of them, "
                       "`abbe explain codes` prints this page.\n"
                       "Codes with an E are errors: nothing is rendered. Codes with a W are warnings.\n";
    constexpr std::pair<std::string_view, std::string_view> kAreas[] = {
        {"01", "Syntax"},
        {"02", "Names"},
        {"03", "Values and units"},
        {"04", "Files"},
        {"05", "The `scene` line"},
        {"06", "Scenes"},
        {"07", "Materials and lights"},
        {"08", "Scenes of other programs"},
    };
    for (const auto& [area, heading] : kAreas) {
        text += fmt::format("\n## {}\n", heading);
        for (const CodeInfo& code : allCodes())
            if (code.code.substr(1, 2) == area)
                text += fmt::format("\n### {}: {}\n\n{}\n", code.code, code.title, code.explanation);
    }
    return text;
}

std::string schemaJson(const TypeTable& table) {
    const auto form = [](const SpectrumForm& f) {
        return fmt::format(R"({{"name":{},"example":{},"doc":{}}})", jsonText(f.name), jsonText(f.example),
                           jsonText(f.doc));
    };
    return fmt::format("{{\"edition\":1,\"kinds\":{},\"words\":{},\"types\":{},\"spectra\":{},\"units\":{},"
                       "\"dimensions\":{},\"names\":{},\"presets\":{},\"codes\":{}}}\n",
                       jsonKinds(), jsonArray(languageWords(), jsonWord), jsonArray(table.all(), jsonType),
                       jsonArray(spectrumForms(), form), jsonUnits(), jsonDimensions(), jsonNames(), jsonPresets(table),
                       jsonArray(allCodes(), jsonCode));
}

std::string schemaListing(const TypeTable& table) {
    std::string text;
    for (const TypeInfo& type : table.all()) {
        text += fmt::format("{} {}{}\n", keyword(type.kind), type.name, type.isDefault ? " default" : "");
        for (const FieldInfo& field : type.fields) {
            text += fmt::format("{} {} {} {}", keyword(type.kind), type.name, field.name, id(field.type));
            for (const Dimension d : field.dimensions)
                if (d != Dimension::none) text += fmt::format(" [{}]", id(d));
            if (field.type == FieldType::spectrum || field.type == FieldType::stop)
                text += fmt::format(" role={}", id(field.role));
            if (field.type == FieldType::reference) text += fmt::format(" kind={}", keyword(field.referenceKind));
            if (!field.defaultText.empty()) text += fmt::format(" default=\"{}\"", field.defaultText);
            if (std::isfinite(field.lower)) text += fmt::format(" min={}", field.lower);
            if (std::isfinite(field.upper)) text += fmt::format(" max={}", field.upper);
            for (const std::string_view choice : field.choices) text += fmt::format(" |{}", choice);
            for (const FieldKey& key : field.keys) text += fmt::format(" {}=", key.name);
            if (!field.group.empty()) text += fmt::format(" group=\"{}\"", field.group);
            if (field.texturable) text += " texturable";
            if (field.required) text += " required";
            if (field.argument >= 0) text += fmt::format(" argument={}", field.argument);
            text += '\n';
        }
    }
    return text;
}

} // namespace abbe::schema
