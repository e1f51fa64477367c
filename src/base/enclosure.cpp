#include "base/enclosure.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <mutex>
#include <set>
#include <string_view>

namespace abbe {

namespace {

namespace fs = std::filesystem;

struct Reach {
    fs::path project;
    std::vector<fs::path> search;
};

struct Places {
    std::mutex mutex;
    std::set<fs::path> enclosed;
    std::map<std::uint64_t, Reach> reaches; // in the order in which they were stated
    std::uint64_t next = 0;
};

Places& places() {
    static Places all;
    return all;
}

// Without `.`, `..` and a slash at the end.
fs::path plainPath(const fs::path& path) {
    std::error_code error;
    fs::path whole = fs::absolute(path, error).lexically_normal();
    return whole.has_filename() || !whole.has_relative_path() ? whole : whole.parent_path();
}

// Where it is, links followed as far as the path exists.
fs::path realPlace(const fs::path& path) {
    std::error_code error;
    const fs::path place = fs::weakly_canonical(fs::absolute(path, error), error);
    return plainPath(error ? path : place);
}

// The same of two plain paths.
bool isIn(const fs::path& file, const fs::path& top) {
    return std::mismatch(top.begin(), top.end(), file.begin(), file.end()).first == top.end();
}

fs::path folderOf(const fs::path& from) {
    std::error_code error;
    const fs::path folder = fs::is_directory(from, error) ? from : from.parent_path();
    return realPlace(folder.empty() ? "." : folder);
}

// Those that were stated for the deepest folder around a real one.
std::vector<Reach> reachesAround(const fs::path& folder) {
    const std::lock_guard lock(places().mutex);
    std::vector<Reach> found;
    std::ptrdiff_t deepest = -1;
    for (const auto& [number, reach] : places().reaches) {
        std::ptrdiff_t depth = -1;
        const auto look = [&](const fs::path& top) {
            if (isIn(folder, top)) depth = std::max(depth, std::distance(top.begin(), top.end()));
        };
        look(reach.project);
        for (const fs::path& top : reach.search) look(top);
        if (depth < 0 || depth < deepest) continue;
        if (depth > deepest) found.clear();
        deepest = depth;
        found.push_back(reach);
    }
    return found;
}

bool isSearchStated() {
    const std::lock_guard lock(places().mutex);
    return std::ranges::any_of(places().reaches, [](const auto& entry) { return !entry.second.search.empty(); });
}

// Nothing if no enclosed folder is around `from`.
std::vector<fs::path> enclosuresAround(const fs::path& from) {
    const std::lock_guard lock(places().mutex);
    const fs::path asker = plainPath(from);
    std::vector<fs::path> found;
    for (const fs::path& folder : places().enclosed)
        if (isIn(asker, folder)) found.push_back(folder);
    return found;
}

} // namespace

bool isBelow(const fs::path& path, const fs::path& folder) {
    const fs::path file = plainPath(path), top = plainPath(folder);
    return file != top && isIn(file, top);
}

void encloseFolder(const fs::path& folder) {
    const std::lock_guard lock(places().mutex);
    places().enclosed.insert(plainPath(folder));
}

std::vector<fs::path> foldersOfEnvironment() {
    const char* const value = std::getenv("ABBE_PATH");
    std::string_view rest = value ? value : "";
    std::vector<fs::path> folders;
    while (!rest.empty()) {
        const std::string_view one = rest.substr(0, rest.find(':'));
        if (!one.empty()) folders.push_back(realPlace(one));
        rest.remove_prefix(std::min(one.size() + 1, rest.size()));
    }
    return folders;
}

fs::path projectOf(const fs::path& folder) {
    const fs::path own = realPlace(folder.empty() ? "." : folder);
    std::error_code error;
    for (fs::path top = own;; top = top.parent_path()) {
        if (fs::is_regular_file(top / ".abbe-project", error)) return top;
        if (!top.has_relative_path()) return own;
    }
}

FileReach::FileReach(const fs::path& folder, const std::vector<std::string>& search) {
    Reach reach{projectOf(folder), {}};
    for (const std::string& one : search) reach.search.push_back(realPlace(one.empty() ? "." : one));
    const std::lock_guard lock(places().mutex);
    number_ = places().next++;
    places().reaches.emplace(number_, std::move(reach));
}

FileReach::~FileReach() {
    const std::lock_guard lock(places().mutex);
    places().reaches.erase(number_);
}

std::vector<fs::path> searchFolders(const fs::path& from) {
    if (!enclosuresAround(from).empty()) return {};
    std::vector<fs::path> folders;
    if (isSearchStated()) // else no path has to be looked up: this is asked for every name that is not beside its scene
        for (const Reach& reach : reachesAround(folderOf(from)))
            folders.insert(folders.end(), reach.search.begin(), reach.search.end());
    std::ranges::move(foldersOfEnvironment(), std::back_inserter(folders));
    return folders;
}

NameFault nameFault(const fs::path& from, const fs::path& named) {
    const auto enclosures = enclosuresAround(from);
    for (const fs::path& folder : enclosures)
        if (!isBelow(named, folder)) return NameFault::outsideEnclosure;
    if (!enclosures.empty()) return NameFault::none;
    const fs::path own = folderOf(from), place = realPlace(named);
    std::vector<fs::path> tops = foldersOfEnvironment();
    tops.push_back(projectOf(own));
    for (const Reach& reach : reachesAround(own)) {
        tops.push_back(reach.project);
        tops.insert(tops.end(), reach.search.begin(), reach.search.end());
    }
    const bool within = std::ranges::any_of(tops, [&](const fs::path& top) { return isIn(place, top); });
    return within ? NameFault::none : NameFault::outsideReach;
}

bool mayName(const fs::path& from, const fs::path& named) { return nameFault(from, named) == NameFault::none; }

std::string helpOutsideReach(const fs::path& named) {
    return "`--search " + realPlace(named).parent_path().string() +
           "` lets the scene read there; a file `.abbe-project` in a folder above both makes a project of that folder";
}

} // namespace abbe
