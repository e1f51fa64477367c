// Random numbers, textures, cameras and files: cases 73, 75 to 80 of docs/hard_cases.md.
#include "cameras/perspective.h"
#include "hard_cases/hard_case.h"
#include "math/warp.h"
#include "parser/number.h"
#include "support/picture_file.h"
#include "support/scene_test.h"
#include "textures/image_texture.h"
#include "transport/sampler.h"

#include <set>
#include <unordered_set>

using namespace abbe;
using namespace abbe::test;

TEST_CASE("case 73: light tracing to a lens nearby or edge-on") {
    HardCase c;
    // 1 mm above a floor, looking along it and 20° down: a pinhole, and a lens of 0.4 mm.
    const double down = 20 * kPiD / 180, height = 1e-3;
    const Vec3d back{0, std::sin(down), std::cos(down)};
    const Frame axes{{1, 0, 0}, Vec3(cross(back, Vec3d{1, 0, 0})), Vec3(back)};
    const Vec2 film{64, 48};
    double seen = 0, connected = 0, worst = 0;
    int infinite = 0, naive = 0;
    for (const double radius : {0.0, 2e-4}) {
        const PerspectiveCamera camera(axes, {64, 48}, 1, radius, 0.02);
        Random random(73);
        const auto inSquare = [&] { return Vec2{random.uniform(), random.uniform()}; };
        const auto ask = [&](Vec3d p) {
            auto found = camera.connect({Vec3(p), inSquare(), 0, 550, {}, film});
            if (found && !(std::isfinite(found->importance) && std::isfinite(found->pdfFacingArea) &&
                           isFinite(found->wi) && isFinite(found->lens)))
                ++infinite;
            return found;
        };
        for (int i = 0; i < 20000; ++i) {
            const Vec3d w(squareToSphere(inSquare()));
            const double d = std::pow(10, -25 * random.uniformDouble());
            ask(w * d);
            naive += !std::isfinite(1 / abbe::square(static_cast<float>(d)));
        }
        // The floor's share of the film, by rays and by connections from places whose distance is drawn evenly in its
        // logarithm.
        constexpr int kSamples = 400'000;
        const double nearest = 1e-5, octaves = std::log(1e8);
        seen = connected = 0;
        for (int i = 0; i < kSamples; ++i) {
            const Vec2 at = inSquare();
            seen += camera.ray({{at.x * film.x, at.y * film.y}, inSquare(), 0, 550}).ray.direction.y < 0;
            const double r = nearest * std::exp(octaves * random.uniformDouble()),
                         a = 2 * kPiD * random.uniformDouble();
            if (const auto found = ask({r * std::cos(a), -height, r * std::sin(a)}))
                connected +=
                    static_cast<double>(found->importance * std::abs(found->wi.y)) * r * r * octaves * 2 * kPiD;
        }
        worst = std::max(worst, std::abs(connected / static_cast<double>(film.x * film.y) / seen - 1));
    }
    c.measured("connections with a number that is not finite, from 1e-25 m on", infinite, 0);
    c.naive("1/d² as it comes", naive);
    c.measured("the floor's light, connected against traced, relative", worst, 0.01);
}

