// What this program is, for --version and for the headers of images.
#pragma once

#include <string>

namespace abbe {

inline constexpr int kLanguageEdition = 1;

// "0.1.0": that of the project in CMakeLists.txt.
std::string versionNumber();
// The text of --version: version, edition and what it was built with, without a line end.
std::string versionText();

} // namespace abbe
