// Thin sheets: clear ones against the sum over reflections between their faces, matte ones that let light through.
#include "base/diagnostic.h"
#include "materials/diffuse_transmission.h"
#include "materials/fresnel.h"
#include "materials/thin_dielectric.h"
#include "sphere_checks.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

BsdfUnderTest pane(const Curve* ior, const Curve* tint) {
    ThinDielectricParams params;
    params.ior = ior;
    params.tint.curve = tint;
    return {"thin-dielectric", makeThinDielectric(params), 0};
}

// Shares of the light that a pane reflects and transmits, from samples: weight times probability.
struct Shares {
    double reflected = 0, transmitted = 0;
};
Shares sharesOf(const Bsdf& bsdf, Vec3 wo) {
    Shares result;
    for (const float lobe : {0.f, kOneMinusEpsilon})
        if (const auto s = bsdf.sample(wo, lobe, {}, Transport::radiance))
            (s->lobe.has(Lobe::reflection) ? result.reflected : result.transmitted) =
                static_cast<double>(s->weight[0]) * static_cast<double>(s->pdfSolidAngle);
    return result;
}

// Ray by ray: what is inside after each face.
Shares bounced(double cosine, double eta, double tint) {
    const double inside = std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
    const double pass = std::pow(tint, 1 / inside);
    const double rs = (cosine - eta * inside) / (cosine + eta * inside);
    const double rp = (inside - eta * cosine) / (inside + eta * cosine), face = (rs * rs + rp * rp) / 2;
    Shares result{face, 0};
    double light = 1 - face;
    for (int i = 0; i < 4000; ++i) {
        light *= pass;
        (i % 2 == 0 ? result.transmitted : result.reflected) += light * (1 - face);
        light *= face;
    }
    return result;
}

TEST_CASE("thin-dielectric: all reflections between the faces, one after the other") {
    for (const double eta : {1.0, 1.33, 1.5, 2.4})
        for (const double tint : {1.0, 0.5, 0.0}) {
            const ConstantCurve n(eta), t(tint);
            const BsdfUnderTest b = pane(&n, &t);
            for (const double angle : {0.0, 30.0, 65.0, 85.0, 89.0}) {
                const Vec3 wo = directionAt(angle);
                const Shares expected = bounced(static_cast<double>(wo.z), eta, tint);
                for (const Vec3 w : {wo, mirrored(wo)}) {
                    const Shares found = sharesOf(*b.bsdf, w);
                    CHECK(found.reflected == doctest::Approx(expected.reflected).epsilon(2e-5));
                    CHECK(found.transmitted == doctest::Approx(expected.transmitted).epsilon(2e-5));
                }
            }
        }
}

TEST_CASE("thin-dielectric: straight on or mirrored, whatever the index of a wavelength, and no interior") {
    static const CauchyCurve flint(1.6, 0.02);
    ThinDielectricParams params;
    params.ior = &flint;
    const BsdfUnderTest b("flint", makeThinDielectric(params), 0, 0, Wavelengths::sample(0.3f));
    CHECK(b.material->ior() == nullptr);
    CHECK(b.material->absorption() == nullptr);
    CHECK(!b.bsdf->lobes().has(Lobe::dispersive));
    for (const Vec3 wo : aroundTheSphere()) {
        const auto r = b.bsdf->sample(wo, 0, {}, Transport::radiance);
        const auto t = b.bsdf->sample(wo, kOneMinusEpsilon, {}, Transport::radiance);
        REQUIRE((r && t));
        CHECK(length(t->wi + wo) == 0);
        CHECK(length(r->wi - Vec3{-wo.x, -wo.y, wo.z}) == 0);
        CHECK(t->eta == 1);
        CHECK(t->lobe == (Lobes(Lobe::delta) | Lobe::transmission));
        for (int lane = 0; lane < kLanes; ++lane) // clear: every wavelength keeps all its light
            CHECK(r->weight[lane] * r->pdfSolidAngle + t->weight[lane] * t->pdfSolidAngle ==
                  doctest::Approx(1).epsilon(2e-6));
    }
    const ConstantCurve extreme(10), nothing(1);
    for (const Curve* n : {static_cast<const Curve*>(&extreme), static_cast<const Curve*>(&nothing)})
        CHECK(heaviestAtExtremes(*pane(n, nullptr).bsdf) < 1.0001f);
}

BsdfUnderTest leaf(const Curve* r, const Curve* t) {
    DiffuseTransmissionParams params;
    params.reflectance.curve = r;
    params.transmittance.curve = t;
    return {"diffuse-transmission", makeDiffuseTransmission(params), 1};
}

TEST_CASE("diffuse-transmission: density, weights, shares, reciprocity") {
    Random random(73);
    const double level = sidak(1e-3, 3 * 8);
    for (const auto& [r, t] : {std::pair{0.3, 0.6}, {0.0, 1.0}, {0.7, 0.0}}) {
        const ConstantCurve reflectance(r), transmittance(t);
        const BsdfUnderTest b = leaf(&reflectance, &transmittance);
        for (const Vec3 wo : aroundTheSphere()) {
            CHECK(chiSquareOfSphere(*b.bsdf, wo, {0, 0, 1}, 1, random, chiSquareSamples()) > level);
            CHECK(sampleAgainstEval(*b.bsdf, wo, random) < 1e-5);
            CHECK(albedoBySampling(*b.bsdf, wo) == doctest::Approx(r + t).epsilon(1e-5));
            const auto through = [&](const BsdfSample& s) {
                return s.lobe.has(Lobe::transmission) ? static_cast<double>(s.weight[0]) : 0.0;
            };
            CHECK(meanOfSamples(*b.bsdf, wo, Transport::radiance, 20000, through) == doctest::Approx(t).epsilon(1e-3));
        }
        CHECK(heaviestAtExtremes(*b.bsdf) < 1.0001f);
        for (int i = 0; i < 1000; ++i) {
            const Vec3 a = squareToSphere({random.uniform(), random.uniform()});
            const Vec3 c = squareToSphere({random.uniform(), random.uniform()});
            const float there = b.bsdf->eval(a, c, Transport::radiance).fcos[0] * std::abs(a.z);
            const float back = b.bsdf->eval(c, a, Transport::importance).fcos[0] * std::abs(c.z);
            CHECK(there == doctest::Approx(back).epsilon(1e-5));
        }
    }
}

TEST_CASE("diffuse-transmission: E0710 where a sheet would give back more than it receives") {
    const ConstantCurve half(0.5), more(0.51), most(0.8);
    const auto faults = [](const Curve* r, const Curve* t) {
        DiffuseTransmissionParams params;
        params.reflectance.curve = r;
        params.transmittance.curve = t;
        Diagnostics diagnostics;
        const bool sound = checkParams(
            params, [](std::string_view) { return Span{}; }, diagnostics);
        CHECK(sound == !diagnostics.hasErrors());
        return diagnostics.hasErrors() ? diagnostics.all().front().code : std::string();
    };
    CHECK(faults(&half, &half).empty());
    CHECK(faults(&half, &more) == "E0710");
    CHECK(faults(&most, nullptr) == "E0710"); // 0.25 is transmitted
    CHECK(faults(nullptr, nullptr).empty());
    static const CauchyCurve bluish(0.4, 0.02); // 0.55 at 360 nm
    CHECK(faults(&bluish, &half) == "E0710");
}

} // namespace
} // namespace abbe
