// Light paths at every material against camera paths there: both directions must carry the same light.
#include "materials/diffuse_transmission.h"
#include "materials/hair.h"
#include "materials/layered.h"
#include "materials/mix.h"
#include "materials/sheen.h"
#include "materials/subsurface.h"
#include "materials/thin_dielectric.h"
#include "materials/two_sided.h"
#include "math/frame.h"
#include "path_tracing/directed_bsdf.h"
#include "render/light_vertex.h"
#include "statistical/materials/openpbr_suite.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

const ConstantCurve kGrey(0.7), kFree(0.001), kTint(0.6);

// Turns its normal for whoever looks, as bumps do.
class Bumped final : public Material {
  public:
    explicit Bumped(const Material& inner) : inner_(inner) { traits_ = {.bends = true}; }
    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& w, Arena& arena) const noexcept override {
        return inner_.bsdf(hit, w, arena);
    }
    void bend(SurfaceHit& hit) const noexcept override {
        const Vec3 n = consistentNormal(hit.ng, normalize(hit.shading.z + Vec3{0.5f, -0.3f, 0}), -hit.arrival);
        hit.shading = Frame::fromNormalTangent(n, hit.shading.x);
    }

  private:
    const Material& inner_;
};

struct Surface {
    std::string name;
    const Material* material;
    Wavelengths wavelengths = Wavelengths::single(550);
};

// Every material of the language but hair, which has no light paths, and those that only hold or dress another.
class Surfaces {
  public:
    Surfaces() {
        const Material& matte = add("diffuse", makeDiffuse({{&kGrey, nullptr, {}}}));
        const Material& glass = add("dielectric", std::move(dielectric(1.5, 0).material));
        const Material& frosted = add("rough dielectric", std::move(dielectric(1.5, 0.6f).material));
        const Material& mirror = add("conductor", std::move(conductor(0.2, 3, 0).material));
        const Material& metal = add("rough conductor", std::move(conductor(0.2, 3, 0.8f).material));
        add("stretched conductor", std::move(conductor(0.2, 3, 0.6f, 0.8f).material));
        add("thin dielectric", makeThinDielectric({nullptr, {&kTint, nullptr, {}}}));
        const Material& paper = add("diffuse transmission", makeDiffuseTransmission({{&flat(0.2), nullptr, {}}, {}}));
        add("sheen", makeSheen({{}, {&kGrey, nullptr, {}}, {0.4, nullptr, {}}}));
        addDispersive();
        addSubsurface("dielectric", 0.3);
        addSubsurface("diffuse", 0);
        addSubsurface("diffuse", 0.4);
        for (const double roughness : {0.0, 0.4}) {
            LayeredParams coat;
            coat.ior = &flat(1.5);
            coat.roughness.value = roughness;
            coat.tint.curve = &kTint;
            for (const Material* base : {&matte, &mirror, &glass, &frosted, &paper})
                add(fmt::format("layered, {}, on {}", roughness, nameOf(base)), makeLayered(coat, *base));
        }
        add("mix of mirror and glass", makeMix({{}, {}, {0.3, nullptr, {}}}, mirror, glass));
        add("mix of metal and matte", makeMix({{}, {}, {0.6, nullptr, {}}}, metal, matte));
        add("two-sided, opaque", makeTwoSided(metal, matte));
        add("two-sided, letting light through", makeTwoSided(paper, matte));
        add("bumped matte", std::make_unique<Bumped>(matte));
        add("bumped metal", std::make_unique<Bumped>(metal));
        add("bumped glass", std::make_unique<Bumped>(glass));
        addOpenPbr();
    }
    const std::vector<Surface>& all() const { return all_; }

