#include "schema/file_path.h"

#include "schema/suggest.h"

#include <fmt/format.h>

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
    const bool nameable = !value.text.empty() && value.text.find('\0') == std::string_view::npos;
    const fs::path written(nameable ? value.text : std::string_view());
    const fs::path path = written.is_absolute() ? written : tree.directory / written;
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
    if (nameable && (fs::exists(status) || (tiles && hasTile(path)))) return path;
    const std::string folder = written.is_absolute() ? written.parent_path().string() : tree.directory.string();
    auto& d = reportAt(diagnostics, value, "E0401", fmt::format("file not found: `{}`", value.text),
                       fmt::format("looked in {}", folder.empty() ? "the current folder" : folder));
    if (!nameable) return std::nullopt;
    const fs::path parent = path.parent_path().empty() ? fs::path(".") : path.parent_path();
    if (const std::string similar = similarFile(written, parent); !similar.empty())
        d.help = fmt::format("`{}` exists", similar);
    else if (!fs::is_directory(parent, error))
        d.help = fmt::format("there is no folder `{}`", written.parent_path().generic_string());
    return std::nullopt;
}

} // namespace abbe::schema
