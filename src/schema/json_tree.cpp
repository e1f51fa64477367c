#include "schema/json_schema.h"
#include "schema/json_text.h"

#include <cmath>

namespace abbe::schema {

namespace {

std::string jsonNumber(double v) {
    if (std::isnan(v)) return "\"#nan\"";
    if (std::isinf(v)) return v > 0 ? "\"#inf\"" : "\"#-inf\"";
    return fmt::format("{}", v);
}

std::string jsonValue(const Value& value) {
    switch (value.kind) {
    case ValueKind::number:
        return jsonNumber(value.number);
    case ValueKind::boolean:
        return value.boolean ? "true" : "false";
    case ValueKind::null:
        return "null";
    default:
        return jsonText(value.text);
    }
}

// Everything is appended to one text: inline meshes are large.
void addTree(const Node& node, std::string& out) {
    out += R"({"name":)" + jsonText(node.name());
    if (node.allNumbers() && node.numbers().size() > 0) {
        out += R"(,"values":[)";
        const char* between = "";
        for (const double v : node.numbers()) {
            out += between + jsonNumber(v);
            between = ",";
        }
        out += ']';
    } else if (node.valueCount() > 0) {
        out += R"(,"values":[)";
        for (std::size_t i = 0; i < node.valueCount(); ++i) out += (i > 0 ? "," : "") + jsonValue(node.value(i));
        out += ']';
    }
    if (!node.keys().empty()) {
        out += R"(,"keys":{)";
        const char* between = "";
        for (const Key& key : node.keys()) {
            out += between + jsonText(key.name) + ":" + jsonValue(key.value);
            between = ",";
        }
        out += '}';
    }
    if (node.hasBlock()) {
        out += R"(,"children":[)";
        bool first = true;
        for (const Node child : node.children()) {
            if (!first) out += ',';
            first = false;
            addTree(child, out);
        }
        out += ']';
    }
    out += '}';
}

} // namespace

std::string treeJson(const Document& document) {
    std::string out = "[";
    for (const Document::Parameter& parameter : document.parameters) {
        if (out.size() > 1) out += ",\n";
        out += R"({"name":"param","values":[)" + jsonText(parameter.name);
        for (const Value& value : parameter.values()) out += "," + jsonValue(value);
        if (!parameter.doc.empty()) out += "," + jsonText(parameter.doc);
        out += "]}";
    }
    for (const Node node : document.roots()) {
        if (out.size() > 1) out += ",\n";
        addTree(node, out);
    }
    return out + "]\n";
}

} // namespace abbe::schema
