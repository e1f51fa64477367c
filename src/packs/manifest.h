// What a pack says of itself: `abz.json`, its first file. docs/packing.md has the format.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// A pack is damaged, or is none that this program reads. what() names it, and the file in it.
struct PackFault : std::runtime_error {
    using std::runtime_error::runtime_error;
};

inline constexpr const char* kManifestName = "abz.json";
inline constexpr std::uint64_t kMostPackedFiles = 100'000;
inline constexpr std::uint64_t kLargestManifest = std::uint64_t{64} << 20;

struct PackedFile {
    std::string name; // relative, with slashes
    std::uint64_t bytes = 0;
    std::string sha256; // 64 hexadecimal digits
};

struct PackManifest {
    std::string program; // "abbe 0.1.0"
    std::string scene;   // the name of one of the files
    std::vector<PackedFile> files;
};

// As messages show it.
std::string quotedName(std::string_view name);
// Empty, or why a file in a pack is not called so. Good names are relative and go down only, on every system: UTF-8
// without control characters, `\`, `:` and empty, `.` or `..` parts.
std::string nameFault(std::string_view name);

// The same manifest makes the same text.
std::string manifestText(const PackManifest&);
// Of a text from anywhere: all names are good, none is there twice or the folder of another, the scene is one of them.
// `pack` is what messages call it. Throws PackFault.
PackManifest readManifest(const std::string& text, const std::string& pack);

} // namespace abbe
