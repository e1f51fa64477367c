// Layers of rendered images: what they hold, and that they change nothing.
#include "film/layer_planes.h"
#include "rendering/path_tracer.h"
#include "spectrum/sensor.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <map>

namespace abbe::test {
namespace {

// A floor, a sphere of %s and two lights with names; `layers` is the block's content.
std::string sceneText(const std::string& layers, const std::string& material = "diffuse") {
    return "scene 1\nfilm { size 24 16; filter box 0.5; output \"x.exr\" space=acescg" +
           (layers.empty() ? std::string() : "; layers { " + layers + " }") + R"( }
camera { from 0 1 4; look-at 0 0.5 0; fov 40 deg }
shape floor quad { points -3 0 -3  -3 0 3  3 0 3  3 0 -3; material diffuse { reflectance rgb 0.6 0.3 0.1 space=acescg } }
shape ball sphere { center 0 0.6 0; radius 0.6; material )" +
           material + R"( }
light key quad { points -1 2 -1  1 2 -1  1 2 1  -1 2 1; luminance 3000 nits }
light lamp sphere { center 1.2 0.3 0.5; radius 0.1; power 300 lm }
light sky { luminance 100 nits }
)";
}

struct Layered {
    TestScene scene;
    PixelFilm film;
    ResolvedImage picture;
    LayerPlanes layers;

    explicit Layered(const std::string& text, std::uint32_t samples = 32, int replicates = 2)
        : scene(TestScene::parse(text)), film(makeFilm(scene, replicates)) {
        RenderSettings settings = scene.settings();
        settings.samples = samples;
        makePathTracer(scene.scene().effects)->render(scene.scene(), film, settings, {});
        const double exposure = scene.built().exposure;
        picture = film.resolve(rgb::ap1.fromXyz(), exposure);
        layers = layerPlanes(film, picture, {&rgb::ap1, rgb::ap1.fromXyz(), exposure, scene.scene().origin});
    }
    static PixelFilm makeFilm(const TestScene& scene, int replicates) {
        const FilmSettings s = filmSettings(scene.built().film);
        PixelFilm film(s.crop, PixelFilter(s.filter, s.filterRadius), replicates);
        film.keepLayers(scene.built().layers, scene.scene().names, rgb::ap1);
        return film;
    }
    const std::vector<float>& plane(std::string_view name) const {
        for (const NamedPlane& p : layers.planes)
            if (p.name == name) return p.values;
        FAIL(std::string(name));
        return layers.planes[0].values;
    }
    std::size_t at(int x, int y) const { return static_cast<std::size_t>(y * 24 + x); }
};

double meanOf(const std::vector<float>& v) {
    double sum = 0;
    for (const float x : v) sum += static_cast<double>(x);
    return sum / static_cast<double>(v.size());
}

constexpr const char* kAll = "albedo; normal; position; depth; uv; samples; seconds; invalid; object-id; material-id; "
                             "cryptomatte; spectral; denoise";

} // namespace

TEST_CASE("layers change nothing of the picture") {
    for (const char* material : {"diffuse", "dielectric { ior glass SF11 }"}) {
        const Layered with(sceneText(kAll, material)), without(sceneText("", material));
        CHECK(without.film.layers() == nullptr);
        CHECK(with.picture.r == without.picture.r);
        CHECK(with.picture.b == without.picture.b);
        CHECK(with.picture.variance == without.picture.variance);
        // Parts that cancel may cost some last bits.
        const Layered parts(sceneText("components; light-group key", material));
        std::size_t same = 0;
        for (std::size_t i = 0; i < without.picture.r.size(); ++i) {
            same += parts.picture.r[i] == without.picture.r[i];
            CHECK(parts.picture.r[i] == doctest::Approx(without.picture.r[i]).epsilon(1e-5));
        }
        CHECK(same > without.picture.r.size() * 9 / 10);
    }
}

