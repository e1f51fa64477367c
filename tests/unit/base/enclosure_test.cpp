#include "base/enclosure.h"

#include <cstdlib>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <vector>

using namespace abbe;
namespace fs = std::filesystem;

TEST_CASE("a path is below a folder by its names alone") {
    CHECK(isBelow("/a/b/c", "/a/b"));
    CHECK(isBelow("/a/b/../b/./c", "/a/b/"));
    CHECK(isBelow("/a", "/"));
    CHECK_FALSE(isBelow("/a/b", "/a/b"));
    CHECK_FALSE(isBelow("/a/bc", "/a/b"));
    CHECK_FALSE(isBelow("/a/b/../c", "/a/b"));
    CHECK_FALSE(isBelow("/a/b/c/../../..", "/a/b"));
}

TEST_CASE("what is in an enclosed folder names nothing outside of it") {
    encloseFolder("/pack-of-a-test/");
    CHECK_FALSE(mayName("/pack-of-a-test", "/etc/hostname"));
    CHECK_FALSE(mayName("/pack-of-a-test/models/a.gltf", "/pack-of-a-test/models/../../a.bin"));
    CHECK_FALSE(mayName("/pack-of-a-test/a.scene", "/pack-of-a-test2/a.bin"));
    CHECK(mayName("/pack-of-a-test", "/pack-of-a-test/a.bin"));
    CHECK(mayName("/pack-of-a-test/models/a.gltf", "/pack-of-a-test/models/../a.bin"));
    const FileReach all("/pack-of-a-test", {"/"});
    CHECK_FALSE(mayName("/pack-of-a-test", "/etc/hostname"));
    CHECK(searchFolders("/pack-of-a-test").empty());
}

namespace {

// Folders below a temporary one, and what may be named among them.
struct Tree {
    fs::path top = fs::temp_directory_path() / ("abbe_reach_" + std::to_string(::getpid()));
    Tree() {
        ::unsetenv("ABBE_PATH");
        for (const char* folder : {"shot/meshes", "shot/sets", "library/deep", "elsewhere"})
            fs::create_directories(top / folder);
        fs::create_symlink(top / "elsewhere", top / "shot/link");
    }
    ~Tree() {
        ::unsetenv("ABBE_PATH");
        fs::remove_all(top);
    }
    bool may(const char* from, const char* named) const { return mayName(top / from, top / named); }
    std::string operator()(const char* path) const { return (top / path).string(); }
};

} // namespace

TEST_CASE("files name what is below their own folder, wherever links lead") {
    const Tree t;
    CHECK(t.may("shot", "shot/meshes/a.ply"));
    CHECK(t.may("shot/x.scene", "shot/meshes/../a.ply"));
    CHECK_FALSE(t.may("shot", "elsewhere/a.ply"));
    CHECK_FALSE(t.may("shot", "shot/../elsewhere/a.ply"));
    CHECK_FALSE(t.may("shot", "shot/link/a.ply"));
    CHECK_FALSE(t.may("shot", "shot2/a.ply"));
    CHECK_FALSE(t.may("shot/sets", "shot/meshes/a.ply"));
    CHECK_FALSE(mayName(t("shot"), "/etc/hostname"));
}

TEST_CASE("files of a scene name what is in its project, and those of another scene do not") {
    const Tree t;
    {
        const FileReach shot(t("shot"), {});
        CHECK(t.may("shot/sets", "shot/meshes/a.ply"));
        CHECK_FALSE(t.may("shot/sets", "library/a.ply"));
        const FileReach sent(t("shot/sets"), {}); // somebody else's, in a folder of the first
        CHECK_FALSE(t.may("shot/sets", "shot/meshes/a.ply"));
    }
    CHECK_FALSE(t.may("shot/sets", "shot/meshes/a.ply"));
    std::ofstream(t.top / ".abbe-project");
    CHECK(projectOf(t("shot/sets")) == fs::canonical(t.top));
    CHECK(t.may("shot/sets", "library/a.ply"));
    CHECK(t.may("shot", "shot/link/a.ply"));
    CHECK_FALSE(mayName(t("shot"), "/etc/hostname"));
    std::ofstream(t.top / "shot/.abbe-project");
    CHECK(projectOf(t("shot/sets")) == fs::canonical(t.top / "shot"));
    CHECK(t.may("shot/sets", "shot/meshes/a.ply"));
    CHECK_FALSE(t.may("shot/sets", "library/a.ply"));
}

TEST_CASE("files name what is in folders that were stated") {
    const Tree t;
    {
        const FileReach shot(t("shot"), {t("library") + "/", "/no-such-folder"});
        CHECK(t.may("shot", "library/deep/a.ply"));
        CHECK(t.may("shot", "shot/../library/a.ply"));
        CHECK_FALSE(t.may("shot", "library2/a.ply"));
        CHECK_FALSE(t.may("shot", "elsewhere/a.ply"));
        CHECK(t.may("library/deep", "library/a.ply"));
        CHECK_FALSE(t.may("elsewhere", "library/a.ply"));
        CHECK(searchFolders(t("shot/sets")) ==
              std::vector<fs::path>{fs::canonical(t.top / "library"), "/no-such-folder"});
        CHECK(searchFolders(t("elsewhere")).empty());
        const FileReach more(t("shot"), {"/"}); // the same scene, read by another command of this process
        CHECK(t.may("shot", "elsewhere/a.ply"));
        CHECK(mayName("/etc", "/etc/hostname"));
    }
    CHECK_FALSE(t.may("shot", "library/a.ply"));
    ::setenv("ABBE_PATH", (":/no-such-folder:" + t("library") + "/").c_str(), 1);
    CHECK(t.may("shot", "library/a.ply"));
    CHECK(t.may("elsewhere", "library/a.ply"));
    CHECK_FALSE(t.may("library", "shot/a.ply"));
    CHECK(searchFolders(t("shot")) == std::vector<fs::path>{"/no-such-folder", fs::canonical(t.top / "library")});
    ::setenv("ABBE_PATH", "/", 1);
    CHECK(mayName(t("shot"), "/etc/hostname"));
    ::setenv("ABBE_PATH", "", 1);
    CHECK_FALSE(t.may("shot", "elsewhere/a.ply"));
}
