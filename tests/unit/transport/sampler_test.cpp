// The sample points: nets, scrambles, independence, and dimensions that keep their meaning.
#include "support/chi_square.h"
#include "support/statistics.h"
#include "transport/sampler.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <doctest/doctest.h>
#include <set>

namespace abbe::test {
namespace {

constexpr double kLevel = 1e-4; // of each test below, before the correction for the number of tests

using Point = std::array<float, kSobolDimensions>;

// A point by the plain route, without the work that SobolBlock shares.
Point plainPoint(std::uint32_t index, std::uint32_t seed) {
    alignas(32) float out[kSobolDimensions];
    const std::uint32_t shuffled = shuffleIndex(index, seed);
    for (int first = 0; first < kSobolDimensions; first += 8) scrambledSobol8(shuffled, seed, first, out + first);
    Point p;
    std::copy(std::begin(out), std::end(out), p.begin());
    return p;
}

// As wavelength(), in two: the eighth that the hero is in, and where in it.
struct WavelengthPair {
    std::uint32_t hero;
    double within;
};
WavelengthPair wavelengthPair(const Sampler& s) {
    const double u = 8 * s.wavelength();
    return {static_cast<std::uint32_t>(u), u - std::floor(u)};
}

// All 24 joint dimensions as the sampler hands them out, in the documented order.
Point jointPoint(Sampler& s) {
    const VertexSample a = s.vertex(0), b = s.vertex(1), c = s.vertex(2);
    const float wavelength = static_cast<float>(std::floor(s.wavelength() * 0x1p24)) * 0x1p-24f;
    return {a.bsdf.x,   a.bsdf.y,   b.light.x, b.light.y, a.light.x, a.light.y, wavelength, s.film().x,
            s.film().y, b.bsdf.x,   b.bsdf.y,  c.light.x, c.light.y, c.bsdf.x,  c.bsdf.y,   s.time(),
            s.lens().x, s.lens().y, a.pick,    a.lobe,    b.pick,    b.lobe,    c.pick,     c.lobe};
}

Sampler pixelSampler(std::uint64_t seed, bool random = false) {
    Sampler s;
    s.startPixel(seed, random ? Technique::Numbers::random : Technique::Numbers::sobol, true);
    return s;
}

std::uint32_t cell(float u, std::uint32_t cells) { return static_cast<std::uint32_t>(static_cast<double>(u) * cells); }

// p-value that counts of equally likely cells are so.
double evenness(const std::vector<double>& observed, double total) {
    const std::vector<double> expected(observed.size(), total / static_cast<double>(observed.size()));
    return chiSquareTest(observed, expected).pValue;
}

} // namespace

TEST_CASE("sampler: every joint dimension is a (0, m, 1)-net in every aligned block") {
    for (const std::uint64_t seed : {0ull, 1ull, 0xdeadbeefull, 0x9e3779b97f4a7c15ull, 123456789ull}) {
        for (std::uint32_t m = 0; m <= 12; ++m) {
            const std::uint32_t n = 1u << m;
            for (const std::uint32_t first : {0u, n, 5 * n}) {
                Sampler s = pixelSampler(seed);
                std::vector<std::array<bool, kSobolDimensions>> seen(n);
                bool once = true;
                for (std::uint32_t i = first; i < first + n; ++i) {
                    s.start(i);
                    const Point p = jointPoint(s);
                    for (std::size_t d = 0; d < p.size(); ++d) {
                        bool& met = seen[cell(p[d], n)][d];
                        once = once && !met;
                        met = true;
                    }
                }
                INFO("seed " << seed << ", block of " << n << " at " << first);
                CHECK(once);
            }
        }
    }
}

namespace {

// What of the points is drawn together, out of a sampler that stands at one.
using Pair = Vec2 (*)(Sampler&);
struct NamedPair {
    const char* name;
    Pair pair;
};
constexpr NamedPair kPairs[] = {
    {"BSDF of the first vertex", [](Sampler& s) { return s.vertex(0).bsdf; }},
    {"light of the first vertex", [](Sampler& s) { return s.vertex(0).light; }},
    {"BSDF of the second vertex", [](Sampler& s) { return s.vertex(1).bsdf; }},
    {"BSDF of the third vertex", [](Sampler& s) { return s.vertex(2).bsdf; }},
    {"light of the third vertex", [](Sampler& s) { return s.vertex(2).light; }},
    {"film", [](Sampler& s) { return s.film(); }},
    {"lens", [](Sampler& s) { return s.lens(); }},
    {"choices of the first vertex",
     [](Sampler& s) {
         return Vec2{s.vertex(0).pick, s.vertex(0).lobe};
     }},
    {"choices of the second vertex",
     [](Sampler& s) {
         return Vec2{s.vertex(1).pick, s.vertex(1).lobe};
     }},
    {"light of a later vertex", [](Sampler& s) { return s.vertex(7).light; }},
};

// Whether every elementary interval of 2^m points has one, of which 2^(m - digits) are needed at the most: the digits
// of each number are shared out in all ways.
bool isNet(std::uint64_t seed, std::uint32_t m, std::uint32_t digits, std::initializer_list<Pair> pairs) {
    std::vector<std::array<float, 4>> points;
    Sampler s = pixelSampler(seed);
    for (std::uint32_t i = 0; i < 1u << m; ++i) {
        s.start(i);
        std::array<float, 4> point{};
        std::size_t d = 0;
        for (const Pair pair : pairs) {
            const Vec2 u = pair(s);
            point[d++] = u.x;
            point[d++] = u.y;
        }
        points.push_back(point);
    }
    const std::uint32_t last = pairs.size() == 2 ? digits : 0;
    for (std::uint32_t a = 0; a <= digits; ++a)
        for (std::uint32_t b = 0; a + b <= digits; ++b)
            for (std::uint32_t c = 0; c <= std::min(last, digits - a - b); ++c) {
                const std::uint32_t rest = digits - a - b - c;
                if (last == 0 && rest > 0) continue;
                std::vector<std::uint32_t> counts(1u << digits);
                for (const auto& p : points)
                    ++counts[((cell(p[0], 1u << a) << b | cell(p[1], 1u << b)) << c | cell(p[2], 1u << c)) << rest |
                             cell(p[3], 1u << rest)];
                if (std::ranges::any_of(counts, [&](auto n) { return n != 1u << (m - digits); })) return false;
            }
    return true;
}

} // namespace

TEST_CASE("sampler: pairs are (0, m, 2)-nets: every elementary interval has its point") {
    for (const std::uint64_t seed : {0ull, 7ull, 0xfeedull})
        for (std::uint32_t m = 1; m <= 13; ++m) // beyond those that were searched
            for (const NamedPair& p : kPairs) {
                INFO(p.name << ", m " << m);
                CHECK(isNet(seed, m, m, {p.pair}));
            }
}

TEST_CASE("sampler: pairs that matter together are nets of four dimensions, up to a factor of two or four") {
    const Pair bsdf = [](Sampler&s) { return s.vertex(0).bsdf; }, light = [](Sampler&s) { return s.vertex(0).light; };
    const Pair nextLight = [](Sampler&s) { return s.vertex(1).light; }, film = [](Sampler&s) { return s.film(); };
    for (const std::uint64_t seed : {0ull, 7ull}) {
        for (const std::uint32_t m : {2u, 3u, 4u}) {
            INFO("m " << m);
            CHECK(isNet(seed, m, m - 1, {film, light}));
        }
        for (const std::uint32_t m : {3u, 4u, 5u, 6u}) {
            INFO("m " << m);
            CHECK(isNet(seed, m, m - 2, {film, light}));
            CHECK(isNet(seed, m, m - 2, {bsdf, film}));
            CHECK(isNet(seed, m, m - 2, {bsdf, nextLight}));
        }
    }
}

TEST_CASE("sampler: sets of later vertices are nets of their own") {
    for (const std::uint32_t depth : {3u, 4u, 17u}) {
        Sampler s = pixelSampler(99);
        std::vector<std::array<bool, 6>> seen(1024);
        std::set<std::uint32_t> light;
        bool once = true;
        for (std::uint32_t i = 0; i < 1024; ++i) {
            s.start(i);
            const VertexSample v = s.vertex(depth);
            light.insert(cell(v.light.x, 32) << 5 | cell(v.light.y, 32));
            const float all[] = {v.light.x, v.light.y, v.bsdf.x, v.bsdf.y, v.pick, v.lobe};
            for (std::size_t d = 0; d < 6; ++d) {
                bool& met = seen[cell(all[d], 1024)][d];
                once = once && !met;
                met = true;
            }
        }
        CHECK(once);
        CHECK(light.size() == 1024);
    }
}

TEST_CASE("sampler: work shared between the points of a block changes no bit") {
    for (const std::uint64_t seed : {3ull, 0xabcdef0123456789ull})
        for (const std::uint32_t end : {1u, 2u, 3u, 17u, 256u, 1000u, 1u << 20, 0xffffffffu}) {
            Sampler s = pixelSampler(seed);
            for (std::uint32_t k = 0; k < 64; ++k) {
                const std::uint32_t i = static_cast<std::uint32_t>(std::uint64_t{end - 1} * k / 63);
                s.start(i);
                CHECK(jointPoint(s) == plainPoint(i, static_cast<std::uint32_t>(seed)));
            }
        }
}

TEST_CASE("sampler: 2^20 samples of every dimension lie in [0, 1)") {
    for (const bool random : {false, true}) {
        Sampler s = pixelSampler(0x5eed, random);
        float least = 1, largest = 0;
        for (std::uint32_t i = 0; i < 1u << 20; ++i) {
            s.start(i);
            const VertexSample later = s.vertex(5);
            for (const float u : jointPoint(s)) least = std::min(least, u), largest = std::max(largest, u);
            for (const float u : {later.light.x, later.bsdf.y, later.lobe, s.roulette(3)})
                least = std::min(least, u), largest = std::max(largest, u);
        }
        CHECK(least >= 0);
        CHECK(largest < 1);
        CHECK(least < 1e-5f); // the whole range is used
        CHECK(largest > 1 - 1e-5f);
    }
    // The largest that 32 bits can give, through the same conversion.
    alignas(32) float out[8];
    for (std::uint32_t seed = 0; seed < 4096; ++seed) {
        const UInt8 ones = UInt8{} + 0xffffffffu, seeds = UInt8{} + seed;
        scrambleToFloats(ones, seeds, out);
        for (const float u : out) CHECK_UNARY(u >= 0 && u < 1);
    }
}

TEST_CASE("Owen scramble: nested, and every flip is a fair coin") {
    // Bit k of the result may depend on bits 0 … k of the reversed input alone.
    Random random(1);
    for (int trial = 0; trial < 20000; ++trial) {
        const std::uint32_t x = random.bits(), seed = random.bits(), k = random.bits() % 32;
        const std::uint32_t mask = k == 31 ? 0xffffffffu : (2u << k) - 1;
        const std::uint32_t other = (x & mask) | (random.bits() & ~mask);
        CHECK_UNARY(((owenScrambleReversed(x, seed) ^ owenScrambleReversed(other, seed)) & mask) == 0);
        if (k < 31) { // and the next bit is flipped with it: a bijection of every subtree
            const std::uint32_t flipped = x ^ (1u << k);
            CHECK_UNARY(((owenScrambleReversed(x, seed) ^ owenScrambleReversed(flipped, seed)) & mask) == 1u << k);
        }
    }
    // Over seeds, each node of the tree flips half of the time.
    constexpr int seeds = 1 << 14;
    std::vector<double> pValues;
    for (std::uint32_t level = 0; level < 8; ++level)
        for (std::uint32_t node = 0; node < 1u << level; node += 1 + (1u << level) / 8) {
            double flips = 0;
            for (std::uint32_t i = 0; i < seeds; ++i) {
                const std::uint32_t reversed = owenScrambleReversed(node, mix32(i + 1));
                flips += ((reversed ^ node) >> level) & 1;
            }
            pValues.push_back(normalTwoSided((flips - seeds / 2.0) / std::sqrt(seeds / 4.0)));
        }
    INFO("nodes " << pValues.size());
    CHECK(*std::min_element(pValues.begin(), pValues.end()) > sidak(kLevel, static_cast<int>(pValues.size())));
    CHECK(kolmogorovUniform(pValues) > kLevel);
}

TEST_CASE("sampler: seeds of pixels and replicates: single samples are uniform, and neighbours are independent") {
    // The first sample of each pixel is one random point: any structure comes from the seeds.
    constexpr std::uint64_t side = 256;
    std::vector<Point> points;
    for (std::uint64_t y = 0; y < side; ++y)
        for (std::uint64_t x = 0; x < side; ++x) {
            Sampler s = pixelSampler(combine64(combine64(0, y << 32 | x), 0));
            s.start(0);
            points.push_back(jointPoint(s));
        }
    std::vector<double> pValues;
    for (std::size_t d = 0; d < kSobolDimensions; ++d) {
        std::vector<double> one(256, 0), next(256, 0), pair(256, 0);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Point& p = points[i];
            const Point& right = points[i % side + 1 < side ? i + 1 : i + 1 - side];
            ++one[cell(p[d], 256)];
            ++next[cell(p[d], 16) * 16 + cell(right[d], 16)];
            ++pair[cell(p[d], 16) * 16 + cell(p[(d + 1) % kSobolDimensions], 16)];
        }
        for (const auto* counts : {&one, &next, &pair})
            pValues.push_back(evenness(*counts, static_cast<double>(points.size())));
    }
    CHECK(*std::min_element(pValues.begin(), pValues.end()) > sidak(kLevel, static_cast<int>(pValues.size())));
    CHECK(kolmogorovUniform(pValues) > kLevel);
}

