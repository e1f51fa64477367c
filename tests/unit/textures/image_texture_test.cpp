// Images for shading: filtering, colours, what lies outside, the cache on disk, and what can go wrong.
#include "base/parallel.h"
#include "support/picture_file.h"
#include "textures/image_texture.h"

#include <cmath>
#include <doctest/doctest.h>
#include <iterator>

using namespace abbe;
using abbe_test::Picture;
using abbe_test::writePicture;
namespace fs = std::filesystem;

namespace {

// A folder for pictures, and one for what is made of them.
struct Setup {
    abbe_test::TemporaryFolder folder;
    fs::path cache = folder.path / "cache";
    Diagnostics diagnostics;

    std::string file(const std::string& name, const Picture& p) const {
        writePicture(folder.path / name, p);
        return (folder.path / name).string();
    }
    std::shared_ptr<TextureStore> store(std::int64_t bytes = 64 << 20) const {
        TextureStoreSettings s;
        s.bytes = bytes;
        s.directory = cache;
        return std::make_shared<TextureStore>(s);
    }
    // Null after an error.
    std::unique_ptr<Texture> texture(const std::string& path, const std::string& space,
                                     const std::string& wrap = "periodic", TextureUse use = TextureUse::reflectance) {
        ImageTextureParams params;
        params.file.value = path;
        if (!space.empty()) params.file.keys.emplace_back("space", space);
        params.wrap.word = wrap;
        auto made = makeImageTexture(params, store(), diagnostics);
        return made && made->prepare(use, {}, diagnostics) ? std::move(made) : nullptr;
    }
    std::unique_ptr<Texture> numbers(const std::string& path, const std::string& wrap = "periodic") {
        return texture(path, "data", wrap, TextureUse::number);
    }
    std::string codes() const {
        std::string all;
        for (const Diagnostic& d : diagnostics.all()) all += (all.empty() ? "" : " ") + d.code;
        return all;
    }
    std::size_t cached() const {
        return fs::exists(cache) ? static_cast<std::size_t>(std::distance(fs::directory_iterator(cache), {})) : 0;
    }
    fs::path onlyCached() const { return fs::directory_iterator(cache)->path(); }
};

TextureQuery query(float u, float v, Vec2 du = {}, Vec2 dv = {}) {
    TextureQuery q(Vec2{u, v}, Vec3{});
    q.du = du;
    q.dv = dv;
    return q;
}

float at(const Texture& t, float u, float v, Vec2 du = {}, Vec2 dv = {}) { return t.value(query(u, v, du, dv)).x; }

Picture checkerboard(int width, int height) {
    return {width, height, 1, 1, [](int x, int y, int) { return (x + y) % 2; }};
}

Picture plain(double r, double g, double b, int bytes = 4) {
    return {8, 8, 3, bytes, [=](int, int, int c) { return c == 0 ? r : c == 1 ? g : b; }};
}

} // namespace

TEST_CASE("image texture: over a large footprint it is the mean, whatever the size") {
    Setup s;
    const int sizes[][2] = {{64, 64}, {256, 16}, {62, 34}, {1, 1}, {2, 1}};
    for (const auto& [w, h] : sizes) {
        const auto t = s.numbers(s.file("board.tif", checkerboard(w, h)));
        REQUIRE(t);
        const float mean = static_cast<float>(w * h / 2) / static_cast<float>(w * h);
        for (const float wide : {1.f, 100.f, 1e30f, INFINITY}) {
            CAPTURE(w);
            CAPTURE(h);
            CAPTURE(wide);
            CHECK(at(*t, 0.3f, 0.7f, {wide, 0}, {0, wide}) == doctest::Approx(mean).epsilon(0.006));
        }
    }
    // The last level of odd sizes is the mean of all texels, not of those that pair up.
    const auto odd = s.numbers(s.file("odd.tif", {63, 37, 1, 4, [](int x, int y, int) { return x * x + 3 * y; }}));
    REQUIRE(odd);
    double mean = 0;
    for (int y = 0; y < 37; ++y)
        for (int x = 0; x < 63; ++x) mean += (x * x + 3 * y) / (63.0 * 37);
    CHECK(at(*odd, 0.5f, 0.5f, {1, 0}, {0, 1}) == doctest::Approx(mean).epsilon(1e-5));
    CHECK(s.codes() == "");
}

