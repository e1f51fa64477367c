// Hair (docs/hard_cases.md, case 43): furnace, samplers, directions against rays through a cylinder, pigment.
#include "materials/hair.h"
#include "sphere_checks.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe {
namespace {

using namespace test;

constexpr float kScale = 0.035f;

HairBsdf fibre(float h, float longitudinal, float azimuthal, float absorption = 0, float scale = kScale) {
    HairBsdf::Fibre f;
    f.h = h;
    f.variance = hairVariance(longitudinal);
    f.width = hairAzimuthalWidth(azimuthal);
    f.sinScale = std::sin(scale);
    f.cosScale = std::cos(scale);
    f.absorption = Spectrum(absorption);
    return HairBsdf(f);
}

// By inclination θ against the normal plane and azimuth φ.
Vec3d fibreDirection(double theta, double phi) {
    return {std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi)};
}

TEST_CASE("hair: the longitudinal density integrates to one, from v = 1e-4 to 10") {
    for (const double v : {1e-4, 1e-3, 0.01, 0.099, 0.101, 0.5, 2.0, 10.0})
        for (const double thetaO : {-1.5707, -1.2, 0.0, 0.3, 1.0, 1.57}) {
            const CrowdedCells cells(-kPiD / 2, kPiD / 2, -thetaO, std::sqrt(v), 4000);
            double sum = 0;
            for (int i = 0; i < cells.count(); ++i) {
                const double x = (i + 0.5) / cells.count(), theta = cells.at(x);
                const double m = hairLongitudinal(
                    static_cast<float>(std::sin(theta)), static_cast<float>(std::cos(theta)),
                    static_cast<float>(std::sin(thetaO)), static_cast<float>(std::cos(thetaO)), static_cast<float>(v));
                sum += m * std::cos(theta) * cells.slope(x) / cells.count();
            }
            CHECK_MESSAGE(std::abs(sum - 1) < 2e-3, "v ", v, " θo ", thetaO, ": ", sum);
        }
}

TEST_CASE("hair: white furnace by sampling, over both roughnesses from 0 to 1, offset and inclination") {
    double worst = 0;
    for (const float bm : {0.f, 0.01f, 0.1f, 0.3f, 0.6f, 1.f})
        for (const float bn : {0.f, 0.01f, 0.1f, 0.3f, 0.6f, 1.f})
            for (const float h : {-1.f, -0.7f, 0.f, 0.31f, 0.99f})
                for (const double theta : {-1.5, -0.4, 0.0, 1.1, 1.57}) {
                    const HairBsdf b = fibre(h, bm, bn);
                    const double e = albedoBySampling(b, Vec3(fibreDirection(theta, 1.2)), 500);
                    CHECK_MESSAGE(std::abs(e - 1) < 1e-5, "βm ", bm, " βn ", bn, " h ", h, " θ ", theta, ": ", e);
                    worst = std::max(worst, std::abs(e - 1));
                }
    MESSAGE("largest error ", worst);
}

// With uniform directions, which know nothing of the sampler; narrow lobes by quadrature about their centre.
double energyByQuadrature(const HairBsdf& b, double thetaO, double width) {
    const Vec3 wo(fibreDirection(thetaO, 1.2));
    const CrowdedCells thetas(-kPiD / 2, kPiD / 2, -thetaO, width, 200);
    constexpr int phis = 4096;
    double sum = 0;
    for (int i = 0; i < thetas.count(); ++i) {
        const double x = (i + 0.5) / thetas.count(), theta = thetas.at(x);
        double ring = 0;
        for (int j = 0; j < phis; ++j)
            ring += static_cast<double>(
                b.eval(wo, Vec3(fibreDirection(theta, (j + 0.5) * 2 * kPiD / phis)), Transport::radiance).fcos[0]);
        sum += ring * (2 * kPiD / phis) * std::cos(theta) * thetas.slope(x) / thetas.count();
    }
    return sum;
}