  private:
    const Material& add(std::string name, std::unique_ptr<const Material> made) {
        all_.push_back({std::move(name), made.get()});
        return *owned_.emplace_back(std::move(made));
    }
    std::string nameOf(const Material* m) const {
        for (const Surface& s : all_)
            if (s.material == m) return s.name;
        return "";
    }
    void addDispersive() {
        static const CauchyCurve flint(1.6, 0.02);
        for (const float roughness : {0.f, 0.5f}) {
            const Wavelengths w = Wavelengths::sample(0.3f);
            add(fmt::format("dispersive glass {}", roughness),
                std::move(dispersiveGlass(flint, roughness, w).material));
            all_.back().wavelengths = w;
        }
    }
    void addSubsurface(std::string boundary, double roughness) {
        SubsurfaceParams p;
        p.reflectance = &kGrey;
        p.meanFreePath = &kFree;
        p.ior = &flat(1.5);
        p.roughness.value = roughness;
        p.boundary.word = boundary;
        add(fmt::format("subsurface, {} {}", boundary, roughness), makeSubsurfaceSurface(p));
    }
    void addOpenPbr() {
        OpenPbrParams p;
        add("openpbr", makeOpenPbr(p));
        p.coatWeight = number(1);
        p.coatColor = color(kTint);
        p.fuzzWeight = number(0.5);
        add("openpbr, coat and fuzz", makeOpenPbr(p));
        p.geometryCoatNormal = number(0);
        p.coatRoughness = number(0);
        add("openpbr, polished coat with its own normal", makeOpenPbr(p));
        p = {};
        p.subsurfaceWeight = number(1);
        p.coatWeight = number(0.5);
        p.coatColor = color(kTint);
        add("openpbr, subsurface under a coat", makeOpenPbr(p));
        for (const double roughness : {0.0, 0.4}) {
            p = {};
            p.transmissionWeight = number(0.8);
            p.specularRoughness = number(roughness);
            p.coatWeight = number(0.6);
            p.coatColor = color(kTint);
            p.fuzzWeight = number(0.3);
            add(fmt::format("openpbr, glass {} under coat and fuzz", roughness), makeOpenPbr(p));
        }
        for (const double roughness : {0.0, 0.4}) {
            p = {};
            p.geometryThinWalled = true;
            p.transmissionWeight = number(0.7);
            p.specularRoughness = number(roughness);
            p.coatWeight = number(0.5);
            p.coatColor = color(kTint);
            add(fmt::format("openpbr, sheet {} under a coat", roughness), makeOpenPbr(p));
        }
        for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
            const OpenPbrParams q = random_(seed % 2 == 0, seed % 3 != 0, seed > 3);
            add("openpbr " + describe(q), makeOpenPbr(q));
        }
    }

    RandomOpenPbr random_{77};
    std::vector<std::unique_ptr<const Material>> owned_;
    std::vector<Surface> all_;
};

const std::vector<Surface>& surfaces() {
    static const Surfaces all;
    return all.all();
}

// Its shading normal leans by `lean`.
SurfaceHit metFrom(const Surface& s, Vec3 arrival, double lean) {
    SurfaceHit hit;
    hit.ng = {0, 0, 1};
    hit.localNormal = {0, 0, 1};
    hit.shading =
        Frame::fromNormalTangent(Vec3(Vec3d{std::sin(lean) * 0.6, std::sin(lean) * 0.8, std::cos(lean)}), {1, 0, 0});
    hit.dpdu = {1, 0, 0};
    hit.dpdv = {0, 1, 0};
    hit.material = s.material;
    hit.arrival = arrival;
    return hit;
}

// What the eye looks for, and the light that there is.
double eyes(Vec3 w) { return static_cast<double>(1 + 0.6f * w.x + 0.5f * w.y * w.z + 0.3f * w.z); }
double lights(Vec3 w) { return static_cast<double>(1.1f - 0.5f * w.x + 0.3f * w.y + 0.4f * w.z * w.z - 0.4f * w.z); }

// Room for a vertex and what it makes.
struct Arenas {
    Arena own, eye;
    SurfaceHit hit;
    LightVertex vertex(const Surface& s, double lean, Vec3 from) {
        own.reset();
        hit = metFrom(s, -from, lean);
        return {hit, s.wavelengths, own, eye};
    }
};

struct Found {
    double value = 0;  // light times what the eye looks for, over the density
    double weight = 1; // by the balance heuristic, against the path the other way
};

// One camera path that comes from `away`, as the path loop goes on: what it gathers, of the hero's wavelength.
Found gathered(const Surface& s, double lean, Vec3 away, Random& random, Arenas& arenas) {
    SurfaceHit hit = metFrom(s, -away, lean);
    if (s.material->bends()) s.material->bend(hit);
    arenas.own.reset();
    const Bsdf& bsdf = *s.material->bsdf(hit, s.wavelengths, arenas.own);
    const Vec3 wo = hit.shading.toLocal(away);
    const float lobe = random.uniform();
    const auto next = bsdf.sample(wo, lobe, {random.uniform(), random.uniform()}, Transport::radiance);
    if (!next) return {};
    const Vec3 from = hit.shading.toWorld(next->wi);
    if ((away.z * from.z > 0) != (wo.z * next->wi.z > 0)) return {};
    const LightVertex light = arenas.vertex(s, lean, from);
    const LightScattering there =
        next->lobe.has(Lobe::delta) ? light.deltaTowards(away, 1 / next->eta) : light.towards(away);
    const double own = static_cast<double>(there.pdfReverse), other = static_cast<double>(there.pdfSolidAngle);
    return {eyes(away) * lights(from) * static_cast<double>(next->weight[0]), own / (own + other)};
}

