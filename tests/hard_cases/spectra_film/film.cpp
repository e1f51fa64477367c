// Sums, filters and files: cases 52 to 60 of docs/hard_cases.md.
#include "film/pixel_film.h"
#include "hard_cases/hard_case.h"
#include "io/exr_reader.h"
#include "io/exr_writer.h"
#include "io/image_compare.h"
#include "math/sobol.h"
#include "support/broken_plane.h"
#include "support/constant_image.h"
#include "support/picture_file.h"

#include <immintrin.h>
#include <limits>
#include <random>
#include <thread>

using namespace abbe;
using namespace abbe::test;

TEST_CASE("case 52: 1e8 samples in float") {
    HardCase c;
    c.doctor();
    volatile float start = 0;
    float sum = start;
    for (int i = 0; i < 100'000'000; ++i) sum += 1.f;
    c.naive("sum of 1e8 ones in single precision", std::abs(static_cast<double>(sum) / 1e8 - 1));
}

TEST_CASE("case 53: variance as E[x²] − E[x]²") {
    HardCase c;
    PixelFilm film({0, 0, 1, 1}, {FilterShape::box, 0.5}, 8);
    // Replicate means 1000 ± 1 in turn: s² = 8/7, s²/8 = 1/7.
    for (int r = 0; r < 8; ++r) film.add(0, 0, r, Xyz{0, 1000.0 + (r % 2 ? 1 : -1), 0} * 1000, 1000);
    c.measured("relative error of the variance of 1000 ± 1", std::abs(*film.variance(0, 0) * 7 - 1), 1e-6);
    float mean = 0, square = 0;
    Random random(1);
    for (int i = 0; i < 1000000; ++i) {
        const float x = 1000 + (random.bits() % 2 ? 1.f : -1.f);
        mean += x;
        square += x * x;
    }
    c.naive("variance of a million of them in single precision, which is 1",
            std::abs(static_cast<double>(square / 1e6f - mean / 1e6f * (mean / 1e6f)) - 1));
}

TEST_CASE("case 54: filters with negative lobes") {
    HardCase c;
    const PixelFilter filter(FilterShape::mitchell, 2);
    double worst = 0;
    for (std::uint32_t seed = 0; seed < 64; ++seed)
        for (const std::uint32_t count : {16u, 48u, 1024u}) {
            double weights = 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                alignas(32) float u[kSobolDimensions];
                scrambledSobol16(i, seed * 0x9e3779b9u, u);
                weights += static_cast<double>(filter.sample({u[0], u[1]}).weight);
            }
            worst = std::max(worst, std::abs(weights / count - 1));
        }
    c.measured("error of a constant picture", worst, 1e-6);
    Random random(2);
    double naive = 0; // samples splatted with the filter's value; few of them in a tail nearly cancel
    for (int pixel = 0; pixel < 1000; ++pixel) {
        double sum = 0;
        for (int i = 0; i < 16; ++i)
            sum += PixelFilter::evaluate(FilterShape::mitchell, 2, 4 * random.uniformDouble() - 2) *
                   PixelFilter::evaluate(FilterShape::mitchell, 2, 4 * random.uniformDouble() - 2);
        naive = std::max(naive, std::abs(sum - 1)); // 16 samples over 16 pixels: the weights should sum to 1
    }
    c.naive("sum of 16 splatted weights, which should be 1, worst of 1000 pixels", naive);
}

TEST_CASE("case 55: one pixel, 32768×1, crops") {
    HardCase c;
    int wrong = 0;
    for (const PixelBounds b :
         {PixelBounds{0, 0, 1, 1}, {0, 0, 32768, 1}, {0, 0, 1, 32768}, {10, 20, 13, 22}, {-7, -3, 5, 2}}) {
        PixelFilm film(b, {FilterShape::box, 0.5}, 2);
        film.add(b.x1 - 1, b.y1 - 1, 1, Xyz{1, 2, 3}, 1);
        film.add(b.x0, b.y0, 0, Xyz{1, 2, 3}, 1);
        const auto image = film.resolve(rgb::ap0.fromXyz(), 1);
        wrong += film.mean(b.x0, b.y0).y != 2 || film.mean(b.x1 - 1, b.y1 - 1).y != 2;
        wrong +=
            image.g.size() != static_cast<std::size_t>(b.area()) || !(image.g.front() > 0) || !(image.g.back() > 0);
    }
    wrong += PixelFilm::memoryBytes({0, 0, 65536, 65536}, 16) != 65536ull * 65536 * 16 * 52;
    c.measured("films of awkward sizes with a pixel in the wrong place", wrong, 0);
    c.naive("index of the last pixel of 65536 × 65536 in 32 bits, off by",
            65536.0 * 65536 - static_cast<double>(static_cast<std::uint32_t>(65536ull * 65536)));
}

