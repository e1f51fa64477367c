#include "base/diagnostic_catalogue.h"
#include "schema/describe.h"
#include "schema/spectrum_reader.h"

#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

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

std::string cell(std::string text) {
    for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
    return text;
}

std::string jsonString(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        if (static_cast<unsigned char>(c) < 0x20)
            out += fmt::format("\\u{:04x}", c);
        else
            out += c;
    }
    return out + '"';
}

template <typename Range, typename Text> std::string array(const Range& range, Text text) {
    std::string out = "[";
    for (const auto& item : range) out += (out.size() > 1 ? "," : "") + text(item);
    return out + "]";
}

std::string jsonView(std::string_view text) { return jsonString(text); }

std::string jsonField(const FieldInfo& field) {
    std::string out = fmt::format(R"({{"name":{},"type":"{}","doc":{})", jsonString(field.name), id(field.type),
                                  jsonString(field.doc));
    out += fmt::format(R"(,"dimensions":{})", array(field.dimensions, [](Dimension d) { return jsonString(id(d)); }));
    if (!field.example.empty()) out += fmt::format(R"(,"example":{})", jsonString(field.example));
    if (!field.defaultText.empty()) out += fmt::format(R"(,"default":{})", jsonString(field.defaultText));
    if (std::isfinite(field.lower)) out += fmt::format(R"(,"minimum":{})", field.lower);
    if (std::isfinite(field.upper)) out += fmt::format(R"(,"maximum":{})", field.upper);
    if (field.type == FieldType::spectrum || field.type == FieldType::stop)
        out += fmt::format(R"(,"role":"{}")", id(field.role));
    if (field.type == FieldType::reference || field.type == FieldType::weighted)
        out += fmt::format(R"(,"kind":"{}")", keyword(field.referenceKind));
    if (!field.choices.empty()) out += fmt::format(R"(,"choices":{})", array(field.choices, jsonView));
    if (!field.synonyms.empty()) out += fmt::format(R"(,"synonyms":{})", array(field.synonyms, jsonView));
    if (!field.keys.empty())
        out += fmt::format(R"(,"keys":{})", array(field.keys, [](const FieldKey& key) {
                               return fmt::format(R"({{"name":{},"doc":{},"choices":{}}})", jsonString(key.name),
                                                  jsonString(key.doc), array(key.choices, jsonView));
                           }));
    if (!field.block.empty()) out += fmt::format(R"(,"block":{})", array(field.block, jsonField));
    if (!field.group.empty()) out += fmt::format(R"(,"group":{})", jsonString(field.group));
    if (field.required) out += R"(,"required":true)";
    if (field.argument >= 0) out += fmt::format(R"(,"argument":{})", field.argument);
    if (field.texturable) out += R"(,"texturable":true)";
    return out + "}";
}

std::string jsonType(const TypeInfo& type) {
    return fmt::format(R"({{"kind":"{}","name":{},"doc":{},"example":{},"default":{},"fields":{}}})",
                       keyword(type.kind), jsonString(type.name), jsonString(type.doc), jsonString(type.example),
                       type.isDefault ? "true" : "false", array(type.fields, jsonField));
}

std::string jsonUnits() {
    std::string out = "[";
    for (std::size_t i = 1; i < kDimensionIds.size(); ++i)
        for (const std::string_view name : spellings(static_cast<Dimension>(i)))
            out += fmt::format(R"({}{{"name":{},"dimension":"{}","scale":{}}})", out.size() > 1 ? "," : "",
                               jsonString(name), kDimensionIds[i], findUnit(name)->scale);
    return out + "]";
}

} // namespace

std::string diagnosticsMarkdown() {
    std::string text =
        "# Diagnostics\n\nEvery message has a stable code. `abbe explain E0310` prints the entry of one code; this "
        "page is what\n"
        "`abbe explain codes` prints. E01 and W01: syntax, 02: names, 03: values and units, 04: files, 05: layers,\n"
        "06: the scene as a whole. E: errors, W: warnings.\n\n| code | | |\n|---|---|---|\n";
    for (const CodeInfo& code : allCodes())
        text += fmt::format("| {} | {} | {} |\n", code.code, cell(std::string(code.title)),
                            cell(std::string(code.explanation)));
    return text;
}

std::string schemaJson(const TypeTable& table) {
    const auto form = [](const SpectrumForm& f) {
        return fmt::format(R"({{"name":{},"example":{},"doc":{}}})", jsonString(f.name), jsonString(f.example),
                           jsonString(f.doc));
    };
    return fmt::format("{{\"edition\":1,\"types\":{},\"spectra\":{},\"units\":{}}}\n", array(table.all(), jsonType),
                       array(spectrumForms(), form), jsonUnits());
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
