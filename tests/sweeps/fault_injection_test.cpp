// Faults of every material, light, phase function and camera that a scene can name: whatever one of their functions
// answers that is no number, infinite or negative, none of it gets into the image unseen, and it is found where it was.
#include "rendering/path_record.h"
#include "support/environment_file.h"
#include "support/faults.h"
#include "support/picture_file.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <tuple>

namespace abbe::test {
namespace {

using Culprit = SampleFault::Culprit;

constexpr std::uint32_t kSamples = 24; // of a replicate
constexpr int kReplicates = 2;

// One sample, as it would go into the film.
struct Value {
    ExactXyz sum;
    bool kept = false;
    bool operator==(const Value& o) const { return kept == o.kept && same(sum.value(), o.sum.value()); }
    static bool same(Xyz a, Xyz b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
};

// Samples in the order in which they are repeated.
class LogFilm final : public Film {
  public:
    explicit LogFilm(PixelBounds bounds) : bounds_(bounds) {}
    PixelBounds bounds() const override { return bounds_; }
    int replicates() const override { return kReplicates; }
    FilterSample filter(Vec2 u) const noexcept override { return {{u.x - 0.5f, u.y - 0.5f}, 1}; }
    void add(int, int, int, const ExactXyz& sum, std::uint32_t samples) noexcept override {
        values.push_back({sum, samples == 1});
    }
    Xyz mean(int, int) const noexcept override { return {}; }
    double relativeNoise() const override { return 0; }

    std::vector<Value> values;

  private:
    PixelBounds bounds_;
};

// A scene of which something is faulty: made once, and then tried with one fault after the other.
class FaultyScene {
  public:
    explicit FaultyScene(const std::string& text) : scene_(TestScene::parse(text)) {
        scene_.scene(); // without errors
        auto intersector = std::make_unique<FaultyIntersector>(std::move(scene().intersector));
        intersector_ = intersector.get();
        scene().intersector = std::move(intersector);
    }
    Injection& injection() { return injection_; }
    Scene& scene() { return scene_.changeable(); }

    // All of that name, or number `i` of all.
    void breakMaterial(const std::string& name) {
        for (std::size_t i = 0, count = scene().materials.size(); i < count; ++i) {
            const Material* sound = scene().materials[i].get();
            if (scene().names[sound] != name) continue;
            scene().materials.push_back(std::make_unique<FaultyMaterial>(*sound, injection_));
            culprits_.emplace_back(scene().materials.back().get(), name);
            intersector_->materials[sound] = scene().materials.back().get();
        }
    }
    void breakLight(const std::string& name) {
        for (auto& light : scene().lights) {
            const Light* sound = light.get();
            if (scene().names[sound] != name) continue;
            if (sound->asDistant()) {
                light = std::make_unique<FaultyDistantLight>(std::move(light), injection_);
            } else if (dynamic_cast<const SurfaceLight*>(sound)) {
                auto faulty = std::make_unique<FaultySurfaceLight>(std::move(light), injection_);
                intersector_->lights[sound] = faulty.get();
                light = std::move(faulty);
            } else {
                light = std::make_unique<FaultyLightOf<Light>>(std::move(light), injection_);
            }
            culprits_.emplace_back(light.get(), name);
        }
    }
    void breakMedium() {
        const Medium* sound = scene().openMedia.at(0);
        scene().media.push_back(std::make_unique<FaultyMedium>(*sound, injection_));
        scene().openMedia[0] = scene().media.back().get();
        culprits_.emplace_back(scene().media.back().get(), "fog");
    }
    void breakCamera() {
        scene().camera = std::make_unique<FaultyCamera>(std::move(scene().camera), injection_);
        culprits_.emplace_back(scene().camera.get(), "camera");
        culprits_.emplace_back(nullptr, "camera"); // which has no name
    }
    bool broken() const { return !culprits_.empty(); }
    bool isCulprit(const void* who) const {
        return std::ranges::any_of(culprits_, [&](const auto& c) { return c.first == who; });
    }

    // Every sample by itself, without a fault.
    const std::vector<Value>& soundValues() {
        if (sound_.empty()) sound_ = values(false);
        return sound_;
    }
    std::vector<Value> values(bool faulty = true) {
        LogFilm log(scene_.built().scene.frame);
        repeat(log, ids(), faulty);
        return log.values;
    }
    std::vector<SampleId> ids() {
        std::vector<SampleId> list;
        const PixelBounds frame = scene().frame;
        for (std::uint32_t i = 0; i < kSamples; ++i)
            for (int y = frame.y0; y < frame.y1; ++y)
                for (int x = frame.x0; x < frame.x1; ++x) list.push_back({x, y, 0, i});
        return list;
    }
    SampleFault locate(SampleId id) {
        LogFilm like(scene().frame);
        WatchedFilm film(like, {id});
        repeat(film, film.samples(), true);
        CHECK_FALSE(film.records().at(0).kept());
        return findFault(film.records()[0]);
    }
    TestImage image() {
        TestImage image{RecordingFilm(scene_.built().film, kReplicates), {}};
        ArmingFilm film(image.film, injection_);
        injection_.arm(false);
        image.statistics = tracer()->render(scene(), film, settings(), {});
        return image;
    }

