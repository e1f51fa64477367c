#include "film/error_certificate.h"
#include "film/error_figure.h"
#include "film/layer_planes.h"
#include "spectrum/color_space.h"
#include "support/certificate_coverage.h"

#include <cmath>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <random>

namespace abbe::test {

namespace {

constexpr PixelBounds kBounds{0, 0, 40, 33}; // the last tiles are cut

// A display with a curve like that of sRGB.
ErrorCertificate::Picture picture() {
    ErrorCertificate::Picture p;
    p.display = [](std::span<float> rgb) {
        for (float& v : rgb) v = std::pow(std::max(v, 0.0f), 1 / 2.2f);
    };
    return p;
}

// Brightness over the picture, 0.02 to 1.
double truth(int x, int y) { return 0.02 + 0.98 * (x / 39.0) * (0.5 + 0.5 * std::sin(y * 0.4)); }

// One sample of a pixel whose mean is 1.
using Draw = double (*)(std::mt19937&);

double normalDraw(std::mt19937& random) { return std::normal_distribution<double>(1, 0.5)(random); }
double logNormalDraw(std::mt19937& random) { return std::lognormal_distribution<double>(-0.5, 1)(random); }
// One of a hundred carries a tenth, or half of the light.
double oneInAHundred(std::mt19937& random, double share) {
    return std::uniform_int_distribution<int>(0, 99)(random) == 0 ? 1 + 99 * share : 1 - share;
}
double fireflyDraw(std::mt19937& random) { return oneInAHundred(random, 0.1); }
// One of 4000 carries something, of sizes that fall as those of a glossy lobe do: a seventh of the light in all.
double glossyDraw(std::mt19937& random) {
    if (std::uniform_int_distribution<int>(0, 3999)(random) != 0)
        return std::normal_distribution<double>(0.86, 0.1)(random);
    constexpr double kShape = 0.55;
    const double p = 1 - std::uniform_real_distribution<double>(0, 1)(random);
    return 0.86 + 4000 * 0.14 * (1 - kShape) * std::pow(p, -kShape);
}
double unseenDraw(std::mt19937& random) { return oneInAHundred(random, 0.5); }

PixelFilm makeFilm(Draw draw, unsigned seed, int replicates, std::uint32_t samples) {
    std::mt19937 random(seed);
    PixelFilm film(kBounds, {FilterShape::box, 0.5}, replicates);
    for (int y = kBounds.y0; y < kBounds.y1; ++y)
        for (int x = kBounds.x0; x < kBounds.x1; ++x)
            for (int r = 0; r < replicates; ++r) {
                // As adaptive sampling leaves them: up to twice as many.
                const std::uint32_t n = samples + (x % 5) * samples / 4;
                double sum = 0;
                for (std::uint32_t i = 0; i < n; ++i) sum += draw(random) * truth(x, y);
                film.add(x, y, r, Xyz{1, 1, 1} * sum, n);
            }
    return film;
}

MeasuredError::Planes exact() {
    std::vector<Xyz> values;
    for (int y = kBounds.y0; y < kBounds.y1; ++y)
        for (int x = kBounds.x0; x < kBounds.x1; ++x) values.push_back(Xyz{1, 1, 1} * truth(x, y));
    return measuredPlanes(picture(), kBounds, values);
}

Coverages coverages(Draw draw, int replicates, std::uint32_t samples) {
    const auto reference = exact();
    Coverages all;
    for (unsigned seed = 1; seed <= 100; ++seed) {
        const PixelFilm film = makeFilm(draw, seed, replicates, samples);
        all.add(ErrorCertificate::of(film, picture()),
                MeasuredError::of(measuredPlanes(picture(), film, 0, replicates), reference));
    }
    return all;
}

void checkCoverage(const Coverage& c, double widest) {
    MESSAGE(fmt::format("held {} of {}, {} below, {} above; width {:.3f}, ideal {:.3f}, ln(measured/stated) {:+.3f}",
                        c.held, c.trials, c.below, c.above, c.meanWidth(), c.idealWidth(), c.bias()));
    CHECK(c.held >= 90);
    CHECK(c.meanWidth() < widest);
}

} // namespace

TEST_CASE("certificate: intervals hold the error, whatever the distribution of the samples") {
    SUBCASE("normal") {
        const Coverages c = coverages(normalDraw, 2, 8);
        checkCoverage(c.relative, 0.25);
        checkCoverage(c.display, 0.25);
    }
    SUBCASE("normal, three replicates") {
        const Coverages c = coverages(normalDraw, 3, 8);
        checkCoverage(c.relative, 0.2);
        checkCoverage(c.display, 0.2);
    }
    SUBCASE("log-normal") {
        const Coverages c = coverages(logNormalDraw, 2, 8);
        checkCoverage(c.relative, 0.35);
        checkCoverage(c.display, 0.35);
    }
    SUBCASE("fireflies") {
        const Coverages c = coverages(fireflyDraw, 2, 16);
        checkCoverage(c.relative, 0.6);
        checkCoverage(c.display, 0.6);
    }
    SUBCASE("glossy caustics") {
        const Coverages c = coverages(glossyDraw, 2, 16);
        checkCoverage(c.relative, 2.5);
        checkCoverage(c.display, 2.5);
    }
}

TEST_CASE("certificate: the estimate is the error in the mean") {
    // So many samples that the measures are linear: nothing but the estimate is tested.
    const Coverages c = coverages(normalDraw, 2, 400);
    CHECK(std::abs(c.relative.bias()) < 0.01); // three standard errors: ideal width/4/√100 · 3
    CHECK(std::abs(c.display.bias()) < 0.01);
    CHECK(c.relative.meanWidth() < 1.3 * c.relative.idealWidth());
    CHECK(c.relative.meanWidth() > 0.75 * c.relative.idealWidth());
}

TEST_CASE("certificate: tiles whose error bars few samples carry are counted, and the figure has room for the others") {
    int flagged = 0, plain = 0;
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const auto light = ErrorCertificate::of(makeFilm(normalDraw, seed, 2, 16), picture()).relative;
        CHECK(light.unseen < TailEstimate::kTrusted);
        CHECK(light.tiles == 6); // those with a hundred pixels
        plain += static_cast<int>(light.untrustedTiles);
        const auto heavy = ErrorCertificate::of(makeFilm(glossyDraw, seed, 2, 16), picture()).relative;
        flagged += static_cast<int>(heavy.untrustedTiles);
        CHECK(heavy.high >= heavy.value * std::sqrt(1 + heavy.unseen));
    }
    MESSAGE(fmt::format("untrusted of 120 tiles: {} of normal samples, {} of a glossy caustic's", plain, flagged));
    CHECK(plain <= 2);
    CHECK(flagged >= 60);
}

