// Materials of materials: mixtures, sheets with two sides. Their parts are proved elsewhere; here it is that nothing of
// them is lost, doubled or made up.
#include "materials/mix.h"
#include "materials/mixed_bsdf.h"
#include "materials/two_sided.h"
#include "suite.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

const Material& matte() {
    static const auto m = makeDiffuse({{&flat(0.2), nullptr, {}}});
    return *m;
}
const Material& white() {
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

std::vector<Vec3> outgoing() {
    std::vector<Vec3> result;
    for (const double a : {0.0, 30.0, 65.0, 85.0})
        result.push_back(directionAt(a)), result.push_back(mirrored(directionAt(a)));
    return result;
}

bool mayScatter(const BsdfUnderTest& b, Vec3 wo, bool upper) { return b.eta != 0 || upper == (wo.z > 0); }

} // namespace

TEST_CASE("mixtures: chi-square of the samples") {
    const auto all = mixtures();
    const double level = sidak(1e-3, static_cast<int>(all.size()) * 16);
    Random random(111);
    for (const BsdfUnderTest& b : all)
        for (const Vec3 wo : outgoing())
            for (const bool upper : {true, false}) {
                if (!mayScatter(b, wo, upper)) continue;
                const auto sample = [&]() -> std::optional<Vec3d> {
                    const float uLobe = random.uniform();
                    const auto s = b.bsdf->sample(wo, uLobe, {random.uniform(), random.uniform()}, Transport::radiance);
                    return s ? std::optional(Vec3d(s->wi)) : std::nullopt;
                };
                const auto pdf = [&](Vec3d wi) {
                    return static_cast<double>(b.bsdf->eval(wo, Vec3(wi), Transport::radiance).pdfSolidAngle);
                };
                const ChiSquareResult r = chiSquareDirections(cellsFor(b, wo, upper), sample, pdf, chiSquareSamples());
                CHECK_MESSAGE(r.pValue > level, b.name, " wo.z ", wo.z, upper ? " up" : " down", ": chi2 ", r.statistic,
                              " with ", r.degrees, " degrees");
            }
}

TEST_CASE("mixtures: sample() returns the weight and the densities that eval() gives, in every lane") {
    Random random(112);
    for (const BsdfUnderTest& b : mixtures())
        for (const Vec3 wo : outgoing())
            for (const Transport transport : {Transport::radiance, Transport::importance}) {
                double worst = 0;
                for (int i = 0; i < 4000; ++i) {
                    const float uLobe = random.uniform();
                    const auto s = b.bsdf->sample(wo, uLobe, {random.uniform(), random.uniform()}, transport);
                    if (!s) continue;
                    const BsdfEval e = b.bsdf->eval(wo, s->wi, transport);
                    const float pdf = s->pdfSolidAngle;
                    worst = std::max(worst, static_cast<double>(std::abs(e.pdfSolidAngle / pdf - 1)));
                    for (int lane = 0; lane < kLanes; ++lane) {
                        const float f = s->weight[lane] * pdf, q = s->pdfRatio[lane] * pdf;
                        worst =
                            std::max(worst, static_cast<double>(std::abs(e.fcos[lane] - f) / std::max(f, 1e-6f * pdf)));
                        worst = std::max(worst, static_cast<double>(std::abs(e.pdfRatio[lane] * e.pdfSolidAngle - q) /
                                                                    std::max(q, 1e-6f * pdf)));
                    }
                    CHECK(s->lobe.has(Lobe::reflection) == (s->wi.z * wo.z > 0));
                    CHECK(b.bsdf->lobes().contains(s->lobe));
                }
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
            const BsdfUnderTest lossless("lossless", makeMix(share(amount), white(), metal(0)), 0.09f);
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
    constexpr float cosines[] = {1, 1e-3f, 1e-8f, 1e-20f, 1e-37f, 1e-38f, 0};
    constexpr float numbers[] = {0, 1e-7f, 0.3f, 0.5f, 0.7f, kOneMinusEpsilon};
    for (const BsdfUnderTest& b : mixtures()) {
        bool good = true;
        for (const float c : cosines)
            for (const float side : {1.f, -1.f})
                for (const float lobe : numbers)
                    for (const float u : numbers)
                        for (const float v : numbers) {
                            const Vec3 wo{std::sqrt(1 - c * c), 0, side * c};
                            for (const Vec3 wi : {wo, -wo, mirrored(wo), Vec3{0, u, v}}) {
                                const BsdfEval e = b.bsdf->eval(wo, wi, Transport::radiance);
                                good = good && allFinite(e.fcos) && allFinite(e.pdfRatio) && e.pdfSolidAngle >= 0;
                            }
                            const auto s = b.bsdf->sample(wo, lobe, {u, v}, Transport::importance);
                            if (s)
                                good = good && allFinite(s->weight) && allFinite(s->pdfRatio) && isFinite(s->wi) &&
                                       s->pdfSolidAngle > 0 && std::isfinite(s->pdfSolidAngle);
                        }
        CHECK_MESSAGE(good, b.name);
    }
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
