#include "media/grid_medium.h"

#include "volumes/brick_walk.h"

namespace abbe {

namespace {

using namespace schema;

FieldKey gridKey() {
    FieldKey key{"grid", {}, "The grid's name, as if it stood behind the property's."};
    key.value = true;
    return key;
}

FieldKey numberKey(std::string_view name, double lower, std::string_view doc) {
    FieldKey key{name, {}, doc};
    key.number = true;
    key.lower = lower;
    key.upper = 1e12;
    return key;
}

Field gridField(std::string_view name, std::optional<Text> VdbParams::*member) {
    return field<VdbParams, std::optional<Text>>(FieldType::text, name, member).key(gridKey());
}

std::vector<FieldInfo> gridFields() {
    using P = VdbParams;
    return {
        gridField("density", &P::density)
            .key(numberKey("scale", 0, "Factor of its values; 1 when absent."))
            .byDefault("density")
            .synonyms({"grid", "grid_name", "field", "density_grid"})
            .doc("Name of the grid that is the density.")
            .example("density smoke scale=2.5"),
        gridField("temperature", &P::temperature)
            .key(numberKey("scale", 0, "Kelvin per unit of its values; 1 when absent."))
            .key(numberKey("offset", -1e12, "Kelvin where its values are 0; 0 when absent."))
            .synonyms({"temperature_grid", "heat", "temp"})
            .doc("Name of the grid of temperatures. The medium emits by Kirchhoff's law: what it absorbs, times a "
                 "black body of that temperature.")
            .example("temperature heat scale=1500 offset=300"),
        gridField("flame", &P::flame)
            .key(numberKey("scale", 0, "Factor of its values; 1 when absent."))
            .synonyms({"flames", "fire", "flame_grid", "emission_grid"})
            .doc("Name of the grid that is the amount of what emits; the density when absent.")
            .example("flame flames scale=3"),
        gridField("color", &P::color)
            .synonyms({"Cd", "albedo_grid", "scattering_grid"})
            .doc("Name of the grid of vectors that tints the albedo, a factor of it: scene-linear Rec. 709 within 0 "
                 "and 1.")
            .example("color Cd"),
        gridField("velocity", &P::velocity)
            .key(numberKey("scale", -1e12, "Factor of its values; 1 when absent."))
            .synonyms({"vel", "v", "velocity_grid", "motion"})
            .doc("Name of the grid of vectors, in units of the file's world per second, with which all grids drift "
                 "while the shutter is open.")
            .example("velocity v scale=24"),
        field<P, std::optional<double>>(FieldType::quantity, "time", &P::time)
            .unit({Dimension::time})
            .range(-1e9, 1e9)
            .synonyms({"frame", "moment"})
            .doc("With `velocity`: the moment at which things are where the file has them; when the shutter opens if "
                 "absent.")
            .example("time 0.5 s"),
    };
}

} // namespace

TypeInfo vdbType() {
    using P = VdbParams;
    std::vector<FieldInfo> fields = {
        field<P, Text>(FieldType::file, "file", &P::file)
            .argument(0)
            .required()
            .synonyms({"filename", "path"})
            .doc("OpenVDB or NanoVDB file.")
            .example("file \"cloud.vdb\""),
    };
    for (FieldInfo& f : gridFields()) fields.push_back(std::move(f));
    fields.push_back(field<P, bool>(FieldType::toggle, "level-set", &P::levelSet)
                         .byDefault("off")
                         .doc("Whether a level set may be the density: it becomes fog of density 1 with a soft edge.")
                         .example("level-set on"));
    addOpticsFields<P>(fields);
    addGlowFields<P>(fields);
    fields.push_back(field<P, Transform>(FieldType::transform, "transform", &P::transform)
                         .synonyms({"to_world", "toWorld", "xform"})
                         .doc("Places the volume: steps from top to bottom, as applied to the object.")
                         .example("transform { scale 2; translate 0 1 0 }"));
    return {Kind::volume,
            "vdb",
            "Cloud, smoke and fire from the grids of an OpenVDB or NanoVDB file.",
            "volume cloud vdb \"cloud.vdb\" { extinction 0.08 per-m; phase henyey-greenstein 0.85 }",
            false,
            std::move(fields)};
}

namespace {

// Along a line; what the medium has besides its density is there if it is given.
struct GridParts {
    const GridField<float>& density;
    const BrickBounds& bricks;
    double perVoxel;
    const GridColor* color;
    const GridMotion* motion;
    const Curve& albedo;
    float factor, thickest;
};

class GridWalk final : public MediumWalk {
  public:
    GridWalk(const GridParts& parts, const Ray& ray, float tMax)
        : density_(parts.density, Vec3d(ray.origin), Vec3d(ray.direction)),
          walk_(parts.bricks, density_.origin() * parts.perVoxel, density_.direction() * parts.perVoxel, 0, tMax,
                parts.thickest),
          color_(parts.color, Vec3d(ray.origin), Vec3d(ray.direction)),
          motion_(parts.motion, Vec3d(ray.origin), Vec3d(ray.direction), ray.time), albedo_(&parts.albedo),
          factor_(parts.factor) {}