TEST_CASE("case 56: half floats") {
    HardCase c;
    const abbe_test::TemporaryFolder folder;
    const std::vector<float> values{1e9f, 65504, 65520, 1e-9f, 6e-8f, -1e9f, 0, 0.18f};
    const std::string whole = (folder.path / "float.exr").string(), half = (folder.path / "half.exr").string();
    ExrPicture picture;
    picture.window = picture.display = {0, 0, 8, 1};
    picture.r = picture.g = picture.b = values;
    picture.chromaticities = Chromaticities::of(rgb::ap0);
    writeExr(whole, picture);
    picture.half = true;
    const auto counts = writeExr(half, picture);
    const RgbImage a = readImage(whole), b = readImage(half);
    double worst = 0;
    int bad = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        worst = std::max(worst, std::abs(static_cast<double>(a.rgb[3 * i]) - static_cast<double>(values[i])));
        bad += !std::isfinite(b.rgb[3 * i]);
    }
    c.measured("change of values from 1e-9 to 1e9 by writing and reading", worst, 0);
    c.naive("1e9 as a half", static_cast<double>(_cvtsh_ss(_cvtss_sh(1e9f, 0))));
    c.measured("infinite values in a file of halves", bad, 0);
    c.measured("halves beyond their range that are not counted",
               std::abs(static_cast<double>(counts.halfOverflows) - 9) +
                   std::abs(static_cast<double>(counts.halfUnderflows) - 3),
               0);
}

// A picture with an error that one pixel in a thousand has, against one that all pixels share.
TEST_CASE("case 57: rare bright samples") {
    HardCase c;
    const RgbImage reference = constant(64, 64, {0.25, 0.25, 0.25});
    RgbImage tail = reference, even = reference;
    Random random(57);
    for (int i = 0; i < 4; ++i) tail.rgb[3 * (random.bits() % (64 * 64))] += 100;
    for (float& v : even.rgb) v += 0.1f * (random.uniform() - 0.5f);
    const auto share = [&](const RgbImage& image) {
        const ImageDifference d = compare(image, reference);
        return 1 - d.relMseWithoutTail / d.relMse;
    };
    c.atLeast("share of the error in the worst 0.1 % of pixels, of a picture with four fireflies", share(tail), 0.99);
    c.naive("the same share where all pixels are alike", share(even));
}

TEST_CASE("case 58: a NaN sample") {
    HardCase c;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const GateImage clean = renderPlane(Spectrum(1.f)), broken = renderPlane(Spectrum(nan));
    CHECK(broken.faults > 80); // one in 2048 of 3e5 samples
    int different = 0, bad = 0, struck = 0;
    for (int i = 0; i < 24 * 24 * 2; ++i) {
        const auto [sum, count] = broken.film.replicate(i / 2 % 24, i / 48, i % 2);
        const auto [cleanSum, cleanCount] = clean.film.replicate(i / 2 % 24, i / 48, i % 2);
        bad += !std::isfinite(sum.y);
        struck += !std::isfinite(count < cleanCount ? sum.y + static_cast<double>(nan) : sum.y);
        if (count == cleanCount) different += sum.y != cleanSum.y || sum.x != cleanSum.x || sum.z != cleanSum.z;
    }
    c.measured("pixels that differ from the clean picture's beside those with a fault", different, 0);
    c.measured("samples that are not finite and not counted",
               std::abs(static_cast<double>(broken.statistics.dropped[0]) - static_cast<double>(broken.faults)), 0);
    c.measured("pixels that are not finite", bad, 0);
    c.naive("if such samples are added, of 1152 replicates of pixels", struck);
}

// Without times, which a busy machine would spoil: a worker in which no denormal number can come up is never slow.
TEST_CASE("case 59: denormals") {
    HardCase c;
    c.doctor();
    int left = 0;
    std::thread([&] {
        _mm_setcsr(0x1f80); // as a process begins; a thread begins with what the one that made it has
        const volatile float smallest = std::numeric_limits<float>::min(), half = 0.5f;
        for (int i = 0; i < 100; ++i) left += smallest * half != 0;
    }).join();
    c.naive("of 100 products in a thread that nobody has set up", left);
}

TEST_CASE("case 60: order of additions") {
    HardCase c;
    c.doctor();
    std::mt19937_64 random(5);
    std::vector<double> terms;
    for (int i = 0; i < 20000; ++i)
        terms.push_back(
            std::ldexp(std::uniform_real_distribution(-1.0, 1.0)(random), static_cast<int>(random() % 60) - 30));
    const auto sum = [&] {
        double total = 0;
        for (const double t : terms) total += t;
        return total;
    };
    const double first = sum();
    int different = 0;
    for (int trial = 0; trial < 20; ++trial) {
        std::shuffle(terms.begin(), terms.end(), random);
        different += sum() != first;
    }
    c.naive("of 20 orders in double precision", different);
}
