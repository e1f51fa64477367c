#include "packs/unpacked.h"

#include "base/enclosure.h"
#include "base/file.h"
#include "base/memory_limit.h"
#include "base/path_lock.h"
#include "base/private_folder.h"
#include "io/file.h"
#include "packs/sha256.h"
#include "packs/zip_file.h"
#include "spectrum/upsampling_table.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <fmt/format.h>
#include <map>
#include <sys/stat.h>
#include <unistd.h>

namespace abbe {

namespace {

namespace fs = std::filesystem;

// The time of every file that was unpacked and checked; a file that somebody changed since has another.
constexpr timespec kUnpacked{315532800, 0}; // 1 January 1980
constexpr double kUnused = 24 * 3600;       // s after which a pack is removed
constexpr double kLongestWait = 3600;       // s, for another process that unpacks

[[noreturn]] void failSystem(const fs::path& path, int error) {
    throw IoError(fmt::format("cannot unpack to `{}`: {}", path.string(), std::strerror(error)));
}

void requirePrivateFolder(const fs::path& path) {
    if (const int error = makePrivateFolder(path)) failSystem(path, error);
}

bool isUnpacked(const fs::path& path, const PackedFile& file) {
    struct stat status {};
    return ::lstat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
           static_cast<std::uint64_t>(status.st_size) == file.bytes && status.st_mtim.tv_sec == kUnpacked.tv_sec;
}

void requireRoom(const fs::path& cache, std::uint64_t bytes) {
    const auto hasRoom = [&] {
        std::error_code error;
        const fs::space_info space = fs::space(cache, error);
        return error || bytes <= space.available;
    };
    if (hasRoom()) return;
    removeUnusedFolders(cache, 0);
    if (!hasRoom())
        throw IoError(fmt::format("cannot unpack to `{}`: the pack has {:.3g} GB, and there is less room",
                                  cache.string(), static_cast<double>(bytes) / 1e9));
}

class Unpacking {
  public:
    Unpacking(const ZipReader& zip, const std::string& pack, const fs::path& folder)
        : zip_(zip), pack_(pack), folder_(folder) {}

    void file(const PackedFile& file, const ZipReader::Entry& entry) const {
        const fs::path target = folder_ / file.name;
        std::error_code error;
        fs::create_directories(target.parent_path(), error);
        TemporaryFile temporary(target.string());
        if (temporary.error() != 0) failSystem(target, temporary.error());
        Sha256 hash;
        zip_.read(entry, [&](std::span<const char> bytes) {
            hash.add(bytes);
            put(temporary, bytes);
        });
        if (hash.digits() != file.sha256)
            throw PackFault(
                fmt::format("`{}`: {}: its SHA-256 is not the one in {}", pack_, quotedName(file.name), kManifestName));
        const timespec times[2] = {kUnpacked, kUnpacked};
        if (::futimens(temporary.descriptor(), times) != 0) failSystem(target, errno);
        if (const int fault = temporary.commit()) failSystem(target, fault);
    }

  private:
    void put(const TemporaryFile& to, std::span<const char> bytes) const {
        while (!bytes.empty()) {
            const ssize_t done = ::write(to.descriptor(), bytes.data(), bytes.size());
            if (done < 0 && errno == EINTR) continue;
            if (done <= 0) failSystem(to.path(), done < 0 ? errno : ENOSPC);
            bytes = bytes.subspan(static_cast<std::size_t>(done));
        }
    }