TEST_CASE("image texture: a footprint of some texels sees about their mean") {
    Setup s;
    // A step in the middle: what a footprint of a given width sees of it.
    const auto t =
        s.numbers(s.file("step.tif", {256, 256, 1, 1, [](int x, int, int) { return x < 128 ? 0 : 1; }}), "clamp");
    REQUIRE(t);
    for (const float half : {0.01f, 0.03f, 0.1f}) {
        CHECK(at(*t, 0.5f, 0.5f, {half, 0}, {0, half}) == doctest::Approx(0.5).epsilon(0.02));
        CHECK(at(*t, 0.5f - 3 * half, 0.5f, {half, 0}, {0, half}) < 0.03f);
        CHECK(at(*t, 0.5f + 3 * half, 0.5f, {half, 0}, {0, half}) > 0.97f);
        const float near = at(*t, 0.5f + 0.5f * half, 0.5f, {half, 0}, {0, half});
        CHECK(near > 0.55f); // a filter as wide as that has not forgotten on which side it is
        CHECK(near < 0.98f);
    }
    CHECK(at(*t, 0.5f - 0.02f, 0.5f) == 0);
    CHECK(at(*t, 0.5f + 0.02f, 0.5f) == 1);
}

TEST_CASE("image texture: long footprints blur along themselves alone") {
    Setup s;
    // Stripes of four texels, upright.
    const auto t = s.numbers(s.file("stripes.tif", {256, 256, 1, 1, [](int x, int, int) { return x / 4 % 2; }}));
    REQUIRE(t);
    const float texel = 1 / 256.f, middle = 6 * texel; // of a white stripe
    const Vec2 thin{texel / 2, 0}, wide{8 * texel, 0}, tall{0, 8 * texel}, low{0, texel / 2};
    CHECK(at(*t, middle, 0.5f, tall, thin) > 0.9f);
    CHECK(at(*t, middle, 0.5f, wide, low) == doctest::Approx(0.5).epsilon(0.12));
    CHECK(at(*t, middle, 0.5f, thin, tall) > 0.9f); // whichever is named first
    // The same slanted: stripes of x + y, across and along.
    const auto slanted =
        s.numbers(s.file("slanted.tif", {256, 256, 1, 1, [](int x, int y, int) { return (x + y) / 6 % 2; }}));
    REQUIRE(slanted);
    const float d = 6 * texel;
    const float u = 100.5f * texel, v = 1 - (109 - 0.5f - 100.5f + 0.5f) * texel; // x + y = 108 … 113 is dark
    CHECK(at(*slanted, u, v, {d, d}, {texel / 3, -texel / 3}) < 0.3f);
    CHECK(std::abs(at(*slanted, u, v, {d, -d}, {texel / 3, texel / 3}) - 0.5f) < 0.15f);
}