// One light path that comes from `from`: what it brings.
Found brought(const Surface& s, double lean, Vec3 from, Random& random, Arenas& arenas) {
    const LightVertex vertex = arenas.vertex(s, lean, from);
    const float lobe = random.uniform();
    const auto next = vertex.sample(lobe, {random.uniform(), random.uniform()});
    if (!next) return {};
    const LightScattering& there = next->scattering;
    const double own = static_cast<double>(there.pdfSolidAngle), other = static_cast<double>(there.pdfReverse);
    return {eyes(next->away) * lights(from) * static_cast<double>(there.fcos[0]) / own, own / (own + other)};
}

// The same with directions drawn evenly, for what is no delta lobe.
Found connected(const Surface& s, double lean, Vec3 from, Random& random, Arenas& arenas) {
    const LightVertex vertex = arenas.vertex(s, lean, from);
    const Vec3 away = squareToSphere({random.uniform(), random.uniform()});
    return {eyes(away) * lights(from) * static_cast<double>(vertex.towards(away).fcos[0]) * 4 * kPiD};
}

struct Means {
    Moments whole, weighted;
};

// Over directions of the one end, drawn evenly; |cosine| to the geometric normal makes radiance flux.
template <typename Path> Means meansOf(const Surface& s, double lean, int samples, Path&& path) {
    Random random(41);
    Arenas arenas;
    Means result;
    for (int i = 0; i < samples; ++i) {
        const Vec3 w = squareToSphere({random.uniform(), random.uniform()});
        const Found found = path(s, lean, w, random, arenas);
        const double value = 2 * static_cast<double>(std::abs(w.z)) * found.value;
        result.whole.add(value);
        result.weighted.add(value == 0 ? 0 : value * found.weight);
    }
    return result;
}

// Two-sided p-value that a and the sum of b and c have the same mean.
double sumTest(const Moments& a, const Moments& b, const Moments& c) {
    const double error = std::hypot(a.standardError(), std::hypot(b.standardError(), c.standardError()));
    return normalTwoSided((a.mean() - b.mean() - c.mean()) / error);
}

TEST_CASE("light paths bring to the eye what camera paths gather, whatever scatters" * doctest::test_suite("sweep")) {
    const int samples = chiSquareSamples() / 8;
    const double level = sidak(1e-3, static_cast<int>(surfaces().size()) * 6);
    for (const Surface& s : surfaces())
        for (const double lean : {0.0, 0.4}) {
            CAPTURE(s.name);
            CAPTURE(lean);
            const Means camera = meansOf(s, lean, samples, gathered), light = meansOf(s, lean, samples, brought);
            INFO(camera.whole.mean(), " ± ", camera.whole.standardError(), " against ", light.whole.mean(), " ± ",
                 light.whole.standardError(), " and ", camera.weighted.mean(), " + ", light.weighted.mean());
            // Together they have everything; alone, light paths miss what light does not see of the surface.
            CHECK(sumTest(camera.whole, camera.weighted, light.weighted) > level);
            CHECK(light.weighted.mean() > 0.1 * camera.whole.mean());
            if (!s.material->bends()) CHECK(sameMeanTest(camera.whole, light.whole) > level);
            Arenas arenas;
            if (arenas.vertex(s, 0, {0, 0, 1}).bsdf().lobes().has(Lobe::delta)) continue;
            const Means met = meansOf(s, lean, samples, connected);
            INFO("connected ", met.whole.mean(), " ± ", met.whole.standardError());
            CHECK(sameMeanTest(camera.whole, met.whole) > level);
        }
}

