// Which layers an image has beside the picture.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace abbe {

class Diagnostics;
namespace schema {
struct TableRows;
}

// Bins of equal width from `first` to `last` nm, for spectral layers.
struct SpectralBins {
    double first = 380, last = 780, width = 10; // nm; last − first is a multiple of the width

    int count() const;
    double centre(int bin) const { return first + (bin + 0.5) * width; }
};

struct LightGroup {
    std::string name;
    std::vector<std::string> members; // names of lights, or of shapes that shine
};

struct LayerPlan {
    bool albedo = false, normal = false;                    // of the first surface that is no mirror
    bool position = false, depth = false, uv = false;       // of the first surface
    bool motion = false;                                    // of it on the film, while the shutter is open
    bool samples = false, seconds = false, invalid = false; // of the work
    bool components = false;                                // direct, indirect, caustic
    bool halves = false;                                    // half of the replicates by themselves
    bool objects = false, materials = false;                // Cryptomatte
    bool objectIds = false, materialIds = false;            // of what most samples saw
    std::vector<LightGroup> groups;                         // without the last one: all other lights
    std::optional<SpectralBins> spectral;
    std::optional<int> deep; // bins of a pixel at most, of surfaces and of media each: film/deep_sums.h

    bool empty() const;
    // Values per pixel and half that are sums over samples, in this order: hits of a surface, position, depth, uv,
    // surfaces that were followed, motion, hits of what is no mirror, normal, albedo, groups (with the rest),
    // components, bins.
    struct Offsets {
        int surface = 0, position = 0, depth = 0, uv = 0, followed = 0, motion = 0, looks = 0, normal = 0, albedo = 0,
            groups = 0, components = 0, spectral = 0, total = 0;

        int light() const { return total - groups; } // how many of them are parts of the picture: the last ones
    };
    Offsets offsets() const;
    bool coversObjects() const { return objects || objectIds; }
    bool coversMaterials() const { return materials || materialIds; }
    int groupCount() const { return groups.empty() ? 0 : static_cast<int>(groups.size()) + 1; }
};

// What the scene calls things by: shapes, materials, lights and media that shine, by their addresses.
using SceneNames = std::unordered_map<const void*, std::string>; // Scene::names

// The block `layers { … }` of a film.
// One row for each layer: `albedo`, `light-group key lamp1 lamp2`, `spectral 380 780 10`. Faults are reported where
// they stand, and what is sound is taken.
LayerPlan layerPlan(const schema::TableRows&, Diagnostics&);

} // namespace abbe
