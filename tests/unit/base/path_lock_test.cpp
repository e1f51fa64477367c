#include "base/path_lock.h"
#include "base/stopwatch.h"
#include "unit/io/temporary_folder.h"

#include <atomic>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

using namespace abbe;

TEST_CASE("a lock of a path is held once, waited for as long as told, and leaves nothing behind") {
    const TemporaryFolder folder;
    const std::string path = folder / "room.exr", name = path + ".abbe-lock";
    {
        const PathLock held(path, 0);
        CHECK_FALSE(held.refused());
        CHECK(std::filesystem::exists(name));
        const Stopwatch watch;
        CHECK(PathLock(path, 0.05).refused());
        CHECK(watch.seconds() >= 0.05);
        CHECK(std::filesystem::exists(name)); // the other one's
    }
    CHECK_FALSE(std::filesystem::exists(name));
    std::ofstream(name).close(); // of a killed process
    CHECK_FALSE(PathLock(path, 0).refused());
    CHECK_FALSE(std::filesystem::exists(name));
}

TEST_CASE("one at a time holds the lock, though each removes its file") {
    const TemporaryFolder folder;
    const std::string path = folder / "room.exr";
    std::atomic<int> inside{0}, most{0}, turns{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i)
        threads.emplace_back([&] {
            for (int turn = 0; turn < 50; ++turn) {
                const PathLock lock(path, 60);
                most = std::max(most.load(), ++inside);
                std::this_thread::yield();
                turns += lock.refused() ? 0 : 1;
                --inside;
            }
        });
    for (std::thread& thread : threads) thread.join();
    CHECK(most == 1);
    CHECK(turns == 200);
}

TEST_CASE("what else has the name of a lock stays, and holds nobody up") {
    const TemporaryFolder folder;
    const std::string path = folder / "room.exr", name = path + ".abbe-lock", other = folder / "other";
    std::ofstream(name) << "somebody's";
    CHECK_FALSE(PathLock(path, 0).refused());
    CHECK(std::filesystem::file_size(name) == 10);
    std::filesystem::remove(name);
    std::filesystem::create_symlink(other, name);
    CHECK_FALSE(PathLock(path, 0).refused());
    CHECK(std::filesystem::is_symlink(name));
    CHECK_FALSE(std::filesystem::exists(other));
    CHECK_FALSE(PathLock(folder / "missing/room.exr", 0).refused());
    CHECK_FALSE(PathLock(folder / std::string(250, 'x'), 0).refused());
    CHECK_FALSE(std::filesystem::exists(folder / std::string(245, 'x') + ".abbe-lock"));
}
