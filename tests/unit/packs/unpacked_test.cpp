#include "io/file.h"
#include "packs/sha256.h"
#include "packs/unpacked.h"
#include "packs/zip_file.h"
#include "unit/io/temporary_folder.h"
#include "unit/packs/made_archives.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <sys/stat.h>

using namespace abbe;
using namespace abbe::test;

namespace {

namespace fs = std::filesystem;

std::string shaOfText(const std::string& text) {
    Sha256 hash;
    hash.add(text);
    return hash.digits();
}

std::string manifestOf(const std::vector<MadeFile>& files) {
    PackManifest manifest{"abbe test", "a.scene", {}};
    for (const MadeFile& file : files)
        if (!file.name.ends_with('/')) manifest.files.push_back({file.name, file.bytes.size(), shaOfText(file.bytes)});
    return manifestText(manifest);
}

const MadeFile kScene{"a.scene", "scene 1\n"};

// A folder with a cache, where one pack after the other is read.
struct PackFixture {
    TemporaryFolder folder;

    std::string write(const std::string& bytes) const {
        writeAll(folder / "a.abz", bytes);
        return folder / "a.abz";
    }

    // What is wrong with a pack of these files and this manifest, or "".
    std::string faultOf(std::vector<MadeFile> files, const std::string& manifest) const {
        files.insert(files.begin(), {kManifestName, manifest});
        return faultOfBytes(madeArchive(files));
    }
    std::string faultOf(const std::vector<MadeFile>& files) const { return faultOf(files, manifestOf(files)); }

