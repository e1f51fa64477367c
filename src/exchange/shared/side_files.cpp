#include "exchange/shared/side_files.h"

#include "io/file.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <functional>
#include <optional>

namespace abbe::exchange {

namespace {

constexpr std::size_t kLongestStem = 80;

// Of "name-7".
std::optional<int> numberBehind(std::string_view name) {
    const std::size_t dash = name.rfind('-');
    if (dash == std::string_view::npos) return std::nullopt;
    int number = 0;
    const char* const end = name.data() + name.size();
    const auto [rest, error] = std::from_chars(name.data() + dash + 1, end, number);
    return error == std::errc() && rest == end ? std::optional(number) : std::nullopt;
}

std::string safeStem(std::string_view text) {
    const auto kept = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    };
    std::string stem;
    for (const char c : text.substr(0, kLongestStem)) stem += kept(c) ? c : '-';
    return stem.find_first_not_of('-') == std::string::npos ? "file" : stem;
}

} // namespace

SideFiles::SideFiles(std::filesystem::path scene, Target target) : scene_(std::move(scene)), target_(target) {
    folder_ = scene_.stem().string() + "-files";
}

std::string SideFiles::write(std::string_view stem, std::string_view extension, std::span<const char> bytes) {
    const std::string safe = safeStem(stem);
    std::string name = fmt::format("{}.{}", safe, extension);
    for (int& number = next_.try_emplace(name, 2).first->second; names_.contains(name); ++number)
        name = fmt::format("{}-{}.{}", safe, number, extension);
    if (target_ == Target::disk) {
        const auto folder = scene_.parent_path() / folder_;
        std::error_code error;
        std::filesystem::create_directories(folder, error);
        if (error) throw IoError(fmt::format("cannot make the folder `{}`: {}", folder.string(), error.message()));
        writeAtomically((folder / name).string(), bytes, Flush::later);
    }
    names_.insert(name);
    return (folder_ / name).generic_string();
}

std::string SideFiles::refer(const std::filesystem::path& file) {
    noteRead(file);
    std::error_code error;
    const auto target = std::filesystem::weakly_canonical(file, error);
    const auto parent = scene_.has_parent_path() ? scene_.parent_path() : std::filesystem::path(".");
    const auto home = std::filesystem::weakly_canonical(parent, error);
    if (error) return std::filesystem::absolute(file, error).generic_string();
    const auto relative = target.lexically_relative(home);
    const auto steps = std::ranges::count(relative, std::filesystem::path(".."));
    return relative.empty() || steps > 2 ? target.generic_string() : relative.generic_string();
}

std::string NameTable::take(std::string_view wish, std::string_view fallback) {
    std::string base(wish.empty() ? fallback : wish);
    if (!made(base) && insert(base)) {
        numbered_ = numbered_ || numberBehind(base);
        return prefix_.empty() ? base : prefix_ + base;
    }
    int& number = next_.try_emplace(base, 2).first->second;
    std::string name;
    do name = base + '-' + std::to_string(number++);
    while (numbered_ && isTaken(name));
    return prefix_.empty() ? name : prefix_ + name;
}

namespace {

std::uint64_t hashOfName(std::string_view name) {
    const std::uint64_t hash = std::hash<std::string_view>()(name);
    return hash != 0 ? hash : 1;
}

// Where a hash is in the table, or the free place where it belongs. The size is a power of two.
std::size_t placeOf(const std::vector<std::uint64_t>& table, std::uint64_t hash) {
    const std::size_t mask = table.size() - 1;
    std::size_t at = hash & mask;
    while (table[at] != 0 && table[at] != hash) at = (at + 1) & mask;
    return at;
}

} // namespace

bool NameTable::isTaken(std::string_view name) const {
    return !taken_.empty() && taken_[placeOf(taken_, hashOfName(name))] != 0;
}

bool NameTable::insert(std::string_view name) {
    constexpr std::size_t kFirst = 64;
    if (2 * (count_ + 1) > taken_.size()) {
        std::vector<std::uint64_t> larger(std::max(kFirst, 2 * taken_.size()), 0);
        for (const std::uint64_t hash : taken_)
            if (hash != 0) larger[placeOf(larger, hash)] = hash;
        taken_ = std::move(larger);
    }
    const std::uint64_t hash = hashOfName(name);
    std::uint64_t& slot = taken_[placeOf(taken_, hash)];
    if (slot != 0) return false;
    slot = hash;
    ++count_;
    return true;
}

// Whether a name with a number behind it was given to somebody.
bool NameTable::made(const std::string& name) const {
    if (next_.empty()) return false;
    const auto number = numberBehind(name);
    if (!number) return false;
    const auto found = next_.find(name.substr(0, name.rfind('-')));
    return found != next_.end() && *number < found->second;
}

void reserveTypeNames(NameTable& materials, NameTable& textures, NameTable& media) {
    for (const char* type :
         {"diffuse", "conductor", "dielectric", "subsurface", "mix", "two-sided", "layered", "boundary", "sheen",
          "thin-dielectric", "diffuse-transmission", "hair", "openpbr", "preset"})
        materials.take(type, {});
    for (const char* type :
         {"image", "noise", "checker", "ramp", "triplanar", "attribute", "product", "placed", "channel"})
        textures.take(type, {});
    for (const char* type : {"homogeneous", "noise", "preset"}) media.take(type, {});
}

} // namespace abbe::exchange