TEST_CASE("image texture: v = 0 is the lower edge; outside of the unit square; far away") {
    Setup s;
    const auto ramp = [](int x, int y, int) { return x < 8 ? 0 : y < 8 ? 1.0 : 0.5; }; // bright at the upper right
    const std::string path = s.file("ramp.tif", {16, 16, 1, 4, ramp});
    const auto periodic = s.numbers(path), clamp = s.numbers(path, "clamp"), mirror = s.numbers(path, "mirror"),
               black = s.numbers(path, "black");
    CHECK(at(*periodic, 0.75f, 0.75f) == doctest::Approx(1));
    CHECK(at(*periodic, 0.75f, 0.25f) == doctest::Approx(0.5));
    CHECK(at(*periodic, 0.25f, 0.25f) == doctest::Approx(0));
    CHECK(at(*periodic, -0.25f, 5.75f) == doctest::Approx(1));
    CHECK(at(*clamp, 7, 7) == doctest::Approx(1));
    CHECK(at(*clamp, 1e6f, -1e6f) == doctest::Approx(0.5));
    CHECK(at(*clamp, -2, 0.5f) == doctest::Approx(0));
    CHECK(at(*mirror, 1.25f, 1.25f) == doctest::Approx(1));
    CHECK(at(*mirror, -0.75f, 0.25f) == doctest::Approx(0.5));
    CHECK(at(*mirror, -0.25f, 0.25f) == doctest::Approx(0));
    CHECK(at(*black, 0.75f, 0.75f) == doctest::Approx(1));
    CHECK(at(*black, 1.75f, 0.75f) == 0);
    CHECK(at(*black, 0.75f, -1e9f) == 0);
    // Hundred thousand repeats away floats still tell quarters of a texel apart: so must the lookup.
    const auto fine = s.numbers(s.file("fine.tif", {32, 1, 1, 4, [](int x, int, int) { return x; }}));
    for (const float repeats : {0.f, 1e5f, -1e5f})
        for (int x = 8; x < 24; ++x) {
            const float u = repeats + (static_cast<float>(x) + 0.5f) / 32;
            CHECK(std::abs(at(*fine, u, 0.5f) - static_cast<float>(x)) < 0.25f);
        }
    CHECK(std::isfinite(at(*fine, 1e6f, -1e6f)));
    CHECK(std::isfinite(at(*fine, NAN, 0.5f, {NAN, 0}, {0, -INFINITY})));
    Diagnostics found;
    fine->reportLookups(found);
    REQUIRE(found.all().size() == 1);
    CHECK(found.all()[0].code == "W0457");
    // Very wide ones, and those of one texel.
    const auto wide = s.numbers(s.file("wide.tif", {65536, 2, 1, 1, [](int x, int, int) { return x / 256 / 255.0; }}));
    CHECK(at(*wide, 100.5f / 256, 0.5f) == doctest::Approx(100 / 255.0));
    CHECK(at(*wide, 0.5f, 0.5f, {1, 0}, {0, 1}) == doctest::Approx(0.5).epsilon(0.01));
}

TEST_CASE("image texture: tiles") {
    Setup s;
    for (const int tile : {1001, 1002, 1011})
        s.file("t." + std::to_string(tile) + ".tif",
               {8, 8, 1, 4, [=](int x, int, int) { return tile - 1000 + x * 0.01; }});
    const auto t = s.numbers((s.folder.path / "t.<UDIM>.tif").string());
    REQUIRE(t);
    CHECK(at(*t, 0.5f, 0.5f) == doctest::Approx(1.035));
    CHECK(at(*t, 1.5f, 0.5f) == doctest::Approx(2.035));
    CHECK(at(*t, 0.5f, 1.5f) == doctest::Approx(11.035));
    CHECK(at(*t, 0.9999f, 0.5f) == doctest::Approx(1.07).epsilon(1e-3)); // does not look into the next one
    CHECK(at(*t, 1.0001f, 0.5f) == doctest::Approx(2).epsilon(1e-3));
    CHECK(at(*t, 2, 0.5f) == doctest::Approx(2.07).epsilon(1e-3)); // the border of the last one
    CHECK(t->covers({0.5f, 1.5f}));
    CHECK(!t->covers({1.5f, 1.5f}));
    CHECK(!t->covers({-0.5f, 0.5f}));
    Diagnostics none, found;
    t->reportLookups(none);
    CHECK(none.all().empty());
    CHECK(at(*t, 1.5f, 1.5f) == 0);
    CHECK(at(*t, -1, 0.5f) == 0);
    t->reportLookups(found);
    REQUIRE(found.all().size() == 1);
    CHECK(found.all()[0].message.find("2 lookups") == 0);
    s.file("t.1002.tif", plain(0.5, 0.5, 0.5, 1));
    CHECK(!s.texture((s.folder.path / "t.<UDIM>.tif").string(), ""));
    CHECK(s.codes() == "E0452");
}

