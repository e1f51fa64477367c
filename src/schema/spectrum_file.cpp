#include "schema/spectrum_file.h"

#include "base/regular_file.h"

#include <charconv>
#include <fmt/format.h>
#include <string_view>

namespace abbe::schema {

namespace {

constexpr std::size_t kLargestFile = 16u << 20; // a spectrum is a few kilobytes; more is another kind of file

std::string_view withoutComment(std::string_view line) {
    line = line.substr(0, line.find('#'));
    return line.substr(0, line.find("//"));
}

bool isSeparator(char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r'; }

// The numbers of a line; false if something else stands there.
bool readNumbers(std::string_view line, std::vector<double>& out) {
    const char* at = line.data();
    const char* const end = at + line.size();
    while (true) {
        while (at != end && isSeparator(*at)) ++at;
        if (at == end) return true;
        if (*at == '+') ++at;
        double value = 0;
        const auto [stop, error] = std::from_chars(at, end, value);
        if (error != std::errc() || (stop != end && !isSeparator(*stop))) return false;
        out.push_back(value);
        at = stop;
    }
}

bool fail(SpectrumFile& file, int line, std::string message) {
    file.error = std::move(message);
    file.errorLine = line;
    return false;
}

bool readLine(std::string_view text, int line, std::string_view what, SpectrumFile& file) {
    std::vector<double> row;
    const bool good = readNumbers(withoutComment(text), row);
    if (good && row.empty()) return true;
    if (!good && file.numbers.empty() && row.empty()) return true; // a heading such as "wavelength,value"
    if (!good) return fail(file, line, "a line without two numbers");
    if (row.size() != 2)
        return fail(file, line, fmt::format("a line has one {} and one value; this has {} numbers", what, row.size()));
    file.numbers.insert(file.numbers.end(), row.begin(), row.end());
    file.lines.push_back(line);
    return true;
}

} // namespace

SpectrumFile readSpectrumFile(const std::filesystem::path& path, std::string_view what) {
    SpectrumFile file;
    RegularFile stored(path.string());
    if (stored.size() > kLargestFile) {
        fail(file, 0, "it is larger than 16 MiB");
        return file;
    }
    const std::string text = stored.readAll();
    if (!stored.good()) {
        fail(file, 0, fmt::format("it cannot be read: {}", stored.why()));
        return file;
    }
    std::string_view rest = text;
    if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
    for (int line = 1; !rest.empty(); ++line) {
        const auto end = rest.find('\n');
        if (!readLine(rest.substr(0, end), line, what, file)) return file;
        rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    }
    if (file.numbers.empty()) fail(file, 0, fmt::format("it holds no lines of \"{} value\"", what));
    return file;
}

} // namespace abbe::schema
