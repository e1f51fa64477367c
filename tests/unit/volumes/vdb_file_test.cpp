#include "volumes/brick_bounds.h"
#include "volumes/vdb_file.h"

#include <cstdlib>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <random>
#include <unistd.h>

using namespace abbe;
namespace fs = std::filesystem;

namespace {

// A folder for this test's files.
class Folder {
  public:
    Folder() : path_(fs::temp_directory_path() / ("abbe_vdb_test_" + std::to_string(::getpid()))) {
        fs::create_directories(path_);
    }
    ~Folder() {
        std::error_code error;
        fs::remove_all(path_, error);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::string file(const char* name) const { return (path_ / name).string(); }

  private:
    fs::path path_;
};

std::string made(const Folder& folder, const char* kind, const char* resolution = "40") {
    const std::string path = folder.file((std::string(kind) + ".vdb").c_str());
    const auto result = runVdbHelper({"make", kind, path, resolution, "1"});
    const auto* fault = std::get_if<VdbFault>(&result);
    REQUIRE_MESSAGE(!fault, (fault ? fault->text : ""));
    return path;
}

// One grid that must be there.
VdbGrid readOne(const std::string& path, const VdbRequest& request) {
    auto result = readVdb(path, {&request, 1});
    const auto* fault = std::get_if<VdbFault>(&result);
    REQUIRE_MESSAGE(!fault, (fault ? fault->text : ""));
    return std::move(std::get<0>(result)[0]);
}

VdbFault faultOf(const std::string& path, const VdbRequest& request) {
    auto result = readVdb(path, {&request, 1});
    REQUIRE(std::holds_alternative<VdbFault>(result));
    return std::get<VdbFault>(result);
}

std::string shared(const char* name) {
    const std::string path = std::string(ABBE_SOURCE_DIR "/../shared/data/vdb/") + name;
    return fs::exists(path) ? path : std::string();
}

} // namespace

TEST_CASE("what is written is read: scalar and vector grids, in the order asked for" * doctest::test_suite("input")) {
    const Folder folder;
    const std::string path = made(folder, "smoke");
    const VdbRequest requests[] = {{"velocity", VdbUse::vector}, {"heat", VdbUse::amount, true}, {"density"}};
    auto result = readVdb(path, requests);
    REQUIRE(std::holds_alternative<std::vector<VdbGrid>>(result));
    const auto& grids = std::get<0>(result);
    REQUIRE(grids.size() == 3);
    REQUIRE(grids[0].vector);
    CHECK(grids[0].vector->facts().unit == "m/s");
    CHECK_FALSE(grids[1].scalar);
    CHECK_FALSE(grids[1].vector);
    REQUIRE(grids[2].scalar);
    const VoxelGrid& density = *grids[2].scalar;
    CHECK(density.name() == "density");
    CHECK(density.facts().volumeClass == VolumeClass::fog);
    const Vec3i count = density.upperVoxel() - density.lowerVoxel() + Vec3i(1, 1, 1);
    CHECK(maxComponent(Vec3(count)) >= 40); // as was asked for
    CHECK(maxComponent(Vec3(count)) <= 46);
    CHECK(density.indexToWorld().a[0][0] == doctest::Approx(6. / 40).epsilon(0.1));
    CHECK(density.maximum() > 0);
    CHECK(density.activeVoxels() == grids[0].vector->activeVoxels());
    CHECK(density.worldBounds().upper.y < 6.5);
    CHECK(length(grids[0].vector->sampler().at(Vec3(density.worldToIndex().point({0, 0.6, 0})))) > 0.1f);
    CHECK_FALSE(BrickBounds::build(density).empty());
}

TEST_CASE("the same seed makes the same volume, another seed another") {
    const Folder folder;
    const auto sum = [&](const char* kind, const char* seed) {
        const std::string path = folder.file("x.vdb");
        REQUIRE(std::holds_alternative<std::string>(runVdbHelper({"make", kind, path, "48", seed})));
        const VdbGrid g = readOne(path, {"density"});
        return std::pair(g.scalar->activeVoxels(), g.scalar->sampler().at({2, 12, 1}));
    };
    for (const char* kind : {"cumulus", "smoke", "fire", "candle"}) {
        CHECK(sum(kind, "1") == sum(kind, "1"));
        CHECK(sum(kind, "1") != sum(kind, "2"));
    }
}

TEST_CASE("missing grids, files and folders are named" * doctest::test_suite("input")) {
    const Folder folder;
    const std::string path = made(folder, "fire");
    const VdbFault missing = faultOf(path, {"densiti"});
    CHECK(missing.kind == VdbFault::Kind::noGrid);
    CHECK(missing.names == std::vector<std::string>{"density", "flame", "temperature"});
    CHECK(missing.text.find("`density`") != std::string::npos);
    CHECK(faultOf(folder.file("none.vdb"), {"density"}).kind == VdbFault::Kind::file);
    CHECK(faultOf(folder.file(""), {"density"}).kind == VdbFault::Kind::file);
    CHECK(faultOf(path, {"density", VdbUse::vector}).kind == VdbFault::Kind::wrongKind);
    CHECK(faultOf(made(folder, "smoke"), {"velocity"}).kind == VdbFault::Kind::wrongKind);
}

TEST_CASE("damaged files are faults, whatever they do to the reader" * doctest::test_suite("input")) {
    const Folder folder;
    const std::string good = made(folder, "fire", "24");
    std::ifstream in(good, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    const std::string path = folder.file("bad.vdb");
    const auto write = [&](const std::string& content) { std::ofstream(path, std::ios::binary) << content; };
    write("");
    CHECK(faultOf(path, {"density"}).kind == VdbFault::Kind::damaged);
    write("this is no volume, however long it may be");
    CHECK(faultOf(path, {"density"}).kind == VdbFault::Kind::damaged);
    for (const std::size_t size : {20ul, 200ul, bytes.size() / 4, bytes.size() / 2}) {
        write(bytes.substr(0, size));
        CHECK(faultOf(path, {"density"}).kind == VdbFault::Kind::damaged);
    }
    std::string newer = bytes;
    newer[8] = static_cast<char>(225); // after the magic number; this library writes 224
    write(newer);
    CHECK(faultOf(path, {"density"}).text.find("has format 225 of OpenVDB") != std::string::npos);
    std::mt19937 random(1);
    int faults = 0;
    for (int i = 0; i < 25;
         ++i) { // wrong values cannot be told from right ones; what is read must be sound all the same
        std::string spoilt = bytes;
        for (int k = 0; k < 4; ++k)
            spoilt[random() % (i % 2 ? 1500 : spoilt.size())] ^= static_cast<char>(1 + random() % 255);
        write(spoilt);
        const VdbRequest request{"density"};
        auto result = readVdb(path, {&request, 1});
        if (std::holds_alternative<VdbFault>(result)) {
            ++faults;
            continue;
        }
        const VoxelGrid& grid = *std::get<0>(result)[0].scalar;
        CHECK(std::isfinite(grid.maximum()));
        CHECK(grid.minimum() >= 0);
        inspectVdb(path);
    }
    CHECK(faults > 0);
}

TEST_CASE("inspection tells what is there" * doctest::test_suite("input")) {
    const Folder folder;
    const auto result = inspectVdb(made(folder, "fire"));
    REQUIRE(std::holds_alternative<VdbFileInfo>(result));
    const auto& info = std::get<VdbFileInfo>(result);
    REQUIRE(info.grids.size() == 3);
    const VdbGridInfo& temperature = info.grids[2];
    CHECK(temperature.name == "temperature");
    CHECK(temperature.unit == "K");
    CHECK(temperature.half);
    CHECK(temperature.maximum > 1000);
    CHECK(temperature.notFinite == 0);
    CHECK(info.compression.find("blosc") == 0);
}

TEST_CASE("conversion resamples and keeps the amount") {
    const Folder folder;
    const std::string in = made(folder, "cumulus", "96"), out = folder.file("half.vdb");
    const auto result = runVdbHelper({"convert", in, out, "grid=density", "resample=2", "half"});
    REQUIRE(std::holds_alternative<std::string>(result));
    const auto total = [&](const std::string& path) {
        const VdbGrid g = readOne(path, {"density"});
        VoxelGrid::Sampler s = g.scalar->sampler();
        double sum = 0;
        const Vec3i a = g.scalar->lowerVoxel(), b = g.scalar->upperVoxel();
        for (int x = a.x; x <= b.x; ++x)
            for (int y = a.y; y <= b.y; ++y)
                for (int z = a.z; z <= b.z; ++z) sum += double(s.voxel({x, y, z}));
        return sum * std::abs(g.scalar->indexToWorld().determinant());
    };
    CHECK(total(out) == doctest::Approx(total(in)).epsilon(0.01));
}

TEST_CASE("awkward grids are put right or refused, with words" * doctest::test_suite("input")) {
    const Folder folder;
    const std::string path = folder.file("cases.vdb");
    REQUIRE(std::system((std::string(ABBE_VDB_CASES) + " " + path).c_str()) == 0);

    const VdbGrid spoilt = readOne(path, {"spoilt"});
    CHECK(spoilt.scalar->activeVoxels() == 61);
    CHECK(spoilt.scalar->minimum() == 1);
    CHECK(spoilt.scalar->maximum() == 1);
    CHECK(spoilt.scalar->sampler().at({50, 0, 0}) == 0);
    REQUIRE(spoilt.notes.size() == 3);
    CHECK(spoilt.notes[0].find("2 values are not finite") != std::string::npos);
    CHECK(spoilt.notes[1].find("1 values are negative") != std::string::npos);
    CHECK(spoilt.notes[2].find("1 inactive") != std::string::npos);

    const VdbGrid tiles = readOne(path, {"spoilt-tiles"});
    CHECK(tiles.scalar->activeVoxels() == 512);
    CHECK(tiles.scalar->minimum() == 2);
    CHECK(tiles.scalar->sampler().at({3, 3, 3}) == 0);
    CHECK(tiles.scalar->sampler().at({11, 3, 3}) == 2);
    CHECK(tiles.scalar->sampler().at({200, 50, 50}) == 0);
    REQUIRE(tiles.notes.size() == 2);
    CHECK(tiles.notes[0].find("2 values are not finite") != std::string::npos);
    CHECK(tiles.notes[1].find("1 values are negative") != std::string::npos);

    const VdbGrid background = readOne(path, {"background"});
    CHECK(background.scalar->sampler().at({30, 0, 0}) == 0);
    CHECK(background.scalar->sampler().at({2, 2, 2}) == 1);
    REQUIRE(background.notes.size() == 1);

    const VdbGrid far = readOne(path, {"far"});
    CHECK(far.scalar->activeVoxels() == 3);
    CHECK(far.scalar->bytes() + BrickBounds::build(*far.scalar).bytes() < 10'000'000);
    CHECK(faultOf(path, {"too-far"}).kind == VdbFault::Kind::extent);
    CHECK(faultOf(path, {"vast"}).kind == VdbFault::Kind::extent);

    CHECK(readOne(path, {"empty"}).scalar->empty());
    CHECK(readOne(path, {"double"}).scalar->sampler().at({1.5f, 1, 2}) == 0.25f);
    CHECK(readOne(path, {"integer"}).scalar->sampler().at({1, 1, 2}) == 3);
    CHECK(readOne(path, {"mask"}).scalar->sampler().at({1, 1, 2}) == 1);
    CHECK(readOne(path, {"wind", VdbUse::vector}).vector->sampler().at({1, 1, 2}) == Vec3(1, 2, 3));

    const VdbGrid gale = readOne(path, {"gale", VdbUse::vector});
    CHECK(gale.vector->sampler().at({3, 3, 3}) == Vec3(1, 2, 3));
    CHECK(gale.vector->sampler().at({20, 0, 0}) == Vec3(4, 5, 6));

    CHECK(faultOf(path, {"wind"}).kind == VdbFault::Kind::wrongKind);
    CHECK(faultOf(path, {"frustum"}).kind == VdbFault::Kind::transform);
    CHECK(faultOf(path, {"flat"}).kind == VdbFault::Kind::transform);

    const VdbGrid turned = readOne(path, {"turned"}); // index x is world y
    const Vec3d p = turned.scalar->indexToWorld().point({2, 0, 0});
    CHECK(p.x == doctest::Approx(10));
    CHECK(p.y == doctest::Approx(21));
    CHECK(p.z == doctest::Approx(30));

    const auto result = inspectVdb(path);
    REQUIRE(std::holds_alternative<VdbFileInfo>(result));
    for (const VdbGridInfo& g : std::get<VdbFileInfo>(result).grids) {
        if (g.name == "spoilt") CHECK(g.notFinite + g.negative + g.inactiveValues == 4);
        if (g.name == "spoilt-tiles") {
            CHECK(g.notFinite == 2);
            CHECK(g.negative == 1);
            CHECK(g.maximum == 2);
        }
        if (g.name == "frustum") CHECK_FALSE(g.affine);
        if (g.name == "flat") CHECK(g.singular);
    }
}

TEST_CASE("NanoVDB files: every packing and every width of numbers" * doctest::test_suite("input")) {
    const Folder folder;
    const std::string path = folder.file("cases.nvdb");
    REQUIRE(std::system((std::string(ABBE_VDB_CASES) + " " + path).c_str()) == 0);

    const VdbGrid density = readOne(path, {"density"});
    CHECK(density.scalar->activeVoxels() == 20 + 512 + 128 * 128 * 128 + 1);
    CHECK(density.scalar->maximum() == 4.875f);
    const Vec3d p = density.scalar->indexToWorld().point({2, 0, 0}); // index x is world y
    CHECK(p.x == doctest::Approx(10));
    CHECK(p.y == doctest::Approx(21));
    CHECK(p.z == doctest::Approx(30));
    struct Voxel {
        Vec3i at;
        float value;
    };
    for (const char* name : {"density", "zipped", "blosc", "half", "packed"}) {
        INFO(name);
        const VdbGrid grid = readOne(path, {name});
        auto s = grid.scalar->sampler();
        for (const Voxel v :
             {Voxel{{-3, 0, 0}, 0.125f}, Voxel{{16, 38, 1}, 4.875f}, Voxel{{66, 3, 5}, 2}, Voxel{{300, 100, 7}, 3},
              Voxel{{-5000, 9000, 12000}, 4}, Voxel{{-2, 0, 0}, 0}, Voxel{{90, 0, 0}, 0}})
            CHECK(s.voxel(v.at) == doctest::Approx(v.value).epsilon(1e-3));
    }
    CHECK(readOne(path, {"wind", VdbUse::vector}).vector->sampler().at({1, 1, 2}) == Vec3(1, 2, 3));
    CHECK(faultOf(path, {"wind"}).kind == VdbFault::Kind::wrongKind);
    CHECK(faultOf(path, {"wing"}).names.size() == 6);
    const auto info = inspectVdb(path);
    REQUIRE(std::holds_alternative<VdbFileInfo>(info));
    CHECK(std::get<VdbFileInfo>(info).grids.size() == 6);
    CHECK(std::get<VdbFileInfo>(info).library.starts_with("NanoVDB 32"));

    // Cut off anywhere: what is left of it is read, or refused; nothing hangs.
    std::ifstream whole(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(whole), {}};
    for (const std::size_t size : {std::size_t{12}, std::size_t{100}, std::size_t{400}, bytes.size() / 2}) {
        std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(size));
        CHECK(faultOf(path, {"packed"}).kind == VdbFault::Kind::damaged);
    }
}

TEST_CASE("files of other programs" * doctest::test_suite("input")) {
    if (shared("smoke.vdb").empty()) return;
    const VdbGrid smoke = readOne(shared("smoke.vdb"), {"density"});
    CHECK(smoke.scalar->activeVoxels() > 1000);
    CHECK(faultOf(shared("sphere.vdb"), {std::get<VdbFileInfo>(inspectVdb(shared("sphere.vdb"))).grids[0].name}).kind ==
          VdbFault::Kind::wrongKind);
    for (const char* name : {"grids.vdb", "points.vdb", "torus01.vdb", "sphere.vdb"}) {
        const auto info = inspectVdb(shared(name));
        REQUIRE(std::holds_alternative<VdbFileInfo>(info));
        for (const VdbGridInfo& g : std::get<VdbFileInfo>(info).grids) {
            const VdbRequest request{g.name, VdbUse::amountOrLevelSet};
            auto result = readVdb(shared(name), {&request, 1});
            if (const auto* fault = std::get_if<VdbFault>(&result)) {
                CHECK(fault->kind == VdbFault::Kind::wrongKind);
                continue;
            }
            const VoxelGrid& grid = *std::get<0>(result)[0].scalar;
            if (g.volumeClass == "level set") CHECK(grid.maximum() == doctest::Approx(1));
        }
    }
}