TEST_CASE("case 75: too many dimensions, too long sequences, equal seeds") {
    HardCase c;
    // As the path loop makes them (tile_kernel.h): of a frame of 1000 × 1000 pixels.
    std::unordered_set<std::uint64_t> seeds;
    std::unordered_set<std::uint32_t> narrow, plain;
    for (std::uint64_t y = 0; y < 1000; ++y)
        for (std::uint64_t x = 0; x < 1000; ++x) {
            const std::uint64_t seed = combine64(combine64(1, y << 32 | x), 0);
            seeds.insert(seed);
            narrow.insert(static_cast<std::uint32_t>(seed));
            plain.insert(static_cast<std::uint32_t>(x * 131 + y * 31));
        }
    c.measured("equal seeds of 64 bits among 1e6 pixels", 1e6 - static_cast<double>(seeds.size()), 0);
    const double birthday = 1e12 / 2 / 0x1p32; // 116
    c.measured("equal scrambles of 32 bits beyond the birthday's 116, in standard errors",
               (1e6 - static_cast<double>(narrow.size()) - birthday) / std::sqrt(birthday), 3);
    c.naive("with seeds x · 131 + y · 31", (1e6 - static_cast<double>(plain.size()) - birthday) / std::sqrt(birthday));
    // Correlation of the first numbers of neighbours, and of vertices far beyond the joint dimensions.
    Moments neighbours, deep;
    double before = 0.5;
    for (std::uint64_t pixel = 0; pixel < 20000; ++pixel) {
        Sampler sampler;
        sampler.startPixel(combine64(combine64(1, pixel), 0), Technique::Numbers::sobol, true);
        sampler.start(4000000000u); // an index next to 2³²
        const double u = static_cast<double>(sampler.film().x);
        neighbours.add((u - 0.5) * (before - 0.5) * 12);
        before = u;
        deep.add((static_cast<double>(sampler.vertex(50).bsdf.x) - 0.5) *
                 (static_cast<double>(sampler.vertex(51).bsdf.x) - 0.5) * 12);
    }
    c.measured("largest correlation between neighbours, or between vertices 50 and 51, in standard errors",
               std::max(std::abs(neighbours.mean()) / neighbours.standardError(),
                        std::abs(deep.mean()) / deep.standardError()),
               4);
}

TEST_CASE("case 76: a random number of 1") {
    HardCase c;
    int ones = 0;
    for (std::uint64_t i = 0; i < 1u << 16; ++i) ones += !(unitFloat(0xffffffffu - static_cast<std::uint32_t>(i)) < 1);
    RandomStream stream(1);
    for (int i = 0; i < 2000000; ++i) {
        const float u = stream.uniform();
        ones += !(u >= 0 && u < 1);
    }
    Sampler sampler;
    for (const bool random : {false, true})
        for (std::uint32_t i = 0; i < 200000; ++i) {
            if (i % 1000 == 0)
                sampler.startPixel(mix64(i), random ? Technique::Numbers::random : Technique::Numbers::sobol, true);
            sampler.start(i * 40503u);
            const VertexSample v = sampler.vertex(i % 9);
            ones += !(sampler.wavelength() >= 0 && sampler.wavelength() < 1);
            for (const float u :
                 {sampler.film().x, sampler.lens().y, v.light.x, v.bsdf.y, v.pick, v.lobe, sampler.roulette(3)})
                ones += !(u >= 0 && u < 1);
        }
    // Every value that a scramble can give: the 24 upper bits.
    alignas(32) float out[8];
    scrambleToFloats(~UInt8{}, UInt8{}, out);
    for (const float u : out) ones += !(u < 1);
    c.measured("numbers of 1 or more, of 5 million and of the largest of each kind", ones, 0);
    const volatile std::uint32_t largest = 0xffffffffu;
    c.naive("1 or more by dividing 32 bits in single precision", static_cast<float>(largest) * 0x1p-32f >= 1 ? 1 : 0);
}

namespace {

// The texture of a picture, read as numbers.
struct PictureTexture {
    explicit PictureTexture(const abbe_test::Picture& p) {
        const std::string path = (folder.path / "x.tif").string();
        writePicture(path, p);
        ImageTextureParams params;
        params.file.value = path;
        params.file.keys.emplace_back("space", "data");
        params.wrap.word = "periodic";
        TextureStoreSettings settings;
        settings.directory = folder.path / "cache";
        Diagnostics diagnostics;
        texture = makeImageTexture(params, std::make_shared<TextureStore>(settings), diagnostics);
        REQUIRE(texture);
        REQUIRE(texture->prepare(TextureUse::number, {}, diagnostics));
    }
    double at(float u, float v, Vec2 du = {}, Vec2 dv = {}) const {
        TextureQuery q(Vec2{u, v}, Vec3{});
        q.du = du;
        q.dv = dv;
        return static_cast<double>(texture->value(q).x);
    }
    abbe_test::TemporaryFolder folder;
    std::unique_ptr<Texture> texture;
};

} // namespace

