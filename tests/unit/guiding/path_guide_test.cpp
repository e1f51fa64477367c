// What a guide has learnt, against the light that it learnt from.
#include "guiding/guide_training.h"
#include "materials/diffuse.h"
#include "math/warp.h"
#include "path_tracing/directed_bsdf.h"

#include <doctest/doctest.h>
#include <functional>
#include <random>

namespace abbe::test {
namespace {

class Numbers {
  public:
    explicit Numbers(unsigned seed) : engine_(seed) {}
    float one() { return std::min(uniform_(engine_), kOneMinusEpsilon); }
    Vec2 two() { return {one(), one()}; }

  private:
    std::mt19937 engine_;
    std::uniform_real_distribution<float> uniform_;
};

// Of a floor of diffuse points of albedo 1, in the unit square, each of which sees this light.
std::vector<PilotVertex> floorUnder(std::size_t count, const std::function<float(Vec3 p, Vec3 w)>& light) {
    Numbers numbers(1);
    std::vector<PilotVertex> list(count);
    for (PilotVertex& v : list) {
        v.p = {numbers.one(), numbers.one(), 0};
        v.w = squareToCosineHemisphere(numbers.two());
        v.face = faceOf({0, 0, 1});
        v.pdf = v.ownPdf = v.scatter = cosineHemispherePdf(v.w.z);
        v.beyond = light(v.p, v.w);
        v.weight = 1;
    }
    return list;
}

// The same floor, under a ceiling at a height of which a disk gives off light.
std::vector<PilotVertex> floorUnderDisk(std::size_t count, Vec3 centre, float radius) {
    std::vector<PilotVertex> list;
    for (PilotVertex v : floorUnder(count, [](Vec3, Vec3) { return 0.f; })) {
        PilotVertex next;
        next.p = v.p + v.w * ((centre.z - v.p.z) / v.w.z);
        next.emission = length(next.p - centre) < radius ? 10 : 0.01f;
        v.goesOn = true;
        v.carried = 1;
        list.push_back(v);
        list.push_back(next);
    }
    return list;
}

PathGuide::View viewFrom(const PathGuide& guide, Vec3 p) {
    const PathGuide::View view = guide.at(p, faceOf({0, 0, 1}));
    REQUIRE(view);
    return view;
}

// ∫ pdf dω over midpoints of squares of equal area on the sphere.
double integral(const PathGuide::View& view) {
    constexpr int kCells = 3000;
    double sum = 0;
    for (int i = 0; i < kCells; ++i)
        for (int k = 0; k < kCells; ++k) {
            const Vec2 u{(static_cast<float>(i) + 0.5f) / kCells, (static_cast<float>(k) + 0.5f) / kCells};
            sum += static_cast<double>(view.look(squareToSphere(u)).pdf);
        }
    return sum * 4 * static_cast<double>(kPi) / (kCells * kCells);
}

// Directions drawn, by cells of the sphere, against what the density says of them, by as many even directions.
void checkDraws(const PathGuide::View& view) {
    constexpr int kDraws = 400000, kSide = 8;
    const auto cell = [](Vec3 w) {
        const Vec2 u = sphereToSquare(w);
        return std::min<std::size_t>(kSide - 1, static_cast<std::size_t>(kSide * u.x)) * kSide +
               std::min<std::size_t>(kSide - 1, static_cast<std::size_t>(kSide * u.y));
    };
    std::array<double, kSide * kSide> drawn{}, told{}, squares{};
    Numbers numbers(3);
    int apart = 0;
    for (int i = 0; i < kDraws; ++i) {
        const PathGuide::Direction d = view.sample(numbers.two());
        drawn[cell(d.w)] += 1;
        const PathGuide::Direction again = view.look(d.w);
        apart += std::abs(again.pdf - d.pdf) > 1e-3f * d.pdf; // next to the edge of a square they may differ
        const Vec3 even = squareToSphere(numbers.two());
        const double weight = static_cast<double>(view.look(even).pdf / kSpherePdf);
        told[cell(even)] += weight;
        squares[cell(even)] += weight * weight;
    }
    CHECK(apart < kDraws / 1000);
    for (std::size_t i = 0; i < drawn.size(); ++i)
        CHECK(std::abs(drawn[i] - told[i]) < 5 * std::sqrt(drawn[i] + squares[i] + 1));
}

} // namespace

TEST_CASE("directions and their places on the squares are each other's inverse, with the areas that are told") {
    Numbers numbers(2);
    double area = 0;
    for (int i = 0; i < 100000; ++i) {
        const SphereSquare from{numbers.one() < 0.5f, numbers.two()};
        const Vec3 w = normalize(from.onOctahedron());
        CHECK(length(w) == doctest::Approx(1).epsilon(1e-5));
        const SphereSquare back = PathGuide::seen({}, w).at;
        CHECK(back.upper == from.upper);
        CHECK(back.u.x == doctest::Approx(from.u.x).epsilon(2e-4));
        CHECK(back.u.y == doctest::Approx(from.u.y).epsilon(2e-4));
        // Two squares together have the area 2 and 4π sr.
        area += 1 / static_cast<double>(PathGuide::seen({}, w).area);
    }
    CHECK(2 * area / 100000 == doctest::Approx(4 * static_cast<double>(kPi)).epsilon(0.005));
}

TEST_CASE("a guide finds a small source at infinity, and draws directions with the density that it tells") {
    // A cone of 0.05 sr about a direction, another one in the other half of space; all else is dim.
    const Vec3 left = normalize(Vec3(-1, 0.5f, 0.8f)), right = normalize(Vec3(1, 0.2f, 0.5f));
    const float cosine = 1 - 0.05f / (2 * kPi);
    const TrainedGuide trained = trainGuide(
        floorUnder(100000, [&](Vec3 p, Vec3 w) { return dot(w, p.x < 0.5f ? left : right) > cosine ? 10 : 0.01f; }), 1);
    CHECK(trained.gain > 0);
    for (const Vec3 p : {Vec3(0.2f, 0.5f, 0), Vec3(0.8f, 0.1f, 0)}) {
        const PathGuide::View view = viewFrom(trained.guide, p);
        const Vec3 source = p.x < 0.5f ? left : right;
        CHECK(view.guided() >= 0.75f);
        CHECK(view.region().nearness == 0);
        CHECK(view.look(source).pdf > 5);
        CHECK(view.look(source).radiance > 4); // its square is larger than the cone
        CHECK(integral(view) == doctest::Approx(1).epsilon(0.004));
        checkDraws(view);
    }
}

// Every column and every row of a hemisphere's square has a quarter of it: what is drawn, over its density on the
// square. All directions together would not show a part that is drawn too often, as others are drawn too rarely.
TEST_CASE("parts of squares are drawn as often as their density tells, to four thousandths") {
    const TrainedGuide trained = trainGuide(floorUnder(100000, [](Vec3, Vec3 w) { return w.x > 0 ? 2.f : 1.f; }), 1);
    const PathGuide::View view = viewFrom(trained.guide, {0.2f, 0.5f, 0});
    std::array<double, 4> columns{}, rows{};
    int below = 0;
    Numbers numbers(9);
    constexpr int kDraws = 16'000'000;
    for (int i = 0; i < kDraws; ++i) {
        const PathGuide::Direction d = view.sample(numbers.two());
        const auto [at, area] = PathGuide::seen({}, d.w);
        below += !at.upper;
        const double weight = static_cast<double>(area / d.pdf) / kDraws;
        columns[static_cast<std::size_t>(4 * at.u.x)] += weight;
        rows[static_cast<std::size_t>(4 * at.u.y)] += weight;
    }
    CHECK(below == 0); // no light comes from there
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(std::abs(columns[i] / 0.25 - 1) < 0.004);
        CHECK(std::abs(rows[i] / 0.25 - 1) < 0.004);
    }
}

