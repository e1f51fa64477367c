// Pieces of JSON.
#pragma once

#include <fmt/format.h>
#include <string>
#include <string_view>

namespace abbe::schema {

// Quoted, with escapes.
inline std::string jsonString(std::string_view text) {
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

inline std::string jsonView(std::string_view text) { return jsonString(text); }

template <typename Range, typename Text> std::string jsonArray(const Range& range, Text text) {
    std::string out = "[";
    for (const auto& item : range) out += (out.size() > 1 ? "," : "") + text(item);
    return out + "]";
}

} // namespace abbe::schema
