#include "base/enclosure.h"

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

namespace abbe {

namespace {

namespace fs = std::filesystem;

struct Enclosures {
    std::mutex mutex;
    std::set<fs::path> folders;
};

Enclosures& enclosures() {
    static Enclosures all;
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
    return error ? plainPath(path) : place;
}

bool isBelowRoots(const fs::path& place, std::string_view roots) {
    while (!roots.empty()) {
        const std::string_view root = roots.substr(0, roots.find(':'));
        if (!root.empty() && isBelow(place, realPlace(root))) return true;
        roots.remove_prefix(std::min(root.size() + 1, roots.size()));
    }
    return false;
}

} // namespace

const char* rootFolders() {
    const char* const roots = std::getenv("ABBE_ROOT");
    return roots && *roots ? roots : nullptr;
}

bool isBelow(const fs::path& path, const fs::path& folder) {
    const fs::path file = plainPath(path), top = plainPath(folder);
    const auto [left, rest] = std::mismatch(top.begin(), top.end(), file.begin(), file.end());
    return left == top.end() && rest != file.end();
}

void encloseFolder(const fs::path& folder) {
    const std::lock_guard lock(enclosures().mutex);
    enclosures().folders.insert(plainPath(folder));
}

NameFault nameFault(const fs::path& from, const fs::path& named) {
    bool enclosed = false;
    {
        const std::lock_guard lock(enclosures().mutex);
        const fs::path asker = plainPath(from);
        for (const fs::path& folder : enclosures().folders) {
            if (asker != folder && !isBelow(asker, folder)) continue;
            if (!isBelow(named, folder)) return NameFault::outsideEnclosure;
            enclosed = true;
        }
    }
    const char* const roots = rootFolders();
    if (enclosed || !roots) return NameFault::none;
    std::error_code error;
    const fs::path own = fs::is_directory(from, error) ? from : from.parent_path();
    const fs::path place = realPlace(named);
    const bool below = isBelow(place, realPlace(own.empty() ? "." : own)) || isBelowRoots(place, roots);
    return below ? NameFault::none : NameFault::outsideRoots;
}

bool mayName(const fs::path& from, const fs::path& named) { return nameFault(from, named) == NameFault::none; }

} // namespace abbe
