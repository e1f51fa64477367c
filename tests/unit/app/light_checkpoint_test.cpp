// Checkpoints of renders whose light paths add to pixels all over the picture.
#include "checkpoints/checkpoint_reader.h"
#include "checkpoints/render_checkpoint.h"
#include "checkpoints/render_identity.h"
#include "checkpoints/render_parts.h"
#include "film/pixel_film.h"
#include "math/hash.h"

#include <atomic>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>
#include <unistd.h>

namespace abbe::test {
namespace {

namespace fs = std::filesystem;

struct LightFolder {
    fs::path path = fs::temp_directory_path() / ("abbe_light_checkpoint_" + std::to_string(getpid()));
    LightFolder() { fs::create_directories(path); }
    ~LightFolder() { fs::remove_all(path); }
    std::string operator/(const std::string& name) const { return (path / name).string(); }
};

constexpr PixelBounds kFrame{0, 0, 40, 20};
constexpr std::size_t kBlocks = 5;
constexpr int kPaths = 30; // of a block and sample
constexpr std::uint32_t kWhole = 8;

const int kLight = 0;
const SceneNames kNames{{&kLight, "lamp"}};

PixelFilm makeLightFilm(PixelBounds bounds) {
    PixelFilm film(bounds, PixelFilter(FilterShape::box, 0.5), 2);
    LayerPlan plan;
    plan.components = true;
    plan.groups = {{"lamp", {"lamp"}}};
    plan.spectral = SpectralBins{};
    film.keepLayers(plan, kNames, rgb::ap0);
    film.keepSplats();
    return film;
}

// In the place of an integrator: the same numbers for the same block, sample and path.
class Renderer {
  public:
    Renderer(PixelFilm& film, RenderState& state) : film_(film), state_(state) {}

    // Takes an entry on by one sample.
    void advance(std::size_t i) {
        const auto hold = state_.hold(i);
        TileState& tile = state_.tile(i);
        if (state_.isLightBlock(i))
            trace(state_.lightBlock(i), tile);
        else
            sample(state_.pixels(i), tile);
        ++tile.reached;
    }
    void run(std::uint32_t last) {
        for (std::size_t i = 0; i < state_.tileCount(); ++i)
            while (state_.tile(i).reached < last) advance(i);
    }

  private:
    void sample(PixelBounds b, TileState& tile) {
        for (int y = b.y0; y < b.y1; ++y)
            for (int x = b.x0; x < b.x1; ++x)
                for (int r = 0; r < 2; ++r) film_.add(x, y, r, Xyz{0.1 * x, 1.0 / (1 + y + tile.reached), 1e-5 * r}, 1);
        tile.tally.paths += static_cast<std::uint64_t>(2 * b.area());
    }
    // Paths of the whole frame, of which a crop gets what falls on it.
    void trace(std::size_t block, TileState& tile) {
        const int replicate = static_cast<int>(block % 2);
        const PixelBounds b = film_.bounds();
        for (int p = 0; p < kPaths; ++p) {
            const std::uint64_t h = combine64(combine64(block, tile.reached), static_cast<std::uint64_t>(p));
            const int x = static_cast<int>(h % 40), y = static_cast<int>(h / 40 % 20);
            ++tile.tally.lightPaths;
            if (x < b.x0 || x >= b.x1 || y < b.y0 || y >= b.y1) continue;
            const Wavelengths lambda = Wavelengths::sample(static_cast<float>(h % 997) / 997.f);
            const Spectrum radiance(static_cast<float>(h % 13));
            const double value = 1e-3 * static_cast<double>(h % 100003);
            film_.splat(x, y, replicate,
                        {{value, 2 * value, -value},
                         radiance,
                         lambda,
                         0.5,
                         p % 2 ? &kLight : nullptr,
                         static_cast<PathComponent>(p % 3)});
            ++tile.tally.splats;
        }
        film_.countLightPaths(replicate, kPaths);
    }

