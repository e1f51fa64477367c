// Checkpoints as files: what is written is read, parts add up, and no damage is taken for a render.
#include "checkpoints/checkpoint_reader.h"
#include "checkpoints/render_checkpoint.h"
#include "checkpoints/render_identity.h"
#include "checkpoints/render_parts.h"
#include "film/pixel_film.h"
#include "io/file.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>
#include <unistd.h>

namespace abbe::test {
namespace {

namespace fs = std::filesystem;

struct Folder {
    fs::path path = fs::temp_directory_path() / ("abbe_checkpoint_" + std::to_string(getpid()));
    Folder() { fs::create_directories(path); }
    ~Folder() { fs::remove_all(path); }
    std::string operator/(const char* name) const { return (path / name).string(); }
};

PixelFilm makeFilm(PixelBounds b) { return {b, PixelFilter(FilterShape::box, 0.5), 2}; }

CheckpointHeader headerOf(const PixelFilm& film, const FilmPlanes& planes, std::uint32_t first, std::uint32_t last) {
    CheckpointHeader h;
    h.identity = {{"seed", "7"}, {"material glass ior", "1.5"}};
    h.words = {"render", "x.scene"};
    h.folder = "/there";
    h.bounds = film.bounds();
    h.replicates = film.replicates();
    h.first = first;
    h.last = last;
    h.whole = 8;
    h.seconds = 2.5;
    h.work.seconds = 2.25;
    h.work.charges[WorkReading::index(11, 2, 16)] = {1.25, 1e-6, 77};
    for (const auto& plane : planes) h.planes.push_back(plane->name());
    return h;
}

// Something for each pixel, replicate and sample.
Xyz valueOf(int x, int y, int r, std::uint32_t sample) {
    return {0.1 * x + r, 1e-9 * sample - y, 1e6 / (1.0 + sample + x)};
}

void fill(PixelFilm& film, RenderState& state, std::uint32_t last) {
    const PixelBounds b = film.bounds();
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x)
            for (int r = 0; r < 2; ++r)
                for (std::uint32_t s = state.first(); s < last; ++s) film.add(x, y, r, valueOf(x, y, r, s), 1);
    for (std::size_t i = 0; i < state.tileCount(); ++i) {
        TileState& tile = state.tile(i);
        tile.reached = last;
        tile.tally.paths = 100 + i;
        tile.tally.dropped = {1, 2, 3};
        tile.tally.excess = {10, 2, 1.5f};
        tile.tally.effects = {1, 2, 3, 4, 5, 6, 7 + i};
        tile.tally.effects.volumes[2] = {8, 9, 10, 11};
        tile.examples = {{b.x0, b.y0, 1, 5, DropCause::negative}};
    }
}

bool sameFilm(const PixelFilm& a, const PixelFilm& b) {
    for (int y = b.bounds().y0; y < b.bounds().y1; ++y)
        for (int x = b.bounds().x0; x < b.bounds().x1; ++x) {
            const Xyz s = a.mean(x, y), t = b.mean(x, y);
            if (s.x != t.x || s.y != t.y || s.z != t.z || a.samples(x, y) != b.samples(x, y)) return false;
            if (a.variance(x, y) != b.variance(x, y)) return false;
        }
    return true;
}

// Writes what samples [first, last) of a film come to.
void writePart(const std::string& path, PixelBounds bounds, std::uint32_t first, std::uint32_t last,
               std::uint32_t reached) {
    PixelFilm film = makeFilm(bounds);
    RenderState state(bounds, first);
    fill(film, state, reached);
    const FilmPlanes planes = film.planes();
    writeCheckpoint(path, headerOf(film, planes, first, last), planes, state);
}

std::string codeOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const CheckpointFault& fault) {
        return fault.code;
    } catch (const IoError&) {
        return "IoError";
    }
    return "";
}

} // namespace