TEST_CASE("features: what is seen where") {
    const Layered image(sceneText("albedo; normal; position; depth; uv; denoise; samples; object-id; material-id"), 64);
    const auto floor = image.at(4, 14), ball = image.at(12, 7), sky = image.at(1, 0);
    CHECK(image.plane("albedo.R")[floor] == doctest::Approx(0.6).epsilon(0.02));
    CHECK(image.plane("albedo.G")[floor] == doctest::Approx(0.3).epsilon(0.02));
    CHECK(image.plane("albedo.B")[floor] == doctest::Approx(0.1).epsilon(0.04));
    // Over many pixels: one alone has the noise of its wavelengths.
    const double wanted[] = {0.6, 0.3, 0.1};
    for (int c = 0; c < 3; ++c) {
        double sum = 0;
        int count = 0;
        for (int y = 12; y < 16; ++y)
            for (int x = 0; x < 24; ++x, ++count) sum += image.plane(std::string("albedo.") + "RGB"[c])[image.at(x, y)];
        CHECK(sum / count == doctest::Approx(wanted[c]).epsilon(0.003));
    }
    CHECK(image.plane("normal.Y")[floor] == doctest::Approx(1));
    CHECK(image.plane("position.Y")[floor] == doctest::Approx(0).epsilon(1e-5));
    CHECK(image.plane("normal.Z")[ball] > 0.9f);
    CHECK(image.plane("depth.Z")[ball] == doctest::Approx(3.45).epsilon(0.02));
    const double x = image.plane("position.X")[floor], z = image.plane("position.Z")[floor];
    CHECK(image.plane("depth.Z")[floor] == doctest::Approx(std::sqrt(x * x + 1 + (z - 4) * (z - 4))).epsilon(0.002));
    CHECK(image.plane("uv.U")[floor] >= 0);
    CHECK(image.plane("uv.U")[floor] <= 1);
    CHECK(image.plane("samples.N")[floor] == 64);
    for (const char* name : {"albedo.R", "normal.X", "depth.Z", "position.X", "object.id"})
        CHECK(image.plane(name)[sky] == 0);
    CHECK(image.plane("object.id")[floor] != image.plane("object.id")[ball]);
    CHECK(image.plane("material.id")[floor] != image.plane("material.id")[ball]);
    // Halves: the mean of both is the whole.
    const float half = image.plane("half.R")[ball], whole = image.picture.r[ball];
    CHECK(half != whole);
    CHECK(half == doctest::Approx(whole).epsilon(0.5));
    CHECK(image.plane("half.albedo.R")[floor] == doctest::Approx(0.6).epsilon(0.03));
}

TEST_CASE("features of mirrors are those of what they show") {
    const Layered image(sceneText("albedo; normal; depth", "conductor { index metal Ag }"), 64);
    // The middle of the ball mirrors the camera's side: floor or sky, never a tilted normal of its own.
    const auto low = image.at(12, 10);
    CHECK(image.plane("normal.Y")[low] > 0.99f);
    CHECK(image.plane("albedo.R")[low] == doctest::Approx(0.6).epsilon(0.1));
    CHECK(image.plane("depth.Z")[low] < 4);
}

TEST_CASE("light groups and components add up to the picture to the last bit") {
    for (const char* material : {"diffuse", "dielectric { ior glass BK7 }"}) {
        const Layered image(sceneText("light-group key; light-group warm lamp; components", material), 64);
        CHECK(image.layers.unequalSums == 0);
        const std::vector<float>* const picture[] = {&image.picture.r, &image.picture.g, &image.picture.b};
        for (int c = 0; c < 3; ++c) {
            const std::string channel(1, "RGB"[c]);
            for (std::size_t i = 0; i < picture[c]->size(); ++i) {
                const auto sum = [&](std::initializer_list<const char*> names) {
                    float total = 0;
                    for (const char* name : names) total += image.plane(fmt::format("{}.{}", name, channel))[i];
                    return total;
                };
                REQUIRE(sum({"group_key", "group_warm", "group_rest"}) == (*picture[c])[i]);
                REQUIRE(sum({"direct", "indirect", "caustic"}) == (*picture[c])[i]);
            }
        }
    }
}

