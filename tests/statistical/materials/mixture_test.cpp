// Materials of materials: mixtures, sheets with two sides. Their parts are proved elsewhere; here it is that nothing of
// them is lost, doubled or made up.
#include "materials/mix.h"
#include "materials/two_sided.h"
#include "sphere_checks.h"
#include "suite.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

const Material& matte() {
    static const auto m = makeDiffuse({{&flat(0.2), nullptr, {}}});
    return *m;
}
const Material& whiteMaterial() {
    static const ConstantCurve one(1);
    static const auto m = makeDiffuse({{&one, nullptr, {}}});
    return *m;
}
const Material& glass(float roughness) {
    static const BsdfUnderTest rough = dielectric(1.5, 0.4f), smooth = dielectric(1.5, 0);
    return *(roughness > 0 ? rough : smooth).material;
}
const Material& metal(double n = 0.2) {
    static const BsdfUnderTest copper = conductor(0.2, 3, 0.3f), lossless = conductor(0, 3, 0.3f);
    return *(n > 0 ? copper : lossless).material;
}
const Material& prism() {
    static const CauchyCurve flint(1.6, 0.02);
    static const BsdfUnderTest rough = dispersiveGlass(flint, 0.4f, Wavelengths::sample(0.3f));
    return *rough.material;
}

MixParams share(double amount) {
    MixParams params;
    params.amount.value = amount;
    return params;
}

std::vector<BsdfUnderTest> mixtures() {
    static const auto inner = makeMix(share(0.35), matte(), metal());
    std::vector<BsdfUnderTest> all;
    all.emplace_back("metal on matte", makeMix(share(0.3), matte(), metal()), 0.09f);
    all.emplace_back("matte on glass", makeMix(share(0.5), glass(1), matte()), 0.16f, 1.5f);
    all.emplace_back("glass on a mix", makeMix(share(0.8), *inner, glass(1)), 0.16f, 1.5f);
    all.emplace_back("matte on dispersive glass", makeMix(share(0.4), prism(), matte()), 0.16f, 1.66f,
                     Wavelengths::sample(0.3f));
    all.emplace_back("metal and matte, two sides", makeTwoSided(metal(), matte()), 0.09f);
    return all;
}

} // namespace

TEST_CASE("mixtures: chi-square of the samples") {
    Random random(111);
    checkChiSquare(mixtures(), random, chiSquareSamples(),
                   [](const auto& b, Vec3 wo, bool upper) { return cellsFor(b, wo, upper); });
}

TEST_CASE("mixtures: sample() returns the weight and the densities that eval() gives, in every lane") {
    Random random(112);
    for (const BsdfUnderTest& b : mixtures())
        for (const Vec3 wo : aroundTheSphere())
            for (const Transport transport : {Transport::radiance, Transport::importance}) {
                const double worst = sampleAgainstEval(*b.bsdf, wo, random, 4000, transport);
                CHECK_MESSAGE(worst < 5e-4 + 4e-6 / std::abs(static_cast<double>(wo.z)), b.name, " wo.z ", wo.z, ": ",
                              worst);
            }
}

TEST_CASE("mixtures: the value is the weighted sum of the parts, and the furnace stays white") {
    Arena arena;
    Random random(113);
    const auto mixed = makeMix(share(0.3), matte(), metal());
    const Wavelengths lambda = Wavelengths::single(550);
    const Bsdf &m = *mixed->bsdf({}, lambda, arena), &a = *matte().bsdf({}, lambda, arena),
               &b = *metal().bsdf({}, lambda, arena);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 wo = squareToSphere({random.uniform(), random.uniform()}),
                   wi = squareToSphere({random.uniform(), random.uniform()});
        const auto f = [&](const Bsdf& x) { return x.eval(wo, wi, Transport::radiance).fcos[0]; };
        CHECK(f(m) == doctest::Approx(0.7f * f(a) + 0.3f * f(b)).epsilon(1e-5));
    }
    for (const double amount : {0.01, 0.5, 0.99})
        for (const double angle : {5.0, 45.0, 80.0}) {
            const BsdfUnderTest lossless("lossless", makeMix(share(amount), whiteMaterial(), metal(0)), 0.09f);
            const double e = meanOfSamples(*lossless.bsdf, directionAt(angle), Transport::radiance, 50000,
                                           [](const BsdfSample& s) { return s.weight[0]; });
            CHECK(e == doctest::Approx(1).epsilon(0.003));
        }
}

TEST_CASE("mixtures with none or all of a part are the other part") {
    Arena arena;
    const Vec3 wo = directionAt(40), wi = directionAt(20, 2);
    for (const double amount : {0.0, 1.0}) {
        const auto m = makeMix(share(amount), matte(), metal());
        const Material& part = amount == 0 ? matte() : metal();
        const Bsdf& b = *m->bsdf({}, Wavelengths::single(550), arena);
        CHECK(b.eval(wo, wi, Transport::radiance).fcos[0] ==
              part.bsdf({}, Wavelengths::single(550), arena)->eval(wo, wi, Transport::radiance).fcos[0]);
    }
}

