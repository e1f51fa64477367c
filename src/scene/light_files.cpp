// Lights that files describe: goniometric diagrams and pictures of all directions.
#include "io/ies.h"
#include "io/image.h"
#include "lights/environment_light.h"
#include "lights/ies_light.h"
#include "scene/file_faults.h"
#include "scene/light_builder.h"
#include "spectrum/named_spectra.h"
#include "spectrum/upsampling_table.h"

#include <fmt/format.h>

namespace abbe {

namespace {

// L(λ) = 2 m R(λ; rgb / 2m) I(λ), m the largest component: reflectances of at most a half stay where the model is
// smooth, and white is the illuminant of the space with Y = 1 [Jakob2019, sec. 4].
class TableRadiance final : public RgbRadiance {
  public:
    TableRadiance(const RgbSpace& space, const NamedSpectrum& white)
        : table_(UpsamplingTable::loadOrBuild(space)), white_(illuminantCurve(white)) {}

    Spectrum at(Vec3 rgb, const Wavelengths& lambda) const noexcept override {
        const float scale = 2 * maxComponent(rgb);
        if (!(scale > 0)) return Spectrum(0.f);
        return table_.lookup(rgb * (1 / scale)).at(lambda) * white_->at(lambda) * scale;
    }

  private:
    UpsamplingTable table_;
    std::unique_ptr<const Curve> white_;
};

// The upsampler of an RGB space, or null with the reason in `error`.
std::unique_ptr<const RgbRadiance> makeRgbRadiance(const RgbSpace& space, std::string& error) {
    const auto white = findIlluminant(space.illuminant);
    if (!white) {
        error = fmt::format("no spectrum is known for the white of `{}`", space.name);
        return nullptr;
    }
    return std::make_unique<TableRadiance>(space, *white);
}

} // namespace

std::unique_ptr<PlacedLight> loadIesLight(const IesLightParams& params, const LightContext& context,
                                          BuildContext& scene) {
    IntensityTable table;
    if (!readsFile(
            params.file.value, params.file.span, scene.diagnostics, [&] { table = readIes(params.file.value); },
            "E0752"))
        return nullptr;
    auto light = makeIesLight(params, std::move(table), context, scene.diagnostics);
    scene.noteFile(params.file.value);
    return light;
}

std::unique_ptr<DistantLight> loadEnvironmentLight(const EnvironmentLightParams& params, const LightContext& context,
                                                   BuildContext& scene) {
    const std::string& path = params.image.value;
    RgbImage file;
    if (!readsFile(path, params.image.span, scene.diagnostics, [&] { file = readImage(path); })) return nullptr;
    scene.noteFile(path);
    RgbSpace space = file.chromaticities ? file.chromaticities->space() : rgb::rec709;
    for (const auto& [key, word] : params.image.keys)
        if (key == "space") space = abbe::findRgbSpace(word).value_or(space);
    std::string reason;
    auto upsampling = makeRgbRadiance(space, reason);
    if (!upsampling) {
        scene.diagnostics.error("E0403", params.image.span, reason);
        return nullptr;
    }
    const bool compensated = scene.built.render.strategy.word == "mis"; // else its samples must cover everything
    auto light = makeEnvironmentLight(params, {file.width(), file.height(), std::move(file.rgb)}, std::move(upsampling),
                                      compensated, context, scene.diagnostics);
    if (light && !(light->power() > 0)) {
        scene.diagnostics.warning("W0602", params.image.span, "this environment is black; the light is left out");
        return nullptr;
    }
    return light;
}

} // namespace abbe
