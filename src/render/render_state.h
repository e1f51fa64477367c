// How far a render has come, tile by tile: with the film's sums all that is needed to go on with it.
#pragma once

#include "base/check.h"
#include "base/work_clock.h"
#include "render/integrator.h"
#include "render/path_tally.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <vector>

namespace abbe {

// Where a portion of samples was cut short. Samples of a tile are taken unit by unit: of pixels, row by row, and of
// each its replicates. Of light paths a unit is a sample of a replicate, and of merging a round.
struct PortionPlace {
    std::uint32_t unit = 0; // all units before it are done,
    std::uint32_t done = 0; // and so many samples, or light paths, of this one
};

// A portion that was to take a tile to sample `end`.
struct CutPortion {
    std::uint32_t end = 0;
    PortionPlace at;
};

// The way into a film for light paths, which whoever wants to see their sums at rest can close. Many are inside at
// once; to close it is to wait for those inside and to let nobody else in meanwhile, so that threads which come and go
// without end cannot keep it open. A lock for each block of light paths would do as well, if threads could hold
// thousands of them.
class LightGate {
  public:
    using Pass = std::shared_lock<std::shared_mutex>;
    using Closure = std::unique_lock<std::shared_mutex>;

    // Both wait. A thread that is inside must not call either.
    [[nodiscard]] Pass enter() {
        const std::lock_guard turn(turnstile_);
        return Pass(inside_);
    }
    [[nodiscard]] Closure close() {
        const std::lock_guard turn(turnstile_);
        return Closure(inside_);
    }

  private:
    std::mutex turnstile_; // of those who wait for the other
    std::shared_mutex inside_;
};

// The samples [RenderState::first(), reached) of each replicate of each pixel of the tile are in the film, and of a
// portion that was cut short those before the place where it was; no others. Of a block of light paths, its paths of
// these samples.
struct TileState {
    static constexpr std::size_t kExamples = 4;

    std::uint32_t reached = 0;
    std::optional<CutPortion> cut; // to be finished before anything else
    PathTally tally;
    std::vector<DroppedSample> examples = {}; // kExamples at most
};

// The tiles of a rectangle, row by row from its corner; those at its other edges may be smaller.
class TileGrid {
  public:
    static constexpr int kSize = 16;

    // Requires a non-empty rectangle.
    explicit TileGrid(PixelBounds bounds) : bounds_(bounds) {}

    PixelBounds bounds() const { return bounds_; }
    std::size_t columns() const { return tilesOver(bounds_.width()); }
    std::size_t count() const { return columns() * tilesOver(bounds_.height()); }
    PixelBounds pixels(std::size_t i) const {
        const int x = bounds_.x0 + static_cast<int>(i % columns()) * kSize;
        const int y = bounds_.y0 + static_cast<int>(i / columns()) * kSize;
        return {x, y, std::min(x + kSize, bounds_.x1), std::min(y + kSize, bounds_.y1)};
    }
    // Those with pixels of a rectangle that is not empty and lies within the bounds.
    std::vector<std::size_t> tilesIn(PixelBounds b) const {
        const auto before = [](int pixels) { return static_cast<std::size_t>(pixels / kSize); };
        std::vector<std::size_t> tiles;
        for (std::size_t row = before(b.y0 - bounds_.y0); row <= before(b.y1 - 1 - bounds_.y0); ++row)
            for (std::size_t column = before(b.x0 - bounds_.x0); column <= before(b.x1 - 1 - bounds_.x0); ++column)
                tiles.push_back(row * columns() + column);
        return tiles;
    }

  private:
    static std::size_t tilesOver(int pixels) { return static_cast<std::size_t>((pixels + kSize - 1) / kSize); }

    PixelBounds bounds_;
};

// How far all tiles have come. The tiles of a film's bounds, row by row, and behind them blocks of light paths: tiles
// without pixels, which a render takes to the same samples. While it goes on, a tile and the film's pixels in it are
// changed by the holder of its mutex alone: who holds it finds both in step, at any moment and without stopping the
// render. A block's light is all over the film, so blocks and splats are in step together: while nobody is inside the
// gate.
class RenderState {
  public:
    static constexpr int kTileSize = TileGrid::kSize;