// The limit of all estimates, as docs/output.md states it: with 32 samples most pixels lack what one sample in a
// hundred carries, and half of the light is that.
TEST_CASE("certificate: what no sample has hit is not in the estimate") {
    const Coverages c = coverages(unseenDraw, 2, 16);
    CHECK(c.relative.held < 50);
    CHECK(c.relative.above == c.relative.trials - c.relative.held);
    CHECK(c.relative.bias() < 0.3);
}

TEST_CASE("certificate: none, and why") {
    const auto one = ErrorCertificate::of(makeFilm(normalDraw, 1, 1, 4), picture());
    CHECK(one.reason.find("one replicate") == 0);
    CHECK(one.fewest == 4);
    CHECK(one.most == 8);
    PixelFilm half(kBounds, {FilterShape::box, 0.5}, 2); // the second replicate has nothing
    half.add(3, 4, 0, Xyz{1, 1, 1}, 1);
    CHECK(ErrorCertificate::of(half, picture()).reason.find("too few samples") == 0);
    half.add(3, 4, 1, Xyz{2, 2, 2}, 1); // and now in one pixel
    const auto c = ErrorCertificate::of(half, picture());
    CHECK(c.reason.empty());
    CHECK(c.relative.pixels == 1);
    CHECK(c.pixels == kBounds.area());
    CHECK(c.fewest == 0);
    CHECK(c.relative.high > 10 * c.relative.value); // one pixel says little
}

