#include "media/noise_media.h"

#include "base/check.h"
#include "volumes/brick_tree_builder.h"
#include "volumes/brick_walk.h"
#include "volumes/noise.h"

namespace abbe {

namespace {

// Bricks are 0.3 features wide, or as much wider as keeps their number, and the pilot's time, below this.
constexpr double kMostBricks = 20'000;

Vec3i bricksFor(const NoiseField& field, const NoiseBox& box) {
    if (field.constant() && box.edge == 0 && std::isinf(box.scaleHeight)) return {8, 8, 8}; // a single node
    const Vec3d size = box.upper - box.lower;
    const auto along = [&](int a, double width) { return std::clamp(std::ceil(size[a] / width), 1.0, kMostBricks); };
    double width = std::max(0.3 * field.pattern().scale, 1e-6 * maxComponent(size));
    while (along(0, width) * along(1, width) * along(2, width) > kMostBricks) width *= 1.1;
    return Vec3i(Vec3d(along(0, width), along(1, width), along(2, width)));
}

// How much the box thins density: near its faces, and with height. Each rises, or falls, with one coordinate only.
float nearFaces(const NoiseBox& box, Vec3d p) {
    if (!(box.edge > 0)) return 1;
    float product = 1;
    for (int a = 0; a < 3; ++a) {
        const double inside = std::min(p[a] - box.lower[a], box.upper[a] - p[a]);
        product *= smoothStep(0, 1, static_cast<float>(inside / box.edge));
    }
    return product;
}
float withHeight(const NoiseBox& box, double height) {
    return static_cast<float>(std::exp(-std::max(0.0, height - box.lower[box.up]) / box.scaleHeight));
}

Vec3d clamped(Vec3d p, const Bounds3d& box) { return min(max(p, box.lower), box.upper); }

// Of their product over a region: each by itself, since they may pull apart along the same axis.
std::pair<float, float> thinningOver(const NoiseBox& box, const Bounds3d& region) {
    const Vec3d middle = (box.lower + box.upper) * 0.5;
    const auto furthest = [&](int a) {
        return middle[a] - region.lower[a] > region.upper[a] - middle[a] ? region.lower[a] : region.upper[a];
    };
    return {nearFaces(box, {furthest(0), furthest(1), furthest(2)}) * withHeight(box, region.upper[box.up]),
            nearFaces(box, clamped(middle, region)) * withHeight(box, region.lower[box.up])};
}

void addPattern(DigestWriter& key, const NoisePattern& p) {
    key.number(static_cast<int>(p.kind));
    for (const double v : {p.scale, p.lacunarity, p.gain, p.warp, p.coverage, p.softness, p.contrast}) key.number(v);
    key.number(p.octaves), key.number(p.seed);
}

class NoiseWalk final : public MediumWalk {
  public:
    NoiseWalk(const NoiseVolume& volume, const BrickWalk& walk, Vec3d origin, Vec3d direction)
        : volume_(volume), walk_(walk), origin_(origin), direction_(direction) {}

    bool next(MediumSegment& s) noexcept override {
        BrickSegment brick;
        if (!walk_.next(brick)) return false;
        s = {brick.tNear, brick.tFar, brick.minimum, brick.mean, brick.maximum};
        return true;
    }
    float density(float t) noexcept override { return volume_.density(origin_ + direction_ * static_cast<double>(t)); }

  private:
    const NoiseVolume& volume_;
    BrickWalk walk_;
    Vec3d origin_, direction_; // space of the box
};

} // namespace

// In the space of the bricks: eight units a brick.
class NoiseVolume::Sampled final : public PointField {
  public:
    explicit Sampled(const NoiseVolume& volume) : volume_(volume) {
        const Vec3d cells = volume.cellsPerMetre();
        size_ = {1 / cells.x, 1 / cells.y, 1 / cells.z};
    }
    float at(Vec3d p) const noexcept override { return volume_.density(toBox(p)); }
    FieldBounds limits(const Bounds3d& region) const override {
        const auto [low, high] = thinningOver(volume_.box_, {toBox(region.lower), toBox(region.upper)});
        return {low * volume_.field_.minimum(), high, high};
    }

