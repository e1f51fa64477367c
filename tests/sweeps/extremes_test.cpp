// Every numeric property of every type at the extremes: what the schema lets pass can be rendered, without samples that
// are no numbers, and a light that it lets pass is seen.
#include "support/environment_file.h"
#include "support/scene_test.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <regex>
#include <set>

namespace abbe::test::extremes {

namespace {

using schema::FieldInfo;
using schema::FieldType;
using schema::Kind;
using schema::TypeInfo;

constexpr const char* kProbedNamed = R"(
object pebble { shape sphere { center 0 0.5 0; radius 0.5; material diffuse } }
material skin diffuse; material horn diffuse; material glass dielectric; material gold diffuse; material wood diffuse
texture pores checker; texture picture checker; texture grain checker
phase forward isotropic; phase haze isotropic; phase fog isotropic
medium fog homogeneous { extinction 1 per-m; albedo 0.5 }; medium haze homogeneous { extinction 0.1 per-m; albedo 0.5 }
medium milk homogeneous { extinction 10 per-m; albedo 0.9 }
)";
constexpr const char* kProbedCamera = "camera { from 0 1 4; look-at 0 0.5 0 }\n";
constexpr const char* kProbedFilm = "film { size 4 4; output \"x.exr\" }\n";
constexpr const char* kProbedFloor = "shape floor quad { points -3 0 -3  -3 0 3  3 0 3  3 0 -3; material diffuse }\n";
constexpr const char* kProbedBall = "shape ball sphere { center 0 0.5 0; radius 0.5; material diffuse }\n";
constexpr const char* kProbedLights = "light sky { luminance 5000 nits }\n"
                                      "light quad { points -1 3 -1  1 3 -1  1 3 1  -1 3 1; luminance 10000 nits }\n";

// The scene in which a definition of that type shows.
std::string sceneAround(const TypeInfo& type, const std::string& definition) {
    std::string scene = "scene 1\n" + std::string(kProbedNamed);
    if (type.kind != Kind::film) scene += kProbedFilm;
    if (type.kind != Kind::camera) scene += kProbedCamera;
    if (type.kind != Kind::light) scene += kProbedLights;
    scene += kProbedFloor;
    switch (type.kind) {
    case Kind::material:
        scene += "shape ball sphere { center 0 0.5 0; radius 0.5; material probe }\n";
        break;
    case Kind::medium:
        scene += "shape ball sphere { center 0 0.5 0; radius 0.5; medium probe }\n";
        break;
    case Kind::phase:
        scene += "medium dust homogeneous { extinction 1 per-m; albedo 0.5; phase probe }\n"
                 "shape ball sphere { center 0 0.5 0; radius 0.5; medium dust }\n";
        break;
    case Kind::texture:
        scene += "material painted diffuse { reflectance probe }\n"
                 "shape ball sphere { center 0 0.5 0; radius 0.5; material painted }\n";
        break;
    case Kind::shape:
        break;
    default:
        scene += kProbedBall;
    }
    return scene + definition + "\n";
}

bool isNamed(Kind kind) {
    return kind == Kind::material || kind == Kind::medium || kind == Kind::phase || kind == Kind::texture;
}

// One property of each group that must be given besides.
std::string definitionOf(const TypeInfo& type, const FieldInfo& shown, const std::string& line) {
    std::string body = line;
    std::set<std::string_view> stated = {shown.group};
    const auto add = [&](const FieldInfo& field) {
        if (field.name != shown.name && (field.group.empty() || stated.insert(field.group).second))
            body += "; " + std::string(field.example);
    };
    for (const FieldInfo& field : type.fields)
        if (field.required || (field.group == "amount" && field.dimensions[0] == schema::Dimension::power)) add(field);
    const std::string kind(keyword(type.kind));
    if (type.kind == Kind::instances) return kind + " pebble { " + body + " }";
    if (type.kind == Kind::film && shown.name != "size") body += "; size 4 4";
    return fmt::format("{} {} {} {{ {} }}", kind, isNamed(type.kind) ? "probe" : "",
                       type.isDefault && !isNamed(type.kind) ? "" : type.name, body);
}

// The example with one of its numbers, or all of them, replaced.
std::vector<std::string> linesWith(const FieldInfo& field, const std::string& value) {
    static const std::regex number("(^|[\\s=])([-+]?[0-9][0-9.e]*)(?=$|[\\s;}])");
    const std::string example(field.example);
    std::set<std::string> lines = {std::regex_replace(example, number, "$1" + value)};
    for (std::sregex_iterator it(example.begin(), example.end(), number), end; it != end; ++it) {
        std::string one = example;
        one.replace(static_cast<std::size_t>(it->position(2)), static_cast<std::size_t>(it->length(2)), value);
        lines.insert(one);
    }
    if (field.type == FieldType::spectrum) {
        lines.insert(fmt::format("{} {}", field.name, value));
        lines.insert(fmt::format("{0} rgb {1} {1} {1}", field.name, value));
        lines.insert(fmt::format("{} rgb 0.1 {} 0", field.name, value));
        lines.insert(fmt::format("{} table 400 0.1 550 {} 700 0", field.name, value));
    }
    if (field.type == FieldType::transform)
        for (const char* step : {"translate 0 V 0", "scale V", "scale 1 V 1", "rotate x V deg",
                                 "matrix V 0 0 0  0 V 0 0  0 0 V 0  0 0 0 1"})
            lines.insert(fmt::format("{} {{ {} }}", field.name, std::regex_replace(step, std::regex("V"), value)));
    lines.erase(example);
    return {lines.begin(), lines.end()};
}

enum class Outcome : std::uint8_t { refused, rendered, failed };

struct Result {
    Outcome outcome;
    std::string what; // of a failure
};

Result outcomeOf(const TypeInfo& type, const std::string& text, bool asProgram) {
    try {
        const TestScene scene = TestScene::parse(text);
        if (scene.diagnostics().hasErrors()) return {Outcome::refused, {}};
        RenderSettings settings = scene.settings();
        settings.samples = 4;
        const TestImage image = asProgram ? renderAsProgram(scene, settings, 2) : render(scene, settings, {}, 2);
        const auto& dropped = image.statistics.dropped;
        // A light that is brighter than sums of pixels hold may be looked at: that is told (W0640).
        const bool mayDazzle = type.kind == Kind::light || type.kind == Kind::shape;
        if (dropped[0] + (mayDazzle ? 0 : dropped[1]) + dropped[2] > 0)
            return {Outcome::failed,
                    fmt::format("{} nan, {} infinite, {} negative", dropped[0], dropped[1], dropped[2])};
        double sum = 0;
        const ResolvedImage picture = image.film.pixelFilm().resolve(rgb::ap1.fromXyz(), scene.built().exposure);
        for (const auto* plane : {&picture.r, &picture.g, &picture.b})
            for (const float x : *plane) {
                if (!std::isfinite(x)) return {Outcome::failed, "a pixel is no number"};
                sum += std::abs(static_cast<double>(x));
            }
        for (const float x : picture.variance)
            if (std::isnan(x)) return {Outcome::failed, "a variance is no number"}; // infinite: not known
        if (sum == 0 && type.kind == Kind::light && scene.diagnostics().all().empty())
            return {Outcome::failed, "black, without a word"};
        return {Outcome::rendered, {}};
    } catch (const std::exception& e) {
        return {Outcome::failed, e.what()};
    }
}

constexpr std::array kExtremes = {"1e-300", "1e-45", "1e-19", "1e12", "1e19", "1e38", "1e300", "-1e38"};

struct Counts {
    int refused = 0, rendered = 0;
    double slowest = 0;
};

void sweep(const TypeInfo& type, const FieldInfo& field, const std::string& line, bool asProgram, Counts& counts) {
    const std::string definition = definitionOf(type, field, line);
    const auto start = std::chrono::steady_clock::now();
    const Result result = outcomeOf(type, sceneAround(type, definition), asProgram);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    counts.slowest = std::max(counts.slowest, seconds);
    ++(result.outcome == Outcome::refused ? counts.refused : counts.rendered);
    CHECK_MESSAGE(result.outcome != Outcome::failed, definition << ": " << result.what);
}

} // namespace

