#include "base/named_arrays.h"

#include <mutex>

namespace abbe {

namespace {

constexpr std::string_view kArraysPrefix = "memory:";

struct ArrayNames {
    std::mutex mutex;
    std::uint64_t given = 0;
    std::map<std::string, std::weak_ptr<const NamedArrays>, std::less<>> list;
};

ArrayNames& arrayNames() {
    static ArrayNames names;
    return names;
}

} // namespace

std::span<const float> NamedArrays::of(std::string_view name) const {
    const auto found = floats.find(name);
    return found == floats.end() ? std::span<const float>() : found->second;
}

std::span<const std::uint32_t> NamedArrays::indices(std::string_view name) const {
    const auto found = integers.find(name);
    return found == integers.end() ? std::span<const std::uint32_t>() : found->second;
}

std::string nameArrays(std::string_view what, std::shared_ptr<const NamedArrays> arrays) {
    ArrayNames& names = arrayNames();
    const std::scoped_lock lock(names.mutex);
    std::erase_if(names.list, [](const auto& entry) { return entry.second.expired(); });
    std::string name = std::string(kArraysPrefix) + std::to_string(++names.given) + "/" + std::string(what);
    names.list.emplace(name, std::move(arrays));
    return name;
}

std::shared_ptr<const NamedArrays> findArrays(std::string_view name) {
    if (!name.starts_with(kArraysPrefix)) return nullptr;
    ArrayNames& names = arrayNames();
    const std::scoped_lock lock(names.mutex);
    const auto found = names.list.find(name);
    return found == names.list.end() ? nullptr : found->second.lock();
}

} // namespace abbe