TEST_CASE("sampler: padded sets are independent of the joint dimensions and of each other") {
    // Within one pixel, pairs of dimensions out of different sets fall evenly into 8 × 8 cells. 64 points of one pixel
    // are stratified in each, so only pairs are tested, over many pixels.
    constexpr int pixels = 512, samples = 64;
    std::vector<double> pValues;
    const auto test = [&](auto&& first, auto&& second) {
        std::vector<double> counts(64, 0);
        for (int pixel = 0; pixel < pixels; ++pixel) {
            Sampler s = pixelSampler(mix64(static_cast<std::uint64_t>(pixel) + 1));
            for (std::uint32_t i = 0; i < samples; ++i) {
                s.start(i);
                ++counts[cell(first(s), 8) * 8 + cell(second(s), 8)];
            }
        }
        pValues.push_back(evenness(counts, pixels * samples));
    };
    const auto filmX = [](Sampler& s) { return s.film().x; };
    const auto firstLight = [](Sampler& s) { return s.vertex(0).light.x; };
    const auto light = [](std::uint32_t depth) { return [depth](Sampler& s) { return s.vertex(depth).light.x; }; };
    const auto bsdf = [](std::uint32_t depth) { return [depth](Sampler& s) { return s.vertex(depth).bsdf.y; }; };
    for (const std::uint32_t depth : {3u, 4u, 5u, 9u}) {
        test(filmX, light(depth));
        test(firstLight, bsdf(depth));
        test(light(depth), light(depth + 1));
        test(bsdf(depth), bsdf(depth + 2));
        test(light(depth), [depth](Sampler& s) { return s.roulette(depth); });
    }
    CHECK(*std::min_element(pValues.begin(), pValues.end()) > sidak(kLevel, static_cast<int>(pValues.size())));
}