TEST_CASE("a checkpoint holds film, tiles and header") {
    const Folder folder;
    const std::string path = folder / "a.ckpt";
    const PixelBounds bounds{5, 3, 42, 24}; // 3 × 2 tiles, some of them cut
    PixelFilm film = makeFilm(bounds);
    RenderState state(bounds, 2);
    fill(film, state, 7);
    state.tile(4).reached = 7;
    state.tile(3).cut = CutPortion{9, {100, 1}};
    FilmPlanes planes = film.planes();
    const CheckpointHeader header = headerOf(film, planes, 2, 8);
    writeCheckpoint(path, header, planes, state);

    CheckpointReader reader(path);
    CHECK(reader.header().identity == header.identity);
    CHECK(reader.header().words == header.words);
    CHECK(reader.header().folder == "/there");
    CHECK(reader.header().planes == std::vector<std::string>{"xyz/2x384", "samples/2x32"});
    CHECK(reader.header().first == 2);
    CHECK(reader.header().last == 8);
    CHECK(reader.header().whole == 8);
    PixelFilm again = makeFilm(bounds);
    const RenderState read = reader.addTo(again.planes());
    CHECK(sameFilm(film, again));
    CHECK(read.seconds == 2.5);
    CHECK(read.reached() == 7);
    REQUIRE(read.tile(3).cut);
    CHECK(read.tile(3).cut->end == 9);
    CHECK(read.tile(3).cut->at.unit == 100);
    CHECK(read.tile(3).cut->at.done == 1);
    CHECK_FALSE(read.tile(4).cut);
    CHECK_FALSE(read.even());
    CHECK(read.tally().paths == state.tally().paths);
    CHECK(read.tally().dropped == std::array<std::uint64_t, 3>{6, 12, 18});
    CHECK(read.tally().excess.above == 12);
    CHECK(read.tally().effects == state.tally().effects);
    CHECK(read.tally().effects.volumes[2].first == 66);
    CHECK(read.work.seconds == 2.25);
    CHECK(read.work.charges[WorkReading::index(11, 2, 16)].looks == 77);
    CHECK(read.work.charges[WorkReading::index(11, 2, 16)].seconds == 1.25);
    CHECK(read.examples().size() == 4);
    CHECK(read.examples()[0].cause == DropCause::negative);
}

TEST_CASE("no damage to a checkpoint goes unnoticed: every byte changed, every length cut") {
    const Folder folder;
    const std::string whole = folder / "whole.ckpt", bad = folder / "bad.ckpt";
    const PixelBounds bounds{0, 0, 18, 1}; // two tiles
    writePart(whole, bounds, 0, 8, 8);
    std::ifstream in(whole, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const auto readBad = [&](const std::string& content) {
        std::filesystem::remove(bad); // some file systems wait for the disk when a file is cut and written anew
        std::ofstream(bad, std::ios::binary) << content;
        return codeOf([&] {
            PixelFilm film = makeFilm(bounds);
            CheckpointReader(bad).addTo(film.planes());
        });
    };
    REQUIRE(readBad(bytes).empty());
    std::size_t unnoticed = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string changed = bytes;
        changed[i] = static_cast<char>(changed[i] ^ (1 << (i % 8)));
        const std::string code = readBad(changed);
        unnoticed += code != "E0661" && code != "E0662";
    }
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        const std::string code = readBad(bytes.substr(0, size));
        unnoticed += code != "E0661" && code != "E0662";
    }
    unnoticed += readBad(bytes + "x") != "E0662";
    CHECK(unnoticed == 0);
    CHECK(codeOf([&] { CheckpointReader(folder / "absent"); }) == "IoError");
}

TEST_CASE("parts by samples and by crops add up to the whole; what overlaps or lacks is named") {
    const Folder folder;
    const PixelBounds all{0, 0, 40, 20}, left{0, 0, 7, 20}, right{7, 0, 40, 20};
    writePart(folder / "left", left, 0, 8, 8);
    writePart(folder / "right1", right, 0, 3, 3);
    writePart(folder / "right2", right, 3, 8, 8);
    writePart(folder / "short", right, 3, 8, 6);
    writePart(folder / "whole", all, 0, 8, 8);
    const std::vector<Fact> identity{{"seed", "7"}, {"material glass ior", "1.5"}};
    PixelFilm whole = makeFilm(all), merged = makeFilm(all);
    RenderState state(all, 0);
    fill(whole, state, 8);
    const auto merge = [&](std::vector<std::string> names, const std::vector<Fact>& with) {
        for (std::string& name : names) name = folder / name.c_str();
        return codeOf([&] {
            RenderParts parts(names);
            parts.check(with);
            merged = makeFilm(parts.bounds());
            const RenderStatistics statistics = parts.addTo(merged);
            CHECK(statistics.samplesPerPixel == 16);
        });
    };
    CHECK(merge({"right2", "left", "right1"}, identity).empty());
    CHECK(sameFilm(whole, merged));
    CHECK(merge({"whole"}, identity).empty());
    CHECK(merge({"right2", "left"}, identity) == "E0664");                   // missing samples
    CHECK(merge({"right1", "left"}, identity) == "E0664");                   // missing samples at the end
    CHECK(merge({"left", "right1", "right2", "left"}, identity) == "E0664"); // twice
    CHECK(merge({"whole", "right2"}, identity) == "E0664");                  // overlap
    CHECK(merge({"left", "right1", "short"}, identity) == "E0664");          // not finished
    CHECK(merge({"left", "right1", "right2"}, {{"seed", "8"}}) == "E0663");
}