TEST_CASE("a light group is the picture with its lights alone") {
    const Layered all(sceneText("light-group key; light-group warm lamp"), 256);
    std::string text = sceneText("light-group key");
    for (const char* light :
         {"light lamp sphere { center 1.2 0.3 0.5; radius 0.1; power 300 lm }\n", "light sky { luminance 100 nits }\n"})
        text.erase(text.find(light), std::string(light).size());
    const Layered key(text, 256);
    CHECK(meanOf(all.plane("group_key.G")) == doctest::Approx(meanOf(key.picture.g)).epsilon(0.01));
    CHECK(meanOf(key.picture.g) > 0.5 * meanOf(all.picture.g));
    CHECK(meanOf(key.plane("group_rest.G")) == 0);
    CHECK(meanOf(all.plane("group_warm.G")) > 0);
}

TEST_CASE("components: what one scattering lights is direct, what glass focuses is caustic") {
    const Layered diffuse(sceneText("components"), 64), glass(sceneText("components", "dielectric { ior 1.5 }"), 256);
    CHECK(meanOf(diffuse.plane("caustic.G")) == 0);
    CHECK(meanOf(diffuse.plane("indirect.G")) > 0.01 * meanOf(diffuse.picture.g));
    CHECK(meanOf(glass.plane("caustic.G")) > 0.01 * meanOf(glass.picture.g));
    // What a mirror shows of the sky has met no diffuse surface, though it came by a mirror.
    const Layered mirror(sceneText("components", "conductor { index metal Ag }"), 64);
    const auto top = mirror.at(12, 4);
    CHECK(mirror.picture.g[top] > 0);
    CHECK(mirror.plane("direct.G")[top] == mirror.picture.g[top]);
    std::string once = sceneText("components");
    once += "render { max-depth 1 }\n";
    const Layered direct(once, 64);
    CHECK(meanOf(direct.plane("indirect.G")) == 0);
    CHECK(meanOf(direct.plane("direct.G")) == doctest::Approx(meanOf(diffuse.plane("direct.G"))).epsilon(0.02));
}

TEST_CASE("spectral layers integrate to the picture, also behind glass that disperses") {
    for (const char* material :
         {"diffuse", "dielectric { ior glass SF11 }", "dielectric { ior glass SF11; roughness 0.2 }"}) {
        const Layered image(sceneText("spectral 360 830 1", material), 64);
        // Bins of 1 nm against the matching functions at their middles.
        const double exposure = image.scene.built().exposure;
        double worst = 0;
        for (const auto& [x, y] : {std::pair{4, 14}, {12, 7}, {10, 9}, {12, 10}, {20, 12}}) {
            Xyz sum;
            for (int nm = 360; nm < 830; ++nm) {
                const double value = image.plane(fmt::format("S0.{},5nm", nm))[image.at(x, y)];
                const Wavelengths lambda = Wavelengths::single(static_cast<float>(nm) + 0.5f);
                sum += Xyz{xbar(lambda)[0], ybar(lambda)[0], zbar(lambda)[0]} * (value / kYIntegral);
            }
            const Xyz picture = image.film.mean(x, y) * exposure;
            for (const auto& [got, wanted] : {std::pair{sum.x, picture.x}, {sum.y, picture.y}, {sum.z, picture.z}})
                worst = std::max(worst, std::abs(got - wanted) / picture.y);
        }
        CHECK(worst < 0.005);
    }
}

// The lines of the tube, which stays out of sight, draw nearly all wavelengths of paths to themselves.
TEST_CASE("spectral layers of a white sky beside a fluorescent tube are right at both ends of the spectrum") {
    const Layered image(R"(scene 1
film { size 24 16; filter box 0.5; output "x.exr"; layers { spectral 360 830 10 } }
camera { from 0 0 4; look-at 0 0 0 }
light quad { points -1 0 9  1 0 9  1 1 9  -1 1 9; luminance 20000 nits; color illuminant FL11 }
light sky { luminance 1 nits; color illuminant E }
)",
                        512);
    REQUIRE(image.scene.scene().wavelengths.followsLights());
    for (int nm = 360; nm < 830; nm += 10) {
        const std::vector<float>& bin = image.plane(fmt::format("S0.{}nm", nm + 5));
        double sum = 0, squares = 0;
        for (const float v : bin) {
            const double radiance = static_cast<double>(v) * 72983;
            sum += radiance;
            squares += radiance * radiance;
        }
        const double count = 24 * 16, mean = sum / count, error = std::sqrt((squares / count - mean * mean) / count);
        CAPTURE(nm);
        CHECK(error < 0.02);
        CHECK(std::abs(mean - 1) < 4 * error + 1e-3);
    }
}