TEST_CASE("sampler: replicates of a pixel share no stratification") {
    // Means of a linear function over one net are nearly exact; those of two replicates must err independently.
    double sum = 0, squares = 0;
    constexpr int pixels = 4096;
    for (std::uint64_t pixel = 0; pixel < pixels; ++pixel) {
        double error[2] = {};
        for (std::uint64_t r = 0; r < 2; ++r) {
            Sampler s = pixelSampler(combine64(combine64(9, pixel), r));
            for (std::uint32_t i = 0; i < 8; ++i) {
                s.start(i);
                error[r] += static_cast<double>(s.film().x) - 0.5;
            }
        }
        sum += error[0] * error[1];
        squares += square(error[0] * error[1]);
    }
    CHECK(normalTwoSided(sum / std::sqrt(squares)) > kLevel);
}

TEST_CASE("sampler: numbers belong to a purpose, not to an order of use") {
    for (const bool random : {false, true}) {
        Sampler all = pixelSampler(42, random), some = all;
        for (std::uint32_t i = 0; i < 64; ++i) {
            all.start(i);
            const Point joint = jointPoint(all);
            std::array<VertexSample, 6> vertices;
            for (std::uint32_t d = 0; d < 6; ++d) vertices[d] = all.vertex(d);
            some.start(i);
            const VertexSample fifth = some.vertex(5), third = some.vertex(3); // backwards, and nothing else before
            CHECK(fifth.light == vertices[5].light);
            CHECK(fifth.lobe == vertices[5].lobe);
            CHECK(third.bsdf == vertices[3].bsdf);
            CHECK(some.roulette(2) == all.roulette(2));
            CHECK(some.vertex(1).bsdf == vertices[1].bsdf);
            CHECK(jointPoint(some) == joint);
        }
    }
    // What a scene does not ask for is left out, and moves nothing.
    Sampler with = pixelSampler(42), without;
    without.startPixel(42, Technique::Numbers::sobol, false);
    for (std::uint32_t i = 0; i < 64; ++i) {
        with.start(i);
        without.start(i);
        CHECK(with.film() == without.film());
        CHECK(with.wavelength() == without.wavelength());
        for (std::uint32_t d = 0; d < 5; ++d) {
            CHECK(with.vertex(d).light == without.vertex(d).light);
            CHECK(with.vertex(d).bsdf == without.vertex(d).bsdf);
        }
    }
}