  private:
    RenderSettings settings() const {
        RenderSettings s = scene_.settings();
        s.samples = kSamples * kReplicates;
        s.maxDepth = 5;
        return s;
    }
    std::unique_ptr<const Integrator> tracer() { return makePathTracer(scene().effects); }
    void repeat(Film& film, std::span<const SampleId> samples, bool faulty) {
        injection_.arm(false);
        if (!faulty) return tracer()->repeat(scene(), film, settings(), samples);
        ArmingFilm armed(film, injection_);
        tracer()->repeat(scene(), armed, settings(), samples);
    }

    Injection injection_;
    TestScene scene_;
    FaultyIntersector* intersector_ = nullptr;
    std::vector<std::pair<const void*, std::string>> culprits_;
    std::vector<Value> sound_;
};

struct Expected {
    Culprit culprit;
    std::uint32_t lanes;
};

Expected expectedOf(Site site) {
    constexpr std::uint32_t kOne = 1u << Injection::kLane, kAll = 0xff;
    switch (site) {
    case Site::value:
    case Site::weight:
        return {Culprit::material, kOne};
    case Site::density:
    case Site::pdf:
    case Site::turn:
    case Site::opacity:
        return {Culprit::material, kAll};
    case Site::radiance:
    case Site::emitted:
        return {Culprit::light, kOne};
    case Site::lightPdf:
    case Site::lightTurn:
    case Site::emittedPdf:
        return {Culprit::light, kAll};
    case Site::phase:
    case Site::cosine:
    case Site::extinction:
        return {Culprit::medium, kAll};
    case Site::cameraWeight:
    case Site::cameraRay:
        return {Culprit::camera, kAll};
    }
    return {};
}

// Samples that were dropped; 0 also if the function was never asked.
std::uint64_t tryFault(FaultyScene& faulty) {
    const Injection& injection = faulty.injection();
    const std::vector<Value>& sound = faulty.soundValues();
    const std::vector<Value> values = faulty.values();
    const std::uint64_t injected = injection.injected();
    const std::vector<SampleId> ids = faulty.ids();
    REQUIRE(values.size() == ids.size() * kReplicates);
    REQUIRE(sound.size() == values.size());
    std::uint64_t dropped = 0, unseen = 0;
    const Expected expected = expectedOf(injection.site());
    for (std::size_t i = 0; i < values.size(); ++i) {
        CHECK(sound[i].kept);
        if (values[i].kept) {
            unseen += !(values[i] == sound[i]); // a fault got through
            continue;
        }
        if (++dropped > 12) continue;
        SampleId id = ids[i / kReplicates];
        id.replicate = static_cast<int>(i % kReplicates);
        const SampleFault fault = faulty.locate(id);
        INFO("what: ", std::string(fault.what), ", vertex ", fault.event.vertex, ", number ", fault.number);
        CHECK(fault.culprit == expected.culprit);
        CHECK(fault.lanes == expected.lanes);
        CHECK(fault.cause == injection.fault());
        CHECK(faulty.isCulprit(fault.who));
    }
    CHECK(unseen == 0);

    // The same in a render.
    const TestImage image = faulty.image();
    const auto& counts = image.statistics.dropped;
    CHECK(counts[0] + counts[1] + counts[2] == dropped);
    // Zero times infinity is not a number, and nor is that times anything.
    if (injection.fault() == DropCause::infinite)
        CHECK(counts[2] == 0);
    else
        CHECK(counts[static_cast<std::size_t>(injection.fault())] == dropped);
    // Bit by bit the sum of what was repeated.
    std::map<std::tuple<int, int, int>, ExactXyz> sums;
    for (std::size_t i = 0; i < values.size(); ++i)
        sums[{ids[i / kReplicates].x, ids[i / kReplicates].y, static_cast<int>(i % kReplicates)}] += values[i].sum;
    for (const auto& [at, sum] : sums) {
        const auto [x, y, r] = at;
        CHECK(Value::same(sum.value(), image.film.replicate(x, y, r).first));
    }
    bool finite = true;
    const PixelBounds frame = image.film.bounds();
    for (int y = frame.y0; y < frame.y1; ++y)
        for (int x = frame.x0; x < frame.x1; ++x)
            for (const Channel c : {Channel::x, Channel::y, Channel::z})
                finite = finite && std::isfinite(image.film.pixel(x, y, c).mean);
    CHECK(finite);
    // What was asked often had faults, and of those some count.
    if (injected > 30) CHECK(dropped > 0);
    return dropped;
}

constexpr DropCause kFaults[] = {DropCause::nan, DropCause::infinite, DropCause::negative};
constexpr const char* kFaultNames[] = {"NaN", "infinite", "negative"};

bool mayBe(Site site, DropCause fault) {
    // Directions and cosines may well be negative.
    const bool direction = site == Site::turn || site == Site::lightTurn || site == Site::cameraRay;
    return !(fault == DropCause::negative && (direction || site == Site::cosine));
}

// All faults of some sites; how many of the sites were found at least once.
template <typename Break> int tryAll(const std::string& text, std::initializer_list<Site> sites, Break breakIt) {
    FaultyScene faulty(text);
    breakIt(faulty);
    REQUIRE(faulty.broken());
    int found = 0;
    for (const Site site : sites) {
        std::uint64_t dropped = 0;
        for (const DropCause fault : kFaults) {
            if (!mayBe(site, fault)) continue;
            faulty.injection().inject(site, fault);
            INFO("site ", static_cast<int>(site), " ", std::string(kFaultNames[static_cast<int>(fault)]));
            dropped += tryFault(faulty);
        }
        found += dropped > 0;
    }
    return found;
}

const char* const kRoom = R"(scene 1
film { size 8 6; filter box 0.5 }
shape floor quad { points -3 0 -3  -3 0 3  3 0 3  3 0 -3; material diffuse { reflectance 0.7 } }
shape wall quad { points -3 0 -2  3 0 -2  3 3 -2  -3 3 -2; material diffuse { reflectance rgb 0.2 0.4 0.6 } }
)";
const char* const kCamera = "camera { from 0 1 4; look-at 0 0.6 0; fov 40 deg }\n";

std::vector<const schema::TypeInfo*> typesOf(schema::Kind kind) {
    static const schema::TypeTable table = makeTypeTable();
    return table.of(kind);
}

} // namespace

TEST_CASE("faults of each material are dropped, counted and located") {
    for (const schema::TypeInfo* type : typesOf(schema::Kind::material)) {
        if (type->name == "boundary") continue; // has no Bsdf: light goes straight on
        // The example of the manual, with a name; a file in it is one of the tests.
        std::string example(type->example);
        if (const auto file = example.find('"'); file != std::string::npos)
            example.replace(file + 1, example.find('.', file) - file - 1, "tests/snippets/any");
        INFO(example);
        const auto name = example.substr(9, example.find(' ', 9) - 9);
        REQUIRE(example.starts_with("material "));
        const std::string text = std::string(kRoom) + kCamera + example +
                                 "\nshape ball sphere { center 0 0.9 0; radius 0.9; material " + name +
                                 " }\nlight lamp quad { points -0.6 2.8 -0.6  0.6 2.8 -0.6  0.6 2.8 0.6  -0.6 2.8 0.6; "
                                 "luminance 3000 nits }\nlight sky { luminance 300 nits }\n";
        const auto breakIt = [&](FaultyScene& scene) { scene.breakMaterial(name); };
        const int found = tryAll(text, {Site::value, Site::density, Site::weight, Site::pdf, Site::turn}, breakIt);
        CHECK(found >= 2); // polished ones have no value and no density
    }
}

TEST_CASE("an opacity that is none is found") {
    const std::string text = std::string(kRoom) + kCamera +
                             "material veil diffuse { opacity 0.5 }\nshape ball sphere { center 0 0.9 0; radius 0.9; "
                             "material veil }\nlight sky { luminance 300 nits }\n";
    CHECK(tryAll(text, {Site::opacity}, [](FaultyScene& scene) { scene.breakMaterial("veil"); }) == 1);
}

TEST_CASE("faults of each light are dropped, counted and located") {
    const abbe_test::TemporaryFolder folder;
    const auto sky = (folder.path / "sky.exr").string(), profile = (folder.path / "lamp.ies").string();
    writeEnvironment(sky, 8, 4, [](int x, int y) {
        return std::array<float, 3>{0.2f + 0.1f * static_cast<float>(x), 0.5f, 2 - 0.4f * static_cast<float>(y)};
    });
    std::ofstream(profile) << "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 10\n0 45 90\n"
                              "0\n100 80 10\n";
    // Where they light the room; in front of the eye, if they can be seen.
    const std::map<std::string_view, std::string> texts = {
        {"quad", "light lamp quad { points -0.6 1.8 -0.6  0.6 1.8 -0.6  0.6 1.2 0.6  -0.6 1.2 0.6; two-sided on; "
                 "luminance 3000 nits }"},
        {"disk", "light lamp disk { center 0 1.6 -1; normal 0 -0.3 1; radius 60 cm; luminance 3000 nits }"},
        {"sphere", "light lamp sphere { center 0 1.5 0; radius 40 cm; luminance 3000 nits }"},
        {"mesh",
         "light lamp mesh { points { - -1 1 -1; - 1 1 -1; - 0 2 -1 }; faces { - 0 1 2 }; luminance 3000 nits }"},
        {"point", "light lamp point { position 0 2 1; power 800 lm }"},
        {"spot", "light lamp spot { position 0 3 1; look-at 0 0 0; angle 60 deg; intensity 500 cd }"},
        {"beam", "light lamp beam { position 0 3 0; look-at 0 0 0; radius 1; power 20 W }"},
        {"sun", "light lamp sun { elevation 40 deg; azimuth 160 deg; irradiance 1 klx }"},
        {"sky", "light lamp sky { luminance 300 nits }"},
        {"daylight", "light lamp daylight { elevation 40 deg; azimuth 160 deg; turbidity 3 }"},
        {"environment", "light lamp environment \"" + sky + "\""},
        {"ies", "light lamp ies \"" + profile + "\" { position 0 2.5 0.5 }"},
    };
    for (const schema::TypeInfo* type : typesOf(schema::Kind::light)) {
        INFO(std::string(type->name));
        const auto text = texts.find(type->name);
        REQUIRE(text != texts.end()); // a new light has to be here
        const std::string scene = std::string(kRoom) + kCamera + text->second +
                                  "\nshape ball sphere { center 0.8 0.5 1; radius 0.5; material conductor { index "
                                  "metal Ag; roughness 0.3 } }\n";
        // In each function that it has: those that cannot be met have no light to be met.
        const bool met = type->name != "point" && type->name != "spot" && type->name != "beam" && type->name != "ies";
        const int found =
            tryAll(scene, {Site::radiance, Site::lightPdf, Site::lightTurn, Site::emitted, Site::emittedPdf},
                   [](FaultyScene& s) { s.breakLight("lamp"); });
        CHECK(found == (met ? 5 : 3));
    }
}

TEST_CASE("faults of each phase function, and of density, are dropped, counted and located") {
    for (const schema::TypeInfo* type : typesOf(schema::Kind::phase)) {
        const std::string example(type->example);
        INFO(example);
        REQUIRE(example.starts_with("phase "));
        const auto name = example.substr(6, example.find(' ', 6) - 6);
        const std::string scene = std::string(kRoom) + kCamera + example +
                                  "\nvolume fog noise { size 6 4 6 m; scale 1 m; scattering 0.4 per-m; absorption 0.1 "
                                  "per-m; phase " +
                                  name +
                                  " }\nlight lamp quad { points -0.6 2.8 -0.6  0.6 2.8 -0.6  0.6 2.8 0.6  -0.6 2.8 "
                                  "0.6; luminance 3000 nits }\nlight sky { luminance 300 nits }\n";
        CHECK(tryAll(scene, {Site::phase, Site::cosine, Site::extinction}, [](FaultyScene& s) { s.breakMedium(); }) ==
              3);
    }
}

TEST_CASE("faults of each camera are dropped, counted and located") {
    for (const schema::TypeInfo* type : typesOf(schema::Kind::camera)) {
        if (type->name == "gltf") continue; // reads one of the others from a file
        INFO(std::string(type->name));
        const std::string camera =
            type->name == "orthographic"  ? "camera orthographic { from 0 1 4; look-at 0 0.6 0; height 3 m }\n"
            : type->name == "spherical"   ? "camera spherical { from 0 1 3; look-at 0 0.6 0 }\n"
            : type->name == "lens-system" ? "camera lens-system { from 0 1 4; look-at 0 0.6 0; prescription "
                                            "double-gauss; lens 50 mm; f-stop 2.8; focus 4 m }\n"
                                          : kCamera;
        const std::string scene = std::string(kRoom) + camera + "light sky { luminance 300 nits }\n";
        CHECK(tryAll(scene, {Site::cameraWeight, Site::cameraRay}, [](FaultyScene& s) { s.breakCamera(); }) == 2);
    }
}

} // namespace abbe::test
