// Tables of "wavelength value" lines: .spd, .csv and plain text.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace abbe::schema {

struct SpectrumFile {
    std::vector<double> numbers; // nm, value, nm, value, …
    std::vector<int> lines;      // the line of each pair, from 1
    std::string error;           // empty: read
    int errorLine = 0;           // 0: the file as a whole
};

// Reads a file. Lines hold two numbers with spaces, tabs, a comma or a semicolon between; `#` and `//` start comments;
// the first line of data may be a heading. Never throws.
SpectrumFile readSpectrumFile(const std::filesystem::path&);

} // namespace abbe::schema