TEST_CASE("hair: white furnace by quadrature of eval(), which knows nothing of the sampler") {
    double worst = 0;
    const float roughnesses[][2] = {{0.01f, 0.01f}, {0.01f, 1}, {1, 0.01f}, {0.1f, 0.3f}, {0.3f, 0.1f}, {1, 1}};
    for (const auto& [bm, bn] : roughnesses)
        for (const float h : {-0.95f, 0.2f})
            for (const double theta : {0.0, -0.9, 1.45}) {
                const double e = energyByQuadrature(fibre(h, bm, bn), theta, 3 * std::sqrt(hairVariance(bm)) + 0.05);
                CHECK_MESSAGE(std::abs(e - 1) < 0.01, "βm ", bm, " βn ", bn, " h ", h, " θ ", theta, ": ", e);
                worst = std::max(worst, std::abs(e - 1));
            }
    MESSAGE("largest error ", worst);
}

// Cells of inclination and azimuth: wide enough apart for a rule of 4 × 4 points in each.
double chiSquareOfFibre(const HairBsdf& b, double thetaO, double width, Random& random, int samples) {
    constexpr int phis = 64;
    const Vec3 wo(fibreDirection(thetaO, 1.2));
    const CrowdedCells thetas(-kPiD / 2, kPiD / 2, -thetaO, width, 24);
    std::vector<double> expected(24 * phis, 0.0), observed(24 * phis, 0.0);
    static const GaussLegendre<8> rule;
    for (int i = 0; i < 24; ++i)
        for (int j = 0; j < phis; ++j)
            for (std::size_t k = 0; k < 8; ++k)
                for (std::size_t l = 0; l < 8; ++l) {
                    const double x = (i + rule.node[k]) / 24, theta = thetas.at(x);
                    const double phi = (j + rule.node[l]) * 2 * kPiD / phis - kPiD;
                    expected[static_cast<std::size_t>(i * phis + j)] +=
                        rule.weight[k] * rule.weight[l] * (2 * kPiD / phis) * std::cos(theta) * thetas.slope(x) / 24 *
                        static_cast<double>(
                            b.eval(wo, Vec3(fibreDirection(theta, phi)), Transport::radiance).pdfSolidAngle);
                }
    CHECK(std::abs(std::accumulate(expected.begin(), expected.end(), 0.0) - 1) < 2e-3); // nothing is rejected
    for (double& e : expected) e *= samples;
    for (int n = 0; n < samples; ++n) {
        const float lobe = random.uniform();
        const auto s = b.sample(wo, lobe, {random.uniform(), random.uniform()}, Transport::radiance);
        if (!s) continue;
        const Vec3d w(s->wi);
        const double theta = std::atan2(w.x, std::hypot(w.y, w.z)), phi = std::atan2(w.z, w.y);
        const int j = std::clamp(static_cast<int>((phi + kPiD) / (2 * kPiD) * phis), 0, phis - 1);
        observed[static_cast<std::size_t>(thetas.cell(theta) * phis + j)] += 1;
    }
    return chiSquareTest(observed, expected).pValue;
}

TEST_CASE("hair: chi-square of the samples against the density") {
    Random random(74);
    const float roughnesses[][2] = {{0.1f, 0.15f}, {0.3f, 0.3f}, {0.15f, 1}, {1, 0.2f}, {1, 1}};
    const double level = sidak(1e-3, 5 * 3 * 3);
    for (const auto& [bm, bn] : roughnesses)
        for (const float h : {-0.9f, 0.1f, 0.7f})
            for (const double theta : {-0.2, 0.9, 1.5}) {
                const double p = chiSquareOfFibre(fibre(h, bm, bn, 0.3f), theta, std::sqrt(hairVariance(bm)) + 0.05,
                                                  random, chiSquareSamples());
                CHECK_MESSAGE(p > level, "βm ", bm, " βn ", bn, " h ", h, " θ ", theta, ": p ", p);
            }
}

TEST_CASE("hair: sample() against eval(), and extremes") {
    Random random(75);
    for (const float bm : {0.01f, 0.1f, 0.3f, 1.f})
        for (const float bn : {0.01f, 0.1f, 0.3f, 1.f})
            for (const float h : {-1.f, -0.5f, 0.f, 0.9f}) {
                const HairBsdf b = fibre(h, bm, bn, 0.3f);
                for (const Vec3 wo : aroundTheSphere()) CHECK(sampleAgainstEval(b, wo, random, 200) < 1e-4);
                CHECK_MESSAGE(heaviestAtExtremes(b) <= 1.001f, "βm ", bm, " βn ", bn, " h ", h);
                CHECK(heaviestAtExtremes(fibre(h, bm, bn, 1e6f)) <= 1.001f);
            }
}