TEST_CASE("image texture: greys are flat and white reflects everything") {
    Setup s;
    const auto grey = s.texture(s.file("grey.tif", plain(0.5, 0.5, 0.5, 2)), "srgb_rec709_scene");
    const auto white = s.texture(s.file("white.tif", plain(1, 1, 1, 1)), "");
    const auto wide = s.texture(s.file("wide.tif", plain(1, 1, 1, 4)), "lin_ap1_scene");
    REQUIRE(grey);
    REQUIRE(white);
    REQUIRE(wide);
    Wavelengths lambda;
    for (int i = 0; i < kLanes; ++i) lambda.nm.v[i] = 390 + 40 * static_cast<float>(i);
    const Spectrum half = grey->spectrum(query(0.4f, 0.6f, {0.1f, 0}, {0, 0.1f}), lambda);
    CHECK(half[0] == doctest::Approx(0.21404).epsilon(5e-4));
    for (int i = 0; i < kLanes; ++i) {
        CHECK(half[i] == half[0]);
        CHECK(white->spectrum(query(0.1f, 0.2f), lambda)[i] == 1);
        CHECK(wide->spectrum(query(0.1f, 0.2f, {0.3f, 0}, {0, 0.3f}), lambda)[i] == 1);
    }
    CHECK(s.codes() == "");
}

TEST_CASE("image texture: curves and primaries") {
    Setup s;
    const std::string path = s.file("paint.tif", plain(0.6, 0.3, 0.2, 4));
    const struct {
        const char* space;
        double red;
        const RgbSpace* primaries;
    } cases[] = {
        {"lin_rec709_scene", 0.6, &rgb::rec709},
        {"srgb_rec709_scene", srgbToLinear(0.6), &rgb::rec709},
        {"acescg", 0.6, &rgb::ap1},
        {"g22_rec709_scene", std::pow(0.6, 2.2), &rgb::rec709},
        {"g18_rec709_scene", std::pow(0.6, 1.8), &rgb::rec709},
        {"srgb_p3d65_scene", srgbToLinear(0.6), &rgb::p3d65},
        {"lin_rec2020_scene", 0.6, &rgb::rec2020},
        {"unknown", 0.6, &rgb::rec709},
        {"", 0.6, &rgb::rec709},
    };
    Wavelengths lambda;
    for (int i = 0; i < kLanes; ++i) lambda.nm.v[i] = 400 + 35 * static_cast<float>(i);
    for (const auto& c : cases) {
        CAPTURE(c.space);
        const auto t = s.texture(path, c.space);
        REQUIRE(t);
        REQUIRE(t->rgbSpace());
        CHECK(t->rgbSpace()->name == c.primaries->name);
        const Vec3 value = t->value(query(0.5f, 0.5f));
        CHECK(value.x == doctest::Approx(c.red).epsilon(1e-5));
        const Spectrum got = t->spectrum(query(0.5f, 0.5f), lambda);
        const Spectrum wanted = UpsamplingTable::loadOrBuild(*c.primaries).lookup(value).at(lambda);
        for (int i = 0; i < kLanes; ++i) CHECK(got[i] == wanted[i]);
    }
    CHECK(s.codes() == "");
    // Light has no upper bound.
    const auto emitter = s.texture(s.file("lamp.tif", plain(7, 3, 2, 4)), "", "periodic", TextureUse::light);
    CHECK(emitter->value(query(0.5f, 0.5f)).x == 7);
    CHECK(s.codes() == "");
}

