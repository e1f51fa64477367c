// Deep images of rendered scenes.
#include "support/layered_film.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr const char* kView = "camera { from 0 0 0; look-at 0 0 -1; fov 40 deg }\n";

std::string header(const std::string& row = "deep", const std::string& filter = "box 0.5") {
    return fmt::format("scene 1\nfilm {{ size 16 12; filter {}; output \"x.exr\" space=acescg; layers {{ {} }} }}\n{}",
                       filter, row, kView);
}

// A room that no path leaves, with things in front of each other, glass and a fog that emits and absorbs.
std::string closedRoom(const std::string& row, const std::string& filter) {
    return header(row, filter) + R"(
shape room box { size 6 4 20; material diffuse { reflectance 0.5 } }
light lamp sphere { center 0.6 1.2 -4; radius 0.3; power 800 lm }
shape ball sphere { center 0.3 0 -3; radius 0.5; material conductor { index metal Ag } }
shape glass sphere { center -0.7 0.2 -2.6; radius 0.4; material dielectric { ior 1.5 } }
shape fog sphere { center 0 -0.3 -3; radius 1.2; material boundary
    interior homogeneous { extinction 0.8 per-m; albedo rgb 0.9 0.6 0.3; emission 0.003 } }
)";
}

// The samples put over each other, as a compositing program does it: in float.
struct Flat {
    std::vector<float> r, g, b, a;
};
Flat flat(const DeepImage& deep) {
    Flat f;
    std::size_t at = 0;
    for (const std::uint32_t count : deep.counts) {
        float r = 0, g = 0, b = 0, left = 1;
        for (std::uint32_t s = 0; s < count; ++s, ++at) {
            r += left * deep.r[at];
            g += left * deep.g[at];
            b += left * deep.b[at];
            left *= 1 - deep.a[at];
        }
        f.r.push_back(r);
        f.g.push_back(g);
        f.b.push_back(b);
        f.a.push_back(1 - left);
    }
    return f;
}

// What is left of a pixel in front of `depth`; media that reach beyond count up to there.
double passing(const DeepImage& deep, double depth) {
    double sum = 0;
    std::size_t at = 0;
    for (const std::uint32_t count : deep.counts) {
        double left = 1;
        for (std::uint32_t s = 0; s < count; ++s, ++at) {
            const double front = deep.front[at], back = deep.back[at];
            if (front >= depth) continue;
            const double part = back > depth ? (depth - front) / (back - front) : 1;
            left *= std::pow(1 - static_cast<double>(deep.a[at]), part);
        }
        sum += left;
    }
    return sum / static_cast<double>(deep.counts.size());
}

void checkTidy(const DeepImage& deep, std::uint32_t most) {
    std::size_t at = 0;
    for (const std::uint32_t count : deep.counts) {
        REQUIRE(count <= most);
        for (std::uint32_t s = 0; s < count; ++s, ++at) {
            REQUIRE(deep.a[at] >= 0);
            REQUIRE(deep.a[at] <= 1);
            REQUIRE(deep.front[at] <= deep.back[at]);
            if (s > 0) REQUIRE(deep.back[at - 1] <= deep.front[at]);
        }
    }
    CHECK(at == deep.a.size());
}

} // namespace

TEST_CASE("the samples of a deep image put over each other are the picture") {
    for (const auto& [row, most] : {std::pair{"deep", 64u}, {"deep 3", 6u}})
        for (const char* filter : {"box 0.5", "mitchell 2"}) {
            const LayeredFilm image(closedRoom(row, filter), 64);
            const DeepImage deep = image.deep();
            checkTidy(deep, most);
            const Flat f = flat(deep);
            double mean = 0;
            for (const float v : image.picture.g) mean += static_cast<double>(v) / static_cast<double>(f.g.size());
            REQUIRE(mean > 0);
            for (std::size_t i = 0; i < f.g.size(); ++i) {
                REQUIRE(f.r[i] == doctest::Approx(image.picture.r[i]).epsilon(1e-5).scale(mean));
                REQUIRE(f.g[i] == doctest::Approx(image.picture.g[i]).epsilon(1e-5).scale(mean));
                REQUIRE(f.b[i] == doctest::Approx(image.picture.b[i]).epsilon(1e-5).scale(mean));
                REQUIRE(f.a[i] == doctest::Approx(1).epsilon(1e-6));
            }
        }
}