    const ZipReader& zip_;
    const std::string& pack_;
    const fs::path& folder_;
};

std::string textOf(const ZipReader& zip, const ZipReader::Entry& entry) {
    std::string text;
    requireMemory(static_cast<double>(entry.bytes));
    zip.read(entry, [&](std::span<const char> bytes) { text.append(bytes.data(), bytes.size()); });
    return text;
}

using Entries = std::map<std::string_view, const ZipReader::Entry*>;

Entries entriesOf(const ZipReader& zip) {
    Entries entries;
    for (const ZipReader::Entry& entry : zip.entries())
        if (!entry.name.ends_with('/') && entry.name != kManifestName) entries[entry.name] = &entry;
    return entries;
}

// The archive has the files of its manifest and no others.
void checkEntries(const ZipReader& zip, const PackManifest& manifest, const std::string& pack) {
    Entries entries = entriesOf(zip);
    const auto fail = [&](std::string_view name, const std::string& why) {
        throw PackFault(fmt::format("`{}`: {}: {}", pack, quotedName(name), why));
    };
    for (const PackedFile& file : manifest.files) {
        const auto found = entries.find(file.name);
        if (found == entries.end()) fail(file.name, fmt::format("it is in {}, but not there", kManifestName));
        if (found->second->bytes != file.bytes)
            fail(file.name,
                 fmt::format("it has {} bytes, but {} in {}", found->second->bytes, file.bytes, kManifestName));
        entries.erase(found);
    }
    if (!entries.empty()) fail(entries.begin()->first, fmt::format("it is not in {}", kManifestName));
}

PackManifest manifestOf(const ZipReader& zip, const std::string& pack, std::string& key) {
    const auto first = std::ranges::find(zip.entries(), kManifestName, &ZipReader::Entry::name);
    if (first == zip.entries().end())
        throw PackFault(fmt::format("`{}`: it is a ZIP file without {}, and no pack", pack, kManifestName));
    if (first->bytes > kLargestManifest)
        throw PackFault(fmt::format("`{}`: {} is larger than {} MiB", pack, kManifestName, kLargestManifest >> 20));
    const std::string text = textOf(zip, *first);
    PackManifest manifest = readManifest(text, pack);
    checkEntries(zip, manifest, pack);
    Sha256 hash;
    hash.add(text);
    key = hash.digits().substr(0, 32);
    return manifest;
}

} // namespace

bool isPack(const std::string& path) {
    RegularFile file(path);
    char head[4] = {};
    return file.good() && file.readAt(0, head) == sizeof head && std::memcmp(head, "PK\3\4", sizeof head) == 0;
}

fs::path packCacheDirectory() {
    if (const fs::path cache = UpsamplingTable::cacheDirectory(); !cache.empty()) return cache / "packs";
    std::error_code error;
    return fs::temp_directory_path(error) / fmt::format("abbe-packs-{}", ::geteuid());
}

UnpackedPack::UnpackedPack(const std::string& path, fs::path cache) {
    const ZipReader zip(path);
    std::string key; // the contents, since the manifest has the hashes of all
    manifest_ = manifestOf(zip, path, key);
    if (cache.empty()) cache = packCacheDirectory();
    requirePrivateFolder(cache);
    folder_ = cache / key;
    use_ = std::make_unique<const FolderUse>(folder_);
    requirePrivateFolder(folder_);
    if (!missing().empty()) {
        // One process unpacks; others that begin meanwhile wait for it. Two would only do the same twice.
        const PathLock lock(folder_.string(), kLongestWait);
        removeUnusedFolders(cache, kUnused);
        unpack(zip, path, cache);
    }
    encloseFolder(folder_);
}

std::vector<const PackedFile*> UnpackedPack::missing() const {
    std::vector<const PackedFile*> files;
    for (const PackedFile& file : manifest_.files)
        if (!isUnpacked(folder_ / file.name, file)) files.push_back(&file);
    return files;
}

void UnpackedPack::unpack(const ZipReader& zip, const std::string& pack, const fs::path& cache) const {
    const auto files = missing();
    std::uint64_t bytes = 0;
    for (const PackedFile* file : files) bytes += file->bytes;
    requireRoom(cache, bytes);
    const Entries entries = entriesOf(zip);
    const Unpacking unpacking(zip, pack, folder_);
    for (const PackedFile* file : files) unpacking.file(*file, *entries.at(file->name));
}

UnpackedPack::~UnpackedPack() = default;

} // namespace abbe
