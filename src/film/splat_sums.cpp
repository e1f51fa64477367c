#include "film/splat_sums.h"

#include <atomic>

namespace abbe {

SplatSums::SplatSums(SplatKind kind, PixelBounds bounds, int replicates)
    : kind_(kind), bounds_(bounds),
      cells_(static_cast<std::size_t>(bounds.area()) * static_cast<std::size_t>(replicates)),
      paths_(static_cast<std::size_t>(replicates)) {}

std::uint64_t SplatSums::memoryBytes(PixelBounds bounds, int replicates) {
    return static_cast<std::uint64_t>(bounds.area()) * static_cast<std::uint64_t>(replicates) * sizeof(Cell);
}

void SplatSums::count(int replicate, std::uint64_t paths) noexcept {
    std::atomic_ref(paths_[static_cast<std::size_t>(replicate)]).fetch_add(paths, std::memory_order_relaxed);
}

Xyz SplatSums::sum(std::size_t first, std::size_t last) const noexcept {
    ExactSum x, y, z;
    for (std::size_t cell = first; cell < last; ++cell) {
        x += cells_[cell].x.sum();
        y += cells_[cell].y.sum();
        z += cells_[cell].z.sum();
    }
    return {x.value(), y.value(), z.value()};
}

std::uint64_t SplatSums::paths(int first, int last) const noexcept {
    std::uint64_t count = 0;
    for (int r = first; r < last; ++r) count += paths_[static_cast<std::size_t>(r)];
    return count;
}

// Light paths are those of the whole frame, so that crops of the same samples have the same ones, and parts by samples
// each its own. The number is kept with the first pixel of the film: of a picture put together from parts those count
// that have this pixel, and they have each sample once.
class SplatSums::PathsPlane final : public FilmPlane {
  public:
    explicit PathsPlane(SplatSums& sums) : sums_(sums) {}

    std::string name() const override {
        const std::string what = sums_.kind_ == SplatKind::merged ? "rounds/" : "light-paths/";
        return what + std::to_string(sums_.paths_.size()) + "x64";
    }
    bool ofLightPaths() const override { return true; }

    void store(PixelBounds b, std::vector<std::byte>& out) const override {
        if (!hasFirstPixel(b)) return;
        const auto bytes = std::as_bytes(std::span(sums_.paths_));
        out.insert(out.end(), bytes.begin(), bytes.end());
    }

    bool addWithin(PixelBounds within, PixelBounds of, std::span<const std::byte> bytes) override {
        if (bytes.size() != std::as_bytes(std::span(sums_.paths_)).size()) return bytes.empty() && !hasFirstPixel(of);
        if (!hasFirstPixel(common(within, of))) return true;
        for (std::uint64_t& count : sums_.paths_) {
            std::uint64_t term;
            std::memcpy(&term, bytes.data(), sizeof term);
            count += term;
            bytes = bytes.subspan(sizeof term);
        }
        return true;
    }

  private:
    bool hasFirstPixel(PixelBounds b) const {
        const PixelBounds& all = sums_.bounds_;
        return b.x0 <= all.x0 && all.x0 < b.x1 && b.y0 <= all.y0 && all.y0 < b.y1;
    }

    SplatSums& sums_;
};

void SplatSums::appendPlanes(FilmPlanes& planes) {
    planes.push_back(std::make_unique<DensePlane<Cell>>(kind_ == SplatKind::merged ? "merged" : "splats", bounds_,
                                                        paths_.size(), std::span(cells_),
                                                        PlaneUse{.ofLightPaths = true}));
    planes.push_back(std::make_unique<PathsPlane>(*this));
}

} // namespace abbe