    PixelFilm& film_;
    RenderState& state_;
};

std::vector<std::byte> bytesOf(PixelFilm& film) {
    std::vector<std::byte> bytes;
    for (const auto& plane : film.planes()) plane->store(film.bounds(), bytes);
    return bytes;
}

CheckpointHeader headerOf(PixelFilm& film, std::size_t blocks, std::uint32_t first, std::uint32_t last) {
    CheckpointHeader h;
    h.identity = {{"seed", "7"}};
    h.bounds = film.bounds();
    h.replicates = 2;
    h.lightBlocks = static_cast<std::uint32_t>(blocks);
    h.first = first;
    h.last = last;
    h.whole = kWhole;
    for (const auto& plane : film.planes()) h.planes.push_back(plane->name());
    return h;
}

void writePart(const std::string& path, PixelBounds bounds, std::uint32_t first, std::uint32_t last,
               std::size_t blocks = kBlocks) {
    PixelFilm film = makeLightFilm(bounds);
    RenderState state(bounds, first, blocks);
    Renderer(film, state).run(last);
    writeCheckpoint(path, headerOf(film, blocks, first, last), film.planes(), state);
}

std::string faultOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const CheckpointFault& fault) {
        return fault.code + ": " + fault.what();
    }
    return "";
}

} // namespace

TEST_CASE("blocks of light paths are entries without pixels behind the tiles") {
    RenderState state({3, 5, 40, 24}, 2, 4);
    CHECK(state.pixelTileCount() == 6);
    CHECK(state.tileCount() == 10);
    CHECK(state.lightBlockCount() == 4);
    CHECK_FALSE(state.isLightBlock(5));
    CHECK(state.isLightBlock(6));
    CHECK(state.lightBlock(9) == 3);
    CHECK(state.pixels(5).area() > 0);
    CHECK(state.pixels(6).area() == 0);
    CHECK(state.even());
    for (std::size_t i = 0; i < 9; ++i) state.tile(i).reached = 7;
    CHECK(state.reached() == 2);
    CHECK_FALSE(state.even());
    state.tile(9).reached = 7;
    CHECK(state.reached() == 7);
    CHECK(state.even());
    state.tile(9).tally.lightPaths = 11;
    state.tile(8).tally.lightPaths = 5;
    state.tile(7).tally.splats = 3;
    CHECK(state.tally().lightPaths == 16);
    CHECK(state.tally().splats == 3);
    CHECK(RenderState({0, 0, 1, 1}, 0).lightBlockCount() == 0);
}

TEST_CASE("a render with light paths goes on from a checkpoint of any moment to the same bits") {
    const LightFolder folder;
    PixelFilm whole = makeLightFilm(kFrame);
    RenderState wholeState(kFrame, 0, kBlocks);
    Renderer(whole, wholeState).run(kWhole);
    for (const unsigned seed : {1u, 2u, 3u}) {
        PixelFilm film = makeLightFilm(kFrame);
        RenderState state(kFrame, 0, kBlocks);
        Renderer renderer(film, state);
        for (std::size_t i = 0; i < state.tileCount(); ++i) // as far as it came, each entry for itself
            for (std::uint64_t n = combine64(seed, i) % kWhole; n > 0; --n) renderer.advance(i);
        writeCheckpoint(folder / "a", headerOf(film, kBlocks, 0, kWhole), film.planes(), state);

        PixelFilm again = makeLightFilm(kFrame);
        RenderState read = CheckpointReader(folder / "a").addTo(again.planes());
        CHECK(read.lightBlockCount() == kBlocks);
        CHECK(bytesOf(again) == bytesOf(film));
        for (std::size_t i = 0; i < state.tileCount(); ++i) CHECK(read.tile(i).reached == state.tile(i).reached);
        CHECK(read.tally().lightPaths == state.tally().lightPaths);
        CHECK(read.tally().splats == state.tally().splats);
        CHECK(again.lightPaths() == read.tally().lightPaths);
        Renderer(again, read).run(kWhole);
        CHECK(bytesOf(again) == bytesOf(whole));
        CHECK(read.tally().splats == wholeState.tally().splats);
        CHECK(again.mean(7, 3).y == whole.mean(7, 3).y);
        CHECK(again.variance(7, 3) == whole.variance(7, 3));
    }
}