// A matte surface of albedo a that is lit evenly shows a, whatever share of its directions a guide gives: the mean
// weight of a direction. A share or a density that is told a hundredth too large shows at once.
TEST_CASE("directions of surface and guide together are found with the density that is told, to a thousandth") {
    const Vec3 source = normalize(Vec3(-1, 0.5f, 0.8f));
    const float cosine = 1 - 0.05f / (2 * kPi);
    const TrainedGuide trained =
        trainGuide(floorUnder(100000, [&](Vec3, Vec3 w) { return dot(w, source) > cosine ? 10 : 0.01f; }), 1);
    const PathGuide::View view = viewFrom(trained.guide, {0.2f, 0.5f, 0});
    REQUIRE(view.guided() > 0.5f);
    const auto material = makeDiffuse({}); // of albedo 0.5
    Arena arena;
    const Bsdf& own = *material->bsdf({}, Wavelengths::single(550), arena);
    const Frame upright = Frame::fromNormal({0, 0, 1});
    const Vec3 wo = normalize(Vec3(0.3f, 0.1f, 0.9f));
    constexpr int kDraws = 2'000'000;
    Numbers numbers(6);
    double sum = 0;
    for (int i = 0; i < kDraws; ++i) {
        const float lobe = numbers.one();
        const GuidedSample drawn = GuidedSample::of(view, own, upright, 1, wo, lobe, numbers.two());
        if (!drawn.next) continue;
        sum += static_cast<double>(drawn.next->weight[0]);
        if (i % 1000 > 0) continue;
        const Vec3 w = upright.toWorld(drawn.next->wi);
        const float matte = cosineHemispherePdf(drawn.next->wi.z);
        CHECK(drawn.ownPdf == doctest::Approx(matte).epsilon(1e-4));
        CHECK(view.mixed(matte, w) == doctest::Approx(drawn.next->pdfSolidAngle).epsilon(0.002));
    }
    CHECK(sum / kDraws == doctest::Approx(0.5).epsilon(0.0015));
}

