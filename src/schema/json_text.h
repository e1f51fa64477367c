// Lists of JSON; texts are jsonText() of base/text.h.
#pragma once

#include "base/text.h"

#include <string>

namespace abbe::schema {

template <typename Range, typename Text> std::string jsonArray(const Range& range, Text text) {
    std::string out = "[";
    for (const auto& item : range) out += (out.size() > 1 ? "," : "") + text(item);
    return out + "]";
}

} // namespace abbe::schema
