// Beams: what they send to a point against closed forms and quadrature, and the densities that go with it.
#include "lights/beam_light.h"
#include "math/warp.h"
#include "spectrum/curve.h"
#include "support/statistics.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe {
namespace {

using schema::Dimension;
using schema::Quantity;

constexpr double kBeamDegree = kPiD / 180;
const SampledCurve kBeamSpectrum([](double nm) { return 37 * std::exp((nm - 360) / 200); });
const Wavelengths kBeamAt = Wavelengths::single(555);

LightContext beamContext() {
    LightContext c;
    c.defaultColor = &kBeamSpectrum;
    return c;
}

struct Opening {
    Vec3d centre{1, -2, 0.5}, axis = normalize(Vec3d{1, 2, -0.5});
    double radius = 0.3, half = 10 * kBeamDegree;

    BeamLight light() const { return {centre, axis, radius, half, {&kBeamSpectrum, 1}}; }
    // At a distance from the opening along the axis, and aside.
    Vec3d place(double along, double aside) const {
        const Vec3d across = normalize(cross(axis, Vec3d{0.3, 0.1, 1}));
        return centre + axis * along + across * aside;
    }
    // Over the radiance, on a surface across the beam: by quadrature over the opening.
    double irradiance(Vec3d from) const {
        const Vec3d x = normalize(cross(axis, Vec3d{1, 0.2, 0.4})), y = cross(axis, x);
        constexpr int kRings = 900, kTurns = 900;
        double sum = 0;
        for (int i = 0; i < kRings; ++i)
            for (int j = 0; j < kTurns; ++j) {
                const double r = radius * std::sqrt((i + 0.5) / kRings), phi = 2 * kPiD * (j + 0.5) / kTurns;
                const Vec3d way = from - centre - x * (r * std::cos(phi)) - y * (r * std::sin(phi));
                const double cosine = dot(way, axis) / length(way);
                if (cosine >= std::cos(half)) sum += square(cosine) / lengthSquared(way);
            }
        return sum * kPiD * square(radius) / (kRings * kTurns);
    }
};

// The same by sampling the light.
double sampledIrradiance(const BeamLight& light, const Opening& opening, Vec3d from) {
    constexpr int kSide = 500;
    double sum = 0;
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
            const Vec2 u{(static_cast<float>(i) + 0.5f) / kSide, (static_cast<float>(j) + 0.5f) / kSide};
            const auto s = light.sample(Vec3(from), 0, u, kBeamAt, 0);
            if (s) sum -= dot(Vec3d(s->wi), opening.axis) / static_cast<double>(s->pdfSolidAngle);
        }
    return sum / (kSide * kSide);
}

} // namespace

TEST_CASE("a beam gives every place what its opening shows it") {
    Opening opening;
    for (const double half : {2.0, 10.0, 40.0}) {
        opening.half = half * kBeamDegree;
        const BeamLight light = opening.light();
        for (const auto& [along, aside] : {std::pair{0.6, 0.15}, {0.5, 0.1}, {0.5, 0.28}, {3.0, 0.2}, {3.0, 0.45}}) {
            CAPTURE(half);
            CAPTURE(along);
            CAPTURE(aside);
            const Vec3d from = opening.place(along, aside);
            const double expected = opening.irradiance(from);
            CHECK(sampledIrradiance(light, opening, from) == doctest::Approx(expected).epsilon(4e-3).scale(1e-4));
        }
        CHECK_FALSE(light.sample(Vec3(opening.place(-0.1, 0)), 0, {}, kBeamAt, 0)); // behind it
        CHECK_FALSE(light.sample(Vec3(opening.place(1, 0.31 + std::tan(opening.half))), 0, {0.5f, 0.5f}, kBeamAt, 0));
    }
}

TEST_CASE("a collimated beam is as bright 20 m away, and dark beside") {
    BeamLightParams p;
    p.position = {0, 1, 0};
    p.toward = Vec3d{1, 0, 0};
    p.radius = 0.02;
    p.irradiance = Quantity{1000, Dimension::irradiance, {}};
    Diagnostics diagnostics;
    const auto light = makeBeamLight(p, beamContext(), diagnostics);
    REQUIRE(light);
    CHECK(light->power() == doctest::Approx(1000 * kPiD * square(0.02)).epsilon(1e-6));
    const auto arriving = [&](Vec3 from) {
        const auto s = light->sample(from, 0, {0.3f, 0.7f}, kBeamAt, 0);
        if (!s) return 0.0;
        CHECK(s->wi.x == doctest::Approx(-1).epsilon(1e-6));
        CHECK(s->delta);
        CHECK(static_cast<double>(s->distance) == doctest::Approx(from.x).epsilon(1e-6));
        const double spectral = radiantIntegral(kBeamSpectrum) / kBeamSpectrum.at(555);
        return static_cast<double>(s->radiance[0]) / static_cast<double>(s->pdfSolidAngle) * spectral;
    };
    for (const float distance : {0.01f, 1.f, 20.f}) {
        CHECK(arriving({distance, 1, 0}) == doctest::Approx(1000).epsilon(1e-4));
        CHECK(arriving({distance, 1.017f, 0}) == doctest::Approx(1000).epsilon(1e-4));
        CHECK(arriving({distance, 1.0225f, 0}) == 0);
    }
    CHECK(arriving({-0.1f, 1, 0}) == 0);
}