TEST_CASE("image texture: colours and numbers are told apart") {
    const auto codes = [](const Picture& p, const char* space, TextureUse use) {
        Setup s;
        s.texture(s.file("x.tif", p), space, "periodic", use);
        return s.codes();
    };
    const Picture eight = plain(0.5, 0.5, 0.5, 1), floats = plain(0.5, 0.5, 0.5, 4);
    using enum TextureUse;
    CHECK(codes(eight, "", reflectance) == "");
    CHECK(codes(eight, "", number) == "W0450");
    CHECK(codes(eight, "", heights) == ""); // untagged, and not decoded
    CHECK(codes(eight, "srgb_rec709_scene", heights) == "W0450");
    CHECK(codes(eight, "data", number) == "");
    CHECK(codes(eight, "data", reflectance) == "W0451");
    CHECK(codes(floats, "", number) == "");
    CHECK(codes(floats, "acescg", number) == "W0450");
    CHECK(codes(floats, "", light) == "");
    Setup s;
    const auto decoded = s.texture(s.file("x.tif", eight), "", "periodic", number);
    CHECK(at(*decoded, 0.5f, 0.5f) == doctest::Approx(srgbToLinear(128 / 255.0)).epsilon(1e-3));
}

TEST_CASE("image texture: values that no texture can have") {
    const auto codes = [](double bad, const char* space, TextureUse use) {
        Setup s;
        const Picture p{40, 40, 3, 4, [=](int x, int y, int c) { return x == 7 && y == 33 && c == 1 ? bad : 0.3; }};
        const auto t = s.texture(s.file("x.tif", p), space, "periodic", use);
        if (t && use != TextureUse::heights) {
            const Vec3 v = t->value(query(0.2f, 0.2f, {0.5f, 0}, {0, 0.5f}));
            CHECK(std::isfinite(v.x + v.y + v.z));
        }
        CHECK(s.cached() == (t && use != TextureUse::heights ? 1 : 0));
        return s.codes();
    };
    using enum TextureUse;
    for (const TextureUse use : {reflectance, number, light, heights}) {
        CHECK(codes(NAN, use == number ? "data" : "", use) == "E0451");
        CHECK(codes(-INFINITY, use == number ? "data" : "", use) == "E0451");
    }
    CHECK(codes(0, "", reflectance) == "");
    CHECK(codes(-2, "", reflectance) == "W0453");
    CHECK(codes(-2, "data", number) == "");
    CHECK(codes(3, "", reflectance) == "W0454");
    CHECK(codes(3, "", light) == "");
    // Red alone is a reflectance in Rec. 709, and far outside of what reflects in the primaries of ACES.
    Setup s;
    CHECK(s.texture(s.file("red.tif", plain(0.6, 0.05, 0.02)), "lin_rec709_scene"));
    CHECK(s.codes() == "");
    CHECK(s.texture(s.file("red.tif", plain(0.9, 0.0, 0.0)), "lin_ap0_scene"));
    CHECK(s.codes() == "W0455");
}

TEST_CASE("image texture: converted once, and again when the picture or the file changes") {
    Setup s;
    const std::string path = s.file("x.tif", plain(0.25, -0.25, 0.25));
    CHECK(at(*s.texture(path, ""), 0.5f, 0.5f) == doctest::Approx(0.25));
    REQUIRE(s.cached() == 1);
    CHECK(s.codes() == "W0453");
    const fs::path made = s.onlyCached();
    const auto written = fs::last_write_time(made);
    CHECK(at(*s.texture(path, ""), 0.5f, 0.5f) == doctest::Approx(0.25));
    CHECK(fs::last_write_time(made) == written);
    CHECK(s.codes() == "W0453 W0453"); // the warning stays with the file
    // Cut off, blanked in the middle, or emptied.
    for (const int fault : {0, 1, 2}) {
        const auto size = fs::file_size(made);
        if (fault == 0) fs::resize_file(made, size / 2);
        if (fault == 1) {
            std::fstream file(made, std::ios::binary | std::ios::in | std::ios::out);
            file.seekp(static_cast<std::streamoff>(size / 3));
            file.write("\xff\x01\x02\x03", 4);
        }
        if (fault == 2) std::ofstream(made, std::ios::binary);
        CHECK(at(*s.texture(path, ""), 0.5f, 0.5f) == doctest::Approx(0.25));
        CHECK(s.cached() == 1);
        CHECK(fs::file_size(made) > 1000);
    }
    s.file("x.tif", plain(0.75, 0.75, 0.75));
    CHECK(at(*s.texture(path, ""), 0.5f, 0.5f) == doctest::Approx(0.75));
    CHECK(s.cached() == 2);
    CHECK(at(*s.texture(path, "srgb_rec709_scene"), 0.5f, 0.5f) == doctest::Approx(srgbToLinear(0.75)).epsilon(1e-4));
    CHECK(s.cached() == 3);
}