TEST_CASE("parts by samples and crops of a render with light paths are the whole to the bit") {
    const LightFolder folder;
    PixelFilm whole = makeLightFilm(kFrame);
    RenderState state(kFrame, 0, kBlocks);
    Renderer(whole, state).run(kWhole);
    const PixelBounds left{0, 0, 13, 20}, right{13, 0, 40, 20};
    writePart(folder / "1of2", kFrame, 0, 4);
    writePart(folder / "2of2", kFrame, 4, 8);
    writePart(folder / "left", left, 0, 8);
    writePart(folder / "right1", right, 0, 3);
    writePart(folder / "right2", right, 3, 8);
    const auto merged = [&](std::vector<std::string> names) {
        for (std::string& name : names) name = folder / name;
        RenderParts parts(names);
        parts.check({{"seed", "7"}});
        PixelFilm film = makeLightFilm(parts.bounds());
        const RenderStatistics statistics = parts.addTo(film);
        parts.bringLayers(film, film.bounds());
        CHECK(film.lightPaths() == kBlocks * kPaths * kWhole);
        CHECK(statistics.splats == state.tally().splats);
        return std::pair(bytesOf(film), statistics.lightPaths);
    };
    const auto halves = merged({"1of2", "2of2"}), crops = merged({"right2", "left", "right1"});
    CHECK(halves.first == bytesOf(whole));
    CHECK(halves.second == state.tally().lightPaths);
    CHECK(crops.first == bytesOf(whole));
    CHECK(crops.second == 2 * state.tally().lightPaths); // for each crop once: the work that it was
    writePart(folder / "other", kFrame, 4, 8, kBlocks + 1);
    const auto fault = faultOf([&] { merged({"1of2", "other"}); });
    CHECK(fault.find("E0663") == 0);
    CHECK(fault.find("blocks of light paths: 6 in the part, 5 in") != std::string::npos);
}

TEST_CASE("the size of the pilots is kept, and parts with plans of different sizes do not fit") {
    const LightFolder folder;
    const auto write = [&](const std::string& name, std::uint32_t first, std::uint32_t last, int pilot) {
        PixelFilm film = makeLightFilm(kFrame);
        RenderState state(kFrame, first, kBlocks);
        state.setPilot(pilot);
        Renderer(film, state).run(last);
        CheckpointHeader header = headerOf(film, kBlocks, first, last);
        CHECK_FALSE(writeCheckpoint(folder / name, header, film.planes(), state)); // planned since the header was made
        header.pilot = pilot;
        CHECK(writeCheckpoint(folder / name, header, film.planes(), state));
        return header;
    };
    CheckpointHeader header = write("1of2", 0, 4, 3);
    write("2of2", 4, 8, 3);
    write("other", 4, 8, 2);
    RenderParts parts({folder / "1of2", folder / "2of2"});
    parts.check({{"seed", "7"}});
    CHECK(parts.pilot() == 3);
    CHECK(faultOf([&] {
              RenderParts({folder / "1of2", folder / "other"}).check({{"seed", "7"}});
          }).find("pilot: 2 in the part, 3 in") != std::string::npos);
    for (const int asked : {-1, 3, 4}) { // -1: whatever the checkpoint has
        header.pilot = asked;
        RenderCheckpoint checkpoint(folder / "1of2", header, [] { return std::vector<Fact>{{"seed", "7"}}; });
        PixelFilm film = makeLightFilm(kFrame);
        RenderState state(kFrame, 0, kBlocks);
        const std::string fault = faultOf([&] { checkpoint.resume(film.planes(), state); });
        CHECK(fault.empty() == (asked != 4));
        if (asked == 4) CHECK(fault.find("pilot: `3` in the checkpoint, `4` in this render") != std::string::npos);
        if (asked != 4) CHECK(state.pilot() == 3);
    }
}