TEST_CASE("case 77: uv of ±1e6, uv that are no numbers, pictures of 1×1 and 65536 columns") {
    HardCase c;
    const PictureTexture ramp({100, 1, 1, 4, [](int x, int, int) { return x; }});
    double worst = 0, naive = 0;
    for (const float repeats : {0.f, 1e5f, -1e5f})
        for (int i = 32; i < 96; ++i) {
            const float u = repeats + static_cast<float>(i) / 128; // floats of this size know so much
            const double exact = (static_cast<double>(u) - std::floor(static_cast<double>(u))) * 100 - 0.5;
            worst = std::max(worst, std::abs(ramp.at(u, 0.5f) - exact));
            const float texel = u * 100; // scaled before the whole part is taken off
            naive = std::max(naive, std::abs(static_cast<double>(texel - 100 * std::floor(texel / 100)) - 0.5 - exact));
        }
    c.measured("error of a lookup 1e5 repeats away, texels", worst, 0.25);
    c.naive("the texel by scaling in single precision first", naive);
    int bad = 0;
    const PictureTexture single({1, 1, 1, 4, [](int, int, int) { return 0.7; }});
    const PictureTexture wide({65536, 2, 1, 1, [](int x, int, int) { return x / 256 / 255.0; }});
    for (const PictureTexture* t : {&ramp, &single, &wide})
        for (const float u : {1e6f, -1e6f, 1e30f, NAN, INFINITY, -INFINITY, -0.f})
            for (const float du : {0.f, 1e-30f, 1e30f, NAN, INFINITY})
                bad += !std::isfinite(t->at(u, 0.5f, {du, 0}, {0, du}));
    c.measured("lookups that are not finite", bad, 0);
    c.measured("error of a texel of 65536 columns", std::abs(wide.at(100.5f / 256, 0.5f) - 100 / 255.0), 1e-3);
}

TEST_CASE("case 78: infinite footprints, footprints longer than the picture") {
    HardCase c;
    const PictureTexture board({64, 64, 1, 1, [](int x, int y, int) { return (x + y) % 2; }});
    double worst = 0;
    int bad = 0;
    for (const float wide : {1.f, 100.f, 1e30f, INFINITY})
        for (const float narrow : {wide, 0.f, 1e-6f}) {
            const double v = board.at(0.3f, 0.7f, {wide, 0}, {0, narrow});
            bad += !(v >= -0.1 && v <= 1.1);
            if (narrow == wide) worst = std::max(worst, std::abs(v - 0.5));
        }
    c.measured("error of the mean of a checkerboard over footprints up to infinite ones", worst, 0.006);
    c.measured("values outside of 0 … 1 by more than 0.1", bad, 0);
    const volatile float wide = INFINITY;
    c.naive("level of detail of an infinite footprint over another",
            static_cast<double>(std::log2(wide) - std::log2(wide)));
    // A chain of mirrors and lenses: cones that grow without end.
    const TestScene chain = TestScene::parse(
        "scene 1\nfilm { size 8 8 }\ncamera { from 0 0 4; look-at 0 0 0; fov 30 deg }\nlight sky { radiance 1 }\n"
        "shape sphere { center -0.9 0 0; radius 0.8; material conductor { index metal Ag; roughness 0 } }\n"
        "shape sphere { center 0.9 0 0; radius 0.8; material dielectric { ior 1.5 } }\n"
        "shape plane { center 0 -1 0; material diffuse { reflectance checker { scale 8 } } }\n");
    REQUIRE_MESSAGE(!chain.diagnostics().hasErrors(), chain.report());
    const TestImage image = render(chain, 128);
    c.measured(
        "samples dropped in a chain of mirrors, lenses and a checkerboard",
        static_cast<double>(image.statistics.dropped[0] + image.statistics.dropped[1] + image.statistics.dropped[2]),
        0);
}

