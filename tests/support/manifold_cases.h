// Small scenes with polished interfaces and a light, and what specular manifold sampling makes of them.
#pragma once

#include "caustics/manifold/caster_candidates.h"
#include "caustics/manifold/manifold_sampling.h"
#include "support/scene_test.h"
#include "support/statistics.h"

#include <memory>
#include <string>

namespace abbe::test {

// Of a smooth dielectric for unpolarised light [Born1999, sec. 1.5.3]; `index` of the far side over the near one.
inline double dielectricReflectance(double cosine, double index) {
    const double sine2 = (1 - cosine * cosine) / (index * index);
    if (sine2 >= 1) return 1;
    const double beyond = std::sqrt(1 - sine2);
    const double s = (cosine - index * beyond) / (cosine + index * beyond);
    const double p = (index * cosine - beyond) / (index * cosine + beyond);
    return 0.5 * (s * s + p * p);
}

struct ManifoldMean {
    Moments value; // of the lanes' mean over the light's spectrum, so that a white light counts its watts
    ManifoldCounts counts;
    Vec3 wi;                      // of the last sample with light
    double last = 0;              // and what it came to
    double total = 0, capped = 0; // sums over all samples, and over those whose trials were capped

    double cappedShare() const { return total > 0 ? capped / total : 0; }
};

// Every shape that chains can start at is a caster, every light is asked. `largestImage`: of each.
inline ManifoldPlan planOfAll(const Scene& scene, float largestImage) {
    ManifoldPlan plan;
    for (const CasterCandidate& c : casterCandidates(scene))
        if (c.obstacle.empty()) plan.casters.push_back(c.caster());
    for (const auto& light : scene.lights) plan.lights.push_back({light.get(), 1, largestImage});
    return plan;
}

// A scene and that plan of it.
class ManifoldCase {
  public:
    explicit ManifoldCase(const std::string& shapes, float largestImage = kInfinity, std::uint32_t maxTrials = 100'000)
        : scene(TestScene::parse("scene 1\ncamera { from 0 0 -20; look-at 0 0 0 }\n" + shapes + "\n")) {
        if (!ok()) return;
        ManifoldPlan plan = planOfAll(scene.scene(), largestImage);
        plan.maxTrials = maxTrials;
        sampler = std::make_unique<ManifoldSampler>(scene.scene(), plan);
    }

    // Lets a pilot choose how often each kind of chain is tried, by what is seen from this point.
    void learn(Vec3 world, int looks) {
        ManifoldPilot pilot(scene.scene(), sampler->plan());
        RandomStream random(5);
        for (int i = 0; i < looks; ++i) pilot.look(start(world), 1, Wavelengths::sample(0.3f), random);
        sampler = std::make_unique<ManifoldSampler>(scene.scene(), pilot.learned());
    }

    bool ok() const { return !scene.diagnostics().hasErrors(); }
    // A point in the world that receives light from everywhere, in air.
    ChainStart start(Vec3 world) const {
        const Vec3 p(Vec3d(world) - scene.scene().origin);
        return {Receiver(p), abs(p) * 1e-7f, {}, 0, {}};
    }
    // Mean over estimates with one signature from the caster, for the first light; 1 W/nm of it counts 1.
    ManifoldMean mean(Vec3 world, const char* signature, int estimates, std::uint32_t caster = 0,
                      float u = 0.3f) const {
        const ChainStart from = start(world);
        const ManifoldChoice choice{caster, ChainSignature::of(signature), 1};
        const Wavelengths lambda = Wavelengths::sample(u);
        const Light& light = *scene.scene().lights.at(0);
        ManifoldMean result;
        RandomStream random(17);
        for (int i = 0; i < estimates; ++i) {
            const Vec2 v{random.uniform(), random.uniform()};
            const auto target = LightTarget::sample(light, 0, 1, v, lambda, 0);
            std::optional<ManifoldSample> s;
            if (target) s = sampler->estimate(from, *target, choice, lambda, random, result.counts);
            const double value = s ? static_cast<double>(abbe::mean(s->irradiance)) / watts(light, lambda) : 0;
            if (s) result.wi = s->wi, result.last = value;
            result.value.add(value);
        }
        return result;
    }

    // The same over everything that is covered; `spectral`: integrated over wavelengths, else at those of u = 0.3.
    ManifoldMean all(Vec3 world, int estimates, bool spectral = false) const {
        const ChainStart from = start(world);
        ManifoldMean result;
        RandomStream random(23);
        for (int i = 0; i < estimates; ++i) {
            const Wavelengths lambda = Wavelengths::sample(spectral ? random.uniform() : 0.3f);
            const auto s = sampler->sample(from, lambda, random, result.counts);
            if (!s) {
                result.value.add(0);
                continue;
            }
            const Spectrum light = spectral ? s->irradiance / lambda.pdf : s->irradiance;
            const auto value = static_cast<double>(abbe::mean(light));
            result.value.add(value);
            result.total += value;
            if (s->capped) result.capped += value;
        }
        return result;
    }

    TestScene scene;
    std::unique_ptr<ManifoldSampler> sampler;

  private:
    // What the light's spectrum is at these wavelengths, per watt of its power over 4π sr, or per W/m² of a sun.
    static double watts(const Light& light, const Wavelengths& lambda) {
        const auto s = LightTarget::sample(light, 0, 1, {0.5f, 0.5f}, lambda, 0);
        if (!s) return 1;
        const double spectrum =
            abbe::mean(s->distant ? s->radiance : s->placed->leaving(s->origin, {0, -1, 0}, lambda));
        return s->distant ? spectrum / static_cast<double>(s->pdf) : spectrum;
    }
};

} // namespace abbe::test