TEST_CASE("no damage to what light paths brought goes unnoticed") {
    const LightFolder folder;
    const PixelBounds bounds{0, 0, 17, 1};
    const auto film = [&] {
        PixelFilm f(bounds, PixelFilter(FilterShape::box, 0.5), 2);
        f.keepSplats();
        return f;
    };
    PixelFilm written = film();
    RenderState state(bounds, 0, 2);
    Renderer(written, state).run(2);
    CheckpointHeader header = headerOf(written, 2, 0, 2);
    writeCheckpoint(folder / "whole", header, written.planes(), state);
    std::ifstream in(folder / "whole", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const auto readBad = [&](const std::string& content) {
        fs::remove(folder / "bad"); // some file systems wait for the disk when a file is cut and written anew
        std::ofstream(folder / "bad", std::ios::binary) << content;
        return faultOf([&] {
            PixelFilm f = film();
            CheckpointReader(folder / "bad").addTo(f.planes());
        });
    };
    REQUIRE(readBad(bytes).empty());
    std::size_t unnoticed = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string changed = bytes;
        changed[i] = static_cast<char>(changed[i] ^ (1 << (i % 8)));
        unnoticed += readBad(changed).empty();
        unnoticed += readBad(bytes.substr(0, i)).empty();
    }
    CHECK(unnoticed == 0);
    std::string older = bytes;
    older[8] = 2;
    CHECK(readBad(older).find("is a checkpoint of version 2; this program knows version 8") != std::string::npos);
    // Into a film that has no place for it, and from one that had none.
    CHECK(faultOf([&] {
              PixelFilm plain(bounds, PixelFilter(FilterShape::box, 0.5), 2);
              CheckpointReader(folder / "whole").addTo(plain.planes());
          }).find("E0662") == 0);
    RenderCheckpoint checkpoint(folder / "whole", header, [] { return std::vector<Fact>{{"seed", "7"}}; });
    PixelFilm f = film();
    RenderState fewer(bounds, 0, 1);
    const std::string fault = faultOf([&] { checkpoint.resume(f.planes(), fewer); });
    CHECK(fault.find("blocks of light paths: `2` in the checkpoint, `1` in this render") != std::string::npos);
    RenderState same(bounds, 0, 2);
    checkpoint.resume(f.planes(), same);
    CHECK(same.reached() == 2);
    CHECK(bytesOf(f) == bytesOf(written));
}

TEST_CASE("checkpoints in the background: every splat in step with the blocks, whoever adds meanwhile") {
    const LightFolder folder;
    const std::string path = folder / "live";
    PixelFilm film = makeLightFilm(kFrame);
    RenderState state(kFrame, 0, kBlocks);
    CheckpointHeader header = headerOf(film, kBlocks, 0, 4000000);
    header.whole = 4000000;
    RenderCheckpoint checkpoint(path, header, [] { return std::vector<Fact>{{"seed", "7"}}; });
    state.setPilot(0); // nothing is written before all is planned
    checkpoint.start(film.planes(), state, 0.002);
    std::atomic<bool> stop = false;
    std::vector<std::thread> workers;
    for (std::size_t w = 0; w < 2; ++w)
        workers.emplace_back([&, w] { // each its own entries, back to back: never is nobody inside by chance
            Renderer renderer(film, state);
            while (!stop)
                for (std::size_t i = w; i < state.tileCount() && !stop; i += 2) renderer.advance(i);
        });
    int read = 0, uneven = 0;
    for (int attempt = 0; read < 4 && attempt < 5000; ++attempt) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        if (!checkpoint.exists()) continue;
        PixelFilm copy = makeLightFilm(kFrame), expected = makeLightFilm(kFrame);
        const RenderState then = CheckpointReader(path).addTo(copy.planes());
        RenderState state2(kFrame, 0, kBlocks);
        Renderer renderer(expected, state2);
        for (std::size_t i = 0; i < then.tileCount(); ++i)
            while (state2.tile(i).reached < then.tile(i).reached) renderer.advance(i);
        CHECK(bytesOf(copy) == bytesOf(expected));
        uneven += !then.even();
        ++read;
    }
    stop = true;
    for (std::thread& w : workers) w.join();
    CHECK(read == 4);
    CHECK(uneven > 0);
}

TEST_CASE("a closed gate: light paths wait, and nobody who comes keeps it from closing") {
    LightGate gate;
    std::atomic<int> inside = 0;
    std::atomic<bool> stop = false;
    std::atomic<std::uint64_t> passes = 0;
    std::vector<std::thread> threads;
    for (int t = 0; t < 3; ++t)
        threads.emplace_back([&] {
            while (!stop) {
                const LightGate::Pass pass = gate.enter();
                ++inside;
                std::this_thread::sleep_for(std::chrono::microseconds(300));
                --inside;
                ++passes;
            }
        });
    int seen = 0;
    for (int i = 0; i < 50; ++i) {
        while (passes < static_cast<std::uint64_t>(i)) std::this_thread::yield();
        const LightGate::Closure closure = gate.close();
        seen += inside;
        const std::uint64_t before = passes;
        std::this_thread::sleep_for(std::chrono::microseconds(200));
        seen += inside;
        seen += passes != before;
    }
    stop = true;
    for (std::thread& t : threads) t.join();
    CHECK(seen == 0);
    CHECK(passes >= 49);
}

} // namespace abbe::test
