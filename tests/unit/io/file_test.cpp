#include "io/file.h"
#include "temporary_folder.h"

#include <csignal>
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

using namespace abbe;

namespace {

// No file may grow beyond `bytes` while this lives: the disk is "full".
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) {
        ::getrlimit(RLIMIT_FSIZE, &old_);
        handler_ = std::signal(SIGXFSZ, SIG_IGN); // write then fails with EFBIG
        const rlimit limit{bytes, old_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &old_);
        std::signal(SIGXFSZ, handler_);
    }

  private:
    rlimit old_{};
    void (*handler_)(int) = nullptr;
};

std::string messageOf(const auto& action) {
    try {
        action();
    } catch (const IoError& e) {
        return e.what();
    }
    return "";
}

} // namespace

TEST_CASE("a file appears with commit, whole") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.bin";
    {
        AtomicFile file(path);
        file.write(std::string("hello world"));
        file.seek(0);
        file.write(std::string("J"));
        CHECK(!std::filesystem::exists(path));
        CHECK(std::filesystem::exists(file.temporaryPath()));
        file.commit();
    }
    CHECK(readAll(path) == "Jello world");
    CHECK(folder.fileCount() == 1);
}

TEST_CASE("without commit the old file stays and nothing is left behind") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.bin";
    writeAll(path, "old");
    { AtomicFile(path).write(std::string("new")); }
    CHECK(readAll(path) == "old");
    CHECK(folder.fileCount() == 1);
}

TEST_CASE("a full disk leaves the old file") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.bin";
    writeAll(path, "old");
    const std::string message = messageOf([&] {
        const FileSizeLimit limit(1000);
        AtomicFile file(path);
        file.write(std::string(5000, 'x'));
        file.commit();
    });
    CHECK(message.find("cannot write") != std::string::npos);
    CHECK(message.find("File too large") != std::string::npos);
    CHECK(readAll(path) == "old");
    CHECK(folder.fileCount() == 1);
}

TEST_CASE("impossible places are refused with their reason") {
    const TemporaryFolder folder;
    CHECK(messageOf([&] { AtomicFile file(folder / "absent/a.exr"); }).find("No such file") != std::string::npos);
    std::filesystem::create_directory(folder / "sub");
    CHECK(messageOf([&] { AtomicFile file(folder / "sub"); }).find("Is a directory") != std::string::npos);
    CHECK(messageOf([&] { AtomicFile file("/dev/null"); }).find("not a regular file") != std::string::npos);
    CHECK(std::filesystem::is_character_file("/dev/null"));
}

TEST_CASE("a link keeps pointing to the file it names") {
    const TemporaryFolder folder;
    writeAll(folder / "target", "old");
    std::filesystem::create_symlink(folder / "target", folder / "link");
    AtomicFile file(folder / "link");
    file.write(std::string("new"));
    file.commit();
    CHECK(std::filesystem::is_symlink(folder / "link"));
    CHECK(readAll(folder / "target") == "new");
}

TEST_CASE("of two that write one file the last to commit wins, whole") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.bin", first(200'000, '1'), second(300'000, '2');
    AtomicFile a(path), b(path);
    for (std::size_t i = 0; i < 100'000; i += 1000) {
        a.write(std::span(first).subspan(2 * i, 2000));
        b.write(std::span(second).subspan(3 * i, 3000));
    }
    b.commit();
    CHECK(readAll(path) == second);
    a.commit();
    CHECK(readAll(path) == first);
    CHECK(folder.fileCount() == 1);
}

TEST_CASE("small pieces, large ones and places that are written again come out as they should") {
    const TemporaryFolder folder;
    std::string wanted(500'000, '\0');
    AtomicFile file(folder / "a.bin");
    std::uint64_t state = 1;
    const auto random = [&](std::uint64_t below) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return (state >> 33) % below;
    };
    for (int i = 0; i < 400; ++i) {
        if (i % 7 == 0) file.seek(random(300'000));
        const std::string piece(i % 50 == 0 ? 90'000 : random(3000), static_cast<char>('a' + i % 26));
        if (file.position() + piece.size() > wanted.size()) file.seek(0);
        wanted.replace(file.position(), piece.size(), piece);
        file.write(piece);
        if (i % 100 == 0)
            CHECK(readAll(file.temporaryPath()) == wanted.substr(0, readAll(file.temporaryPath()).size()));
    }
    file.commit();
    const std::string got = readAll(folder / "a.bin");
    CHECK(got == wanted.substr(0, got.size()));
    CHECK(wanted.find_first_not_of('\0', got.size()) == std::string::npos);
}

// Needs a folder and a link of different users.
TEST_CASE("a link that another user put into a folder for everybody is not followed") {
    if (::geteuid() != 0) return;
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "all");
    REQUIRE(::chmod((folder / "all").c_str(), 01777) == 0);
    REQUIRE(::chown((folder / "all").c_str(), 1, 1) == 0);
    writeAll(folder / "precious", "precious");
    std::filesystem::create_symlink(folder / "precious", folder / "all/mine");
    std::filesystem::create_symlink(folder / "precious", folder / "all/planted");
    REQUIRE(::lchown((folder / "all/planted").c_str(), 2, 2) == 0);
    CHECK(messageOf([&] { AtomicFile file(folder / "all/planted"); }).find("a link of another user") !=
          std::string::npos);
    CHECK(messageOf([&] { writeAtomically(folder / "all/mine", std::string("new")); }).empty());
    CHECK(readAll(folder / "precious") == "new");
}
