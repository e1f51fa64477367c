#include "media/emission_bricks.h"

#include "math/hash.h"
#include "volumes/brick_tree_builder.h"

#include <algorithm>
#include <bit>

namespace abbe {

namespace {

constexpr int kPoints = 4;             // of a brick along each axis, at which the fields are looked at
constexpr float kDefensive = 1 / 64.f; // least mean of a brick, of the most that there could be

float kelvin(const ScaledField& temperature, float value) { return temperature.offset + temperature.scale * value; }

BrickBounds boundsOf(const ScaledField& f, const GridMotion* motion) {
    const double drift = motion ? driftInVoxels(*motion, *f.field) : 0;
    return BrickBounds::build(f.field->grid(), static_cast<float>(drift));
}

class BrickPower {
  public:
    BrickPower(const EmissionFields& fields, const GlowTable& table)
        : fields_(fields), table_(table), amounts_(boundsOf(fields.amount, fields.motion)),
          toRender_(fields.amount.field->toRender()) {
        if (!fields.temperature.field) return;
        temperatures_ = boundsOf(fields.temperature, fields.motion);
        toTemperature_ = toRender_.then(fields.temperature.field->toIndex());
    }

    const BrickBounds& amounts() const { return amounts_; }

    FieldBounds of(Vec3i brick) const {
        const FieldBounds amount = BrickTreeBuilder::brick(amounts_, brick);
        if (!(amount.maximum > 0)) return {};
        const FieldBounds kelvins = temperatureAround(brick);
        const float factor = fields_.amount.scale * table_.seen(kelvins.maximum);
        const float most = amount.maximum * factor;
        if (!(most > 0)) return {};
        if (amount.minimum == amount.maximum && kelvins.minimum == kelvins.maximum) return {most, most, most};
        return {0, std::clamp(average(brick), kDefensive * most, most), most};
    }

  private:
    FieldBounds temperatureAround(Vec3i brick) const {
        const ScaledField& t = fields_.temperature;
        if (!t.field) return {};
        Bounds3d box;
        for (int corner = 0; corner < 8; ++corner)
            box.add(toTemperature_.point(Vec3d(brick * 8 + Vec3i(corner & 1, corner >> 1 & 1, corner >> 2) * 8)));
        // Bounds hold a little beyond their bricks: touching a brick is not yet being in it.
        constexpr double kRim = 1.0 / 64;
        box.lower = box.lower + Vec3d(kRim, kRim, kRim);
        box.upper = box.upper - Vec3d(kRim, kRim, kRim);
        const FieldBounds b = temperatures_.over(box);
        return {kelvin(t, b.minimum), kelvin(t, b.mean), kelvin(t, b.maximum)};
    }

    float average(Vec3i brick) const {
        double sum = 0;
        const int times = fields_.motion ? 3 : 1;
        for (int time = 0; time < times; ++time)
            for (int i = 0; i < kPoints * kPoints; ++i) sum += line(brick, i, static_cast<float>(time) * 0.5f);
        return static_cast<float>(sum / (kPoints * kPoints * kPoints * times));
    }
    double line(Vec3i brick, int i, float time) const {
        constexpr double kColumnStep = 8.0 / kPoints;
        const Vec3d start = Vec3d(brick * 8) + Vec3d(i / kPoints + 0.5, i % kPoints + 0.5, 0.5) * kColumnStep;
        EmissionAlong along(fields_, toRender_.point(start), toRender_.vector({0, 0, kColumnStep}), time);
        double sum = 0;
        for (int k = 0; k < kPoints; ++k) {
            const auto s = along.state(static_cast<float>(k));
            if (s.amount > 0) sum += static_cast<double>(s.amount * table_.seen(s.kelvin));
        }
        return sum;
    }

    const EmissionFields& fields_;
    const GlowTable& table_;
    BrickBounds amounts_, temperatures_;
    Transform toRender_, toTemperature_;
};

} // namespace

double hottest(const EmissionFields& f) {
    const ScaledField& t = f.temperature;
    return t.field ? static_cast<double>(kelvin(t, std::max(t.field->grid().maximum(), 0.f))) : 0;
}

BrickBounds emissionBricks(const EmissionFields& fields, const GlowTable& table) {
    const BrickPower power(fields, table);
    if (power.amounts().empty()) return {};
    BrickTreeBuilder builder(BrickTreeBuilder::placesOf(power.amounts()));
    return builder.build([&](BrickTreeBuilder::Place place, NodeBricks& bricks) {
        for (int i = 0; i < 512; ++i)
            bricks[static_cast<std::size_t>(i)] = power.of(place * 8 + Vec3i(i >> 6, i >> 3 & 7, i & 7));
    });
}

BrickSampler::BrickSampler(const BrickBounds& bricks) : bricks_(&bricks) {
    double total = 0;
    Vec3d weighted;
    const auto add = [&](Vec3i corner, int size, float mean) {
        if (!(mean > 0)) return;
        const double share = static_cast<double>(mean) * size * size * size;
        total += share;
        weighted = weighted + (Vec3d(corner) + Vec3d(0.5, 0.5, 0.5) * size) * share;
        cells_.push_back({corner, size});
        cumulative_.push_back(total);
    };
    for (const Vec3i place : BrickTreeBuilder::placesOf(bricks)) {
        NodeBricks node;
        for (int i = 0; i < 512; ++i)
            node[static_cast<std::size_t>(i)] =
                BrickTreeBuilder::brick(bricks, place * 8 + Vec3i(i >> 6, i >> 3 & 7, i & 7));
        const float mean = node[0].mean;
        if (std::ranges::all_of(node, [mean](const FieldBounds& b) { return b.mean == mean; })) {
            add(place * 64, 64, mean);
            continue;
        }
        for (int i = 0; i < 512; ++i)
            add((place * 8 + Vec3i(i >> 6, i >> 3 & 7, i & 7)) * 8, 8, node[static_cast<std::size_t>(i)].mean);
    }
    ABBE_CHECK(total > 0);
    for (double& c : cumulative_) c /= total;
    perMean_ = 1 / total;
    centre_ = weighted / total;
}

Bounds3d BrickSampler::bounds() const {
    Bounds3d b;
    for (const Cell& cell : cells_) {
        b.add(Vec3d(cell.corner));
        b.add(Vec3d(cell.corner + Vec3i(cell.size, cell.size, cell.size)));
    }
    return b;
}

Vec3d BrickSampler::sample(Vec2 u) const noexcept {
    // Three coordinates and a choice out of two numbers of 24 bits: what their digits do not give comes from a hash.
    const std::uint64_t bits =
        mix64(std::uint64_t{std::bit_cast<std::uint32_t>(u.x)} << 32 | std::bit_cast<std::uint32_t>(u.y));
    const double a = static_cast<double>(bits >> 32) * 0x1p-32, b = static_cast<double>(bits & 0xffffffff) * 0x1p-32;
    const double x = std::min(static_cast<double>(u.x) + a * 0x1p-24, 1 - 0x1p-53);
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, x);
    const auto i = static_cast<std::size_t>(found - cumulative_.begin());
    const double before = i > 0 ? cumulative_[i - 1] : 0;
    const double rest = std::clamp((x - before) / (cumulative_[i] - before), 0.0, 1 - 0x1p-53);
    return Vec3d(cells_[i].corner) + Vec3d(rest, static_cast<double>(u.y), b) * cells_[i].size;
}

} // namespace abbe