TEST_CASE("case 79: angles of view of 0 and 180°, no aperture, focus at 0 or nowhere, no shutter") {
    HardCase c;
    int bad = 0, refused = 0, made = 0;
    for (const char* fov : {"0 deg", "1e-9 deg", "1 deg", "40 deg", "179 deg", "180 deg", "-5 deg"})
        for (const char* focus : {"0 m", "1e-30 m", "1 mm", "1e15 m", "infinite", "-1 m"})
            for (const char* rest :
                 {"", "; aperture 0 mm", "; aperture 1e9 m", "; shutter 0 s", "; aperture -1 mm", "; f-stop 2"}) {
                const TestScene scene =
                    TestScene::parse(fmt::format("scene 1\nfilm {{ size 4 4 }}\ncamera {{ from 0 0 5; look-at 0 0 0; "
                                                 "fov {}; focus {}{} }}\nlight sky {{ radiance 1 }}\n",
                                                 fov, focus, rest));
                if (scene.diagnostics().hasErrors()) {
                    ++refused;
                    for (const Diagnostic& d : scene.diagnostics().all())
                        bad += d.span.file == FileId::none; // without a place
                    continue;
                }
                ++made;
                for (const Vec2 film : {Vec2{0, 0}, {4, 4}, {2.5f, 0.5f}})
                    for (const Vec2 lens : {Vec2{0, 0}, {0.5f, 0.5f}, {kOneMinusEpsilon, kOneMinusEpsilon}}) {
                        CameraSample sample;
                        sample.film = film;
                        sample.lens = lens;
                        sample.time = lens.x;
                        const CameraRay r = scene.scene().camera->ray(sample);
                        bad += !isFinite(r.ray.origin) || !(std::abs(length(r.ray.direction) - 1) < 1e-4f) ||
                               !std::isfinite(r.weight);
                    }
            }
    CHECK(refused > 20);
    CHECK(made > 10);
    c.measured("of 252 cameras at the ends of their ranges, rays that are not finite and errors without a place", bad,
               0);
    const volatile float angle = 0;
    c.naive("distance of the film at an angle of view of 0", static_cast<double>(0.018f / std::tan(angle / 2)));
}

TEST_CASE("case 80: 1e-400, 1e400, `nan`, a comma for a point, blocks without end") {
    HardCase c;
    int wrong = 0;
    const auto accepted = [](const std::string& value) {
        return !TestScene::parse(
                    "scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\nlight sky { radiance 1 }\nshape sphere { radius " +
                    value + " }\n")
                    .diagnostics()
                    .hasErrors();
    };
    for (const char* value :
         {"1e400", "-1e400", "nan", "inf", "#nan", "#inf", "0,5", "1e", "--1", "0x", "1e-400", "1.5.2"})
        wrong += accepted(value);
    wrong += !accepted("0.5");
    std::string deep;
    for (int i = 0; i < 100000; ++i) deep += "group { ";
    wrong += !TestScene::parse("scene 1\n" + deep).diagnostics().hasErrors();
    // The number itself, before any range of a field could refuse it.
    for (const char* text : {"1e400", "-1e400", "1e99999999999", "179769313486231590000e289"})
        wrong += parser::parseNumber(text).error != parser::NumberError::overflow;
    c.measured("of eighteen texts, those that are judged wrongly", wrong, 0);
    c.naive("1e400 by strtod", std::strtod("1e400", nullptr));
    // Cut, repeated and mixed pieces of a scene.
    const std::string text =
        "scene 1 length=mm // c\ncamera \"a\" { from 0 1 4; lens 35 mm }\nlight sky { radiance 1e3 }\n"
        "material m dielectric { ior 1.5; roughness 0.2 }\nshape sphere { radius 1e-3; material m }\n"
        "shape mesh { points { - 0 0 0; - 1 0 0; - 0 1 0 }; faces { - 0 1 2 } }\n";
    Random random(80);
    int places = 0;
    for (int i = 0; i < 4000; ++i) {
        std::string mutant = text;
        for (std::uint32_t k = 1 + random.bits() % 6; k > 0; --k) {
            const std::size_t at = random.bits() % mutant.size(), n = random.bits() % 12;
            switch (random.bits() % 4) {
            case 0:
                mutant.erase(at, n);
                break;
            case 1:
                mutant.insert(at, mutant.substr(random.bits() % mutant.size(), n));
                break;
            case 2:
                mutant[at] = static_cast<char>(random.bits() % 256);
                break;
            default:
                mutant.insert(at, std::array{"1e400", "{", "}", "nan", "\"", "-", "$x", "/*", "0,5",
                                             "1e-400"}[random.bits() % 10]);
            }
            if (mutant.empty()) mutant = " ";
        }
        BuildOptions options;
        options.geometry = false;
        const TestScene scene = TestScene::parse(mutant, options);
        for (const Diagnostic& d : scene.diagnostics().all())
            places += d.span.file != FileId::none && d.span.end > mutant.size();
    }
    c.measured("of 4000 damaged scenes, diagnostics that point behind the text; no crash", places, 0);
}
