// Tables of "wavelength value" lines, or of another quantity and its value: .spd, .csv and plain text.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::schema {

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
