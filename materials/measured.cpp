#include "materials/measured.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace abbe {
namespace {

constexpr double kExactPi = std::numbers::pi;
// Half vectors that are the normal itself have no density: the map folds a whole edge of the square into them.
constexpr double kLeastStretch = 1e-12;

// Angle from the normal, exact near 0 where acos is not.
double elevation(Vec3d d) { return 2 * std::asin(std::min(0.5 * length(d - Vec3d(0, 0, 1)), 1.0)); }
double thetaOf(double u) { return u * u * kExactPi / 2; }
double uOfTheta(double theta) { return std::sqrt(theta * 2 / kExactPi); }
double uOfPhi(double phi) { return (phi + kExactPi) / (2 * kExactPi); }

Vec3d fromAngles(double theta, double phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Solid angle of directions wi per unit square of half vectors: dω_m = 2 π² u sin θ du dv [Dupuy2018, eq. 8], and
// dω_i = 4 (wo · m) dω_m.
double stretch(double u, double sinTheta, double cosine) { return 2 * kExactPi * kExactPi * u * sinTheta * 4 * cosine; }

// On both sides: directions below are mirrored to +z first. What is measured is taken to be reciprocal; light paths use
// it as paths from the camera do.
class MeasuredBsdf final : public Bsdf {
  public:
    MeasuredBsdf(const MeasuredTables& tables, const Wavelengths& wavelengths, double scale)
        : tables_(tables), scale_(scale) {
        const int last = static_cast<int>(tables.wavelengths.size()) - 1;
        for (int lane = 0; lane < kLanes; ++lane) {
            const AxisPlace place = placeOnAxis(tables.wavelengths, wavelengths.nm[lane]);
            lower_[lane] = static_cast<int>(place.index);
            upper_[lane] = std::min(lower_[lane] + 1, last);
            fraction_.v[lane] = static_cast<float>(place.fraction);
        }
    }

    Lobes lobes() const noexcept override { return Lobes(Lobe::glossy) | Lobe::reflection; }

    BsdfEval eval(Vec3 wo, Vec3 wi, Transport) const noexcept override {
        if (wo.z < 0) wo.z = -wo.z, wi.z = -wi.z;
        if (!(wo.z > 0 && wi.z > 0)) return {};
        const View view = viewed(wo);
        const Vec3d m = normalize(turned(view, wi) + view.wo);
        const double theta = elevation(m);
        double v = uOfPhi(std::atan2(m.y, m.x) - (tables_.isotropic ? view.phi : 0));
        v -= std::floor(v);
        const Vec2d at(uOfTheta(theta), v);
        const BilinearWarp::Point place = tables_.visible.invert(view.blend, at);
        const double around = stretch(at.x, std::hypot(m.x, m.y), dot(view.wo, m));
        if (!(around > kLeastStretch)) return {};
        return {spectrum(view, place.at, at),
                static_cast<float>(place.density * tables_.luminance.density(view.blend, place.at) / around)};
    }

    std::optional<BsdfSample> sample(Vec3 wo, float, Vec2 u, Transport) const noexcept override {
        const bool below = wo.z < 0;
        if (below) wo.z = -wo.z;
        if (!(wo.z > 0)) return std::nullopt;
        const View view = viewed(wo);
        const BilinearWarp::Point place = tables_.luminance.sample(view.blend, {u.y, u.x});
        const BilinearWarp::Point half = tables_.visible.sample(view.blend, place.at);
        const double theta = thetaOf(half.at.x), phi = (2 * half.at.y - 1) * kExactPi;
        const Vec3d m = fromAngles(theta, phi + (tables_.isotropic ? view.phi : 0));
        const double cosine = dot(view.wo, m), around = stretch(half.at.x, std::sin(theta), cosine);
        if (!(around > kLeastStretch)) return std::nullopt;
        Vec3 wi(normalize(turned(view, m * (2 * cosine) - view.wo)));
        const double density = half.density * place.density / around;
        if (!(wi.z > 0 && density > 0)) return std::nullopt;
        if (below) wi.z = -wi.z;
        return std::optional<BsdfSample>(std::in_place, wi,
                                         spectrum(view, place.at, half.at) * static_cast<float>(1 / density),
                                         static_cast<float>(density), lobes());
    }

  private:
    // A direction that is looked from, turned into the range that was measured.
    struct View {
        Vec3d wo;
        double phi, theta;
        double flipX, flipY; // ±1
        TableBlend blend;
        AxisPlace phiPlace, thetaPlace;
    };

    View viewed(Vec3 direction) const {
        View v{.wo = Vec3d(direction),
               .phi = 0,
               .theta = 0,
               .flipX = 1,
               .flipY = 1,
               .blend = {},
               .phiPlace = {},
               .thetaPlace = {}};
        if (tables_.repeats >= 2) { // half a circle, φ < 0, turned; or a quarter, mirrored twice
            v.flipY = v.wo.y > 0 ? -1 : 1;
            v.flipX = tables_.repeats == 4 ? (v.wo.x > 0 ? -1 : 1) : v.flipY;
        }
        v.wo = turned(v, Vec3(v.wo));
        v.theta = elevation(v.wo);
        v.phi = std::atan2(v.wo.y, v.wo.x);
        v.phiPlace = placeOnAxis(tables_.phi, v.phi);
        v.thetaPlace = placeOnAxis(tables_.theta, v.theta);
        v.blend = blendTables(v.phiPlace, v.thetaPlace, tables_.theta.size());
        return v;
    }
    static Vec3d turned(const View& v, Vec3d w) { return {w.x * v.flipX, w.y * v.flipY, w.z}; }
    static Vec3d turned(const View& v, Vec3 w) { return turned(v, Vec3d(w)); }

    // f cos θi at a place that the visible half vectors make uniform, and at a half vector.
    Spectrum spectrum(const View& view, Vec2d place, Vec2d half) const {
        double factor = scale_;
        if (tables_.scalesByFacets)
            factor *= tables_.facets.at(half) / (4 * tables_.projected.at({uOfTheta(view.theta), uOfPhi(view.phi)}));
        const std::size_t side = tables_.side;
        const BilinearCell cell(place, side, side);
        Spectrum sum(0.f);
        for (std::size_t i = 0; i < static_cast<std::size_t>(view.blend.count); ++i)
            for (const std::size_t down : {0u, 1u})
                for (const std::size_t across : {0u, 1u}) {
                    const double weight = view.blend.weight[i] * (down ? cell.down : 1 - cell.down) *
                                          (across ? cell.across : 1 - cell.across) * factor;
                    const std::size_t at = (view.blend.table[i] * side + cell.row + down) * side + cell.column + across;
                    sum += curve(at) * static_cast<float>(weight);
                }
        return sum;
    }

    // At one of the tabulated places.
    Spectrum curve(std::size_t at) const {
        const float* v = tables_.spectra.data() + at * tables_.wavelengths.size();
        const Spectrum low(_mm256_i32gather_ps(v, reinterpret_cast<__m256i>(lower_), sizeof(float))),
            high(_mm256_i32gather_ps(v, reinterpret_cast<__m256i>(upper_), sizeof(float)));
        return fma(fraction_, high - low, low);
    }

    static constexpr int kLanes = 8;
    const MeasuredTables& tables_;
    double scale_;
    Int8 lower_{}, upper_{}; // which tabulated wavelengths a lane is between
    Spectrum fraction_;
};

class Measured final : public Material {
  public:
    Measured(MeasuredTables tables, double scale) : tables_(std::move(tables)), scale_(scale) {
        traits_ = {.choosesLobe = false, .isOpaque = true};
    }

    const Bsdf* bsdf(const SurfaceHit&, const Wavelengths& wavelengths, Arena& arena) const noexcept override {
        return arena.make<MeasuredBsdf>(tables_, wavelengths, scale_);
    }

  private:
    MeasuredTables tables_;
    double scale_;
};

} // namespace

double MeasuredGrid::at(Vec2d place) const noexcept {
    const BilinearCell c(place, rows, columns);
    const float* v = values.data() + c.row * columns + c.column;
    return std::lerp(std::lerp(double(v[0]), double(v[1]), c.across),
                     std::lerp(double(v[columns]), double(v[columns + 1]), c.across), c.down);
}

schema::TypeInfo measuredType() {
    using namespace schema;
    return {.kind = Kind::material,
            .name = "measured",
            .doc = "A surface as it was measured, from a `.bsdf` file of the RGL database (spectral, not `_rgb`); on "
                   "both sides.",
            .example = "material cloth measured \"satin_purple_spec.bsdf\"",
            .fields = {
                field(FieldType::file, "file", &MeasuredParams::file)
                    .argument(0)
                    .required()
                    .doc("The `.bsdf` file.")
                    .example("file \"satin_purple_spec.bsdf\"")
                    .synonyms({"filename"}),
                field(FieldType::number, "scale", &MeasuredParams::scale)
                    .doc("Factor on all that is reflected.")
                    .example("scale 0.8")
                    .range(0, 1e6)
                    .byDefault("1"),
            }};
}

std::unique_ptr<const Material> makeMeasured(MeasuredTables tables, double scale) {
    return std::make_unique<Measured>(std::move(tables), scale);
}

} // namespace abbe
