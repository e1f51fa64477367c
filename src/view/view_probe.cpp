// What is seen at a pixel.
#include "film/film_planes.h"
#include "film/layer_planes.h"
#include "spectrum/sensor.h"
#include "spectrum/xyz.h"
#include "view/live_render.h"
#include "view/view_session.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace abbe {

namespace {

constexpr std::uint32_t kSpectrumSamples = 256; // of each replicate
constexpr int kSpectrumReplicates = 4;          // which tell the error

Json numberList(std::initializer_list<double> values) {
    Json numbers = Json::list();
    for (const double v : values) numbers.push(v);
    return numbers;
}

Json thingName(const Scene& scene, const void* thing) {
    const auto found = thing ? scene.names.find(thing) : scene.names.end();
    return found == scene.names.end() ? Json() : Json(found->second);
}

// Standard errors of the three components, from what the replicates differ by.
std::array<double, 3> errorsOf(const PixelFilm& film, int x, int y, const Matrix3& matrix, double scale) {
    std::array<double, 3> errors{};
    const int replicates = film.replicates();
    const auto mean = matrix.apply<Vec3d>(film.mean(x, y) * scale);
    int used = 0;
    for (int r = 0; r < replicates; ++r) {
        if (film.samples(x, y, r, r + 1) == 0) continue;
        ++used;
        const auto one = matrix.apply<Vec3d>(film.mean(x, y, r, r + 1) * scale) - mean;
        for (int c = 0; c < 3; ++c) errors[static_cast<std::size_t>(c)] += one[c] * one[c];
    }
    for (double& e : errors) e = used > 1 ? std::sqrt(e / used / (used - 1)) : NAN;
    return errors;
}

// What a ray through the middle of the pixel and of the lens meets.
void addHit(Json& found, const Scene& scene, int x, int y) {
    CameraSample sample;
    sample.film = {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
    sample.lens = {0.5f, 0.5f};
    sample.time = 0.5f;
    const CameraRay camera = scene.camera->ray(sample);
    SurfaceHit hit;
    const bool met = camera.weight > 0 && scene.intersector->intersect(camera.ray, hit);
    Json place;
    if (met) {
        const Vec3d p = Vec3d(hit.p) + scene.origin;
        place = numberList({p.x, p.y, p.z});
    }
    found.set("object", met ? thingName(scene, hit.shape) : Json());
    found.set("material", met ? thingName(scene, hit.material) : Json());
    found.set("depth", met ? Json(static_cast<double>(hit.distance)) : Json());
    found.set("position", place);
}

// Another frame for a scene, as long as this lives.
class FrameOf {
  public:
    FrameOf(Scene& scene, PixelBounds frame) : scene_(scene), before_(std::exchange(scene.frame, frame)) {}
    ~FrameOf() { scene_.frame = before_; }
    FrameOf(const FrameOf&) = delete;
    FrameOf& operator=(const FrameOf&) = delete;

  private:
    Scene& scene_;
    PixelBounds before_;
};

// The pixel's own samples once more, camera paths alone, into bins of wavelengths.
Json spectrumOf(RestingFilm& resting, int x, int y) {
    Scene& scene = resting.shot.built.scene;
    const PixelBounds pixel{x, y, x + 1, y + 1};
    RenderSettings settings = resting.film.settings;
    settings.samples = kSpectrumSamples * kSpectrumReplicates;
    settings.noiseTarget = 0;
    settings.adaptive = false;
    settings.pilot = 0;
    settings.technique.guiding = Technique::Guiding::off;
    settings.technique.lightPaths = Technique::LightPaths::off;
    settings.technique.merging = Technique::Merging::off;
    LayerPlan plan;
    plan.spectral = SpectralBins();
    const FilmSettings& film = resting.shot.film;
    // A film of each replicate's own, since the sums of layers do not tell them apart.
    std::vector<std::vector<double>> values;
    const FrameOf only(scene, pixel); // so that nobody looks ahead at all of the picture
    for (int r = 0; r < kSpectrumReplicates; ++r) {
        settings.seed = resting.film.settings.seed + static_cast<std::uint64_t>(r);
        settings.samples = kSpectrumSamples;
        PixelFilm one(pixel, PixelFilter(film.filter, film.filterRadius), 1);
        one.keepLayers(plan, scene.names, rgbSpace(film.space));
        resting.shot.integrator->render(scene, one, settings, {});
        const auto sums = one.layers()->sums(0, 0);
        const double samples = std::max<double>(1, static_cast<double>(one.samples(x, y)));
        auto& bins = values.emplace_back();
        for (int b = 0; b < plan.spectral->count(); ++b)
            bins.push_back(sums[static_cast<std::size_t>(plan.offsets().spectral + b)].value() / samples);
    }
    Json spectrum = Json::list();
    for (int b = 0; b < plan.spectral->count(); ++b) {
        double mean = 0, squares = 0;
        for (const auto& bins : values) mean += bins[static_cast<std::size_t>(b)] / kSpectrumReplicates;
        for (const auto& bins : values) squares += square(bins[static_cast<std::size_t>(b)] - mean);
        const double error = std::sqrt(squares / kSpectrumReplicates / (kSpectrumReplicates - 1));
        spectrum.push(numberList({plan.spectral->centre(b), mean, error}));
    }
    return spectrum;
}

} // namespace

std::optional<Json> ViewSession::probe(const ProbeQuery& query) {
    Json found = Json::object({{"x", query.x}, {"y", query.y}});
    const bool there = render_.whileResting([&](RestingFilm& resting) {
        const LiveShot& shot = resting.shot;
        const PixelFilm& film = resting.film.film;
        if (query.x < 0 || query.y < 0 || query.x >= shot.film.width || query.y >= shot.film.height)
            throw ViewFault(fmt::format("the pixel {}, {} is outside of the picture", query.x, query.y));
        const int x = query.x / resting.film.cell, y = query.y / resting.film.cell;
        const PixelBounds& b = film.bounds();
        const bool inside = x >= b.x0 && x < b.x1 && y >= b.y0 && y < b.y1 && film.samples(x, y) > 0;
        const double scale = shot.built.exposure;
        const Matrix3 matrix = rgbSpace(shot.film.space).fromXyz() * shot.film.whiteBalance;
        found.set("samples", inside ? film.samples(x, y) : std::uint64_t{0});
        const bool photometric = shot.film.sensor == "cie";
        const Xyz mean = inside ? film.mean(x, y) : Xyz{};
        found.set("luminance", inside ? Json(photometric ? mean.y * kUnitLuminance : mean.y * scale) : Json());
        found.set("unit", photometric ? "cd/m²" : "of the sensor");
        const auto rgb = matrix.apply<Vec3d>(mean * scale);
        const auto errors = inside ? errorsOf(film, x, y, matrix, scale) : std::array<double, 3>{NAN, NAN, NAN};
        found.set("rgb", inside ? numberList({rgb.x, rgb.y, rgb.z}) : Json());
        found.set("space", std::string(spaceName(shot.film.space)));
        found.set("error", std::isfinite(errors[0]) ? numberList({errors[0], errors[1], errors[2]}) : Json());
        const auto variance = inside ? film.pooledVariance(x, y, 1) : std::nullopt;
        found.set("relative_error", variance && mean.y > 0 ? Json(std::sqrt(*variance) / mean.y) : Json());
        addHit(found, shot.built.scene, x, y);
        found.set("spectrum", query.spectrum && inside ? spectrumOf(resting, x, y) : Json());
        found.set("spectrum_unit", "W/(m² sr nm)");
    });
    if (!there) return std::nullopt;
    return found;
}

} // namespace abbe