TEST_CASE("image texture: a texture that is one already is used as it is") {
    Setup s;
    const std::string path = s.file("x.tif", plain(0.25, 0.5, 0.25));
    CHECK(s.texture(path, ""));
    const fs::path tx = s.folder.path / "x.tx";
    fs::copy_file(s.onlyCached(), tx);
    fs::remove_all(s.cache);
    const auto t = s.texture(tx.string(), "lin_rec709_scene");
    REQUIRE(t);
    CHECK(s.cached() == 0);
    CHECK(t->value(query(0.5f, 0.5f)).y == doctest::Approx(0.5));
    CHECK(s.texture(tx.string(), "srgb_rec709_scene")); // but not if it is still encoded
    CHECK(s.cached() == 1);
}

TEST_CASE("image texture: without a place for the cache the picture itself is used, with a warning") {
    Setup s;
    std::ofstream(s.cache) << "a file, and no folder";
    const auto t = s.texture(s.file("x.tif", {64, 64, 3, 1, [](int x, int, int) { return x < 32 ? 0.2 : 0.6; }}), "");
    REQUIRE(t);
    CHECK(s.codes() == "W0452");
    CHECK(at(*t, 0.25f, 0.5f) == doctest::Approx(srgbToLinear(0.2)).epsilon(1e-3));
    CHECK(at(*t, 0.75f, 0.5f) == doctest::Approx(srgbToLinear(0.6)).epsilon(1e-3));
    CHECK(at(*t, 0.5f, 0.5f, {1, 0}, {0, 1}) == doctest::Approx(srgbToLinear(0.4)).epsilon(1e-2));
    Setup unset;
    unset.cache.clear();
    CHECK(unset.texture(unset.file("x.tif", plain(0.5, 0.5, 0.5)), ""));
    CHECK(unset.codes() == "W0452");
}

TEST_CASE("image texture: a file that breaks while rendering is counted, and made anew the next time") {
    Setup s;
    const std::string path =
        s.file("x.tif", {512, 512, 1, 4, [](int x, int y, int) { return (x * 7919 + y * 104729) % 1009 / 1009.0; }});
    const auto t = s.numbers(path);
    REQUIRE(t);
    fs::resize_file(s.onlyCached(), 3000);
    for (int i = 0; i < 64; ++i) CHECK(std::isfinite(at(*t, static_cast<float>(i) / 64, 0.3f)));
    Diagnostics found;
    t->reportLookups(found);
    REQUIRE(found.all().size() == 1);
    CHECK(found.all()[0].code == "W0458");
    CHECK(s.cached() == 0);
    CHECK(s.numbers(path));
    CHECK(s.cached() == 1);
}

TEST_CASE("image texture: threads agree, also when tiles come and go") {
    Setup s;
    const std::string path = s.file("x.tif", {1024, 1024, 3, 1, [](int x, int y, int c) {
                                                  return static_cast<double>((x * 31 + y * 17 + c * 101) % 256) / 255;
                                              }});
    ImageTextureParams params;
    params.file.value = path;
    const auto values = [&](std::int64_t bytes, bool parallel) {
        auto t = makeImageTexture(params, s.store(bytes), s.diagnostics);
        REQUIRE(t->prepare(TextureUse::reflectance, {}, s.diagnostics));
        std::vector<Vec3> result(20000);
        const auto body = [&](std::size_t i) {
            const float u = static_cast<float>(i * 7919 % 20011) / 20011,
                        v = static_cast<float>(i * 104729 % 20021) / 20021;
            const float half = 0.001f * static_cast<float>(1 + i % 50);
            result[i] = t->value(query(u, v, {half, 0}, {0, half / 3}));
        };
        if (parallel)
            parallelFor(result.size(), body);
        else
            for (std::size_t i = 0; i < result.size(); ++i) body(i);
        return result;
    };
    const auto alone = values(64 << 20, false), together = values(64 << 20, true), crowded = values(1 << 20, true);
    std::size_t different = 0;
    for (std::size_t i = 0; i < alone.size(); ++i) different += !(alone[i] == together[i]) + !(alone[i] == crowded[i]);
    CHECK(different == 0);
}

