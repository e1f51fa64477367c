// Energy: white furnaces, albedos that never exceed one, and reciprocity.
#include "materials/ggx.h"
#include "materials/stretched_ggx.h"
#include "suite.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

constexpr int kEnergySamples = 20000;

// Twenty cosines from nearly grazing to normal incidence.
Vec3 furnaceDirection(int i, bool outside = true) {
    const float mu = (static_cast<float>(i) + 0.5f) / 20, r = std::sqrt(1 - mu * mu);
    return {r * std::cos(0.3f), r * std::sin(0.3f), outside ? mu : -mu};
}

double albedo(const Bsdf& bsdf, Vec3 wo, Transport transport, int lane = 0) {
    return meanOfSamples(bsdf, wo, transport, kEnergySamples, [lane](const BsdfSample& s) { return s.weight[lane]; });
}

TEST_CASE("white furnace: a metal that absorbs nothing reflects everything") {
    double worst = 0;
    for (const float roughness : {0.f, 0.01f, 0.0225f, 0.05f, 0.1f, 0.2f, 0.3f, 0.45f, 0.6f, 0.8f, 1.f}) {
        const BsdfUnderTest b = conductor(0, 3, roughness);
        for (int i = 0; i < 20; ++i) {
            const double e = albedo(*b.bsdf, furnaceDirection(i), Transport::radiance);
            CHECK_MESSAGE(std::abs(e - 1) < 2e-3, b.name, " direction ", i, ": ", e);
            worst = std::max(worst, std::abs(e - 1));
        }
    }
    MESSAGE("largest error ", worst);
}

TEST_CASE("white furnace by quadrature of eval(), which knows nothing of the sampler") {
    for (const float roughness : kRoughnesses) {
        const BsdfUnderTest b = conductor(0, 3, roughness);
        for (int i = 1; i < 20; i += 3) {
            const Vec3 wo = furnaceDirection(i);
            const double e = cellsFor(b, wo, true).integral([&](Vec3d wi) {
                return static_cast<double>(b.bsdf->eval(wo, Vec3(wi), Transport::radiance).fcos[0]);
            });
            CHECK_MESSAGE(std::abs(e - 1) < 2e-3, b.name, " direction ", i, ": ", e);
        }
    }
}

TEST_CASE("white furnace of stretched metal") {
    const auto worst = [](float roughness, float anisotropy) {
        const BsdfUnderTest b = conductor(0, 3, roughness, anisotropy);
        double error = 0;
        for (int i = 0; i < 20; ++i)
            for (const double azimuth : {0.0, 0.5, 1.0, kPiD / 2}) {
                const double degrees = std::acos((i + 0.5) / 20) * 180 / kPiD;
                const double e = albedo(*b.bsdf, directionAt(degrees, azimuth), Transport::radiance);
                error = std::max(error, std::abs(e - 1));
            }
        MESSAGE(b.name, ": largest error ", error);
        return error;
    };
    for (const float anisotropy : {0.3f, 0.7f, 0.95f})
        for (const float roughness : {0.1f, 0.3f, 0.6f, 1.f}) CHECK(worst(roughness, anisotropy) < 0.005);
}

// At roughness 1, where further events turn up to sixteen times as much as one, tables of both factors are less exact.
TEST_CASE("white furnace: a clear interface loses nothing, from both sides and both ways of transport") {
    double worst = 0;
    for (const double ior : {1.33, 1.5, 2.4})
        for (const float roughness : {0.f, 0.01f, 0.0225f, 0.05f, 0.1f, 0.3f, 0.6f, 1.f}) {
            const BsdfUnderTest b = dielectric(ior, roughness);
            for (int i = 0; i < 40; ++i) {
                const Vec3 wo = furnaceDirection(i % 20, i < 20);
                const double light = albedo(*b.bsdf, wo, Transport::importance);
                // In equilibrium the radiance inside is n² that outside: what refraction compressed, it makes up for.
                const double eye = meanOfSamples(*b.bsdf, wo, Transport::radiance, kEnergySamples,
                                                 [](const BsdfSample& s) { return s.weight[0] * s.eta * s.eta; });
                const double limit = roughness < 1 ? 2e-3 : 5e-3;
                CHECK_MESSAGE(std::abs(light - 1) < limit, b.name, " direction ", i, ": ", light);
                CHECK_MESSAGE(std::abs(eye - 1) < limit, b.name, " direction ", i, ": ", eye);
                worst = std::max(worst, std::abs(light - 1));
            }
        }
    MESSAGE("largest error ", worst);
}

