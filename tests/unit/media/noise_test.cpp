// Noise volumes: transmittance against integrals, bounds that hold nearly everywhere, and nothing lost where they do
// not.
#include "media/noise_media.h"
#include "support/media.h"
#include "support/statistics.h"
#include "transport/medium_tracker.h"

#include <doctest/doctest.h>
#include <random>

namespace abbe::test {
namespace {

const ConstantCurve kBlack(0), kExtinction(1.6);

MediumOptics noiseOptics() { return opticsOf(kExtinction, kBlack); }

NoiseBox box() {
    NoiseBox b;
    b.lower = {-1, -0.5, -1};
    b.upper = {1.5, 1, 1};
    return b;
}

NoisePattern pattern(NoiseKind kind) {
    NoisePattern p;
    p.kind = kind;
    p.scale = 0.4;
    p.softness = 0.5;
    p.warp = 0.3;
    return p;
}

// Both estimators of the transmittance of a ray against e^(-extinction · integral).
void checkNoise(const Medium& medium, const Ray& ray, float tMax, double integral) {
    const Medium* const list[] = {&medium};
    MediumTracker tracker(list);
    const Wavelengths lambda = Wavelengths::sample(0.37f);
    Moments direct, tracked;
    for (std::uint64_t i = 0; i < 40'000; ++i) {
        RandomStream random(mix64(i + 1));
        direct.add(static_cast<double>(tracker.transmittance(ray, tMax, {}, lambda, random)[0]));
        Spectrum beta(1.f);
        tracker.follow(ray, tMax, {}, lambda, random, {&beta, nullptr});
        tracked.add(static_cast<double>(beta[0]));
    }
    const double expected = std::exp(-kExtinction.maximum() * integral);
    const auto error = [](const Moments& m) { return std::sqrt(m.variance() / m.count()) + 1e-6; };
    CHECK(std::abs(direct.mean() - expected) < 4.5 * error(direct));
    CHECK(std::abs(tracked.mean() - expected) < 4.5 * error(tracked));
}

} // namespace

TEST_CASE("a box of noise without contrast, edge or falloff is a homogeneous one, without a lookup") {
    NoisePattern flat;
    flat.contrast = 0;
    const NoiseVolume medium(noiseOptics(), flat, box(), Transform::translate({0, 0, 3}));
    const Medium* const list[] = {&medium};
    MediumTracker tracker(list);
    const Wavelengths lambda = Wavelengths::sample(0.1f);
    RandomStream random(1);
    const auto through = [&](Vec3 direction) {
        return static_cast<double>(tracker.transmittance({{}, direction}, 10, {}, lambda, random)[3]);
    };
    CHECK(through({0, 0, 1}) == doctest::Approx(std::exp(-1.6 * 2)).epsilon(1e-6));
    CHECK(through(normalize(Vec3{0.1f, 0.1f, 1})) ==
          doctest::Approx(std::exp(-1.6 * 2 * std::sqrt(1.02))).epsilon(1e-6));
    CHECK(through({0, 0, -1}) == 1);
    CHECK(tracker.counters.lookups == 0);
    CHECK(medium.bounds().upper.z == doctest::Approx(4));
}

TEST_CASE("noise volumes: both estimators against quadrature, thinned or not, whichever way they are turned") {
    const Transform places[] = {{}, Transform::rotate({1, 2, 3}, 0.7).then(Transform::translate({0.2, -0.1, 0.3}))};
    int filled = 0;
    for (const NoiseKind kind : {NoiseKind::gradient, NoiseKind::billow, NoiseKind::cellular})
        for (const bool thin : {false, true})
            for (const Transform& place : places) {
                NoiseBox where = box();
                where.edge = thin ? 0.4 : 0;
                if (thin) where.scaleHeight = 0.5;
                const NoiseVolume medium(noiseOptics(), pattern(kind), where, place);
                const Transform toBox = *place.inverse();
                const Ray ray{{0.05f, 0.03f, -2}, normalize(Vec3{0.13f, 0.06f, 1})};
                constexpr int steps = 200'000;
                double integral = 0;
                for (int i = 0; i < steps; ++i) {
                    const Vec3d p = toBox.point(Vec3d(ray.origin) + Vec3d(ray.direction) * (4.0 * (i + 0.5) / steps));
                    const bool inside = minComponent(p - where.lower) > 0 && minComponent(where.upper - p) > 0;
                    if (inside) integral += 4.0 / steps * static_cast<double>(medium.density(p));
                }
                filled += integral > 0.1;
                checkNoise(medium, ray, 4, integral);
            }
    CHECK(filled >= 9);
}

TEST_CASE("noise ends at the faces of its box, also in cells of the walk that reach beyond") {
    NoisePattern faint = pattern(NoiseKind::gradient);
    faint.contrast = 1e-6;
    const NoiseVolume medium(noiseOptics(), faint, box(), {});
    // Bricks of 2.5/21 and 2/17 m, cells of eight: out of the box at y = 1, close to an edge of a cell.
    const Vec3d leaves{-1 + 16 * 2.5 / 21 + 0.025, 1, -1 + 8 * 2.0 / 17 + 0.025};
    const Vec3d direction = normalize(Vec3d{-1, 0.3, 1});
    checkNoise(medium, {Vec3(leaves - direction * 0.5), Vec3(direction)}, 2, 0.5);
}

TEST_CASE("noise without an end: against quadrature") {
    NoisePattern soft = pattern(NoiseKind::gradient);
    soft.contrast = 0.8;
    const Transform place = Transform::rotate({1, 2, 3}, 0.7);
    NoiseMedium medium(noiseOptics(), soft, place);
    medium.setOrigin({100, -20, 7});
    const NoiseField field(soft);
    const Ray ray{{0.05f, 0.03f, -2}, normalize(Vec3{0.13f, 0.06f, 1})};
    constexpr int steps = 100'000;
    double integral = 0;
    for (int i = 0; i < steps; ++i)
        integral += 2.0 / steps *
                    static_cast<double>(field.at(place.inverse()->point(
                        Vec3d(ray.origin) + Vec3d{100, -20, 7} + Vec3d(ray.direction) * (2.0 * (i + 0.5) / steps))));
    checkNoise(medium, ray, 2, integral);
}

TEST_CASE("bounds of noise: hardly ever exceeded, and not much wider than need be") {
    for (const NoiseKind kind : {NoiseKind::gradient, NoiseKind::billow, NoiseKind::cellular}) {
        NoiseBox where = box();
        where.edge = 0.3;
        where.scaleHeight = 0.8;
        const NoiseVolume medium(noiseOptics(), pattern(kind), where, {});
        const Vec3d size = where.upper - where.lower;
        std::mt19937 random(3);
        std::uniform_real_distribution<double> within(0, 1);
        int above = 0, below = 0;
        double density = 0, bound = 0, excess = 0;
        constexpr int n = 400'000;
        for (int i = 0; i < n; ++i) {
            const Vec3d p = where.lower + multiply(Vec3d(within(random), within(random), within(random)), size);
            const float v = medium.density(p);
            const FieldBounds b = medium.boundsAt(p);
            above += v > b.maximum;
            excess += std::max(0.0, static_cast<double>(v) - static_cast<double>(b.maximum));
            below += v < b.minimum;
            density += static_cast<double>(v);
            bound += static_cast<double>(b.maximum);
        }
        INFO("above ", above, " below ", below, ", mean ", density / n, " bound ", bound / n, " excess ", excess / n);
        CHECK(above < n / 300);
        CHECK(below < n / 1000);
        CHECK(excess < 1e-3 * density);
        CHECK(bound < 5 * density);
    }
}

} // namespace abbe::test