TEST_CASE("layers of two halves of the samples, put together, have the bits of the whole") {
    const std::string text =
        sceneText("albedo; normal; uv; light-group key; components; cryptomatte; spectral; denoise");
    const Layered whole(text, 32);
    TestScene scene = TestScene::parse(text);
    RenderSettings settings = scene.settings();
    settings.samples = 32;
    settings.parts = 2;
    PixelFilm halves[2] = {Layered::makeFilm(scene, 2), Layered::makeFilm(scene, 2)};
    for (std::uint32_t part = 0; part < 2; ++part) {
        settings.part = part + 1;
        makePathTracer(scene.scene().effects)->render(scene.scene(), halves[part], settings, {});
    }
    const auto from = halves[1].planes(), to = halves[0].planes();
    REQUIRE(from.size() == to.size());
    for (std::size_t i = 0; i < from.size(); ++i) {
        std::vector<std::byte> bytes;
        from[i]->store(halves[1].bounds(), bytes);
        CHECK(from[i]->name() == to[i]->name());
        CHECK_FALSE(to[i]->add(halves[0].bounds(), std::span(bytes).first(bytes.size() - 4)));
        REQUIRE(to[i]->add(halves[0].bounds(), bytes));
    }
    const double exposure = scene.built().exposure;
    ResolvedImage picture = halves[0].resolve(rgb::ap1.fromXyz(), exposure);
    const LayerPlanes layers =
        layerPlanes(halves[0], picture, {&rgb::ap1, rgb::ap1.fromXyz(), exposure, scene.scene().origin});
    CHECK(picture.g == whole.picture.g);
    REQUIRE(layers.planes.size() == whole.layers.planes.size());
    for (std::size_t i = 0; i < layers.planes.size(); ++i) {
        INFO(layers.planes[i].name);
        CHECK(layers.planes[i].values == whole.layers.planes[i].values);
    }
    CHECK(layers.header == whole.layers.header);
}

TEST_CASE("faults in the block of layers are found where they stand") {
    const auto report = [](const std::string& layers) { return TestScene::parse(sceneText(layers)).report(); };
    CHECK(report("albedo; light-group key; spectral 400 700 10") == "");
    CHECK(report("albdo").find("there is no layer `albdo`") != std::string::npos);
    CHECK(TestScene::parse(sceneText("albdo")).advice().find("`albedo`") != std::string::npos);
    CHECK(report("albedo 3").find("takes nothing more") != std::string::npos);
    CHECK(report("light-group").find("a light group is a name") != std::string::npos);
    CHECK(report("light-group rest key").find("already") != std::string::npos);
    CHECK(report("light-group a key; light-group b key").find("`key` is in the light group `a`") != std::string::npos);
    CHECK(report("light-group kye").find("no light is called `kye`") != std::string::npos);
    CHECK(report("spectral 300 700 10").find("360 to 830") != std::string::npos);
    CHECK(report("spectral 400 700 7").find("no whole number of bins") != std::string::npos);
    CHECK(report("spectral 400").find("the width of a bin") != std::string::npos);
    CHECK(report("cryptomatte lights").find("`objects` or `materials`") != std::string::npos);
    std::string lossy = sceneText("cryptomatte");
    lossy.replace(lossy.find("space=acescg"), 12, "compression=dwaa");
    CHECK(TestScene::parse(lossy).report().find("would damage Cryptomatte") != std::string::npos);
}

} // namespace abbe::test