TEST_CASE("certificate: a picture without noise has no error, black or not") {
    for (const double value : {0.0, 0.7}) {
        PixelFilm film(kBounds, {FilterShape::box, 0.5}, 2);
        for (int y = kBounds.y0; y < kBounds.y1; ++y)
            for (int x = kBounds.x0; x < kBounds.x1; ++x)
                for (int r = 0; r < 2; ++r) film.add(x, y, r, Xyz{1, 1, 1} * value, 1);
        const auto c = ErrorCertificate::of(film, picture());
        CHECK(c.reason.empty());
        CHECK(c.relative.value == 0);
        CHECK(c.relative.high == 0);
        CHECK(c.display->value == 0);
        CHECK(c.relative.holds(0));
    }
}

TEST_CASE("certificate: the worst tile") {
    PixelFilm film = makeFilm(normalDraw, 1, 2, 400);
    for (int y = 16; y < 32; ++y) film.add(35, y, 0, Xyz{1, 1, 1} * 400, 1);
    const auto c = ErrorCertificate::of(film, picture());
    for (const ErrorFigure& f : {c.relative, *c.display}) {
        CHECK(f.worst.pixels.x0 == 32);
        CHECK(f.worst.pixels.x1 == 40);
        CHECK(f.worst.pixels.y0 == 16);
        CHECK(f.worst.pixels.y1 == 32);
        CHECK(f.worst.value > f.value);
    }
}

TEST_CASE("certificate: scale and balance act on the picture, not on relative errors") {
    const PixelFilm film = makeFilm(logNormalDraw, 1, 2, 8);
    auto p = picture();
    const auto plain = ErrorCertificate::of(film, p);
    p.scale = 0.25;
    const auto dark = ErrorCertificate::of(film, p);
    CHECK(dark.relative.value == doctest::Approx(plain.relative.value).epsilon(1e-9));
    CHECK(dark.display->value == doctest::Approx(plain.display->value * std::pow(0.25, 1 / 2.2)).epsilon(0.05));
    p.display = {};
    CHECK(!ErrorCertificate::of(film, p).display);
}

// Merged light on the film: counted by rounds, beside samples and light paths, with its bias.

namespace {

const Spectrum kDark(0.f);
const Wavelengths kGreen = Wavelengths::single(555);

PixelFilm filmOf(PixelBounds bounds, int replicates) {
    PixelFilm film(bounds, PixelFilter(FilterShape::box, 0.5), replicates);
    film.keepSplats();
    film.keepMerged();
    return film;
}

void merge(PixelFilm& film, int x, int y, int replicate, double wide, double closer) {
    film.splat(x, y, replicate,
               {{wide, wide, wide}, kDark, kGreen, 1, nullptr, PathComponent::caustic, SplatKind::merged, closer});
}

} // namespace