// By night everything, for 20 minutes; else one line of each property. Tables of lenses take long, and light walks far
// too long in media whose particles stand a picometre apart.
TEST_CASE("extremes of every numeric property") {
    constexpr std::array kFew = {"1e-45", "1e-19", "1e-8", "1e12", "1e300"};
    const std::span<const char* const> values = nightly() ? std::span<const char* const>(kExtremes) : kFew;
    const schema::TypeTable types = makeTypeTable();
    Counts all;
    for (const TypeInfo& type : types.all()) {
        if (!nightly() && type.name == "lens-system") continue;
        for (const FieldInfo& field : type.fields)
            for (const char* value : values) {
                const bool space = type.kind == Kind::volume || type.kind == Kind::medium;
                if (space && std::string_view(value) == "1e12") continue;
                const std::vector<std::string> lines = linesWith(field, value);
                const std::size_t count = nightly() ? lines.size() : std::min<std::size_t>(lines.size(), 1);
                for (std::size_t i = 0; i < count; ++i) sweep(type, field, lines[i], nightly(), all);
            }
    }
    MESSAGE(all.refused << " refused, " << all.rendered << " rendered; the slowest took " << all.slowest << " s");
    CHECK(all.rendered > 50);
    CHECK(all.refused > 50);
}

// Weights along rays leave the range of float there, and come back to it (unit/media/extremes_test).
TEST_CASE("coloured noise without an edge, thousands of optical lengths deep: every sample is a number") {
    const TestScene scene =
        TestScene::parse("scene 1\nfilm { size 12 12; output \"x.exr\" }\n" + std::string(kProbedCamera) +
                         kProbedLights + kProbedFloor + "volume noise { scattering rgb 0.1 3.2 3.8 per-mm }\n");
    REQUIRE_FALSE(scene.diagnostics().hasErrors());
    RenderSettings settings = scene.settings();
    settings.samples = 8;
    const TestImage image = render(scene, settings, {}, 2);
    CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
}

} // namespace abbe::test::extremes
