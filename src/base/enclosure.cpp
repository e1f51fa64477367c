#include "base/enclosure.h"

#include <algorithm>
#include <mutex>
#include <set>
#include <string>

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

} // namespace

bool isBelow(const fs::path& path, const fs::path& folder) {
    const fs::path file = plainPath(path), top = plainPath(folder);
    const auto [left, rest] = std::mismatch(top.begin(), top.end(), file.begin(), file.end());
    return left == top.end() && rest != file.end();
}

void encloseFolder(const fs::path& folder) {
    const std::lock_guard lock(enclosures().mutex);
    enclosures().folders.insert(plainPath(folder));
}

bool mayName(const fs::path& from, const fs::path& named) {
    const std::lock_guard lock(enclosures().mutex);
    const fs::path asker = plainPath(from);
    return std::ranges::all_of(enclosures().folders, [&](const fs::path& folder) {
        return (asker != folder && !isBelow(asker, folder)) || isBelow(named, folder);
    });
}

} // namespace abbe