TEST_CASE("merged light is averaged over rounds, by itself") {
    PixelFilm film = filmOf({0, 0, 2, 1}, 2);
    CHECK(film.takesMerged());
    for (int r = 0; r < 2; ++r) {
        film.add(0, 0, r, Xyz{4, 4, 4}, 4);
        film.splat(0, 0, r, {{30, 30, 30}, kDark, kGreen, 1, nullptr, PathComponent::caustic});
        film.countLightPaths(r, 10);
        film.countRounds(r, 2);
    }
    merge(film, 0, 0, 0, 8, 6);
    merge(film, 0, 0, 1, 16, 14);
    CHECK(film.splatMean(SplatKind::merged, 0, 0, 0, 2).y == doctest::Approx(24.0 / 4));
    CHECK(film.closerMean(0, 0, 0, 2) == doctest::Approx(20.0 / 4));
    CHECK(film.mean(0, 0).y == doctest::Approx(1 + 3 + 6));
    CHECK(film.mean(0, 0, 0, 1).y == doctest::Approx(1 + 3 + 4));
    CHECK(*film.variance(0, 0) == doctest::Approx(4)); // replicates of 8 and 12
    CHECK(film.mean(1, 0).y == 0);
    CHECK(PixelFilm::memoryBytes({0, 0, 10, 10}, 2, true, true) == 20000 + 200 * 64);

    PixelFilm sum = filmOf({0, 0, 2, 1}, 2);
    const FilmPlanes from = film.planes(), to = sum.planes();
    REQUIRE(from.size() == to.size());
    for (int times = 0; times < 2; ++times)
        for (std::size_t i = 0; i < from.size(); ++i) {
            CHECK(from[i]->name() == to[i]->name());
            std::vector<std::byte> bytes;
            from[i]->store(film.bounds(), bytes);
            REQUIRE(to[i]->add(film.bounds(), bytes));
        }
    CHECK(sum.mean(0, 0).y == film.mean(0, 0).y);
    CHECK(sum.splatCount(SplatKind::merged, 0, 2) == 8);
    CHECK(sum.closerMean(0, 0, 0, 2) == film.closerMean(0, 0, 0, 2));
}

TEST_CASE("merged light is part of its group and of the caustics") {
    int light = 0;
    LayerPlan plan;
    plan.groups = {{"one", {"a"}}};
    plan.components = true;
    PixelFilm film = filmOf({0, 0, 1, 1}, 2);
    film.keepLayers(plan, {{&light, "a"}}, rgb::xyz);
    for (int r = 0; r < 2; ++r) {
        film.add(0, 0, r, Xyz{}, 8);
        film.countLightPaths(r, 100);
        film.countRounds(r, 5);
    }
    film.splat(0, 0, 0, {{20, 20, 20}, kDark, kGreen, 1, &light, PathComponent::caustic, SplatKind::merged, 20});
    film.splat(0, 0, 0, {{20, 20, 20}, kDark, kGreen, 1, nullptr, PathComponent::caustic});
    ResolvedImage picture = film.resolve(rgb::xyz.fromXyz(), 1);
    const LayerPlanes layers = layerPlanes(film, picture, {&rgb::xyz, rgb::xyz.fromXyz(), 1, {}});
    const auto at = [&](const std::string& name) {
        for (const NamedPlane& plane : layers.planes)
            if (plane.name == name) return static_cast<double>(plane.values[0]);
        FAIL("no channel ", name);
        return 0.0;
    };
    CHECK(at("group_one.G") == doctest::Approx(2));
    CHECK(at("group_rest.G") == doctest::Approx(0.1));
    CHECK(at("caustic.G") == doctest::Approx(2.1));
    CHECK(layers.unequalSums == 0);
}

TEST_CASE("the bias of merged light by two radii") {
    CHECK_FALSE(MergedLight::of(filmOf({0, 0, 16, 8}, 4)));
    PixelFilm film = filmOf({0, 0, 16, 8}, 4);
    // Two tiles with a light of 10: one in which the narrower disk sees 1 % less, the other with noise alone.
    for (int r = 0; r < 4; ++r) {
        film.countRounds(r, 1);
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 16; ++x) merge(film, x, y, r, 10, x < 8 ? 9.9 : r < 2 ? 9.95 : 10.05);
    }
    const auto merged = MergedLight::of(film);
    REQUIRE(merged);
    CHECK(merged->rounds == 4);
    CHECK(merged->share == doctest::Approx(1));
    const double factor = 1 / (1 - std::sqrt(0.5));
    CHECK(merged->bias == doctest::Approx(0.005 * factor));
    // The noise changes its sign between halves, and would count below zero.
    const double a = square(0.01 * factor), b = -square(0.005 * factor);
    CHECK(merged->biasOfTiles == doctest::Approx(std::sqrt((a + b) / 2 + std::hypot(a, b))));
    CHECK(merged->biasOfTiles > 0.01 * factor / std::sqrt(2));
}

} // namespace abbe::test