TEST_CASE("a guide follows a source that is near, from where it was learnt and from farther away") {
    const Vec3 centre{0.3f, 0.6f, 0.5f};
    const TrainedGuide trained = trainGuide(floorUnderDisk(60000, centre, 0.1f), 1);
    bool anyNear = false;
    for (const Vec3 p : {Vec3(0.1f, 0.1f, 0), Vec3(0.3f, 0.6f, 0), Vec3(0.9f, 0.8f, 0), Vec3(1.2f, -0.3f, 0)}) {
        const PathGuide::View view = viewFrom(trained.guide, p);
        anyNear = anyNear || view.region().nearness > 0;
        if (p.x < 1) CHECK(view.look(normalize(centre - p)).pdf > 2);
        CHECK(integral(view) == doctest::Approx(1).epsilon(0.004));
        checkDraws(view);
    }
    CHECK(anyNear);
}

TEST_CASE(
    "where lights are not seen few shadow rays are sent, and places in media have regions of their own with all") {
    std::vector<PilotVertex> vertices = floorUnder(40000, [](Vec3, Vec3 w) { return w.z > 0.95f ? 10.f : 0.01f; });
    for (std::size_t i = 0; i < vertices.size(); i += 2) vertices[i].face = kInMedium;
    const TrainedGuide trained = trainGuide(vertices, 1);
    const Vec3 p{0.5f, 0.5f, 0};
    CHECK(viewFrom(trained.guide, p).lights() == doctest::Approx(0.1));
    REQUIRE(trained.guide.at(p, kInMedium));
    CHECK(trained.guide.at(p, kInMedium).lights() == 1);
    CHECK(!trained.guide.at(p, faceOf({1, 0, 0})));
}

TEST_CASE("a share of shadow rays counts as often as it is rarely sent") {
    // Those of every fourth vertex, which are told: the square of what they bring is four times as much too often.
    std::vector<PilotVertex> vertices = floorUnder(40000, [](Vec3, Vec3) { return 1.f; }), rare = vertices;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        vertices[i].lit = 0.1f;
        rare[i].lit = i % 4 == 0 ? 0.4f : 0;
        rare[i].lightShare = 0.25f;
    }
    const Vec3 p{0.5f, 0.5f, 0};
    const float share = viewFrom(trainGuide(vertices, 1).guide, p).lights();
    CHECK(share > 0.15f);
    CHECK(share < 0.9f);
    CHECK(viewFrom(trainGuide(rare, 1).guide, p).lights() == doctest::Approx(share).epsilon(0.05));
}

TEST_CASE("where light comes from all over a guide is not used") {
    const TrainedGuide trained = trainGuide(floorUnder(40000, [](Vec3, Vec3) { return 1.f; }), 1);
    for (const PathGuide::Region& r : trained.guide.regions()) CHECK(r.guided == 0);
    CHECK(trained.gain == 0);
}

TEST_CASE("light spreads through cells along paths, of which each has found next to nothing") {
    // From a floor to a ceiling and back to the floor: the ceiling is lit by 2 at every tenth vertex, and passes on
    // half of what arrives; the floor is dark and passes on a quarter.
    Numbers numbers(4);
    std::vector<PilotVertex> vertices;
    for (int path = 0; path < 20000; ++path)
        for (int i = 0; i < 3; ++i) {
            PilotVertex v;
            v.p = {numbers.one(), numbers.one(), i == 1 ? 1.f : 0.f};
            v.face = faceOf({0, 0, i == 1 ? -1.f : 1.f});
            v.spreads = true;
            v.goesOn = i < 2;
            v.lit = i == 1 && path % 10 == 0 ? 20 : 0;
            v.carried = i == 1 ? 0.5f : i == 0 ? 0.25f : 0;
            vertices.push_back(v);
        }
    // Ceiling C = 2 + F / 2, floor F = C / 8 in the mean of vertices of which one of two goes on.
    const double ceiling = 2 / (1 - 1.0 / 16);
    const GivenOff given(vertices);
    double mean = 0;
    for (std::size_t i = 0; i < vertices.size(); i += 3) mean += static_cast<double>(given.arriving(i)) / 20000;
    CHECK(mean == doctest::Approx(ceiling).epsilon(0.02));
}

} // namespace abbe::test
