// Files that are read: what is no regular file is refused at once, and no more is read than there was.
#include "base/file.h"
#include "base/memory_limit.h"
#include "support/memory_scope.h"
#include "unit/io/temporary_folder.h"

#include <cerrno>
#include <chrono>
#include <doctest/doctest.h>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <set>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
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
    CHECK_THROWS_AS(requireMemory(101 << 20), MemoryLimitExceeded);
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
    CHECK_THROWS_AS(requireMemory(2 << 20), MemoryLimitExceeded);
}

using namespace abbe;

namespace {

mode_t modeOf(const std::string& path) {
    struct stat status {};
    REQUIRE(::stat(path.c_str(), &status) == 0);
    return status.st_mode & 07777;
}

void put(const TemporaryFile& file, const std::string& text) {
    REQUIRE(::write(file.descriptor(), text.data(), text.size()) == static_cast<ssize_t>(text.size()));
}

// A process of its own that makes a temporary file for `target` and is then killed, or lives until end().
class Writer {
  public:
    explicit Writer(const std::string& target) {
        int ends[2];
        REQUIRE(::pipe(ends) == 0);
        process_ = ::fork();
        if (process_ == 0) {
            const TemporaryFile file(target);
            static_cast<void>(::write(ends[1], "x", 1));
            for (;;) ::pause();
        }
        char byte = 0;
        REQUIRE(::read(ends[0], &byte, 1) == 1); // it is there
        ::close(ends[0]);
        ::close(ends[1]);
    }
    ~Writer() { end(); }
    void end() {
        if (process_ <= 0) return;
        ::kill(process_, SIGKILL);
        ::waitpid(process_, nullptr, 0);
        process_ = 0;
    }

  private:
    pid_t process_ = 0;
};

std::set<std::string> namesIn(const std::string& folder) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename());
    return names;
}

} // namespace

TEST_CASE("temporary files are private and have names of their own until they are renamed") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    const mode_t mask = ::umask(022);
    ::umask(mask);
    {
        TemporaryFile first(path), second(path);
        REQUIRE((first.error() == 0 && second.error() == 0));
        CHECK(first.path() != second.path());
        CHECK(modeOf(first.path()) == 0600);
        put(first, "first");
        put(second, "second");
        CHECK(second.commit() == 0);
        CHECK(readAll(path) == "second");
        CHECK(modeOf(path) == (0666 & ~mask));
        CHECK(first.commit() == 0);
    }
    CHECK(readAll(path) == "first");
    CHECK(folder.fileCount() == 1);
}

TEST_CASE("a file that is replaced passes on its mode") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    writeAll(path, "old");
    REQUIRE(::chmod(path.c_str(), 0604) == 0);
    {
        const TemporaryFile dropped(path);
        put(dropped, "new");
    }
    CHECK(readAll(path) == "old");
    TemporaryFile file(path);
    CHECK(file.commit() == 0);
    CHECK(modeOf(path) == 0604);
}

TEST_CASE("what a killed process leaves behind goes with the next one, and what a living one writes stays") {
    const TemporaryFolder folder;
    const std::string killed = folder / "killed.exr", alive = folder / "alive.exr";
    {
        Writer writer(killed);
        writer.end();
        Writer other(alive);
        REQUIRE(folder.fileCount() == 2);
        { const TemporaryFile next(killed); }
        CHECK(folder.fileCount() == 1); // only that of the same file
        { const TemporaryFile next(alive); }
        CHECK(folder.fileCount() == 1);
    }
}

TEST_CASE("other files are left alone") {
    const TemporaryFolder folder;
    // Links, folders, what is called otherwise, and what another machine may be writing.
    writeAll(folder / "precious", "precious");
    std::filesystem::create_symlink(folder / "precious", folder / "a.exr.abbe-000000-AAAAAA.tmp");
    std::filesystem::create_directory(folder / "a.exr.abbe-000000-BBBBBB.tmp");
    writeAll(folder / "a.exr.abbe-000000-CCCCCC.tmp", "of another machine");
    writeAll(folder / "a.exr.abbe-000000-DDDDDD.tmp", "of another machine, long ago");
    writeAll(folder / "a.exr.tmp", "");
    writeAll(folder / "a.exr.abbe-000000-CCCCCCC.tmp", "");
    writeAll(folder / "b.exr.abbe-000000-CCCCCC.tmp", "");
    const auto old = std::filesystem::file_time_type::clock::now() - std::chrono::hours(49);
    std::filesystem::last_write_time(folder / "a.exr.abbe-000000-DDDDDD.tmp", old);
    auto names = namesIn(folder / ".");
    { const TemporaryFile next(folder / "a.exr"); }
    names.erase("a.exr.abbe-000000-DDDDDD.tmp");
    CHECK(namesIn(folder / ".") == names);
    CHECK(readAll(folder / "precious") == "precious");
}

TEST_CASE("the longest name that can be has a temporary one") {
    const TemporaryFolder folder;
    const std::string path = folder / std::string(255, 'n');
    TemporaryFile file(path);
    REQUIRE(file.error() == 0);
    CHECK(file.commit() == 0);
    CHECK(std::filesystem::exists(path));
    CHECK(TemporaryFile(folder / "absent/a").error() == ENOENT);
}