    // Nothing is done yet; samples will begin at `first`. Requires a non-empty rectangle.
    RenderState(PixelBounds bounds, std::uint32_t first, std::size_t lightBlocks = 0)
        : grid_(bounds), first_(first), pixelTiles_(grid_.count()), tiles_(pixelTiles_ + lightBlocks),
          mutexes_(tiles_.size()) {
        for (TileState& tile : tiles_) tile.reached = first;
    }

    std::uint32_t first() const { return first_; }
    PixelBounds bounds() const { return grid_.bounds(); }
    const TileGrid& grid() const { return grid_; }
    // Tiles of pixels come first, then blocks of light paths.
    std::size_t tileCount() const { return tiles_.size(); }
    std::size_t pixelTileCount() const { return pixelTiles_; }
    std::size_t lightBlockCount() const { return tiles_.size() - pixelTiles_; }
    bool isLightBlock(std::size_t i) const { return i >= pixelTiles_; }
    // Which of the blocks of light paths; requires one.
    std::size_t lightBlock(std::size_t i) const {
        ABBE_DCHECK(isLightBlock(i));
        return i - pixelTiles_;
    }
    TileState& tile(std::size_t i) { return tiles_[i]; }
    const TileState& tile(std::size_t i) const { return tiles_[i]; }
    // Empty for a block of light paths.
    PixelBounds pixels(std::size_t i) const { return isLightBlock(i) ? PixelBounds{} : grid_.pixels(i); }

    std::mutex& mutex(std::size_t i) { return mutexes_[i]; }
    LightGate& lightGate() { return *lightGate_; }
    // What a thread holds while it changes an entry and what that adds to the film.
    struct Hold {
        std::unique_lock<std::mutex> tile;
        LightGate::Pass light; // of a block of light paths
    };
    [[nodiscard]] Hold hold(std::size_t i) {
        return {std::unique_lock(mutexes_[i]), isLightBlock(i) ? lightGate_->enter() : LightGate::Pass()};
    }

    // Where the slowest entry stands. No render may be going on, here and below.
    std::uint32_t reached() const {
        return std::min_element(tiles_.begin(), tiles_.end(),
                                [](const TileState& a, const TileState& b) { return a.reached < b.reached; })
            ->reached;
    }
    // Whether all entries stand at the same sample, and no portion was cut short.
    bool even() const {
        return std::all_of(tiles_.begin(), tiles_.end(),
                           [&](const TileState& t) { return t.reached == tiles_[0].reached && !t.cut; });
    }
    // Whether no pixel has a sample.
    bool empty() const {
        const auto end = tiles_.begin() + static_cast<std::ptrdiff_t>(pixelTiles_);
        return std::all_of(tiles_.begin(), end, [&](const TileState& t) {
            return t.reached == first_ && (!t.cut || (t.cut->at.unit == 0 && t.cut->at.done == 0));
        });
    }
    // Whether a sample of every pixel was taken.
    bool allBegun() const {
        const auto end = tiles_.begin() + static_cast<std::ptrdiff_t>(pixelTiles_);
        return std::all_of(tiles_.begin(), end, [&](const TileState& t) { return t.reached > first_; });
    }
    PathTally tally() const {
        PathTally sum;
        for (const TileState& tile : tiles_) sum.add(tile.tally);
        return sum;
    }

    // The first few, in the order of the entries.
    std::vector<DroppedSample> examples() const {
        std::vector<DroppedSample> list;
        for (const TileState& tile : tiles_)
            for (const DroppedSample& s : tile.examples)
                if (list.size() < TileState::kExamples) list.push_back(s);
        return list;
    }

    double seconds = 0; // wall clock of the runs before this one
    WorkReading work;   // where it went

    // RenderSettings::pilot of the plan that its samples follow; below 0: nothing is planned yet. From any thread.
    int pilot() const { return pilot_->load(); }
    void setPilot(int size) { pilot_->store(size); }

  private:
    TileGrid grid_;
    std::uint32_t first_;
    std::size_t pixelTiles_;
    std::vector<TileState> tiles_;
    std::vector<std::mutex> mutexes_;
    std::unique_ptr<LightGate> lightGate_ = std::make_unique<LightGate>();
    std::unique_ptr<std::atomic<int>> pilot_ = std::make_unique<std::atomic<int>>(-1);
};

} // namespace abbe