Vec3d leaving(const HairBsdf& b, Vec3 wo, int order) {
    // The middle of each narrow lobe, in the order of uLobe: runs of equal directions, one for each order.
    constexpr int steps = 4000;
    std::vector<Vec3d> directions;
    for (int i = 0; i < steps; ++i)
        if (const auto s = b.sample(wo, (static_cast<float>(i) + 0.5f) / steps, {0.5f, 0.5f}, Transport::radiance))
            directions.emplace_back(s->wi);
    int run = 0;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        if (i > 0 && length(directions[i] - directions[i - 1]) > 0.2) ++run;
        if (run == order) return directions[i + 1];
    }
    return {};
}

struct Traced {
    Vec2d direction;
    double inside = 0; // length of the way through the circle
};

// A ray along -z meets the unit circle of glass in the yz-plane at y = offset: reflected (order 0), through (1), or
// reflected inside before (2).
Traced traceCircle(double offset, double eta, int order) {
    const Vec2d p{offset, std::sqrt(1 - offset * offset)};
    const Vec2d d{0, -1};
    const auto dot2 = [](Vec2d a, Vec2d b) { return a.x * b.x + a.y * b.y; };
    if (order == 0) {
        const double c = dot2(d, p);
        return {{d.x - 2 * c * p.x, d.y - 2 * c * p.y}, 0};
    }
    const auto refract = [&](Vec2d w, Vec2d n, double ratio) { // n against w
        const double c = -dot2(w, n), k = std::sqrt(1 - ratio * ratio * (1 - c * c));
        return Vec2d{ratio * w.x + (ratio * c - k) * n.x, ratio * w.y + (ratio * c - k) * n.y};
    };
    Traced t;
    Vec2d q = p, w = refract(d, p, 1 / eta);
    for (int i = 1;; ++i) {
        const double way = -2 * dot2(q, w);
        q = {q.x + way * w.x, q.y + way * w.y};
        t.inside += way;
        if (i == order) break;
        const double c = dot2(w, q);
        w = {w.x - 2 * c * q.x, w.y - 2 * c * q.y};
    }
    t.direction = refract(w, {-q.x, -q.y}, eta);
    return t;
}

TEST_CASE("hair: each order leaves where a ray through a cylinder of glass does") {
    for (const double offset : {-0.8, -0.3, 0.25, 0.6}) {
        // A ribbon: z is towards the eye. v runs along x × wo = x × z = -y.
        const HairBsdf b = fibre(static_cast<float>(offset), 0.01f, 0.01f, 0, 0);
        for (int order = 0; order < 3; ++order) {
            const Vec3d found = leaving(b, {0, 0, 1}, order);
            const Vec2d expected = traceCircle(offset, 1.55, order).direction;
            CHECK_MESSAGE(std::abs(found.y - expected.x) < 2e-3, "offset ", offset, " order ", order);
            CHECK_MESSAGE(std::abs(found.z - expected.y) < 2e-3, "offset ", offset, " order ", order);
        }
    }
}

TEST_CASE("hair: on a tube the reflection is the mirror's about the normal") {
    HairParams params;
    params.longitudinalRoughness.value = params.azimuthalRoughness.value = 0.01;
    params.scaleAngle = 0;
    const auto hair = makeHair(params);
    Arena arena;
    for (const double phi : {0.3, 1.2, 2.8}) {
        const Vec3 wo(fibreDirection(0, phi));
        SurfaceHit hit; // as Curves::surface fills it: across = n · (x × wo) / |x × wo|
        hit.uv.y = 0.5f + 0.5f * cross(Vec3{1, 0, 0}, wo).z;
        const Bsdf* b = hair->bsdf(hit, Wavelengths::single(550), arena);
        const auto s = b->sample(wo, 0, {0, 0.5f}, Transport::radiance);
        REQUIRE(s);
        CHECK(length(s->wi - Vec3{wo.x, -wo.y, wo.z}) < 2e-3f);
    }
}