    bool next(MediumSegment& s) noexcept override {
        BrickSegment brick;
        if (!walk_.next(brick)) return false;
        s = {brick.tNear, brick.tFar, brick.minimum * factor_, brick.mean * factor_, brick.maximum * factor_};
        return true;
    }
    float density(float t) noexcept override {
        return (motion_.moves() ? density_.at(t, motion_.shift(t)) : density_.at(t)) * factor_;
    }
    Spectrum albedo(float t, const Wavelengths& lambda) noexcept override {
        return albedo_->at(lambda) * (motion_.moves() ? color_.at(t, motion_.shift(t), lambda) : color_.at(t, lambda));
    }

  private:
    FieldAlong<float> density_;
    BrickWalk walk_;
    ColorAlong color_;
    MotionAlong motion_;
    const Curve* albedo_;
    float factor_;
};

// Of bricks of eight voxels, until the thickest is not many mean free paths across: loose bounds cost lookups, small
// bricks steps and memory (docs/performance.md).
int halvingsFor(const GridField<float>& density, float thickest) {
    constexpr double kThick = 4;
    double voxel = 0;
    for (const Vec3d axis : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)})
        voxel = std::max(voxel, length(density.toRender().vector(axis)));
    const double brick = 8 * voxel * static_cast<double>(density.grid().maximum() * thickest);
    return brick > 2 * kThick ? 2 : brick > kThick ? 1 : 0;
}

template <typename T> const T* pointer(const std::optional<T>& o) { return o ? &*o : nullptr; }

} // namespace

GridMedium::GridMedium(MediumOptics optics, VoxelGrid grid, double factor, const Transform& worldToRender,
                       GridExtras extras, KeptTables* kept, const Digest& grids)
    : OpticalMedium(std::move(optics)), density_(std::move(grid), worldToRender), factor_(static_cast<float>(factor)) {
    if (extras.color)
        color_ =
            GridColor{GridField<Vec3>(std::move(extras.color->grid), worldToRender), std::move(extras.color->table)};
    if (extras.velocity) {
        motion_.emplace(std::move(*extras.velocity), worldToRender);
        if (!motion_->moves()) motion_.reset();
    }
    thickest_ = factor_ * static_cast<float>(extinction().maximum());
    const int halvings = motion_ ? 0 : halvingsFor(density_, thickest_); // bounds dilated by many bricks take long
    DigestWriter key("bricks");
    key.add(grids);
    key.number(drift()), key.number(halvings);
    bricks_ = KeptTables::get<BrickBounds>(kept, key.digest(), [&] {
        return std::make_shared<const BrickBounds>(
            BrickBounds::build(density_.grid(), static_cast<float>(drift()), halvings));
    });
    perVoxel_ = 1 << halvings;
    if (extras.flame) flame_.emplace(std::move(extras.flame->grid), worldToRender);
    if (extras.temperature) temperature_.emplace(std::move(extras.temperature->grid), worldToRender);
    if (extras.glow) makeEmission(*extras.glow, extras);
    if (density_.grid().empty()) return;
    const Bounds3 box = density_.grid().support();
    const double more = drift();
    for (int corner = 0; corner < 8; ++corner)
        bounds_.add(Vec3(density_.toRender().point(
            {corner & 1 ? static_cast<double>(box.upper.x) + more : static_cast<double>(box.lower.x) - more,
             corner & 2 ? static_cast<double>(box.upper.y) + more : static_cast<double>(box.lower.y) - more,
             corner & 4 ? static_cast<double>(box.upper.z) + more : static_cast<double>(box.lower.z) - more})));
}

void GridMedium::makeEmission(const Glow& glow, const GridExtras& extras) {
    EmissionFields fields{.amount = {&density_, factor_, 0},
                          .temperature = {},
                          .glow = glow,
                          .color = glow.byAlbedo() ? pointer(color_) : nullptr,
                          .motion = pointer(motion_)};
    if (flame_) fields.amount = {&*flame_, static_cast<float>(extras.flame->scale), 0};
    if (glow.thermal()) {
        ABBE_CHECK(temperature_.has_value());
        fields.temperature = {&*temperature_, static_cast<float>(extras.temperature->scale),
                              static_cast<float>(extras.temperature->offset)};
    }
    auto emission = std::make_unique<GridEmission>(fields);
    if (!emission->dark()) emission_ = std::move(emission);
}

MediumWalk* GridMedium::walk(const Ray& ray, float tMax, WalkSpace& space) const noexcept {
    const GridParts parts{density_,         *bricks_, perVoxel_, pointer(color_),
                          pointer(motion_), albedo(), factor_,   thickest_};
    return space.make<GridWalk>(parts, ray, tMax);
}

} // namespace abbe
