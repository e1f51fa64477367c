// The flag `--png` of `abbe render` and `abbe merge`.
#pragma once

#include "app/options.h"

#include <string>
#include <vector>

namespace abbe {

inline constexpr const char* kPngFlag = "--png{.}"; // as the library writes an optional value
inline constexpr const char* kPngHelp = "Name the PNG beside the image; off: none";

// As the library takes them, the last one first, with `--png off` and `--png look.png` as one word. What else follows
// `--png` may be the scene.
std::vector<std::string> libraryWords(std::vector<std::string> words);

// `value`: of the flag; empty without it, "." without a value. A view asks for a PNG, too.
PngOptions pngOptions(const std::string& value, const ViewOptions&);

} // namespace abbe