TEST_CASE("hair: scales turn the reflection to the root and the light from inside to the tip") {
    const HairBsdf b = fibre(0.3f, 0.01f, 0.01f, 0, 0.05f);
    const double theta = 0.4, shifts[] = {-2 * 0.05, 0.05, 4 * 0.05};
    for (int order = 0; order < 3; ++order) {
        const HairBsdf level = fibre(0.3f, 0.01f, 0.01f, 0, 0);
        const Vec3 wo(fibreDirection(theta, 1.2));
        const double with = std::asin(leaving(b, wo, order).x), without = std::asin(leaving(level, wo, order).x);
        CHECK(with - without == doctest::Approx(shifts[order]).epsilon(0.02));
    }
}

TEST_CASE("hair: a fibre absorbs along the way that light takes through it") {
    const auto bsdf = [](float sigma) { return fibre(0.4f, 0.3f, 0.3f, sigma); };
    const double sigma = 0.7;
    const double inside = traceCircle(0.4, 1.55, 1).inside, passed = std::exp(-sigma * inside);
    const double cosine = std::sqrt(1 - 0.16), t = std::sqrt(1 - 0.16 / (1.55 * 1.55));
    const double rs = (cosine - 1.55 * t) / (cosine + 1.55 * t), rp = (t - 1.55 * cosine) / (t + 1.55 * cosine);
    const double r = (rs * rs + rp * rp) / 2, expected = r + (1 - r) * (1 - r) * passed / (1 - r * passed);
    CHECK(albedoBySampling(bsdf(static_cast<float>(sigma)), {0, 0, 1}) == doctest::Approx(expected).epsilon(1e-4));
    CHECK(albedoBySampling(bsdf(1e6f), {0, 0, 1}) == doctest::Approx(r).epsilon(1e-4));
}

TEST_CASE("hair: pigment between blue, green and red as published, and colours") {
    const auto at = [](Spectrum (*pigment)(const Wavelengths&), float nm) {
        return static_cast<double>(pigment(Wavelengths::single(nm))[0]);
    };
    // Red, green and blue of [dEon2011]; the power laws meet them at 640, 550 and 450 nm.
    CHECK(at(eumelaninAbsorption, 640) == doctest::Approx(0.419).epsilon(0.03));
    CHECK(at(eumelaninAbsorption, 550) == doctest::Approx(0.697).epsilon(1e-4));
    CHECK(at(eumelaninAbsorption, 450) == doctest::Approx(1.37).epsilon(0.03));
    CHECK(at(pheomelaninAbsorption, 640) == doctest::Approx(0.187).epsilon(0.06));
    CHECK(at(pheomelaninAbsorption, 550) == doctest::Approx(0.4).epsilon(1e-4));
    CHECK(at(pheomelaninAbsorption, 450) == doctest::Approx(1.05).epsilon(0.03));

    Arena arena;
    SurfaceHit hit;
    hit.uv.y = 0.4f;
    const auto albedo = [&](const HairParams& p) {
        const auto hair = makeHair(p);
        return albedoBySampling(*hair->bsdf(hit, Wavelengths::single(550), arena), {0, 0, 1});
    };
    HairParams plain, brown, dyed;
    brown.eumelanin.value = 1.3;
    const ConstantCurve white(1), grey(0.3);
    CHECK(albedo(plain) == doctest::Approx(1).epsilon(1e-4));
    dyed.color.curve = &white;
    CHECK(albedo(dyed) == doctest::Approx(1).epsilon(1e-4));
    dyed.color.curve = &grey;
    CHECK(albedo(dyed) < 0.95);
    CHECK(albedo(brown) < albedo(dyed));
}

TEST_CASE("hair: light passes out of a fibre") {
    const auto hair = makeHair({});
    CHECK(hair->mayBeOpen());
    SurfaceHit hit;
    hit.ng = {0, 0, 1};
    hit.arrival = {0, 0.6f, -0.8f};
    CHECK(hair->opacity(hit) == 1);
    hit.arrival = {0, 0.6f, 0.8f};
    CHECK(hair->opacity(hit) == 0);
}

} // namespace
} // namespace abbe
