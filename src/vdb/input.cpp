#include "vdb/field.h"
#include "vdb/output.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace abbe::vdb {

namespace {

constexpr std::size_t kMagicBytes = 8;

std::string beginningOf(const std::string& path) {
    std::string bytes(kMagicBytes, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
    return bytes;
}

// A file of another kind is told by its first bytes, which are an eight-byte number in every OpenVDB file.
void checkMagic(const std::string& path) {
    const std::string begin = beginningOf(path);
    const std::int64_t magic = openvdb::OPENVDB_MAGIC;
    if (begin.empty()) throw Failure(VdbFault::Kind::damaged, fmt::format("`{}` is empty", path));
    if (begin.size() == sizeof magic && std::memcmp(begin.data(), &magic, sizeof magic) == 0) return;
    throw Failure(VdbFault::Kind::damaged, fmt::format("`{}` is not an OpenVDB file", path));
}

std::string damage(const std::string& subject, const std::string& path, const std::exception& e) {
    std::error_code unknown;
    const auto size = std::filesystem::file_size(path, unknown);
    return fmt::format("{} is damaged or cut off{}: {}", subject,
                       unknown ? std::string() : fmt::format(" (the file has {} bytes)", size), plainWords(e));
}

} // namespace

VdbInput::VdbInput(const std::string& path) : path_(path) {
    openvdb::initialize();
    checkMagic(path);
    file_ = std::make_unique<openvdb::io::File>(path);
    try {
        file_->open(false); // delayed loading would read later, from another place
    } catch (const openvdb::Exception& e) {
        throw Failure(VdbFault::Kind::damaged, damage(fmt::format("`{}`", path), path, e));
    }
    if (file_->beginName() == file_->endName())
        throw Failure(VdbFault::Kind::damaged, fmt::format("`{}` holds no grids: it is empty or cut off", path));
}

std::vector<std::string> VdbInput::names() const {
    std::vector<std::string> names;
    for (auto name = file_->beginName(); name != file_->endName(); ++name) names.push_back(name.gridName());
    return names;
}

openvdb::GridBase::Ptr VdbInput::grid(const std::string& name) {
    if (!file_->hasGrid(name)) return nullptr;
    try {
        return file_->readGrid(name);
    } catch (const openvdb::ArithmeticError&) {
        throw Failure(VdbFault::Kind::transform, subject(name) + " has a transform without an inverse");
    } catch (const openvdb::Exception& e) {
        throw Failure(VdbFault::Kind::damaged, damage(subject(name), path_, e));
    }
}

std::string VdbInput::subject(const std::string& name) const { return fmt::format("grid `{}` of `{}`", name, path_); }

} // namespace abbe::vdb
