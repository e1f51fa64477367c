#include "base/enclosure.h"

#include <cstdlib>
#include <doctest/doctest.h>
#include <filesystem>
#include <string>
#include <unistd.h>

using namespace abbe;

TEST_CASE("a path is below a folder by its names alone") {
    CHECK(isBelow("/a/b/c", "/a/b"));
    CHECK(isBelow("/a/b/../b/./c", "/a/b/"));
    CHECK(isBelow("/a", "/"));
    CHECK_FALSE(isBelow("/a/b", "/a/b"));
    CHECK_FALSE(isBelow("/a/bc", "/a/b"));
    CHECK_FALSE(isBelow("/a/b/../c", "/a/b"));
    CHECK_FALSE(isBelow("/a/b/c/../../..", "/a/b"));
}

TEST_CASE("what is in an enclosed folder names nothing outside of it; all others name anything") {
    CHECK(mayName("/pack-of-a-test", "/etc/hostname"));
    encloseFolder("/pack-of-a-test/");
    CHECK_FALSE(mayName("/pack-of-a-test", "/etc/hostname"));
    CHECK_FALSE(mayName("/pack-of-a-test/models/a.gltf", "/pack-of-a-test/models/../../a.bin"));
    CHECK_FALSE(mayName("/pack-of-a-test/a.scene", "/pack-of-a-test2/a.bin"));
    CHECK(mayName("/pack-of-a-test", "/pack-of-a-test/a.bin"));
    CHECK(mayName("/pack-of-a-test/models/a.gltf", "/pack-of-a-test/models/../a.bin"));
    CHECK(mayName("/elsewhere/a.scene", "/pack-of-a-test/a.bin"));
    CHECK(mayName("/pack-of-a-test-elsewhere/a.scene", "/etc/hostname"));
}

TEST_CASE("with ABBE_ROOT files name what is below their own folder or one of the roots, wherever links lead") {
    namespace fs = std::filesystem;
    const fs::path top = fs::temp_directory_path() / ("abbe_roots_" + std::to_string(::getpid()));
    for (const char* folder : {"shot/meshes", "library", "elsewhere"}) fs::create_directories(top / folder);
    fs::create_symlink(top / "elsewhere", top / "shot/link");
    const auto may = [&](const char* from, const char* named) { return mayName(top / from, top / named); };
    CHECK(may("shot", "elsewhere/a.ply"));
    ::setenv("ABBE_ROOT", (":/no-such-folder:" + (top / "library").string() + "/").c_str(), 1);
    CHECK(may("shot", "shot/meshes/a.ply"));
    CHECK(may("shot/x.scene", "shot/meshes/../a.ply"));
    CHECK(may("shot", "library/a.ply"));
    CHECK(may("shot", "shot/../library/deep/a.ply"));
    CHECK_FALSE(may("shot", "elsewhere/a.ply"));
    CHECK_FALSE(may("shot", "shot/../elsewhere/a.ply"));
    CHECK_FALSE(may("shot", "shot/link/a.ply"));
    CHECK_FALSE(may("shot", "library2/a.ply"));
    CHECK_FALSE(may("library", "shot/a.ply"));
    CHECK_FALSE(mayName(top / "shot", "/etc/hostname"));
    ::setenv("ABBE_ROOT", "", 1);
    CHECK(may("shot", "elsewhere/a.ply"));
    ::unsetenv("ABBE_ROOT");
    fs::remove_all(top);
}
