// Media by noise: boxes that stand by themselves, and what fills shapes or everything.
#include "media/noise_medium.h"
#include "media/noise_types.h"
#include "scene/scene_builder.h"

namespace abbe {

std::unique_ptr<Medium> SceneBuilder::makeNoiseVolume(const Definition& d, const Transform& toRender) {
    const auto params = bound<NoiseVolumeParams>(d);
    if (!params) return nullptr;
    const auto optics = opticsOf(*params, d);
    const auto box = boxOf(*params, tree_.header.zUp);
    const Transform place = params->transform.then(toRender);
    if (const auto* fault = std::get_if<std::string_view>(&box))
        diagnostics_.error("E0614", d.span, std::string(*fault)).help =
            "`size 1 2 1` with `center`, or `min 0 0 0; max 1 2 1`";
    if (!place.inverse())
        diagnostics_.error("E0641", d.span, "the transform of this volume flattens it", "has no inverse");
    if (!optics || !place.inverse() || !std::holds_alternative<NoiseBox>(box)) return nullptr;
    return std::make_unique<NoiseVolume>(*optics, patternOf(*params), std::get<NoiseBox>(box), place);
}

std::unique_ptr<Medium> SceneBuilder::makeNoiseMedium(const Definition& d) {
    const auto params = bound<NoiseMediumParams>(d);
    if (!params) return nullptr;
    const auto optics = opticsOf(*params, d);
    if (!params->transform.inverse())
        diagnostics_.error("E0641", d.span, "the transform of this medium flattens it", "has no inverse");
    if (!optics || !params->transform.inverse()) return nullptr;
    auto medium = std::make_unique<NoiseMedium>(*optics, patternOf(*params), params->transform);
    noiseMedia_.push_back(medium.get());
    return medium;
}

// What fills shapes may be made before it is known where render space has its origin.
void SceneBuilder::placeNoise(Vec3d origin) {
    for (NoiseMedium* medium : noiseMedia_) medium->setOrigin(origin);
}

} // namespace abbe