TEST_CASE("differences are named with both values") {
    const std::vector<Fact> a{{"seed", "1"}, {"size", "4x4"}, {"camera", ""}},
        b{{"seed", "2"}, {"size", "4x4"}, {"max-depth", "3"}};
    CHECK(differences(a, a, "this", "that").empty());
    const auto lines = differences(a, b, "this", "that");
    REQUIRE(lines.size() == 3);
    CHECK(lines[0] == "seed: `1` in this, `2` in that");
    CHECK(lines[1] == "camera: nothing in this, absent in that");
    CHECK(lines[2] == "max-depth: absent in this, `3` in that");
    CHECK(differences(a, b, "this", "that", 1) == std::vector<std::string>{lines[0], "and 2 more"});
}

TEST_CASE("checkpoints in the background are of a moment: every tile in step with its pixels") {
    const Folder folder;
    const std::string path = folder / "live.ckpt";
    const PixelBounds bounds{0, 0, 64, 64};
    PixelFilm film = makeFilm(bounds);
    RenderState state(bounds, 0);
    CheckpointHeader header = headerOf(film, film.planes(), 0, 4000000);
    header.whole = 4000000;
    header.identity.clear();
    int identified = 0;
    {
        state.setPilot(0); // nothing is written before all is planned
        RenderCheckpoint checkpoint(path, header, [&] { return ++identified, std::vector<Fact>{{"seed", "7"}}; });
        checkpoint.start(film.planes(), state, 0.002);
        int read = 0, mismatches = 0;
        for (std::uint32_t s = 0; read < 5 && s < 100000; ++s) {
            for (std::size_t i = 0; i < state.tileCount(); ++i) {
                const std::lock_guard hold(state.mutex(i));
                const PixelBounds b = state.pixels(i);
                for (int y = b.y0; y < b.y1; ++y)
                    for (int x = b.x0; x < b.x1; ++x)
                        for (int r = 0; r < 2; ++r) film.add(x, y, r, Xyz{1, 1, 1}, 1);
                state.tile(i).reached = s + 1;
            }
            if (s % 50 != 0 || !checkpoint.exists()) continue;
            PixelFilm copy = makeFilm(bounds);
            const RenderState then = CheckpointReader(path).addTo(copy.planes());
            for (std::size_t i = 0; i < then.tileCount(); ++i) {
                const PixelBounds b = then.pixels(i);
                mismatches += copy.samples(b.x0, b.y0) != 2 * then.tile(i).reached;
                mismatches += copy.samples(b.x1 - 1, b.y1 - 1) != 2 * then.tile(i).reached;
            }
            ++read;
        }
        CHECK(read == 5);
        CHECK(mismatches == 0);
        checkpoint.save();
        checkpoint.stop();
        CHECK(CheckpointReader(path).header().identity == std::vector<Fact>{{"seed", "7"}});
        CHECK(identified == 1);
        checkpoint.remove();
        CHECK_FALSE(checkpoint.exists());
        checkpoint.writeOnlyIf([] { return false; });
        checkpoint.save();
        CHECK_FALSE(checkpoint.exists());
    }
    // Where it cannot be written the reason is told once, and nothing ends.
    RenderCheckpoint nowhere(folder / "absent/x.ckpt", header, [] { return std::vector<Fact>{{"seed", "7"}}; });
    nowhere.start(film.planes(), state, 0.001);
    std::optional<std::string> fault;
    for (int i = 0; i < 5000 && !fault; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        fault = nowhere.takeFault();
    }
    REQUIRE(fault.has_value());
    CHECK(fault->find("absent/x.ckpt") != std::string::npos);
}

} // namespace abbe::test