TEST_CASE("the way a path runs changes no direction, no density, and of weights the square of the index alone") {
    Random random(42);
    for (const Surface& s : surfaces())
        for (int i = 0; i < 2000; ++i) {
            Arena arena;
            const SurfaceHit hit = metFrom(s, -squareToSphere({random.uniform(), random.uniform()}), 0);
            const Bsdf& bsdf = *s.material->bsdf(hit, s.wavelengths, arena);
            const float lobe = random.uniform();
            const Vec2 u{random.uniform(), random.uniform()};
            const Vec3 wo = hit.shading.toLocal(-hit.arrival);
            const auto eye = bsdf.sample(wo, lobe, u, Transport::radiance),
                       light = bsdf.sample(wo, lobe, u, Transport::importance);
            REQUIRE(eye.has_value() == light.has_value());
            if (!eye) continue;
            CHECK(eye->wi == light->wi);
            CHECK(eye->pdfSolidAngle == light->pdfSolidAngle);
            CHECK(eye->weight[0] * square(eye->eta) == doctest::Approx(light->weight[0]).epsilon(1e-5));
            if (eye->lobe.has(Lobe::delta)) continue;
            CHECK(bsdf.eval(wo, eye->wi, Transport::radiance).pdfSolidAngle ==
                  bsdf.eval(wo, eye->wi, Transport::importance).pdfSolidAngle);
        }
}

// What the camera path's Bsdf says of light from `from`, per projected solid angle of both ends.
double seenByEye(const Surface& s, double lean, Vec3 away, Vec3 from, Arena& arena) {
    SurfaceHit hit = metFrom(s, -away, lean);
    if (s.material->bends()) s.material->bend(hit);
    arena.reset();
    const Bsdf& bsdf = *s.material->bsdf(hit, s.wavelengths, arena);
    const Vec3 wo = hit.shading.toLocal(away), wi = hit.shading.toLocal(from);
    if ((away.z * from.z > 0) != (wo.z * wi.z > 0)) return 0;
    return static_cast<double>(bsdf.eval(wo, wi, Transport::radiance).fcos[0] / std::abs(from.z));
}