TEST_CASE("a beam's samples have the density that it tells of them, and its directions theirs") {
    test::Random random(4);
    for (const double half : {0.005, 3.0, 44.0}) {
        Opening opening;
        opening.half = half * kBeamDegree;
        const BeamLight light = opening.light();
        int found = 0;
        for (int i = 0; i < 2000; ++i) {
            const double along = 3 * random.uniformDouble();
            const Vec3 from(opening.place(along, (opening.radius + along * std::tan(opening.half)) *
                                                     (2.2 * random.uniformDouble() - 1.1)));
            const auto s = light.sample(from, 0, {random.uniform(), random.uniform()}, kBeamAt, 0);
            if (!s) continue;
            ++found;
            REQUIRE(light.pdfAtPoint(from, 0, s->p, s->n, 0) == doctest::Approx(s->pdfSolidAngle).epsilon(1e-3));
            // Light paths find what was asked for.
            const LightOrigin origin = light.originAt(0, s->p, s->n, 0);
            REQUIRE(light.pdfDirection(origin, -s->wi) > 0);
            REQUIRE(light.leaving(origin, -s->wi, kBeamAt)[0] == s->radiance[0]);
        }
        CHECK(found > 500);
        const auto origin = light.sampleOrigin(0, {0.2f, 0.6f}, kBeamAt, 0);
        REQUIRE(origin);
        for (int i = 0; i < 2000; ++i) {
            const Vec3 w = light.sampleDirection(*origin, {random.uniform(), random.uniform()});
            REQUIRE(light.pdfDirection(*origin, w) == origin->largest);
            REQUIRE(light.leaving(*origin, w, kBeamAt)[0] > 0);
        }
    }
}

TEST_CASE("a beam arrives nowhere on a ray outside of its reach, which is not much too long") {
    test::Random random(5);
    const auto within = [&](double most) { return (2 * random.uniformDouble() - 1) * most; };
    for (const double half : {0.005, 1.0, 20.0}) {
        Opening opening;
        opening.half = half * kBeamDegree;
        const BeamLight light = opening.light();
        int lit = 0, reached = 0;
        for (int i = 0; i < 3000; ++i) {
            const Vec3d origin = opening.place(within(3), within(2)) + Vec3d{within(1), within(1), within(1)};
            const Vec3d target = opening.place(within(3), within(0.4));
            const bool along = i % 3 == 0; // or nearly
            const Vec3d d = along ? opening.axis * (i % 2 ? 1.0 : -1.0) +
                                        Vec3d{within(1), within(1), within(1)} * std::tan(opening.half)
                                  : target - origin;
            const Ray ray{Vec3(origin), Vec3(normalize(d))};
            const auto reach = light.reach(ray, 8);
            for (int k = 0; k < 100; ++k) {
                const float t = 8 * (static_cast<float>(k) + 0.5f) / 100;
                bool arrives = false;
                for (int n = 0; n < 4 && !arrives; ++n)
                    arrives =
                        light
                            .sample(ray.origin + ray.direction * t, 0, {random.uniform(), random.uniform()}, kBeamAt, 0)
                            .has_value();
                const bool inside = reach && t >= reach->tNear && t <= reach->tFar;
                lit += arrives;
                reached += inside;
                REQUIRE((!arrives || inside));
            }
        }
        CHECK(lit > 1000);
        CHECK(reached < 1.25 * lit);
    }
}

TEST_CASE("a beam's opening stays round, and it points somewhere") {
    BeamLightParams p;
    p.power = Quantity{0.005, Dimension::power, {}};
    p.transform = Transform::scale({2, 2, 2});
    Diagnostics diagnostics;
    const auto light = makeBeamLight(p, beamContext(), diagnostics);
    REQUIRE(light);
    CHECK(light->power() == doctest::Approx(0.005).epsilon(1e-6));
    CHECK(light->sample(Vec3{0, 0.0099f, -1}, 0, {}, kBeamAt, 0).has_value());
    CHECK_FALSE(light->sample(Vec3{0, 0.0103f, -1}, 0, {}, kBeamAt, 0).has_value());
    p.transform = Transform::scale({1, 2, 1});
    CHECK(makeBeamLight(p, beamContext(), diagnostics) == nullptr);
    p.transform = {};
    p.toward = Vec3d{};
    CHECK(makeBeamLight(p, beamContext(), diagnostics) == nullptr);
    REQUIRE(diagnostics.all().size() == 2);
    CHECK(diagnostics.all()[0].code == "E0348");
    CHECK(diagnostics.all()[1].code == "E0344");
}

} // namespace abbe