TEST_CASE("clear interface by quadrature of eval()") {
    for (const double ior : {1.33, 1.5, 2.4})
        for (const float roughness : kRoughnesses) {
            const BsdfUnderTest b = dielectric(ior, roughness);
            for (int i = 3; i < 40; i += 5) {
                const Vec3 wo = furnaceDirection(i % 20, i < 20);
                double e = 0;
                for (const bool upper : {true, false})
                    e += cellsFor(b, wo, upper, 32).integral([&](Vec3d wi) {
                        return static_cast<double>(b.bsdf->eval(wo, Vec3(wi), Transport::importance).fcos[0]);
                    });
                CHECK_MESSAGE(std::abs(e - 1) < 4e-3, b.name, " direction ", i, ": ", e);
            }
        }
}

TEST_CASE("no metal reflects more than it receives, and rough ones keep their colour") {
    for (const float roughness : {0.f, 0.1f, 0.3f, 0.6f, 1.f}) {
        const BsdfUnderTest b = conductor(0.2, 3, roughness);
        for (int i = 0; i < 20; ++i) CHECK(albedo(*b.bsdf, furnaceDirection(i), Transport::radiance) < 1);
    }
    // Normal reflectance 0.92 smooth; compensation brings the roughest within a tenth of it.
    CHECK(albedo(*conductor(0.2, 3, 1).bsdf, furnaceDirection(19), Transport::radiance) > 0.82);
}

TEST_CASE("diffuse: albedo is the reflectance") {
    const BsdfUnderTest b("diffuse", makeDiffuse({{&flat(0.2), nullptr, {}}}), 1);
    for (int i = 0; i < 20; ++i)
        CHECK(albedo(*b.bsdf, furnaceDirection(i), Transport::radiance) == doctest::Approx(0.2).epsilon(1e-6));
    const double e = cellsFor(b, {0, 0, 1}, true).integral([&](Vec3d wi) {
        return static_cast<double>(b.bsdf->eval({0, 0, 1}, Vec3(wi), Transport::radiance).fcos[0]);
    });
    CHECK(e == doctest::Approx(0.2).epsilon(1e-5));
}

// Helmholtz reciprocity; between media, what the eye path sees one way a light path carries the other way. Energy
// compensation depends on wo alone and breaks it: undo it first, and measure by how much it does.
TEST_CASE("reciprocity of single scattering") {
    Random random(21);
    double broken = 0;
    for (const BsdfUnderTest& b : roughSuite()) {
        if (b.bsdf->lobes().has(Lobe::dispersive)) continue;
        std::optional<StretchedAlbedo> stretched;
        if (b.name.find("anisotropy 0.7") != std::string::npos) {
            const Ggx ggx = Ggx::fromRoughness(std::sqrt(b.alpha), 0.7f);
            stretched.emplace(ggx.alphaX(), ggx.alphaY());
        }
        const auto kept = [&](Vec3 w, bool through) {
            if (b.name == "diffuse") return 1.0;
            if (b.eta == 0) {
                const Vec3 up{w.x, w.y, std::abs(w.z)};
                const double e = stretched ? (*stretched)(up) : ggxAlbedo(up.z, b.alpha),
                             f0 = 1 - 4 * 0.2 / (1.2 * 1.2 + 9);
                return 1 / (1 + f0 * (1 - e) / e);
            }
            const auto shares = ggxInterface(std::abs(w.z), b.alpha, w.z > 0 ? b.eta : 1 / b.eta);
            return 1 / static_cast<double>(through ? shares.transmission() : shares.reflection());
        };
        for (int i = 0; i < 3000; ++i) {
            const Vec3 a = squareToSphere({random.uniform(), random.uniform()});
            Vec3 c = squareToSphere({random.uniform(), random.uniform()});
            if (std::min(std::abs(a.z), std::abs(c.z)) < 0.01f) continue;
            const float there = b.bsdf->eval(a, c, Transport::radiance).fcos[0] / std::abs(c.z);
            const float back = b.bsdf->eval(c, a, Transport::importance).fcos[0] / std::abs(a.z);
            const bool through = (a.z > 0) != (c.z > 0);
            const double x = there * kept(a, through), y = back * kept(c, through);
            // Relative 1e-4 at the top of a lobe; Fresnel's slope near the critical angle leaves 1e-5 absolute.
            CHECK_MESSAGE(std::abs(x - y) <= 2e-4 * std::max({x, y, 0.05}), b.name, ": ", x, " and ", y);
            if (there > 1e-3f && b.alpha <= 0.36f)
                broken = std::max(broken, std::abs(there / static_cast<double>(back) - 1));
        }
    }
    MESSAGE("compensation breaks reciprocity by up to a factor of ", 1 + broken, " for roughness up to 0.6");
}

} // namespace
} // namespace abbe