    std::string faultOfBytes(const std::string& bytes) const {
        const std::string path = write(bytes);
        try {
            const UnpackedPack pack(path, folder / "cache");
            return {};
        } catch (const PackFault& fault) {
            const std::string text = fault.what();
            CHECK(text.starts_with("`" + path + "`: "));
            return text.substr(path.size() + 4);
        }
    }
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

} // namespace

TEST_CASE("a pack is unpacked once into a private folder, and again where somebody changed it") {
    const PackFixture f;
    const std::vector<MadeFile> files{
        {kManifestName, manifestOf({kScene, {"t/b.bin", "bytes"}})}, kScene, {"t/", "", 040755}, {"t/b.bin", "bytes"}};
    const std::string path = f.write(madeArchive(files));
    CHECK(isPack(path));
    fs::path unpacked;
    {
        const UnpackedPack pack(path, f.folder / "cache");
        unpacked = pack.folder();
        CHECK(readAll(pack.scenePath()) == kScene.bytes);
        CHECK(readAll(unpacked / "t/b.bin") == "bytes");
        struct stat status {};
        CHECK(::stat(unpacked.c_str(), &status) == 0);
        CHECK((status.st_mode & 0777) == 0700);
        CHECK(::stat((f.folder / "cache").c_str(), &status) == 0);
        CHECK((status.st_mode & 0777) == 0700);
    }
    CHECK(fs::exists(unpacked));
    fs::remove(path);
    f.write(madeArchive(files));
    writeAll(unpacked / "t/b.bin", "other"); // of the same size
    const auto before = fs::last_write_time(unpacked / "a.scene");
    const UnpackedPack again(path, f.folder / "cache");
    CHECK(again.folder() == unpacked);
    CHECK(readAll(unpacked / "t/b.bin") == "bytes");
    CHECK(fs::last_write_time(unpacked / "a.scene") == before);
    const UnpackedPack both(path, f.folder / "cache"); // two renders at once
    CHECK(both.folder() == unpacked);
}

TEST_CASE("what nobody used for a day is removed with the next pack; what is used stays") {
    const PackFixture f;
    const auto packOf = [&](const std::string& text) {
        const MadeFile scene{"a.scene", text};
        return f.write(madeArchive({{kManifestName, manifestOf({scene})}, scene}));
    };
    const auto makeOld = [](const fs::path& folder) {
        fs::last_write_time(folder.string() + ".lock", fs::file_time_type::clock::now() - std::chrono::hours(25));
    };
    fs::path unused;
    {
        const UnpackedPack pack(packOf("one"), f.folder / "cache");
        unused = pack.folder();
    }
    makeOld(unused);
    const UnpackedPack used(packOf("two"), f.folder / "cache");
    CHECK_FALSE(fs::exists(unused));
    CHECK_FALSE(fs::exists(unused.string() + ".lock"));
    makeOld(used.folder());
    const UnpackedPack third(packOf("three"), f.folder / "cache");
    CHECK(fs::exists(used.scenePath()));
}

TEST_CASE("a cache that others may write to is refused") {
    const PackFixture f;
    const std::string path = f.write(madeArchive({{kManifestName, manifestOf({kScene})}, kScene}));
    fs::create_directory(f.folder / "cache");
    CHECK_THROWS_AS(UnpackedPack(path, f.folder / "cache"), IoError);
    fs::remove(f.folder / "cache");
    fs::create_directory(f.folder / "elsewhere");
    fs::create_symlink(f.folder / "elsewhere", f.folder / "cache");
    CHECK_THROWS_AS(UnpackedPack(path, f.folder / "cache"), IoError);
}

TEST_CASE("names that lead out of a pack, absolute ones and odd ones are refused, in the archive and in the manifest") {
    const PackFixture f;
    const std::string good = manifestOf({kScene});
    for (const char* name : {"../evil", "a/../../evil", "/tmp/evil", "a/./b", "a//b", "..", ".", "C:evil", "a\\b",
                             "a\nb", "\xff\xfe", "a/"}) {
        CAPTURE(name);
        CHECK_FALSE(f.faultOf({kScene, {name, "x"}}, good).empty());
        const bool asText = std::string(name) != "a/" && std::string(name) != "\xff\xfe"; // as manifestOf() makes it
        if (asText) CHECK_FALSE(f.faultOf({kScene}, manifestOf({kScene, {name, "x"}})).empty());
        CHECK_FALSE(fs::exists(f.folder / "evil"));
        CHECK_FALSE(fs::exists("/tmp/evil"));
    }
    CHECK(has(f.faultOf({kScene, {"../evil", "x"}}), "leads out of the pack"));
    CHECK(has(f.faultOf({kScene, {std::string(300, 'a'), "x"}}), "too long"));
}

TEST_CASE("links, devices, encryption and other methods are refused") {
    const PackFixture f;
    CHECK(has(f.faultOf({kScene, {"b", "/etc/passwd", 0120777}}), "`b`: it is a link"));
    CHECK(has(f.faultOf({kScene, {"b", "", 0020666}}), "no regular file"));
    CHECK(has(f.faultOf({kScene, {"b", "", 040755}}), "folder"));
    CHECK(has(f.faultOf({kScene, {"b", "x", 0100644, 0xffffffffu, 1}}), "encrypted"));
    CHECK(has(f.faultOf({kScene, {"b", "x", 0100644, 0xffffffffu, 0, 12}}), "neither stored nor deflated"));
}

TEST_CASE("what is there twice, missing, or not in the manifest is refused") {
    const PackFixture f;
    CHECK(has(f.faultOf({kScene, kScene}, manifestOf({kScene})), "`a.scene`: it is there twice"));
    CHECK(has(f.faultOf({kScene}, manifestOf({kScene, kScene})), "`a.scene`: it is there twice"));
    CHECK(has(f.faultOf({kScene}, manifestOf({kScene, {"b", "x"}})), "`b`: it is in abz.json, but not there"));
    CHECK(has(f.faultOf({kScene, {"b", "x"}}, manifestOf({kScene})), "`b`: it is not in abz.json"));
    CHECK(has(f.faultOf({kScene, {"b", "x"}, {"b/c", "x"}}), "a file and a folder"));
    CHECK(has(f.faultOf({{"b", "x"}}), "its scene is none of its files"));
    CHECK(has(f.faultOfBytes(madeArchive({kScene})), "without abz.json"));
}

TEST_CASE("more or fewer bytes than promised, and other bytes, are refused") {
    const PackFixture f;
    const MadeFile other{"b", "good"};
    CHECK(has(f.faultOf({kScene, {"b", "evil"}}, manifestOf({kScene, other})), "`b`: its SHA-256 is not"));
    CHECK(f.faultOf({kScene, other}).empty());
    CHECK(has(f.faultOf({kScene, {"b", "more"}}, manifestOf({kScene, {"b", "mo"}})), "`b`: it has 4 bytes, but 2"));
    CHECK_FALSE(f.faultOf({kScene, {"b", "more", 0100644, 2}}, manifestOf({kScene, {"b", "mo"}})).empty());
    CHECK_FALSE(f.faultOf({kScene, {"b", "less", 0100644, 9}}, manifestOf({kScene, {"b", "123456789"}})).empty());
    std::string bytes = madeArchive({{kManifestName, manifestOf({kScene, other})}, kScene, other});
    for (const std::size_t size : {bytes.size() - 1, bytes.size() / 2, std::size_t{40}, std::size_t{4}})
        CHECK_FALSE(f.faultOfBytes(bytes.substr(0, size)).empty());
}

TEST_CASE("manifests that are none are refused") {
    const PackFixture f;
    for (const char* text :
         {"", "{", "[]", "null", R"({"format": "other"})", R"({"format": "abbe pack"})",
          R"({"format": "abbe pack", "version": 2})", R"({"format": "abbe pack", "version": 1, "files": 3})",
          R"({"format": "abbe pack", "version": 1, "files": [3]})",
          R"({"format": "abbe pack", "version": 1, "files": [{"name": "a", "bytes": -1, "sha256": ""}]})",
          R"({"format": "abbe pack", "version": 1, "files": [{"name": "a", "bytes": 1, "sha256": "zz"}]})"}) {
        CAPTURE(text);
        CHECK(has(f.faultOf({kScene}, text), "abz.json: "));
    }
    CHECK(has(f.faultOf({kScene}, std::string(100'000, '[')), "nested too deeply"));
    std::string huge = manifestOf({kScene});
    huge.replace(huge.find("\"bytes\": 8"), 10, "\"bytes\": 18446744073709551615");
    CHECK(has(f.faultOf({kScene}, huge), "too many bytes"));
}

TEST_CASE("an archive that promises a number of files that takes all memory is refused") {
    const PackFixture f;
    std::string bytes = madeArchive({kScene});
    const std::string end = bytes.substr(bytes.size() - 22);
    bytes.resize(bytes.size() - 22);
    const std::uint64_t at = bytes.size(), many = std::uint64_t{1} << 40;
    bytes += std::string("PK\6\6", 4) + littleEndian(44, 8) + littleEndian(45, 2) + littleEndian(45, 2) +
             littleEndian(0, 8) + littleEndian(many, 8) + littleEndian(many, 8) + littleEndian(50, 8) +
             littleEndian(0xffffffff, 8);
    bytes += std::string("PK\6\7", 4) + littleEndian(0, 4) + littleEndian(at, 8) + littleEndian(1, 4);
    bytes += end.substr(0, 8) + std::string(12, '\xff') + std::string(2, '\0');
    CHECK(has(f.faultOfBytes(bytes), "promises more than"));
}

TEST_CASE("archives are written and read again, to the same bytes each time") {
    const TemporaryFolder folder;
    const std::string big(3'000'000, 'x');
    writeAll(folder / "big", big);
    const std::vector<ZipSource> sources{{"a", "text of a", {}, 9, {}, false},
                                         {"s/big", {}, folder / "big", big.size(), shaOfText(big), true},
                                         {"ä", "", {}, 0, {}, false}};
    writeZip(folder / "one.zip", sources);
    writeZip(folder / "two.zip", sources);
    CHECK(readAll(folder / "one.zip") == readAll(folder / "two.zip"));
    CHECK(readAll(folder / "one.zip").size() < 10'000);
    const ZipReader zip(folder / "one.zip");
    REQUIRE(zip.entries().size() == 3);
    CHECK(zip.entries()[1].name == "s/big");
    CHECK(zip.entries()[2].name == "ä");
    std::string read;
    zip.read(zip.entries()[1], [&](std::span<const char> bytes) { read.append(bytes.data(), bytes.size()); });
    CHECK(read == big);
    writeAll(folder / "big", std::string(big.size(), 'y'));
    CHECK_THROWS_WITH_AS(writeZip(folder / "three.zip", sources),
                         ("`" + (folder / "big") + "` was changed while it was packed").c_str(), IoError);
    CHECK_FALSE(fs::exists(folder / "three.zip"));
    CHECK_THROWS_AS(writeZip(folder / "none/three.zip", sources), IoError);
}