TEST_CASE("light that goes on from a light path is the light that the eye sees from there") {
    Random random(44);
    Arenas arenas;
    Arena arena;
    int lit = 0;
    for (const Surface& s : surfaces())
        for (const double lean : {0.0, 0.4})
            for (int i = 0; i < 500; ++i) {
                CAPTURE(s.name);
                const Vec3 from = squareToSphere({random.uniform(), random.uniform()}),
                           away = squareToSphere({random.uniform(), random.uniform()});
                const double seen = seenByEye(s, lean, away, from, arena);
                const double sent = static_cast<double>(arenas.vertex(s, lean, from).towards(away).fcos[0]) /
                                    static_cast<double>(std::abs(away.z));
                CHECK(std::abs(sent - seen) <= 1e-4 * seen);
                lit += seen > 0;
            }
    CHECK(lit > 10'000);
}

// Of delta samples from one direction: how many went one way, and what they brought.
struct Way {
    Vec3 wi;
    double count = 0, weight = 0;
};

// Every surface, and again with a share of directions drawn evenly.
std::vector<std::pair<Surface, float>> alsoEvenly() {
    std::vector<std::pair<Surface, float>> all;
    for (const float even : {0.f, 0.3f, 1.f})
        for (const Surface& s : surfaces()) all.emplace_back(s, even);
    return all;
}

TEST_CASE("delta lobes: the probability and the ratio of two directions are those of samples from either") {
    constexpr int kSamples = 4096;
    int ways = 0;
    for (const auto& [s, even] : alsoEvenly())
        for (const Vec3 wo :
             {directionAt(20), directionAt(70, 2), mirrored(directionAt(20)), mirrored(directionAt(35, 1))}) {
            Arena arena;
            const SurfaceHit hit = metFrom(s, -wo, 0);
            const Bsdf& own = *s.material->bsdf(hit, s.wavelengths, arena);
            const Bsdf& bsdf = even > 0 ? *arena.make<DefensiveBsdf>(own, 1.f, even) : own;
            std::vector<Way> found;
            for (int i = 0; i < kSamples; ++i) {
                const float lobe = (static_cast<float>(i) + 0.5f) / kSamples;
                const auto next = bsdf.sample(wo, lobe, {0.5f, 0.5f}, Transport::radiance);
                if (!next || !next->lobe.has(Lobe::delta)) continue;
                auto way = std::ranges::find_if(found, [&](const Way& w) { return length(w.wi - next->wi) < 1e-4f; });
                if (way == found.end()) way = found.insert(found.end(), {next->wi});
                way->count += 1.0 / kSamples;
                way->weight += static_cast<double>(next->weight[0]) / kSamples;
            }
            for (const Way& way : found) {
                ++ways;
                CAPTURE(s.name);
                const DeltaEval there = bsdf.evalDelta(wo, way.wi);
                CHECK(std::abs(static_cast<double>(there.probability) - way.count) < 2.0 / kSamples);
                CHECK(static_cast<double>(there.ratio[0]) == doctest::Approx(way.weight).epsilon(0.01).scale(0.1));
                // The way back is one, too, and nowhere else does any lead.
                const SurfaceHit back = metFrom(s, -way.wi, 0);
                CHECK(s.material->bsdf(back, s.wavelengths, arena)->evalDelta(way.wi, wo).probability > 0);
                CHECK(bsdf.evalDelta(wo, normalize(way.wi + Vec3{0.01f, 0.02f, 0})).probability == 0);
            }
        }
    CHECK(ways > 180);
}

TEST_CASE("both densities of a light path's step are those of the samplers, and finite at grazing angles") {
    Random random(43);
    Arenas arenas, others;
    for (const Surface& s : surfaces())
        for (int i = 0; i < 1000; ++i) {
            CAPTURE(s.name);
            const Vec3 from = i % 2 ? squareToSphere({random.uniform(), random.uniform()})
                                    : normalize(Vec3{1, random.uniform(), 1e-4f * (random.uniform() - 0.5f)});
            const LightVertex vertex = arenas.vertex(s, 0.2, from);
            const float lobe = random.uniform();
            const auto next = vertex.sample(lobe, {random.uniform(), random.uniform()});
            if (!next) continue;
            const LightScattering there = next->scattering;
            CHECK((allFinite(there.fcos / there.pdfSolidAngle) && there.pdfSolidAngle < kInfinity));
            CHECK((there.pdfReverse >= 0 && there.pdfReverse < kInfinity));
            if (i % 2 == 0) continue;
            // A camera path the other way, at a vertex of its own.
            const LightVertex camera = others.vertex(s, 0.2, next->away);
            if (next->lobe.has(Lobe::delta)) {
                const LightScattering back = camera.deltaTowards(from, 1 / next->eta);
                CHECK(there.pdfSolidAngle * back.pdfSolidAngle ==
                      doctest::Approx(there.pdfReverse * back.pdfReverse).epsilon(1e-4));
            } else {
                CHECK(vertex.towards(next->away).pdfReverse == doctest::Approx(camera.towards(from).pdfSolidAngle));
                CHECK(vertex.towards(next->away).pdfSolidAngle == doctest::Approx(camera.towards(from).pdfReverse));
            }
        }
}

TEST_CASE("refraction spreads solid angles as its directions move") {
    const BsdfUnderTest glass = dielectric(1.5, 0);
    const Surface s{"glass", glass.material.get()};
    Arenas arenas;
    for (const double lean : {0.0, 0.3})
        for (const Vec3 from :
             {directionAt(15), directionAt(50, 2), mirrored(directionAt(8)), mirrored(directionAt(15, 1))}) {
            const auto through = [&](Vec3 w) { return arenas.vertex(s, lean, w).sample(0.999f, {0.5f, 0.5f}); };
            const Frame about = Frame::fromNormal(from);
            const auto moved = [&](Vec3 axis) {
                const float step = 2e-3f;
                const auto a = through(normalize(from + axis * step)), b = through(normalize(from - axis * step));
                REQUIRE((a && b));
                return (a->away - b->away) * (0.5f / step);
            };
            const auto at = through(from);
            REQUIRE(at);
            REQUIRE(at->lobe.has(Lobe::transmission));
            const float spread = length(cross(moved(about.x), moved(about.y)));
            const LightScattering back = arenas.vertex(s, lean, at->away).deltaTowards(from, 1 / at->eta);
            CHECK(at->scattering.pdfReverse / back.pdfSolidAngle == doctest::Approx(spread).epsilon(2e-3));
        }
}

TEST_CASE("light paths end at hair, alone or as a part") {
    const auto hair = makeHair({}), matte = makeDiffuse({});
    CHECK_FALSE(hair->reversible());
    CHECK_FALSE(makeMix({{}, {}, {0.5, nullptr, {}}}, *matte, *hair)->reversible());
    CHECK_FALSE(makeMix({{}, {}, {0.5, nullptr, {}}}, *hair, *matte)->reversible());
    CHECK_FALSE(makeTwoSided(*matte, *hair)->reversible());
    CHECK_FALSE(makeTwoSided(*hair, *matte)->reversible());
    LayeredParams coat;
    coat.ior = &flat(1.5);
    CHECK_FALSE(makeLayered(coat, *hair)->reversible());
    for (const Surface& s : surfaces()) CHECK(s.material->reversible());
}

} // namespace
} // namespace abbe