TEST_CASE("sampler: the number of the wavelengths has even bits beyond the 24 of the sequence") {
    for (const bool random : {false, true}) {
        Sampler s = pixelSampler(6, random);
        constexpr std::uint32_t n = 1 << 16;
        std::vector<double> coarse(256), fine(256);
        for (std::uint32_t i = 0; i < n; ++i) {
            s.start(i);
            const double below = s.wavelength() * 0x1p24 - std::floor(s.wavelength() * 0x1p24);
            ++coarse[static_cast<std::size_t>(below * 256)];
            ++fine[static_cast<std::size_t>(below * 0x1p29) % 256];
        }
        CHECK(evenness(coarse, n) > 1e-4);
        CHECK(evenness(fine, n) > 1e-4);
    }
}

TEST_CASE("sampler: hero and place within an eighth are a (0, m, 2)-net") {
    for (const std::uint64_t seed : {0ull, 7ull, 0xfeedfeedfeedfeedull})
        for (std::uint32_t m = 1; m <= 11; ++m)
            for (std::uint32_t k = 0; k <= std::min(m, 3u); ++k) { // intervals of 2^-k by 2^-(m-k)
                Sampler s = pixelSampler(seed);
                s.shareWavelengths(mix64(seed + 3), 2, 1, true);
                std::set<std::uint32_t> met;
                for (std::uint32_t i = 0; i < 1u << m; ++i) {
                    s.start(i);
                    const WavelengthPair w = wavelengthPair(s);
                    met.insert((w.hero >> (3 - k)) << (m - k) |
                               static_cast<std::uint32_t>(std::ldexp(w.within, static_cast<int>(m - k))));
                }
                INFO("m " << m << ", k " << k);
                CHECK(met.size() == 1u << m);
            }
}

