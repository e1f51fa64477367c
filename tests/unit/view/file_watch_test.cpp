// Files that change in all the ways in which editors change them.
#include "unit/io/temporary_folder.h"
#include "view/file_watch.h"

#include <atomic>
#include <doctest/doctest.h>
#include <fstream>
#include <thread>

namespace abbe {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

fs::path placeOf(const TemporaryFolder& folder) { return fs::path(folder / "x").parent_path(); }

void put(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

// A watch and how often it told of a change: by events of the system alone, unless it looks for itself.
class Told {
  public:
    explicit Told(std::chrono::milliseconds look = 24h) : watch([this] { ++count; }, look) {}
    // Within some seconds, since the machine may be busy.
    bool more(int than) const {
        for (int i = 0; i < 500 && count <= than; ++i) std::this_thread::sleep_for(10ms);
        return count > than;
    }
    bool quiet(int at) const {
        std::this_thread::sleep_for(250ms);
        return count == at;
    }
    std::atomic<int> count = 0;
    FileWatch watch;
};

TEST_CASE("a file that is written, replaced, deleted and made again is told each time") {
    const TemporaryFolder folder;
    const fs::path file = placeOf(folder) / "a.scene";
    put(file, "one");
    std::this_thread::sleep_for(30ms);
    Told told;
    told.watch.follow({file}, FileWatch::Clock::now());
    CHECK(told.quiet(0));
    put(file, "two");
    CHECK(told.more(0));
    int before = told.count;
    const fs::path elsewhere = placeOf(folder) / "elsewhere"; // of which nobody tells: the new name alone is an event
    fs::create_directory(elsewhere);
    put(elsewhere / "a.new", "2 and a half");
    CHECK(told.quiet(before));
    fs::rename(elsewhere / "a.new", file);
    CHECK(told.more(before));
    CHECK(told.quiet(before + 1));
    before = told.count;
    put(placeOf(folder) / "a.new", "three"); // as vim and others do
    fs::rename(placeOf(folder) / "a.new", file);
    CHECK(told.more(before));
    CHECK(told.quiet(before + 1)); // once, since it stays a file of that name
    before = told.count;
    fs::remove(file);
    CHECK(told.more(before));
    before = told.count;
    put(file, "four");
    CHECK(told.more(before));
    before = told.count;
    put(placeOf(folder) / "other.txt", "no part of it");
    CHECK(told.quiet(before));
}

TEST_CASE("many saves at once are told of a few times") {
    const TemporaryFolder folder;
    const fs::path file = placeOf(folder) / "a.scene";
    put(file, "0");
    std::this_thread::sleep_for(30ms);
    Told told;
    told.watch.follow({file}, FileWatch::Clock::now());
    for (int i = 1; i <= 20; ++i) put(file, std::string(static_cast<std::size_t>(i), 'x'));
    CHECK(told.more(0));
    std::this_thread::sleep_for(300ms);
    CHECK(told.count <= 3);
}

TEST_CASE("what changed while it was read is told, what changed before is not") {
    const TemporaryFolder folder;
    const fs::path file = placeOf(folder) / "a.scene";
    put(file, "one");
    std::this_thread::sleep_for(50ms);
    const auto begun = FileWatch::Clock::now();
    Told told;
    told.watch.follow({file}, begun);
    CHECK(told.quiet(0));
    std::this_thread::sleep_for(30ms);
    put(file, "two"); // after reading began, before it is followed again
    Told late;
    late.watch.follow({file}, begun);
    CHECK(late.more(0));
}

TEST_CASE("files of other folders, behind links, and of folders that come later") {
    const TemporaryFolder folder;
    const fs::path real = placeOf(folder) / "real", link = placeOf(folder) / "link.ply",
                   later = placeOf(folder) / "maps/wood.png";
    fs::create_directory(real);
    put(real / "mesh.ply", "1");
    fs::create_symlink(real / "mesh.ply", link);
    std::this_thread::sleep_for(30ms);
    Told told(1s); // a folder that comes later is found by a look
    told.watch.follow({link, later}, FileWatch::Clock::now());
    CHECK(told.quiet(0));
    put(real / "mesh.ply", "22");
    CHECK(told.more(0));
    int before = told.count;
    fs::create_directory(placeOf(folder) / "maps");
    put(later, "png");
    CHECK(told.more(before));
    before = told.count;
    told.watch.follow({link}, FileWatch::Clock::now(), {placeOf(folder)}); // something is missing: anything new counts
    std::this_thread::sleep_for(50ms);
    before = told.count;
    put(placeOf(folder) / "new.spd", "400 1");
    CHECK(told.more(before));
}

} // namespace
} // namespace abbe
