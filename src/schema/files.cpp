#include "schema/files.h"

#include "base/enclosure.h"
#include "base/file.h"
#include "base/named_arrays.h"
#include "schema/suggest.h"

#include <charconv>
#include <fmt/format.h>
#include <string_view>

namespace abbe::schema {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostNames = 10'000; // of a folder that is searched for a similar name

// The file beside the missing one whose name is nearest, written as the scene would write it; or empty.
std::string similarFile(const fs::path& written, const fs::path& folder) {
    std::vector<std::string> names;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end && names.size() < kMostNames;
         it.increment(error))
        names.push_back(it->path().filename().string());
    const std::vector<std::string_view> candidates(names.begin(), names.end());
    const std::string missing = written.filename().string();
    const std::string_view found = nearest(missing, candidates);
    return found.empty() ? std::string() : (written.parent_path() / found).generic_string();
}

bool hasTile(const fs::path& path) {
    const std::string pattern = path.string();
    const std::size_t at = pattern.find("<UDIM>");
    if (at == std::string::npos) return false;
    std::error_code error;
    for (int tile = 1001; tile < 2000; ++tile)
        if (fs::exists(std::string(pattern).replace(at, 6, std::to_string(tile)), error)) return true;
    return false;
}

} // namespace

std::optional<fs::path> findFile(const Value& value, const SceneTree& tree, Diagnostics& diagnostics, bool tiles) {
    const bool user = tree.isOfCommandLine(value.span);
    auto path = lookUpFile(value, tree.directoryOf(value.span), diagnostics, {tiles, user});
    const auto insert = tree.inserts.find(value.span.file);
    if (path && tree.namedFiles && (insert == tree.inserts.end() || insert->second.written))
        tree.namedFiles->push_back({value.span, std::string(value.text), *path});
    return path;
}

fs::path placeOfFile(const fs::path& written, const fs::path& directory, bool tiles) {
    if (written.is_absolute()) return written;
    const auto isThere = [&](const fs::path& path) {
        std::error_code error;
        return fs::exists(path, error) || (tiles && hasTile(path));
    };
    const fs::path beside = directory / written;
    if (written.empty() || isThere(beside)) return beside;
    for (const fs::path& folder : searchFolders(directory))
        if (isThere(folder / written)) return folder / written;
    return beside;
}

namespace {

// Of a file that is where the scene may not look.
bool isRefused(const Value& value, const fs::path& directory, const fs::path& path, bool user,
               Diagnostics& diagnostics) {
    const NameFault fault = nameFault(directory, path);
    if (fault == NameFault::outsideEnclosure) {
        reportAt(diagnostics, value, "E0415", fmt::format("`{}` is outside of the pack", value.text), "not in the pack")
            .help = "unpack it with `abbe pack PACK -o FOLDER/` to render it with files of your own";
        return true;
    }
    if (fault == NameFault::none || user) return false;
    auto& d = reportAt(diagnostics, value, "E0417", fmt::format("`{}` is outside of the scene's project", value.text),
                       "not below the folder of the scene");
    d.notes.push_back(fmt::format("the project is {}", projectOf(directory).string()));
    d.help = helpOutsideReach(path);
    return true;
}

std::string placesSearched(const fs::path& written, const fs::path& directory) {
    if (written.is_absolute()) return written.parent_path().string();
    std::string places = directory.empty() ? "the current folder" : directory.string();
    for (const fs::path& folder : searchFolders(directory)) places += ", " + folder.string();
    return places;
}

} // namespace

std::optional<fs::path> lookUpFile(const Value& value, const fs::path& directory, Diagnostics& diagnostics,
                                   FileWish wish) {
    const bool nameable = !value.text.empty() && value.text.find('\0') == std::string_view::npos;
    if (nameable && findArrays(value.text)) return fs::path(value.text);
    const fs::path written(nameable ? value.text : std::string_view());
    const fs::path path = placeOfFile(written, directory, wish.tiles);
    if (nameable && isRefused(value, directory, path, wish.user, diagnostics)) return std::nullopt;
    std::error_code error;
    const auto status = fs::status(path, error);
    if (nameable && fs::is_directory(status)) {
        reportAt(diagnostics, value, "E0402", fmt::format("`{}` is a folder", value.text), "a file is needed");
        return std::nullopt;
    }
    if (nameable && fs::exists(status) && !fs::is_regular_file(status)) {
        reportAt(diagnostics, value, "E0402", fmt::format("`{}` is not a regular file", value.text),
                 "pipes and devices are not read");
        return std::nullopt;
    }
    if (nameable && (fs::exists(status) || (wish.tiles && hasTile(path)))) return path;
    auto& d = reportAt(diagnostics, value, "E0401", fmt::format("file not found: `{}`", value.text),
                       fmt::format("looked in {}", placesSearched(written, directory)));
    if (!nameable) return std::nullopt;
    const fs::path parent = path.parent_path().empty() ? fs::path(".") : path.parent_path();
    if (const std::string similar = similarFile(written, parent); !similar.empty())
        d.help = fmt::format("`{}` exists", similar);
    else if (!fs::is_directory(parent, error))
        d.help = fmt::format("there is no folder `{}`", written.parent_path().generic_string());
    return std::nullopt;
}

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