  private:
    Vec3d toBox(Vec3d p) const { return volume_.box_.lower + multiply(p, size_); }

    const NoiseVolume& volume_;
    Vec3d size_;
};

NoiseVolume::NoiseVolume(MediumOptics optics, const NoisePattern& pattern, const NoiseBox& box,
                         const Transform& toRender, KeptTables* kept)
    : OpticalMedium(std::move(optics)), field_(pattern), box_(box), brickCount_(bricksFor(field_, box)),
      thickest_(static_cast<float>(extinction().maximum())) {
    const auto inverse = toRender.inverse();
    ABBE_CHECK(inverse.has_value());
    toBox_ = *inverse;
    const Vec3d cells = cellsPerMetre();
    margin_ = Vec3d{1 / cells.x, 1 / cells.y, 1 / cells.z} / 30.0;
    DigestWriter key("noise bricks");
    addPattern(key, pattern);
    key.add(box.lower), key.add(box.upper);
    for (const double v : {box.edge, box.scaleHeight}) key.number(v);
    key.number(box.up);
    bricks_ = KeptTables::get<BrickBounds>(kept, key.digest(), [&] {
        return std::make_shared<const BrickBounds>(sampleBounds(Sampled(*this), brickCount_));
    });
    for (int corner = 0; corner < 8; ++corner)
        bounds_.add(Vec3(toRender.point({corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                                         corner & 4 ? box.upper.z : box.lower.z})));
}

Vec3d NoiseVolume::cellsPerMetre() const {
    const Vec3d size = box_.upper - box_.lower, cells = Vec3d(brickCount_) * 8;
    return {cells.x / size.x, cells.y / size.y, cells.z / size.z};
}

float NoiseVolume::density(Vec3d p) const noexcept {
    const Vec3d inside = clamped(p, {box_.lower, box_.upper});
    // Larger cells of the walk reach beyond the box; points computed in float may do so by the bounds' own margin.
    if (maxComponent(abs(p - inside) - margin_) > 0) return 0;
    p = inside;
    const float thin = nearFaces(box_, p) * withHeight(box_, p[box_.up]);
    return thin > 0 ? thin * field_.at(p) : 0;
}

FieldBounds NoiseVolume::boundsAt(Vec3d p) const {
    return bricks_->at(Vec3(multiply(p - box_.lower, cellsPerMetre())));
}

MediumWalk* NoiseVolume::walk(const Ray& ray, float tMax, WalkSpace& space) const noexcept {
    const Vec3d origin = toBox_.point(Vec3d(ray.origin)), direction = toBox_.vector(Vec3d(ray.direction));
    const Vec3d cells = cellsPerMetre();
    const BrickWalk walk(*bricks_, multiply(origin - box_.lower, cells), multiply(direction, cells), 0, tMax,
                         thickest_);
    return space.make<NoiseWalk>(*this, walk, origin, direction);
}

namespace {

class UnboundedNoiseWalk final : public MediumWalk {
  public:
    UnboundedNoiseWalk(const NoiseField& field, Vec3d origin, Vec3d direction, float tMax)
        : field_(field), origin_(origin), direction_(direction), tMax_(tMax) {}
    bool next(MediumSegment& segment) noexcept override {
        if (done_) return false;
        done_ = true;
        segment = {0, tMax_, field_.minimum(), field_.mean(), 1};
        return true;
    }
    float density(float t) noexcept override { return field_.at(origin_ + direction_ * static_cast<double>(t)); }

