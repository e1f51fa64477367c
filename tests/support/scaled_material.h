// Materials that are wrong by a factor in one of the things that they say.
#pragma once

#include "support/faults.h"

#include <memory>
#include <string>
#include <utility>

namespace abbe::test {

enum class Scaled : std::uint8_t {
    none,
    weight,  // of the samples of a surface
    value,   // of eval()
    density, // of eval()
};

class ScaledBsdf final : public Bsdf {
  public:
    ScaledBsdf(const Bsdf& sound, Scaled what, float factor) : sound_(sound), what_(what), factor_(factor) {}
    Lobes lobes() const noexcept override { return sound_.lobes(); }
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport t) const noexcept override {
        BsdfEval e = sound_.eval(wo, wi, t);
        if (what_ == Scaled::value) e.fcos *= factor_;
        if (what_ == Scaled::density) e.pdfSolidAngle *= factor_;
        return e;
    }
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport t) const noexcept override {
        auto s = sound_.sample(wo, uLobe, u, t);
        if (s && what_ == Scaled::weight && !s->lobe.has(Lobe::delta)) s->weight *= factor_;
        return s;
    }
    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override { return sound_.evalDelta(wo, wi); }
    ScatterOutline outline(Vec3 wo) const noexcept override { return sound_.outline(wo); }

  private:
    const Bsdf& sound_;
    Scaled what_;
    float factor_;
};

class ScaledMaterial final : public ForwardingMaterial {
  public:
    ScaledMaterial(const Material& sound, Scaled what, float factor)
        : ForwardingMaterial(sound), what_(what), factor_(factor) {}
    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        return arena.make<ScaledBsdf>(*inner_.bsdf(hit, lambda, arena), what_, factor_);
    }

  private:
    Scaled what_;
    float factor_;
};

// All materials of the scene, or those of a name, are wrong from here on.
inline void scaleMaterials(Scene& scene, Scaled what, float factor, const std::string& name = {}) {
    auto intersector = std::make_unique<FaultyIntersector>(std::move(scene.intersector));
    for (std::size_t i = 0, count = scene.materials.size(); i < count; ++i) {
        const Material* sound = scene.materials[i].get();
        if (!name.empty() && scene.names[sound] != name) continue;
        scene.materials.push_back(std::make_unique<ScaledMaterial>(*sound, what, factor));
        intersector->materials[sound] = scene.materials.back().get();
    }
    scene.intersector = std::move(intersector);
}

} // namespace abbe::test
