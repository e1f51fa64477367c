#include "base/enclosure.h"

#include <doctest/doctest.h>

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
