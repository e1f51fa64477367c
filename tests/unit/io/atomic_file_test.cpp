#include "io/atomic_file.h"
#include "io/io_error.h"
#include "temporary_folder.h"

#include <csignal>
#include <doctest/doctest.h>
#include <sys/resource.h>

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
