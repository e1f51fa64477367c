#include "volumes/sampled_bounds.h"

#include "math/hash.h"
#include "volumes/brick_tree_builder.h"

namespace abbe {

namespace {

constexpr int kStrata = 4; // along each axis: 64 points in a pass
constexpr int kMostPasses = 8;
// All as shares of what the limits leave open: a pass that raises less is quiet; every extreme is widened by the first
// margin, and by the second as a share of what was found.
constexpr float kQuiet = 0.02f;
constexpr float kLeastMargin = 1.f / 64;
constexpr float kSampledMargin = 0.1f;

class BrickPilot {
  public:
    BrickPilot(const PointField& field, Vec3i brick)
        : field_(field), lower_(Vec3d(brick * 8)),
          seed_(combine64(combine64(static_cast<std::uint64_t>(brick.x), static_cast<std::uint64_t>(brick.y)),
                          static_cast<std::uint64_t>(brick.z))) {}

    FieldBounds run() {
        const FieldBounds limits = field_.limits({lower_, lower_ + Vec3d(8, 8, 8)});
        if (limits.minimum == limits.maximum) return {limits.maximum, limits.maximum, limits.maximum};
        const float open = limits.maximum - limits.minimum;
        low_ = high_ = field_.at(lower_ + Vec3d(4, 4, 4));
        for (int i = 0; i < kMostPasses; ++i) {
            const float low = low_, high = high_;
            pass();
            if (i > 0 && high_ - high <= kQuiet * open && low - low_ <= kQuiet * open) break;
        }
        const float margin = kSampledMargin * (high_ - low_) + kLeastMargin * open;
        FieldBounds b;
        b.minimum = std::max(limits.minimum, low_ - margin);
        b.maximum = std::min(limits.maximum, high_ + margin);
        b.mean = std::clamp(static_cast<float>(sum_ / count_), b.minimum, b.maximum);
        return b;
    }

  private:
    void pass() {
        constexpr double size = 8.0 / kStrata;
        for (int i = 0; i < kStrata * kStrata * kStrata; ++i) {
            const std::uint64_t h = mix64(seed_ + static_cast<std::uint64_t>(++count_) * 0x9e3779b97f4a7c15ull);
            const auto unit = [h](int shift) { return static_cast<double>(h >> shift & 0xfffff) * 0x1p-20; };
            const Vec3d stratum(i % kStrata, i / kStrata % kStrata, i / (kStrata * kStrata));
            const float value = field_.at(lower_ + (stratum + Vec3d{unit(0), unit(20), unit(40)}) * size);
            low_ = std::min(low_, value);
            high_ = std::max(high_, value);
            sum_ += static_cast<double>(value);
        }
    }

    const PointField& field_;
    Vec3d lower_;
    std::uint64_t seed_;
    float low_ = 0, high_ = 0;
    double sum_ = 0;
    int count_ = 0;
};

} // namespace

BrickBounds sampleBounds(const PointField& field, Vec3i bricks) {
    std::vector<BrickTreeBuilder::Place> places;
    for (int x = 0; x < bricks.x; x += 8)
        for (int y = 0; y < bricks.y; y += 8)
            for (int z = 0; z < bricks.z; z += 8) places.push_back(Vec3i(x, y, z) / 8);
    BrickTreeBuilder builder(std::move(places));
    return builder.build([&](Vec3i place, NodeBricks& node) {
        for (int i = 0; i < 512; ++i) {
            const Vec3i brick = place * 8 + Vec3i(i >> 6, i >> 3 & 7, i & 7);
            if (brick.x < bricks.x && brick.y < bricks.y && brick.z < bricks.z)
                node[static_cast<std::size_t>(i)] = BrickPilot(field, brick).run();
        }
    });
}

} // namespace abbe