TEST_CASE("image texture: alpha alone, as numbers, from what the cache has and for heights") {
    // A PNG of 2 × 2 pixels: alpha 255 and 0 above, 128 and 255 below.
    static constexpr unsigned char kPng[] = {
        0x89, 'P',  'N',  'G',  0x0d, 0x0a, 0x1a, 0x0a, 0,   0,    0,    0x0d, 'I',  'H',  'D',  'R',
        0,    0,    0,    2,    0,    0,    0,    2,    8,   6,    0,    0,    0,    0x72, 0xb6, 0x0d,
        0x24, 0,    0,    0,    0x15, 'I',  'D',  'A',  'T', 0x78, 0xda, 0x63, 0xf8, 0xcf, 0xc0, 0xf0,
        0x1f, 0x08, 0x41, 0xe0, 0x7f, 0xc3, 0x7f, 0x20, 0,   0,    0x3d, 0x57, 0x08, 0x79, 0x22, 0xc5,
        0x0c, 0x7b, 0,    0,    0,    0,    'I',  'E',  'N', 'D',  0xae, 0x42, 0x60, 0x82};
    Setup s;
    std::ofstream(s.folder.path / "leaf.png", std::ios::binary)
        .write(reinterpret_cast<const char*>(kPng), static_cast<std::streamsize>(sizeof kPng));
    ImageTextureParams params;
    params.file.value = (s.folder.path / "leaf.png").string();
    params.take.word = "alpha";
    params.wrap.word = "clamp";
    for (int time = 0; time < 2; ++time) { // converted, and as it was kept
        const auto t = makeImageTexture(params, s.store(), s.diagnostics);
        REQUIRE(t);
        REQUIRE(t->prepare(TextureUse::number, {}, s.diagnostics));
        CHECK(t->channels() == 1);
        // Outside of the picture its corners alone count.
        CHECK(at(*t, -2, 3) == doctest::Approx(1).epsilon(1e-3));
        CHECK(at(*t, 3, 3) == doctest::Approx(0).epsilon(1e-3));
        CHECK(at(*t, -2, -2) == doctest::Approx(128 / 255.0).epsilon(1e-3));
        CHECK(at(*t, 3, -2) == doctest::Approx(1).epsilon(1e-3));
        REQUIRE(t->prepare(TextureUse::heights, {}, s.diagnostics));
        CHECK(t->jet({{}, {0.75f, 0.75f}, {0.75f, 0.75f}}, 1).value.x < 0.5f);
    }
    // the colours beside it are kept for themselves
    params.take.word = "color";
    params.file.keys.emplace_back("space", "data");
    const auto colors = makeImageTexture(params, s.store(), s.diagnostics);
    REQUIRE(colors);
    REQUIRE(colors->prepare(TextureUse::number, {}, s.diagnostics));
    CHECK(colors->value(query(3, 3)).y == doctest::Approx(1).epsilon(1e-3)); // not multiplied by alpha 0
    CHECK(s.cached() == 2);
    CHECK(s.codes() == "");
    params.take.word = "alpha";
    params.file.value = s.file("plain.tif", plain(0.5, 0.5, 0.5));
    CHECK_FALSE(makeImageTexture(params, s.store(), s.diagnostics));
    CHECK(s.codes() == "E0455");
}