TEST_CASE("sampler: squares of pixels share the strata of their wavelengths") {
    for (const bool paired : {false, true})
        for (const std::uint64_t square : {1ull, 0x123456789abcdef0ull})
            for (const int side : {2, 4})
                for (const std::uint32_t n : {1u, 2u, 4u, 8u, 16u, 32u}) {
                    const auto strata = static_cast<std::uint32_t>(side * side) * n;
                    std::set<std::uint32_t> heroes, within;
                    for (int y = 0; y < side; ++y)
                        for (int x = 0; x < side; ++x) {
                            Sampler s = pixelSampler(mix64(static_cast<std::uint64_t>(8 * y + x)));
                            s.shareWavelengths(mix64(square), x - 4, y + 4, paired);
                            for (std::uint32_t i = 0; i < n; ++i) {
                                s.start(i);
                                heroes.insert(static_cast<std::uint32_t>(s.wavelength() * strata));
                                within.insert(static_cast<std::uint32_t>(wavelengthPair(s).within * strata));
                            }
                        }
                    INFO("side " << side << ", samples " << n);
                    CHECK(heroes.size() == strata);
                    if (paired) CHECK(within.size() == strata);
                }
}

TEST_CASE("sampler: the wavelengths of each place in a square are uniform, and squares are independent") {
    std::vector<double> pValues;
    for (int place = 0; place < 16; ++place) {
        std::vector<double> one(256, 0), next(256, 0);
        double before = 0;
        constexpr int squares = 1 << 14;
        for (std::uint64_t square = 0; square < squares; ++square) {
            Sampler s = pixelSampler(combine64(5, square * 16 + static_cast<std::uint64_t>(place)));
            s.shareWavelengths(combine64(77, square), place % 4, place / 4, square % 2 == 0);
            s.start(static_cast<std::uint32_t>(square % 5));
            const double u = s.wavelength();
            ++one[static_cast<std::size_t>(u * 256)];
            ++next[static_cast<std::size_t>(u * 16) * 16 + static_cast<std::size_t>(before * 16)];
            before = u;
        }
        pValues.push_back(evenness(one, squares));
        pValues.push_back(evenness(next, squares));
    }
    CHECK(*std::min_element(pValues.begin(), pValues.end()) > sidak(kLevel, static_cast<int>(pValues.size())));
    CHECK(kolmogorovUniform(pValues) > kLevel);
}

TEST_CASE("sampler: all joint dimensions differ") {
    Sampler s = pixelSampler(5);
    for (std::uint32_t i = 0; i < 16; ++i) {
        s.start(i);
        const Point p = jointPoint(s);
        CHECK(std::set<float>(p.begin(), p.end()).size() == p.size());
    }
}

} // namespace abbe::test