TEST_CASE("a deep image changes nothing of the picture, and is the same in two parts put together") {
    const std::string text = closedRoom("deep 6", "box 0.5");
    const LayeredFilm with(text, 32), without(closedRoom("samples", "box 0.5"), 32);
    CHECK(with.picture.r == without.picture.r);
    CHECK(with.picture.variance == without.picture.variance);
    RenderSettings settings = with.scene.settings();
    settings.samples = 32;
    settings.parts = 2;
    PixelFilm halves[2] = {LayeredFilm::makeFilm(with.scene), LayeredFilm::makeFilm(with.scene)};
    for (std::uint32_t part = 0; part < 2; ++part) {
        settings.part = part + 1;
        makePathTracer(with.scene.scene().effects)->render(with.scene.scene(), halves[part], settings, {});
    }
    const auto from = halves[1].planes(), to = halves[0].planes();
    for (std::size_t i = 0; i < from.size(); ++i) {
        std::vector<std::byte> bytes;
        from[i]->store(halves[1].bounds(), bytes);
        REQUIRE(to[i]->add(halves[0].bounds(), bytes));
    }
    const DeepImage whole = with.deep(), together = deepImage(halves[0], with.view());
    CHECK(together.counts == whole.counts);
    CHECK(together.front == whole.front);
    CHECK(together.a == whole.a);
    CHECK(together.g == whole.g);
}

TEST_CASE("surfaces are at their distance, also two in a pixel, and the sky is at none") {
    const LayeredFilm image(header() + R"(
light sky { luminance 100 nits }
shape near quad { points -1 -5 -2.3  0.013 -5 -2.3  0.013 5 -2.3  -1 5 -2.3; material diffuse }
shape far quad { points -5 -5 -7  0.4 -5 -7  0.4 5 -7  -5 5 -7; material diffuse }
)",
                            64);
    const DeepImage deep = image.deep();
    std::vector<std::size_t> first{0};
    for (const std::uint32_t count : deep.counts) first.push_back(first.back() + count);
    const auto left = image.at(4, 6), edge = image.at(8, 6), sky = image.at(15, 6);
    const auto slant = [](int x, int y, double z) {
        const double scale = 2 * std::tan(20 * kPiD / 180) / 16;
        return z * std::hypot(1, scale * (x + 0.5 - 8), scale * (y + 0.5 - 6));
    };
    REQUIRE(deep.counts[left] == 1);
    CHECK(deep.a[first[left]] == 1);
    CHECK(deep.front[first[left]] == doctest::Approx(slant(4, 6, 2.3)).epsilon(1e-3));
    CHECK(deep.front[first[left]] == deep.back[first[left]]);
    CHECK(deep.counts[sky] == 0);
    REQUIRE(deep.counts[edge] == 2);
    CHECK(deep.front[first[edge]] == doctest::Approx(slant(8, 6, 2.3)).epsilon(1e-3));
    CHECK(deep.front[first[edge] + 1] == doctest::Approx(slant(8, 6, 7)).epsilon(1e-3));
    const double pixel = 2 * 2.3 * std::tan(20 * kPiD / 180) / 16; // at the near one
    CHECK(deep.a[first[edge]] == doctest::Approx(0.013 / pixel).epsilon(0.02));
    CHECK(deep.a[first[edge] + 1] == 1);
    // A share of 64 samples, exactly.
    const double samples = 64 * static_cast<double>(deep.a[first[edge]]);
    CHECK(std::abs(samples - std::round(samples)) < 1e-4);
}

TEST_CASE("a medium lets through what the law of Beer and Lambert says, at every distance and whatever it absorbs") {
    for (const char* albedo : {"1", "0.6", "0"}) {
        INFO(albedo);
        // A slab from 2 to 6, seen so narrowly that all rays are parallel.
        const std::string text = "scene 1\nfilm { size 8 8; filter box 0.5; layers { deep 128 } }\n"
                                 "camera { from 0 0 0; look-at 0 0 -1; fov 1 deg }\nlight sky { luminance 100 nits }\n"
                                 "shape slab box { size 9 9 4; material boundary; transform { translate 0 0 -4 }\n"
                                 "interior homogeneous { extinction 0.4 per-m; albedo " +
                                 std::string(albedo) + " } }\n";
        const LayeredFilm image(text, 256);
        const DeepImage deep = image.deep();
        const double samples = 64 * 256;
        for (const double depth : {2.0, 2.5, 3.0, 4.0, 5.0, 5.75, 6.0, 9.0}) {
            const double wanted = std::exp(-0.4 * std::clamp(depth - 2, 0.0, 4.0));
            const double error = std::sqrt(wanted * (1 - wanted) / samples);
            INFO(depth);
            CHECK(std::abs(passing(deep, depth) - wanted) <= 4 * error + 1e-6);
        }
    }
}