  private:
    const NoiseField& field_;
    Vec3d origin_, direction_; // space of the pattern
    float tMax_;
    bool done_ = false;
};

} // namespace

NoiseMedium::NoiseMedium(MediumOptics optics, const NoisePattern& pattern, const Transform& toWorld)
    : OpticalMedium(std::move(optics)), field_(pattern) {
    const auto inverse = toWorld.inverse();
    ABBE_CHECK(inverse.has_value());
    toPattern_ = *inverse;
}

Bounds3 NoiseMedium::bounds() const {
    return {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
}

MediumWalk* NoiseMedium::walk(const Ray& ray, float tMax, WalkSpace& space) const noexcept {
    return space.make<UnboundedNoiseWalk>(field_, toPattern_.point(Vec3d(ray.origin) + origin_),
                                          toPattern_.vector(Vec3d(ray.direction)), tMax);
}

using namespace schema;

namespace {

template <typename P> void addPatternFields(std::vector<FieldInfo>& fields) {
    fields.push_back(field<P, Choice>(FieldType::choice, "pattern", &P::kindWord)
                         .choices({"gradient", "billow", "cellular"})
                         .byDefault("gradient")
                         .synonyms({"noise", "basis", "type"})
                         .doc("Soft patches and wisps (gradient), round heaps (billow) or puffs (cellular).")
                         .example("pattern billow"));
    fields.push_back(field<P, double>(FieldType::quantity, "scale", &P::scale)
                         .unit({Dimension::length})
                         .range(1e-6, 1e9)
                         .byDefault("1 m")
                         .synonyms({"feature-size", "wavelength", "period"})
                         .doc("Distance between the features of the first octave, before the transform.")
                         .example("scale 40 cm"));
    fields.push_back(field<P, int>(FieldType::integer, "octaves", &P::octaves)
                         .range(1, 16)
                         .byDefault("5")
                         .synonyms({"detail", "levels"})
                         .doc("How many noises are added, each finer and weaker than the one before.")
                         .example("octaves 6"));
    fields.push_back(field<P, double>(FieldType::number, "lacunarity", &P::lacunarity)
                         .range(1, 8)
                         .byDefault("2")
                         .doc("How much finer each octave is.")
                         .example("lacunarity 2.1"));
    fields.push_back(field<P, double>(FieldType::number, "gain", &P::gain)
                         .range(0, 1)
                         .byDefault("0.5")
                         .synonyms({"roughness", "persistence"})
                         .doc("How strong each octave is against the one before.")
                         .example("gain 0.4"));
    fields.push_back(field<P, double>(FieldType::number, "warp", &P::warp)
                         .range(0, 10)
                         .byDefault("0")
                         .synonyms({"distortion", "turbulence"})
                         .doc("How far another noise distorts the pattern, in units of `scale`.")
                         .example("warp 0.4"));
}

template <typename P> void addAmountFields(std::vector<FieldInfo>& fields) {
    fields.push_back(field<P, double>(FieldType::number, "coverage", &P::coverage)
                         .range(0.001, 1)
                         .byDefault("0.5")
                         .synonyms({"threshold", "fill", "amount"})
                         .doc("Share of space where the pattern is more than nothing.")
                         .example("coverage 0.3"));
    fields.push_back(
        field<P, double>(FieldType::number, "softness", &P::softness)
            .range(0.001, 1)
            .byDefault("0.5")
            .synonyms({"sharpness", "feather"})
            .doc("How slowly density rises to 1: 0.05 has crisp edges, 1 is 1 at the thickest places alone.")
            .example("softness 0.3"));
    fields.push_back(field<P, double>(FieldType::number, "contrast", &P::contrast)
                         .range(0, 1)
                         .byDefault("1")
                         .doc("1: nothing between the patches; 0: density 1 everywhere.")
                         .example("contrast 0.6"));
    fields.push_back(field<P, std::uint32_t>(FieldType::integer, "seed", &P::seed)
                         .range(0, 4294967295.0)
                         .byDefault("0")
                         .doc("Another number gives another pattern of the same kind.")
                         .example("seed 7"));
}

FieldInfo corner(std::string_view name, std::optional<Vec3d> NoiseVolumeParams::*member, std::string_view doc,
                 std::string_view example) {
    return field<NoiseVolumeParams, std::optional<Vec3d>>(FieldType::vector3, name, member)
        .unit({Dimension::length})
        .doc(doc)
        .example(example);
}

void addBoxFields(std::vector<FieldInfo>& fields) {
    using P = NoiseVolumeParams;
    fields.push_back(field<P, std::optional<Vec3d>>(FieldType::vector3, "size", &P::size)
                         .unit({Dimension::length})
                         .range(1e-6, 1e9)
                         .synonyms({"dimensions", "extent"})
                         .doc("Lengths of the edges of the box along x, y and z; 1 1 1 when absent.")
                         .example("size 12 2 12 m"));
    fields.push_back(corner("center", &P::center, "Middle of the box; not beside `min` and `max`.", "center 0 1 0"));
    fields.push_back(
        corner("min", &P::lowest, "Corner with the smallest coordinates, instead of `size`.", "min -6 0 -6"));
    fields.push_back(
        corner("max", &P::highest, "Corner with the largest coordinates, together with `min`.", "max 6 2 6"));
    fields.push_back(field<P, double>(FieldType::quantity, "edge", &P::edge)
                         .unit({Dimension::length})
                         .range(0, 1e9)
                         .byDefault("0")
                         .synonyms({"falloff", "fade"})
                         .doc("Distance from the faces of the box over which density rises from 0.")
                         .example("edge 50 cm"));
    fields.push_back(field<P, double>(FieldType::quantity, "scale-height", &P::scaleHeight)
                         .unit({Dimension::length})
                         .range(1e-6, 1e9)
                         .synonyms({"height_falloff"})
                         .doc("Height over which density falls to 1/e, from the bottom of the box; none when absent.")
                         .example("scale-height 60 cm"));
}

template <typename P> FieldInfo placement() {
    return field<P, Transform>(FieldType::transform, "transform", &P::transform)
        .synonyms({"to_world", "toWorld", "xform"})
        .doc("Places the pattern: steps from top to bottom.")
        .example("transform { rotate y 30 deg }");
}

} // namespace

NoisePattern patternOf(const NoiseMediumParams& params) {
    NoisePattern pattern = params;
    pattern.kind = params.kindWord.word == "billow"     ? NoiseKind::billow
                   : params.kindWord.word == "cellular" ? NoiseKind::cellular
                                                        : NoiseKind::gradient;
    return pattern;
}

std::variant<NoiseBox, std::string_view> boxOf(const NoiseVolumeParams& p, bool zUp) {
    NoiseBox box;
    if (p.lowest || p.highest) {
        if (!p.lowest || !p.highest) return "`min` and `max` go together";
        if (p.size || p.center) return "`min` and `max` leave nothing for `size` and `center` to say";
        box.lower = *p.lowest;
        box.upper = *p.highest;
    } else {
        const Vec3d size = p.size.value_or(Vec3d{1, 1, 1}), center = p.center.value_or(Vec3d{});
        box.lower = center - size * 0.5;
        box.upper = center + size * 0.5;
    }
    if (!(minComponent(box.upper - box.lower) > 0)) return "the box has no volume";
    box.edge = p.edge;
    box.scaleHeight = p.scaleHeight;
    box.up = zUp ? 2 : 1;
    return box;
}

TypeInfo noiseMediumType() {
    std::vector<FieldInfo> fields;
    addPatternFields<NoiseMediumParams>(fields);
    addAmountFields<NoiseMediumParams>(fields);
    addOpticsFields<NoiseMediumParams>(fields);
    fields.push_back(placement<NoiseMediumParams>());
    return {Kind::medium,
            "noise",
            "Patches, heaps or puffs by fractal noise, wherever the shape that it fills is.",
            "medium smoke noise { scale 20 cm; coverage 0.4; extinction 8 per-m; albedo 0.7 }",
            false,
            std::move(fields)};
}

TypeInfo noiseVolumeType() {
    std::vector<FieldInfo> fields;
    addBoxFields(fields);
    addPatternFields<NoiseVolumeParams>(fields);
    addAmountFields<NoiseVolumeParams>(fields);
    addOpticsFields<NoiseVolumeParams>(fields);
    fields.push_back(placement<NoiseVolumeParams>());
    return {Kind::volume,
            "noise",
            "A box of mist, smoke or cloud by fractal noise.",
            "volume mist noise { size 20 2 20 m; scale 1.5 m; scale-height 50 cm; extinction 0.5 per-m }",
            false,
            std::move(fields)};
}

} // namespace abbe