TEST_CASE("delta lobes in a mixture keep their weight and take their share of the choice (case 39)") {
    const BsdfUnderTest b("matte on polished glass", makeMix(share(0.25), glass(0), matte()), 0, 1.5f);
    const Vec3 wo = directionAt(40), wi = directionAt(20, 2);
    CHECK(b.bsdf->eval(wo, wi, Transport::radiance).pdfSolidAngle == doctest::Approx(0.25 * wi.z / kPiD));
    double through = 0, total = 0, delta = 0;
    const int count = 200000;
    meanOfSamples(*b.bsdf, wo, Transport::importance, count, [&](const BsdfSample& s) {
        if (s.lobe.has(Lobe::delta)) delta += 1;
        if (s.lobe.has(Lobe::delta) && s.lobe.has(Lobe::transmission)) through += s.weight[0];
        total += s.weight[0];
        return 0;
    });
    CHECK(delta / count == doctest::Approx(0.75).epsilon(0.002));
    CHECK(total / count == doctest::Approx(0.75 + 0.25 * 0.2).epsilon(0.002));
    const auto alone = dielectric(1.5, 0);
    const double passes = meanOfSamples(*alone.bsdf, wo, Transport::importance, count, [](const BsdfSample& s) {
        return s.lobe.has(Lobe::transmission) ? s.weight[0] : 0;
    });
    CHECK(through / count == doctest::Approx(0.75 * passes).epsilon(0.002));
}

namespace {

// Keeps the numbers that it is given.
class Probe final : public Bsdf {
  public:
    explicit Probe(std::vector<double>& seen) : seen_(seen) {}
    Lobes lobes() const noexcept override { return Lobes(Lobe::diffuse) | Lobe::reflection; }
    BsdfEval eval(Vec3, Vec3, Transport) const noexcept override { return {Spectrum(1.f), 1}; }
    std::optional<BsdfSample> sample(Vec3, float uLobe, Vec2, Transport) const noexcept override {
        CHECK(uLobe >= 0);
        CHECK(uLobe < 1);
        ++seen_[static_cast<std::size_t>(uLobe * static_cast<float>(seen_.size()))];
        return std::optional<BsdfSample>(std::in_place, Vec3{0, 0, 1}, Spectrum(1.f), 1.f, lobes());
    }

  private:
    std::vector<double>& seen_;
};

} // namespace

TEST_CASE("the number that chooses is even again after ten choices (case 37)") {
    std::vector<double> seen(64), other(64);
    const Probe probe(seen), rest(other);
    std::vector<MixedBsdf> nest;
    nest.reserve(10);
    const Bsdf* inner = &probe;
    for (int i = 0; i < 10; ++i)
        inner = &nest.emplace_back(i % 2 ? *inner : rest, i % 2 ? rest : *inner, i % 2 ? 0.3f : 0.7f);
    Random random(7);
    for (int i = 0; i < 2000000; ++i) inner->sample({0, 0, 1}, random.uniform(), {}, Transport::radiance);
    for (const float edge : {0.f, kOneMinusEpsilon, 0.3f, 0.7f})
        inner->sample({0, 0, 1}, edge, {}, Transport::radiance);
    for (auto* counts : {&seen, &other}) {
        const double total = std::accumulate(counts->begin(), counts->end(), 0.0);
        const std::vector<double> expected(64, total / 64);
        CHECK(chiSquareTest(*counts, expected).pValue > 1e-3);
    }
    const double share = std::accumulate(seen.begin(), seen.end(), 0.0) / 2000004;
    CHECK(share == doctest::Approx(std::pow(0.7, 10)).epsilon(0.02));
}

TEST_CASE("mixtures at every cosine and number are finite") {
    for (const BsdfUnderTest& b : mixtures()) CHECK_MESSAGE(heaviestAtExtremes(*b.bsdf) < kInfinity, b.name);
}

TEST_CASE("the sides of a sheet are their materials, and the back sees itself as an outside") {
    Arena arena;
    const auto card = makeTwoSided(metal(), glass(1)); // not as scenes may: glass tells its sides apart
    const Wavelengths lambda = Wavelengths::single(550);
    const Bsdf &sheet = *card->bsdf({}, lambda, arena), &front = *metal().bsdf({}, lambda, arena),
               &back = *glass(1).bsdf({}, lambda, arena);
    const auto turned = [](Vec3 w) { return Vec3{w.x, -w.y, -w.z}; };
    Random random(114);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 wo = squareToSphere({random.uniform(), random.uniform()}),
                   wi = squareToSphere({random.uniform(), random.uniform()});
        const float f = sheet.eval(wo, wi, Transport::radiance).fcos[0];
        CHECK(f == (wo.z > 0 ? front.eval(wo, wi, Transport::radiance).fcos[0]
                             : back.eval(turned(wo), turned(wi), Transport::radiance).fcos[0]));
    }
    // Where the hit knows how it was met, the geometric normal decides.
    SurfaceHit hit;
    hit.ng = {0, 0, 1};
    hit.arrival = {0, 0, 1};
    const Vec3 wo = directionAt(30), wi = directionAt(50, 1);
    CHECK(card->bsdf(hit, lambda, arena)->eval(mirrored(wo), mirrored(wi), Transport::radiance).fcos[0] ==
          back.eval(turned(mirrored(wo)), turned(mirrored(wi)), Transport::radiance).fcos[0]);
}

} // namespace abbe
