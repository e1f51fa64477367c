// Packs: the archive, its entries and its manifest; and the bytes as a manifest, which archives with checksums hide.
#include "fuzz/target.h"
#include "fuzz/targets/reading.h"
#include "packs/manifest.h"
#include "packs/zip_file.h"

#include <set>

using namespace abbe;

namespace {

// Names stay in the pack, no two are alike, and each entry has the bytes that it promises.
void readArchive(const std::string& path) {
    const ZipReader zip(path);
    std::set<std::string> names;
    for (const ZipReader::Entry& entry : zip.entries()) {
        const std::string slashes = "/" + entry.name + "/";
        fuzz::require(!entry.name.starts_with('/') && slashes.find("/../") == std::string::npos,
                      "a name that leads out of the pack");
        fuzz::require(names.insert(entry.name).second, "a name twice");
        std::uint64_t bytes = 0;
        std::string text;
        try {
            zip.read(entry, [&](std::span<const char> portion) {
                bytes += portion.size();
                fuzz::require(bytes <= entry.bytes, "more bytes than promised");
                if (text.size() < 65536) text.append(portion.data(), portion.size());
            });
        } catch (const PackFault&) {
            continue;
        }
        fuzz::require(bytes == entry.bytes, "fewer bytes than promised");
        if (entry.name == kManifestName && text.size() == bytes) readManifest(text, path);
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes = fuzz::bytesOf(data, size);
    const fuzz::MemoryFile file(bytes);
    try {
        fuzz::reading([&] { readArchive(file.path()); });
    } catch (const PackFault&) {
    }
    try {
        readManifest(bytes, "fuzzed");
    } catch (const PackFault&) {
    }
    return 0;
}