TEST_CASE("how much of a patchy medium is seen through does not depend on what it absorbs") {
    const auto through = [](const char* albedo) {
        const std::string text = "scene 1\nfilm { size 8 8; filter box 0.5; layers { deep 64 } }\n"
                                 "camera { from 0 0 0; look-at 0 0 -1; fov 20 deg }\nlight sky { luminance 100 nits }\n"
                                 "volume slab noise { min -1.5 -1.5 -6; max 1.5 1.5 -2; extinction 1.5 per-m; scale 70 "
                                 "cm; coverage 0.5; albedo " +
                                 std::string(albedo) + " }\n";
        const LayeredFilm image(text, 512);
        return passing(image.deep(), 20);
    };
    const double white = through("1"), grey = through("0.5"), black = through("0");
    CHECK(white > 0.05);
    CHECK(white < 0.95);
    CHECK(std::abs(grey - white) < 0.015);
    CHECK(std::abs(black - white) < 0.015);
}

TEST_CASE("light of a medium that is hardly seen is where it is given off, and none of it is lost to the void behind") {
    const LayeredFilm image(header() +
                                "shape flame box { size 9 9 2; material boundary; transform { translate 0 0 -6 }\n"
                                "interior homogeneous { extinction 0.02 per-m; albedo 0.5; emission 0.01 } }\n"
                                "light lamp point { position 0 0 -1; power 50 lm }\n",
                            64);
    const DeepImage deep = image.deep();
    const Flat f = flat(deep);
    double sum = 0, before = 0;
    for (std::size_t i = 0; i < f.g.size(); ++i) {
        REQUIRE(f.g[i] == doctest::Approx(image.picture.g[i]).epsilon(1e-5));
        sum += static_cast<double>(f.g[i]);
        CHECK(f.a[i] < 0.5f);
    }
    REQUIRE(sum > 0);
    std::size_t at = 0;
    for (const std::uint32_t count : deep.counts)
        for (std::uint32_t s = 0; s < count; ++s, ++at) {
            REQUIRE(deep.back[at] >= 5);
            if (deep.back[at] < 6) before += static_cast<double>(deep.g[at]);
        }
    // Evenly along the way, of which about half lies before 6 m or a little more.
    CHECK(before > 0.3 * sum);
    CHECK(before < 0.7 * sum);
}

TEST_CASE("two things rendered apart and put together by depth are both in one picture") {
    const std::string near = "light near sphere { center 0.1 0 -3; radius 0.6; luminance 500 nits }\n";
    const std::string far =
        "light far quad { points -4 -4 -6  4 -4 -6  4 4 -6  -4 4 -6; luminance 100 nits; two-sided on }\n";
    const std::string middle = "shape fog box { size 9 9 1; material boundary; transform { translate 0 0 -4.5 }\n"
                               "interior homogeneous { extinction 0.7 per-m; albedo 0 } }\n";
    const LayeredFilm a(header() + near + middle, 256), b(header() + far, 256),
        both(header() + near + middle + far, 256);
    const DeepImage x = a.deep(), y = b.deep();
    double worst = 0, sum = 0;
    std::size_t atX = 0, atY = 0;
    for (std::size_t i = 0; i < x.counts.size(); ++i) {
        struct Sample {
            float front, a, g;
        };
        std::vector<Sample> samples;
        for (std::uint32_t s = 0; s < x.counts[i]; ++s, ++atX) samples.push_back({x.front[atX], x.a[atX], x.g[atX]});
        for (std::uint32_t s = 0; s < y.counts[i]; ++s, ++atY) samples.push_back({y.front[atY], y.a[atY], y.g[atY]});
        std::ranges::sort(samples, {}, &Sample::front);
        double g = 0, left = 1;
        for (const Sample& s : samples) {
            g += left * static_cast<double>(s.g);
            left *= 1 - static_cast<double>(s.a);
        }
        const double wanted = both.picture.g[i];
        sum += wanted;
        worst = std::max(worst, std::abs(g - wanted));
    }
    const double mean = sum / static_cast<double>(x.counts.size());
    CHECK(mean > 0);
    CHECK(worst < 0.15 * mean);
}

} // namespace abbe::test
