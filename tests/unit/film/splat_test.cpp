// Light from light paths on the film: means, error bars, layers, planes.
#include "film/layer_planes.h"
#include "film/pixel_film.h"
#include "spectrum/color_space.h"
#include "spectrum/sensor.h"
#include "support/certificate_coverage.h"

#include <cmath>
#include <doctest/doctest.h>
#include <random>
#include <thread>
#include <vector>

namespace abbe::test {
namespace {

PixelFilter box() { return {FilterShape::box, 0.5}; }

const Spectrum kNoSplat(0.f);
const Wavelengths kSplatGreen = Wavelengths::single(555);

Splat splatOf(const Xyz& value, const void* light = nullptr, PathComponent component = PathComponent::caustic) {
    return {value, kNoSplat, kSplatGreen, 1, light, component};
}

std::vector<std::byte> bytesOf(PixelFilm& film) {
    std::vector<std::byte> bytes;
    for (const auto& plane : film.planes()) plane->store(film.bounds(), bytes);
    return bytes;
}

} // namespace

TEST_CASE("a film without splats has no place for them and the bits that it had") {
    PixelFilm film({0, 0, 2, 1}, box(), 2);
    CHECK_FALSE(film.takesSplats());
    film.add(0, 0, 0, Xyz{1, 2, 3}, 4);
    film.splat(0, 0, 0, splatOf({9, 9, 9}));
    film.countLightPaths(0, 5);
    CHECK(film.lightPaths() == 0);
    CHECK(film.mean(0, 0).y == 0.5);
    CHECK(film.planes().size() == 2);
    CHECK(PixelFilm::memoryBytes({0, 0, 10, 10}, 2) == 10400);
    CHECK(PixelFilm::memoryBytes({0, 0, 10, 10}, 2, true) == 20000);
}

TEST_CASE("a mean is that of the samples and that over the light paths, added up") {
    PixelFilm film({3, 5, 6, 7}, box(), 2);
    film.keepSplats();
    CHECK(film.takesSplats());
    film.add(5, 6, 0, Xyz{2, 4, 6}, 2);
    film.add(5, 6, 1, Xyz{6, 12, 18}, 6);
    film.splat(5, 6, 0, splatOf({30, 60, 90}));
    film.countLightPaths(0, 10);
    film.splat(5, 6, 1, splatOf({40, 80, 120}));
    film.splat(5, 6, 1, splatOf({20, 40, 60}));
    film.countLightPaths(1, 15);
    film.countLightPaths(1, 15);
    CHECK(film.lightPaths() == 40);
    CHECK(film.splatCount(SplatKind::lightPath, 0, 1) == 10);
    CHECK(film.mean(5, 6).y == doctest::Approx(16.0 / 8 + 180.0 / 40));
    CHECK(film.mean(5, 6, 0, 1).x == doctest::Approx(1 + 3));
    CHECK(film.mean(5, 6, 1, 2).z == doctest::Approx(3 + 6));
    CHECK(film.sampleMean(5, 6, 1, 2).y == doctest::Approx(2));
    CHECK(film.splatMean(SplatKind::lightPath, 5, 6, 1, 2).y == doctest::Approx(4));
    CHECK(film.mean(4, 6).y == 0);
    CHECK(film.resolve(rgb::xyz.fromXyz(), 2).g.back() == doctest::Approx(2 * (2 + 4.5)));
    // By hand: deviations of the two replicates are those of samples and of light paths together.
    const double d0 = (4 - 2 * 2.0) / 8 + (60 - 10 * 4.5) / 40, d1 = (12 - 6 * 2.0) / 8 + (120 - 30 * 4.5) / 40;
    CHECK(*film.variance(5, 6) == doctest::Approx(2 * (d0 * d0 + d1 * d1)));
    film.add(5, 6, 0, Xyz{0, 8, 0}, 0); // the samples differ, too, and to the same side
    const double e0 = (12 - 2 * 3.0) / 8, e1 = (12 - 6 * 3.0) / 8;
    CHECK(*film.variance(5, 6) == doctest::Approx(2 * (square(d0 + e0) + square(d1 + e1))));
    CHECK_FALSE(film.variance(4, 6)); // no samples
}

TEST_CASE("variance needs light paths in two replicates, if there are any") {
    PixelFilm film({0, 0, 1, 1}, box(), 3);
    film.keepSplats();
    for (int r = 0; r < 3; ++r) film.add(0, 0, r, Xyz{0, 1.0 + r, 0}, 1);
    REQUIRE(film.variance(0, 0));
    CHECK(*film.variance(0, 0) == doctest::Approx(1.0 / 3)); // s² = 1
    film.countLightPaths(1, 10);
    CHECK_FALSE(film.variance(0, 0));
    film.countLightPaths(2, 10);
    CHECK(film.variance(0, 0));
    film.countLightPaths(0, 10); // nobody splatted: as before
    CHECK(*film.variance(0, 0) == doctest::Approx(1.0 / 3));
}

// A constant picture, half of it by samples and half by light paths, of which each goes to four pixels anywhere: what
// films of many seeds differ by is what each of them says about itself.
TEST_CASE("the variance of splats is their spread over seeds, with and without samples") {
    constexpr int kWidth = 20, kHeight = 10, kPixels = kWidth * kHeight, kSeeds = 60, kReplicates = 2;
    constexpr int kPaths = 2 * kPixels; // of a replicate
    for (const bool sampled : {false, true}) {
        double sum = 0, squares = 0, variance = 0, noise = 0;
        for (unsigned seed = 0; seed < kSeeds; ++seed) {
            std::mt19937 random(seed);
            std::exponential_distribution<double> draw(1);
            PixelFilm film({0, 0, kWidth, kHeight}, box(), kReplicates);
            film.keepSplats();
            for (int r = 0; r < kReplicates; ++r) {
                for (int i = 0; i < kPixels; ++i) {
                    double value = 0;
                    if (sampled)
                        for (int s = 0; s < 4; ++s) value += 0.5 * draw(random);
                    film.add(i % kWidth, i / kWidth, r, Xyz{0, value, 0}, 4);
                }
                for (int p = 0; p < kPaths; ++p)
                    for (int k = 0; k < 4; ++k)
                        film.splat(static_cast<int>(random() % kWidth), static_cast<int>(random() % kHeight), r,
                                   splatOf({0, 0.5 * kPixels / 4 * draw(random), 0}));
                film.countLightPaths(r, kPaths);
            }
            for (int i = 0; i < kPixels; ++i) {
                const double y = film.mean(i % kWidth, i / kWidth).y;
                sum += y;
                squares += square(y - (sampled ? 1 : 0.5));
                variance += *film.variance(i % kWidth, i / kWidth);
            }
            noise += film.relativeNoise() / kSeeds;
        }
        constexpr double kCount = 1.0 * kPixels * kSeeds;
        // In a pixel k ~ Poisson(16) splats of exponential size a: variance 16 · 2a², a = kPixels/(8 · 2 kPaths).
        const double a = 1.0 / 32, expected = 16 * 2 * a * a + (sampled ? 0.25 / 8 : 0);
        CHECK(std::abs(sum / kCount - (sampled ? 1 : 0.5)) < 0.005);
        CHECK(std::abs(squares / kCount / expected - 1) < 0.05);
        CHECK(std::abs(variance / squares - 1) < 0.05);
        CHECK(std::abs(noise / std::sqrt(expected / (sampled ? 1.01 : 0.2525)) - 1) < 0.05);
    }
}

TEST_CASE("splats from many threads, in any order, are the same bits") {
    constexpr PixelBounds kBounds{0, 0, 9, 7};
    constexpr int kThreads = 4, kSplats = 20000;
    int lights[2];
    const SceneNames names{{&lights[0], "a"}, {&lights[1], "b"}};
    LayerPlan plan;
    plan.groups = {{"one", {"a"}}};
    plan.components = true;
    plan.spectral = SpectralBins{};
    const auto fill = [&](PixelFilm& film, int first, int last) {
        for (int i = first; i < last; ++i) {
            std::mt19937 random(static_cast<unsigned>(i));
            const auto unit = [&] { return std::uniform_real_distribution(0.0, 1.0)(random); };
            const Wavelengths lambda = Wavelengths::sample(static_cast<float>(unit()));
            const Spectrum radiance(static_cast<float>(unit()));
            const Splat splat{{unit(), -unit(), 1e9 * unit()},  radiance, lambda, unit(), &lights[i % 2],
                              static_cast<PathComponent>(i % 3)};
            film.splat(i % 9 % 2, 6, i % 2, splat); // few pixels: threads meet
            film.countLightPaths(i % 2, 1);
        }
    };
    std::vector<std::byte> results[2];
    for (const int threads : {1, kThreads}) {
        PixelFilm film(kBounds, box(), 2);
        film.keepSplats();
        film.keepLayers(plan, names, rgb::ap0);
        std::vector<std::thread> list;
        for (int t = threads; t-- > 0;)
            list.emplace_back([&, t] { fill(film, kSplats * t / threads, kSplats * (t + 1) / threads); });
        for (std::thread& t : list) t.join();
        CHECK(film.lightPaths() == kSplats);
        results[threads > 1] = bytesOf(film);
    }
    CHECK(results[0] == results[1]);
}

TEST_CASE("layers: light groups, components and bins get splats over light paths, features do not") {
    int lights[2];
    const SceneNames names{{&lights[0], "a"}, {&lights[1], "b"}};
    LayerPlan plan;
    plan.groups = {{"one", {"a"}}};
    plan.components = plan.halves = plan.depth = plan.samples = true;
    plan.spectral = SpectralBins{500, 600, 50};
    PixelFilm film({0, 0, 2, 1}, box(), 2);
    film.keepLayers(plan, names, rgb::xyz);
    film.keepSplats(); // in either order
    for (int r = 0; r < 2; ++r) {
        film.add(1, 0, r, Xyz{}, 8);
        film.countLightPaths(r, 100);
    }
    const Wavelengths lambda = Wavelengths::single(520);
    const Spectrum radiance(3.f);
    const Sensor sensor;
    const double factor = 7;
    const Xyz value = sensor(radiance, lambda) * factor;
    film.splat(1, 0, 0, {value, radiance, lambda, factor, &lights[0], PathComponent::caustic});
    film.splat(1, 0, 0, {value, radiance, lambda, factor, &lights[1], PathComponent::indirect});
    film.splat(1, 0, 1, {value, radiance, lambda, factor, &lights[1], PathComponent::caustic});
    ResolvedImage picture = film.resolve(rgb::xyz.fromXyz(), 2);
    const LayerPlanes layers = layerPlanes(film, picture, {&rgb::xyz, rgb::xyz.fromXyz(), 2, {}});
    const auto at = [&](const std::string& name, std::size_t pixel = 1) {
        for (const NamedPlane& plane : layers.planes)
            if (plane.name == name) return static_cast<double>(plane.values[pixel]);
        FAIL("no channel ", name);
        return 0.0;
    };
    const double one = 2 * value.y / 200;
    CHECK(static_cast<double>(picture.g[1]) == doctest::Approx(3 * one));
    CHECK(at("group_one.G") == doctest::Approx(one));
    CHECK(at("group_rest.G") == doctest::Approx(2 * one));
    CHECK(at("direct.G") == 0);
    CHECK(at("indirect.G") == doctest::Approx(one));
    CHECK(at("caustic.G") == doctest::Approx(2 * one));
    CHECK(at("caustic.G", 0) == 0);
    CHECK(at("half.G") == doctest::Approx(2 * 2 * value.y / 100));             // of the first half's light paths
    CHECK(at("S0.525nm") == doctest::Approx(3 * 2.0 * factor * 3 / 50 / 200)); // eight lanes of density 1
    CHECK(at("S0.575nm") == 0);
    CHECK(at("depth.Z") == 0);
    CHECK(at("samples.N") == 16);
    CHECK(layers.unequalSums == 0);
    for (const char* channel : {"R", "G", "B"}) {
        const auto& whole = channel[0] == 'R' ? picture.r : channel[0] == 'G' ? picture.g : picture.b;
        const auto value4 = [&](const std::string& part) { return static_cast<float>(at(part + "." + channel)); };
        CHECK(value4("group_one") + value4("group_rest") == whole[1]);
        CHECK(value4("direct") + value4("indirect") + value4("caustic") == whole[1]);
    }
}

TEST_CASE("films put together from parts by samples and by crops have each light path once") {
    constexpr PixelBounds kAll{0, 0, 8, 4}, kLeft{0, 0, 5, 4}, kRight{5, 0, 8, 4};
    // Light paths of samples [first, last): those of the whole frame, of which a crop keeps what falls on it.
    const auto filled = [](PixelBounds b, int first, int last) {
        PixelFilm film(b, box(), 2);
        film.keepSplats();
        for (int s = first; s < last; ++s)
            for (int r = 0; r < 2; ++r) {
                for (int i = 0; i < 100; ++i) {
                    const int x = (i * 7 + s) % 8, y = (i + r) % 4;
                    if (x >= b.x0 && x < b.x1) film.splat(x, y, r, splatOf({0.1 * i, 1.0 / (1 + i + s), 1e-7 * r}));
                }
                film.countLightPaths(r, 100);
                for (int y = b.y0; y < b.y1; ++y)
                    for (int x = b.x0; x < b.x1; ++x) film.add(x, y, r, Xyz{1, 0.1 * s, 1}, 1);
            }
        return film;
    };
    PixelFilm whole = filled(kAll, 0, 6), merged(kAll, box(), 2);
    merged.keepSplats();
    PixelFilm parts[] = {filled(kRight, 0, 2), filled(kLeft, 0, 6), filled(kRight, 2, 6)};
    for (PixelFilm& part : parts) {
        const FilmPlanes from = part.planes(), to = merged.planes();
        for (std::size_t p = 0; p < from.size(); ++p) {
            CHECK(from[p]->name() == to[p]->name());
            std::vector<std::byte> bytes;
            from[p]->store(part.bounds(), bytes);
            CHECK(to[p]->add(part.bounds(), bytes));
        }
    }
    CHECK(merged.lightPaths() == 1200);
    CHECK(bytesOf(merged) == bytesOf(whole));
    CHECK(merged.variance(6, 2) == whole.variance(6, 2));
    // What is no count is refused.
    for (const auto& plane : merged.planes())
        if (plane->ofLightPaths()) CHECK_FALSE(plane->add(kAll, std::vector<std::byte>(3)));
}

// Light paths that bring light to many pixels at once tie the errors of pixels together: the interval has to hold all
// the same.
TEST_CASE("certificate: intervals hold with splats") {
    constexpr PixelBounds kBounds{0, 0, 32, 32};
    constexpr int kPaths = 8000, kVertices = 4;
    ErrorCertificate::Picture picture;
    picture.display = [](std::span<float>) {};
    std::vector<Xyz> truth;
    const auto share = [](int x, int y) { return 0.5 + 0.5 * std::sin(x * 0.3) * std::cos(y * 0.2); };
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) truth.push_back(Xyz{1, 1, 1} * (0.3 + share(x, y)));
    const auto reference = measuredPlanes(picture, kBounds, truth);
    for (const int replicates : {2, 3}) {
        Coverage relative;
        for (unsigned seed = 0; seed < 100; ++seed) {
            std::mt19937 random(seed);
            std::exponential_distribution<double> draw(1);
            PixelFilm film(kBounds, box(), replicates);
            film.keepSplats();
            for (int r = 0; r < replicates; ++r) {
                for (int i = 0; i < 1024; ++i)
                    film.add(i % 32, i / 32, r, Xyz{1, 1, 1} * (0.3 * (0.9 + 0.1 * draw(random)) * 16), 16);
                for (int p = 0; p < kPaths; ++p)
                    for (int v = 0; v < kVertices; ++v) {
                        const int x = static_cast<int>(random() % 32), y = static_cast<int>(random() % 32);
                        film.splat(x, y, r, splatOf(Xyz{1, 1, 1} * (1024.0 / kVertices * share(x, y))));
                    }
                film.countLightPaths(r, kPaths);
            }
            relative.add(ErrorCertificate::of(film, picture).relative,
                         MeasuredError::of(measuredPlanes(picture, film, 0, replicates), reference).relative.value);
        }
        CHECK(relative.held >= 90);
        CHECK(std::abs(relative.bias()) < 0.06); // few splats in a pixel: measures bend
        CHECK(relative.meanWidth() < 0.3);
    }
    PixelFilm half(kBounds, box(), 2);
    half.keepSplats();
    for (int r = 0; r < 2; ++r) half.add(0, 0, r, Xyz{1, 1, 1}, 1);
    half.countLightPaths(0, 10);
    CHECK(ErrorCertificate::of(half, picture).reason.find("too few") == 0);
}

} // namespace abbe::test
