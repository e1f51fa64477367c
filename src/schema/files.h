// Files that a scene names: where they are, and the tables in them.
#pragma once

#include "schema/entry.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::schema {

// The path of an existing file, looked up beside the text that names it and then in searchFolders(); nothing after a
// diagnostic. With `tiles`, `<UDIM>` in its name stands for a number from 1001 to 1999, and one such file is enough.
std::optional<std::filesystem::path> findFile(const Value&, const SceneTree&, Diagnostics&, bool tiles = false);

// The same in a folder, of a file that is not noted as one that a definition names.
// `user`: the name was given on the command line, where everything may be named that a pack does not forbid.
struct FileWish {
    bool tiles = false, user = false;
};
std::optional<std::filesystem::path> lookUpFile(const Value&, const std::filesystem::path& directory, Diagnostics&,
                                                FileWish = {});

// Where that looks: beside the naming text if the file is there or nowhere, else in the first of searchFolders().
std::filesystem::path placeOfFile(const std::filesystem::path& written, const std::filesystem::path& directory,
                                  bool tiles = false);

struct SpectrumFile {
    std::vector<double> numbers; // wavelength in nm, value, wavelength, …
    std::vector<int> lines;      // the line of each pair, from 1
    std::string error;           // empty: read
    int errorLine = 0;           // 0: the file as a whole
};

// Reads a file. Lines hold two numbers with spaces, tabs, a comma or a semicolon between; `#` and `//` start comments;
// the first line of data may be a heading. `what` the first number is called in messages. Never throws.
SpectrumFile readSpectrumFile(const std::filesystem::path&, std::string_view what = "wavelength");

} // namespace abbe::schema
