// Paths of light that start at the lights, most of them towards what focuses it.
#pragma once

#include "caustics/shared/aim_cone.h"
#include "light_sampling/light_target.h"
#include "math/bounds.h"
#include "math/distribution.h"
#include "math/vec.h"
#include "render/light.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

namespace abbe {

// Frozen before light is gathered: densities must not depend on what they are used for. All numbers are relative,
// finite and >= 0. The density of a direction looks at every target: whoever makes them groups what is many.
struct EmissionPlan {
    std::vector<AimTarget> targets;
    // How useful a watt of each light is; empty: all alike. No path starts at a light of 0.
    std::vector<double> usefulness;
    // How useful each target is: a row for all lights, or a row for each, one after the other; empty: all alike. A row
    // of zeros aims at nothing.
    std::vector<double> aim;
    // Where in each target's cone or disk it is: for each entry of `aim` the weights of the cells of an AimGrid, > 0,
    // as many rows as columns, or none for all alike; empty: all of them alike.
    std::vector<std::vector<double>> parts = {};
    // Of the paths of each light, those that take its own directions and, from far away, the whole scene: so that no
    // light is ever missed. In (0, 1].
    float uniformShare = 0.25f;
};

// What a path draws, all in [0, 1). Choices among many have more digits than a float.
struct EmissionNumbers {
    double light = 0, part = 0;
    float aim = 0;
    Vec2 position, direction;
};

// Lights are drawn by power and usefulness, their parts by power. Directions follow a mixture: over the cone of
// each target, evenly or by a grid of parts that bring light, with the light's own distribution as the rest. For lights
// far away it is the place across the direction that is aimed: over the disk that each target offers, or the whole
// scene. Densities are those of the whole mixture [Veach1997, sec. 9.2.4], as the targets may overlap. Immutable,
// thread-safe; the lights must outlive it.
class AimedEmission {
  public:
    // The bounds are those that the lights were committed with. Requires a plan as EmissionPlan states it.
    AimedEmission(const std::vector<std::unique_ptr<const Light>>&, const Bounds3& scene, EmissionPlan);

    // Whether no light of the scene can start paths.
    bool empty() const { return !choice_; }
    std::size_t targetCount() const { return plan_.targets.size(); }
    // Nothing where no light leaves. Requires !empty(); `time` is Ray::time.
    std::optional<EmittedRay> sample(const EmissionNumbers&, const Wavelengths&, float time) const noexcept;

    // The density with which sample() makes what a path from the camera has found, up to the choice of wavelengths and
    // time. At a place: light leaves the point p of a part, with the unit normal n there, in the unit direction w.
    EmissionDensity density(const Light*, std::uint32_t part, Vec3 p, Vec3 n, Vec3 w, float time) const noexcept;
    // Far away: light arrives at p in the unit direction w, in which it travels. A single direction has density 1.
    EmissionDensity density(const Light*, Vec3 p, Vec3 w, float time) const noexcept;

  private:
    struct Source {
        const Light* light = nullptr;
        const DistantLight* distant = nullptr; // the same, if it is far away
        const PlacedLight* placed = nullptr;   // or at a place
        std::optional<Distribution1D> parts;   // none: one
        std::size_t row = 0;                   // in aim_
    };

    void addLights(const std::vector<std::unique_ptr<const Light>>&);
    void addAim(std::size_t lights);
    void addGrids();
    const AimGrid* gridOf(std::size_t row, std::uint32_t target) const noexcept;
    double litDensity(std::size_t row, std::uint32_t target, const AimCone&, Vec3 w) const noexcept;
    double litDensity(std::size_t row, std::uint32_t target, Vec3 p, const Frame&) const noexcept;
    // Whether places, which are floats, tell parts of a disk apart.
    bool resolves(const AimTarget& disk) const { return disk.radius > 0x1p-10f * (length(scene_.centre) + start_); }
    double pickProbability(std::size_t source, std::uint32_t part) const noexcept;
    // `chosen`: a target that counts whatever rounding says of the direction.
    double pdfDirection(const Source&, const LightOrigin&, Vec3 w, std::uint32_t chosen) const noexcept;
    double pdfPosition(const Source&, Vec3 p, Vec3 w, std::uint32_t chosen) const noexcept;
    std::optional<EmittedRay> samplePlaced(const Source&, std::uint32_t part, std::uint32_t target,
                                           const EmissionNumbers&, const Wavelengths&, float time) const noexcept;
    std::optional<EmittedRay> sampleDistant(const Source&, std::uint32_t target, const EmissionNumbers&,
                                            const Wavelengths&, float time) const noexcept;

    EmissionPlan plan_;
    std::vector<Source> sources_;
    std::unordered_map<const Light*, std::size_t> places_; // in sources_
    std::optional<Distribution1D> choice_;                 // of a source; none where all are dark
    std::vector<std::optional<AimGrid>> grids_;            // of plan_.parts
    std::vector<Distribution1D> aim_; // rows: the share of what is not aimed, then those of the targets
    AimTarget scene_;                 // the ball whose disk stands for the whole scene
    std::vector<AimTarget> balls_;    // the targets, as their disks are drawn from far away
    float start_ = 0;                 // m before the middle of the scene: rays from far away start there
};

} // namespace abbe
