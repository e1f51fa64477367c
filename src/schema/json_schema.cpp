#include "schema/json_schema.h"

#include "schema/definition_reader.h"
#include "schema/describe.h"
#include "schema/json_text.h"
#include "schema/spectrum_reader.h"
#include "schema/suggest.h"

#include <cmath>
#include <map>
#include <set>
#include <vector>

namespace abbe::schema {

namespace {

// Schemas of values. A text may be computed ("$r * 2"), so one may stand wherever a number may.

constexpr std::string_view kNumeric = R"({"$ref":"#/$defs/numeric"})";
constexpr std::string_view kText = R"({"type":"string"})";
constexpr std::string_view kAnything = "true";

std::string enumOf(const std::vector<std::string_view>& words) {
    return fmt::format(R"({{"enum":{}}})", jsonArray(words, jsonText));
}

// Exactly these values in this order.
std::string listOf(const std::vector<std::string>& items) {
    if (items.empty()) return R"({"maxItems":0})";
    return fmt::format(R"({{"prefixItems":{},"items":false,"minItems":{}}})",
                       jsonArray(items, [](const std::string& item) { return item; }), items.size());
}

std::string anyOf(const std::vector<std::string>& schemas) {
    if (schemas.size() == 1) return schemas[0];
    return fmt::format(R"({{"anyOf":{}}})", jsonArray(schemas, [](const std::string& s) { return s; }));
}

// Ranges are stated in SI units, so that of a number without a unit is known only where that is a plain number.
std::string plainNumber(const FieldInfo& field) {
    if (!field.dimensions.empty() && field.dimensions[0] != Dimension::none) return std::string(kNumeric);
    std::string range;
    if (std::isfinite(field.lower)) range += fmt::format(R"(,"minimum":{})", field.lower);
    if (std::isfinite(field.upper)) range += fmt::format(R"(,"maximum":{})", field.upper);
    const std::string_view type = field.type == FieldType::integer ? "integer" : "number";
    return fmt::format(R"({{"if":{{"type":"number"}},"then":{{"type":"{}"{}}},"else":{{"type":"string"}}}})", type,
                       range);
}

// So many numbers, with or without a unit behind them.
std::vector<std::string> numbersWithUnit(const FieldInfo& field, std::size_t count) {
    std::vector<std::string> all{listOf(std::vector<std::string>(count, plainNumber(field)))};
    if (const auto units = unitsOf(field); !units.empty()) {
        std::vector<std::string> items(count, std::string(kNumeric));
        items.push_back(enumOf(units));
        all.push_back(listOf(items));
    }
    return all;
}

// Whatever may follow the first value, such as the arguments of an inline type.
std::string beginsWith(const std::string& first) {
    return fmt::format(R"({{"prefixItems":[{}],"minItems":1}})", first);
}

std::string spectrumValues(const FieldInfo& field) {
    std::vector<std::string> all{beginsWith(std::string(kText))};
    for (std::string& numbers : numbersWithUnit(field, 1)) all.push_back(std::move(numbers));
    return anyOf(all);
}

std::string quantityValues(const FieldInfo& field) {
    std::vector<std::string> all = numbersWithUnit(field, 1);
    if (!field.choices.empty()) all.push_back(listOf({enumOf(field.choices)}));
    if (field.texturable) all.push_back(beginsWith(std::string(kText)));
    return anyOf(all);
}

std::string valuesOf(const FieldInfo& field) {
    switch (field.type) {
    case FieldType::integer:
    case FieldType::number:
    case FieldType::quantity:
        return quantityValues(field);
    case FieldType::vector2:
        return anyOf(numbersWithUnit(field, 2));
    case FieldType::vector3:
        return anyOf(numbersWithUnit(field, 3));
    case FieldType::toggle:
        return listOf({R"({"enum":["on","off",true,false]})"});
    case FieldType::choice:
        return field.choices.empty()
                   ? beginsWith(std::string(kText))
                   : anyOf({listOf({enumOf(field.choices)}), listOf({enumOf(field.choices), std::string(kNumeric)})});
    case FieldType::words:
        return fmt::format(R"({{"items":{},"minItems":1,"uniqueItems":true}})", enumOf(field.choices));
    case FieldType::text:
    case FieldType::file:
        return R"({"items":{"type":"string"},"maxItems":1})";
    case FieldType::spectrum:
        return spectrumValues(field);
    case FieldType::complexIndex:
        return std::string(kAnything);
    case FieldType::reference:
    case FieldType::weighted:
        return beginsWith(std::string(kText));
    case FieldType::stop:
        return fmt::format(R"({{"prefixItems":[{}],"minItems":2}})", kNumeric);
    case FieldType::namedNumbers:
        return beginsWith(std::string(kText));
    case FieldType::transform:
        return R"({"maxItems":0})";
    case FieldType::moments:
        return anyOf({listOf({std::string(kNumeric)}),
                      listOf({std::string(kNumeric), enumOf({"s", "ms", "us", "ns", "min", "h"})})});
    case FieldType::place:
        return anyOf({listOf({}), anyOf(numbersWithUnit(field, 1))});
    case FieldType::points:
    case FieldType::numbers:
    case FieldType::indexRows:
    case FieldType::sharpRow:
    case FieldType::table: // a unit may stand at their ends or beginnings
        return R"({"items":{"type":["number","string"]}})";
    }
    return std::string(kAnything);
}

bool holdsRows(const FieldInfo& field) {
    return field.type == FieldType::points || field.type == FieldType::indexRows ||
           (field.type == FieldType::table && !field.namedRows);
}

std::string fieldsSchema(const std::vector<FieldInfo>& fields);

std::string childrenOf(const FieldInfo& field) {
    if (holdsRows(field)) return R"({"items":{"$ref":"#/$defs/row"}})";
    if (field.type == FieldType::transform) return R"({"items":{"$ref":"#/$defs/transform-step"}})";
    if (!field.block.empty()) return fmt::format(R"({{"items":{}}})", fieldsSchema(field.block));
    return R"({"items":{"$ref":"#/$defs/node"}})";
}

// Whether nothing but values says what it is.
bool needsValues(const FieldInfo& field) {
    switch (field.type) {
    case FieldType::integer:
    case FieldType::number:
    case FieldType::quantity:
    case FieldType::vector2:
    case FieldType::vector3:
    case FieldType::toggle:
    case FieldType::choice:
    case FieldType::words:
    case FieldType::reference:
    case FieldType::spectrum:
        return true;
    default:
        return false;
    }
}

// Keys of what stands inline are those of its type.
std::string keysOf(const FieldInfo& field) {
    switch (field.type) {
    case FieldType::reference:
    case FieldType::weighted:
    case FieldType::spectrum:
    case FieldType::stop:
    case FieldType::place:
    case FieldType::sharpRow:
        return "true";
    default:
        if (field.texturable) return "true";
        std::vector<std::string_view> names;
        for (const FieldKey& key : field.keys) names.push_back(key.name);
        return names.empty() ? R"({"maxProperties":0})" : fmt::format(R"({{"propertyNames":{}}})", enumOf(names));
    }
}

std::string fieldSchema(const FieldInfo& field) {
    return fmt::format(R"({{"description":{},"properties":{{"values":{},"keys":{},"children":{}}}{}}})",
                       jsonText(field.doc), valuesOf(field), keysOf(field), childrenOf(field),
                       needsValues(field) ? R"(,"required":["values"])" : "");
}

// One of these properties, of which each name chooses what else holds. `x-` is for private data of other tools.
std::string fieldsSchema(const std::vector<FieldInfo>& fields) {
    std::string names, rules;
    for (const FieldInfo& field : fields) {
        names += fmt::format("{}{}", names.empty() ? "" : ",", jsonText(field.name));
        rules += fmt::format(R"({}{{"if":{{"properties":{{"name":{{"const":{}}}}}}},"then":{}}})",
                             rules.empty() ? "" : ",", jsonText(field.name), fieldSchema(field));
    }
    const std::string known =
        fmt::format(R"({{"properties":{{"name":{{"anyOf":[{{"enum":[{}]}},{{"pattern":"^x-"}}]}}}}}})", names);
    return fmt::format(R"({{"$ref":"#/$defs/node","allOf":[{}{}{}]}})", known, rules.empty() ? "" : ",", rules);
}

std::string typeId(const TypeInfo& type) { return fmt::format("{}.{}", keyword(type.kind), type.name); }

// `kind T …`, `kind NAME T …` and, for the default type, `kind` and `kind NAME`. A preset stands for a type.
std::string kindSchema(const TypeTable& table, Kind kind) {
    std::vector<std::string> ways;
    std::vector<std::string_view> names = typeNames(table, kind);
    for (const TypeInfo& type : table.all()) {
        if (type.kind != kind || type.name == "preset") continue;
        const std::string properties = fmt::format(R"("children":{{"items":{{"$ref":"#/$defs/{}"}}}})", typeId(type));
        const std::string word = fmt::format(R"({{"const":{}}})", jsonText(type.name));
        for (const std::string& values : {fmt::format(R"("prefixItems":[{}],"minItems":1)", word),
                                          fmt::format(R"("prefixItems":[{},{}],"minItems":2)", kText, word)})
            ways.push_back(
                fmt::format(R"({{"properties":{{"values":{{{}}},{}}},"required":["values"]}})", values, properties));
        if (!type.isDefault) continue;
        ways.push_back(
            fmt::format(R"({{"properties":{{"values":{{"maxItems":1,"items":{{"type":"string","not":{}}}}},{}}}}})",
                        enumOf(names), properties));
    }
    for (const std::string_view prefix : {"", R"({"type":"string"},)"})
        ways.push_back(fmt::format(
            R"({{"properties":{{"values":{{"prefixItems":[{}{{"const":"preset"}}],"minItems":2}}}},"required":["values"]}})",
            prefix));
    return anyOf(ways);
}

bool hasTypes(const TypeTable& table, Kind kind) { return !typeNames(table, kind).empty() && kind != Kind::spectrum; }

std::string statementSchema(const TypeTable& table) {
    std::string names, rules;
    const auto add = [&](std::string_view name, const std::string& then) {
        names += fmt::format("{}{}", names.empty() ? "" : ",", jsonText(name));
        if (then.empty()) return;
        rules += fmt::format(R"({}{{"if":{{"properties":{{"name":{{"const":{}}}}}}},"then":{}}})",
                             rules.empty() ? "" : ",", jsonText(name), then);
    };
    for (int i = 0; i <= static_cast<int>(Kind::render); ++i) {
        const auto kind = static_cast<Kind>(i);
        if (kind == Kind::group || kind == Kind::object) continue;
        add(keyword(kind), hasTypes(table, kind) ? fmt::format(R"({{"$ref":"#/$defs/{}"}})", keyword(kind)) : "");
    }
    for (const Kind kind : {Kind::group, Kind::object})
        add(keyword(kind),
            R"({"properties":{"children":{"items":{"anyOf":[{"properties":{"name":{"enum":["transform","visible-to"]}}},)"
            R"({"$ref":"#/$defs/statement"}]}}}})");
    add("scene", R"({"properties":{"values":{"items":{"type":"integer"},"maxItems":1},"children":{"maxItems":0}}})");
    add("param", R"({"properties":{"values":{"minItems":2}},"required":["values"]})");
    add("include",
        R"({"properties":{"values":{"items":{"type":"string"},"minItems":1,"maxItems":1}},"required":["values"]})");
    add("override", R"({"properties":{"values":{"items":true,"minItems":1}},"required":["values"]})");
    add("remove", R"({"properties":{"values":{"minItems":1},"children":{"maxItems":0}},"required":["values"]})");
    add("variant",
        R"({"properties":{"values":{"minItems":1,"maxItems":1},"children":{"items":{"$ref":"#/$defs/statement"}}}})");
    return fmt::format(
        R"({{"$ref":"#/$defs/node","properties":{{"name":{{"anyOf":[{{"enum":[{}]}},{{"pattern":"^x-"}}]}}}},"allOf":[{}]}})",
        names, rules);
}

constexpr std::string_view kNode =
    R"({"type":"object","properties":{"name":{"type":"string"},"values":{"type":"array","items":{"type":["number","string","boolean","null"]}},)"
    R"("keys":{"type":"object","additionalProperties":{"type":["number","string","boolean","null"]}},)"
    R"("children":{"type":"array","items":{"$ref":"#/$defs/node"}}},"required":["name"],"additionalProperties":false})";

} // namespace

std::string jsonSchema(const TypeTable& table) {
    std::string defs = fmt::format(R"("node":{},"numeric":{{"type":["number","string"]}},)", kNode);
    defs += R"("row":{"$ref":"#/$defs/node","properties":{"name":{"const":"-"}}},)";
    defs +=
        R"("transform-step":{"$ref":"#/$defs/node","properties":{"name":{"enum":["translate","rotate","scale","matrix","look-at","at"]}}},)";
    for (const TypeInfo& type : table.all())
        defs += fmt::format("{}:{},\n", jsonText(typeId(type)), fieldsSchema(type.fields));
    for (int i = 0; i <= static_cast<int>(Kind::render); ++i)
        if (const auto kind = static_cast<Kind>(i); hasTypes(table, kind))
            defs += fmt::format("{}:{},\n", jsonText(keyword(kind)), kindSchema(table, kind));
    defs += R"("statement":)" + statementSchema(table);
    return fmt::format("{{\"$schema\":\"https://json-schema.org/draft/2020-12/schema\",\n"
                       "\"title\":\"Abbe scene, edition 1\",\n"
                       "\"description\":\"The nodes of a scene file as `abbe fmt --tree` prints them\",\n"
                       "\"type\":\"array\",\"items\":{{\"$ref\":\"#/$defs/statement\"}},\n\"$defs\":{{{}}}}}\n",
                       defs);
}

} // namespace abbe::schema
