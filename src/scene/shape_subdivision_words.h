// Words of the subdivision options, in the order of the enumerators of SubdivisionCage.
#pragma once

#include <string_view>

namespace abbe::subdivision_words {

inline constexpr std::string_view kSchemes[] = {"catmull-clark", "loop", "bilinear"};
inline constexpr std::string_view kBoundaries[] = {"none", "edge-only", "edge-and-corner"};
inline constexpr std::string_view kFaceVarying[] = {"none",          "corners-only", "corners-plus1",
                                                    "corners-plus2", "boundaries",   "all"};
inline constexpr std::string_view kCreasings[] = {"uniform", "chaikin"};

} // namespace abbe::subdivision_words
