#include "caustics/shared/light_path_verdict.h"

#include "render/scene.h"

#include <algorithm>

namespace abbe {

LightPathVerdict lightPathVerdict(const Scene& scene, const Technique& t) {
    using enum LightPathVerdict;
    const Technique plain;
    if (t.lightPaths == Technique::LightPaths::off) return off;
    if (t.strategy != plain.strategy || t.weights != plain.weights || t.directions != plain.directions ||
        t.numbers != plain.numbers || t.wavelengths != plain.wavelengths)
        return otherTechnique;
    if (scene.hidden.splits) return hiddenShapes;
    if (std::ranges::none_of(scene.lights, [](const auto& l) { return l->paths() != LightPaths::none; }))
        return noLights;
    if (scene.focusing.empty() && t.lightPaths == Technique::LightPaths::automatic) return nothingFocuses;
    return undecided;
}

std::size_t lightBlocksOf(const Scene& scene, const Technique& technique) {
    if (scene.frame.area() == 0 || lightPathVerdict(scene, technique) != LightPathVerdict::undecided) return 0;
    return std::clamp<std::size_t>(static_cast<std::size_t>(scene.frame.area()) / 4096, 4, 256);
}

} // namespace abbe
