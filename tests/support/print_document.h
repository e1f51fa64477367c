// A tree of nodes as KDL text: four spaces of indentation, one node a line, numbers in their shortest exact form.
#pragma once

#include "parser/characters.h"
#include "schema/document.h"

#include <cmath>
#include <fmt/format.h>
#include <string>
#include <utility>
#include <vector>

namespace abbe::test {

namespace printing {

using schema::Node;
using schema::Value;
using schema::ValueKind;

inline std::string quoted(std::string_view text) {
    std::string out = "\"";
    const char* const end = text.data() + text.size();
    for (const char* p = text.data(); p < end;) {
        const CodePoint c = decodeUtf8(p, end);
        const parser::Wide kind = parser::wideKind(c.value);
        if (*p == '\n')
            out += "\\n";
        else if (*p == '"' || *p == '\\')
            out += fmt::format("\\{}", *p);
        else if (kind == parser::Wide::newline || kind == parser::Wide::disallowed)
            out += fmt::format("\\u{{{:x}}}", c.value);
        else
            out.append(p, c.length);
        p += c.length;
    }
    return out + "\"";
}

// A name may be any text; quotes only where it would not be one word.
inline std::string name(std::string_view text) {
    const std::string copy(text);
    const char* const end = copy.c_str() + copy.size();
    const char first = copy.empty() ? '0' : copy[0];
    const bool letter = (first >= 'a' && first <= 'z') || (first >= 'A' && first <= 'Z') || first == '_' || copy == "-";
    const bool keyword = text == "true" || text == "false" || text == "null" || text == "inf" || text == "nan";
    return letter && !keyword && parser::wordEnd(copy.c_str(), end) == end ? copy : quoted(text);
}

inline std::string number(double value) {
    if (std::isnan(value)) return "#nan";
    if (std::isinf(value)) return value > 0 ? "#inf" : "#-inf";
    return fmt::format("{}", value);
}

inline std::string print(const Value& value) {
    switch (value.kind) {
    case ValueKind::number:
        return number(value.number);
    case ValueKind::word:
        return std::string(value.text);
    case ValueKind::string:
        return quoted(value.text);
    case ValueKind::boolean:
        return value.boolean ? "#true" : "#false";
    case ValueKind::null:
        break;
    }
    return "#null";
}

inline std::string printHead(const Node& node) {
    std::string line = name(node.name());
    if (node.allNumbers())
        for (const double n : node.numbers()) line += " " + number(n);
    else
        for (std::size_t i = 0; i < node.valueCount(); ++i) line += " " + print(node.value(i));
    for (const schema::Key& key : node.keys()) line += fmt::format(" {}={}", name(key.name), print(key.value));
    return line;
}

} // namespace printing

// Parsing the result gives the same names, values, keys and blocks. Parameters have been put in place already.
inline std::string print(const schema::Document& document) {
    std::string out;
    std::vector<std::pair<schema::NodeIterator, schema::NodeIterator>> open; // rest of each level
    open.emplace_back(document.roots().begin(), document.roots().end());
    while (!open.empty()) {
        auto& [next, end] = open.back();
        const std::string indent(4 * (open.size() - 1), ' ');
        if (next == end) {
            open.pop_back();
            if (!open.empty()) out += indent.substr(4) + "}\n";
            continue;
        }
        const schema::Node node = *next;
        ++next;
        out += indent + printing::printHead(node) + (node.hasBlock() ? " {\n" : "\n");
        if (node.hasBlock()) open.emplace_back(node.children().begin(), node.children().end());
    }
    return out;
}

} // namespace abbe::test
