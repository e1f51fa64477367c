// Files that are read: what is no regular file is refused at once, and no more is read than there was.
#include "base/memory_limit.h"
#include "base/regular_file.h"
#include "support/memory_scope.h"
#include "unit/io/temporary_folder.h"

#include <chrono>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <sys/stat.h>
#include <vector>

using namespace abbe;

namespace {

std::string text(RegularFile& file, std::uint64_t at, std::size_t count) {
    std::string bytes(count, '?');
    bytes.resize(file.readAt(at, bytes));
    return bytes;
}

} // namespace

TEST_CASE("regular files: pipes and devices are refused without waiting") {
    const TemporaryFolder folder;
    const std::string fifo = folder / "fifo";
    REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
    const auto begin = std::chrono::steady_clock::now();
    CHECK(RegularFile(fifo).why() == "it is not a regular file");
    CHECK(RegularFile("/dev/zero").why() == "it is not a regular file");
    CHECK(RegularFile("/dev/tty").good() == false);
    CHECK(RegularFile(folder / ".").why() == "Is a directory");
    CHECK(RegularFile(folder / "missing").why() == "No such file or directory");
    CHECK(whyNotRegular(fifo) == "it is not a regular file");
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(1)); // a writer never comes
}

TEST_CASE("regular files: links count as what they lead to, and files may shrink and grow") {
    const TemporaryFolder folder;
    const std::string path = folder / "a";
    std::ofstream(path) << "0123456789";
    std::filesystem::create_symlink(path, folder / "link");
    std::filesystem::create_symlink("/dev/zero", folder / "zero");
    CHECK_FALSE(RegularFile(folder / "zero").good());
    RegularFile file(folder / "link");
    REQUIRE(file.good());
    CHECK(file.size() == 10);
    CHECK(text(file, 0, 4) == "0123");
    CHECK(text(file, 8, 4) == "89");
    CHECK(text(file, 10, 4).empty());
    CHECK(text(file, ~std::uint64_t{0}, 4).empty());
    std::ofstream(path, std::ios::app) << "and more";
    CHECK(text(file, 8, 4) == "89"); // as it was when opened
    std::filesystem::resize_file(path, 3);
    CHECK(text(file, 0, 10) == "012");
    CHECK(file.good());
}

TEST_CASE("memory: what is beyond the limit is refused before it is taken") {
    CHECK(memoryLimit() == availableMemory());
    CHECK(availableMemory() <= physicalMemory());
    const test::MemoryScope scope(100 << 20);
    CHECK(memoryLeft() > 0);
    CHECK(memoryLeft() <= 100 << 20);
    CHECK_NOTHROW(requireMemory(20 << 20));
    CHECK_THROWS_AS(requireMemory(101 << 20), BeyondMemory);
    try {
        requireMemory(3e12);
        FAIL("no fault");
    } catch (const std::bad_alloc& e) {
        CHECK(memoryReason(e).starts_with("it takes 2793.97 GiB of memory; "));
        CHECK(memoryReason(e).find(" left of ") != std::string::npos);
    }
    CHECK(memoryReason(std::bad_alloc()) == "it needs more memory than there is");
    setMemoryLimit(1); // less than what is there already
    CHECK(memoryLeft() == 0);
    CHECK_THROWS_AS(requireMemory(2 << 20), BeyondMemory);
}
