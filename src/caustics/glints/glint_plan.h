// Glints, small images of lights that mirrors and clear glass show on the film: which there are, and what to do with
// them.
#pragma once

#include "caustics/shared/chain_signature.h"
#include "math/vec.h"
#include "render/film.h"
#include "render/scene.h"

#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

namespace abbe {

// What was found out about glints before a render, for people to read. It depends on the scene, the frame, the pixel
// filter and the seed alone.
struct GlintFindings {
    bool measured = false;   // a pilot has run
    std::uint32_t found = 0; // glints that are probed
    double error = 0; // of the worst tile of 8×8 pixels, as 1024 samples by camera paths alone would leave it, relative
    double rays = 0;  // of probes for a sample of every pixel, in the mean over pixels
    std::uint64_t pilotRays = 0; // that it took to find out
};

// A light that is small enough to be seen as a glint. Render space.
struct GlintLight {
    const Light* source = nullptr;
    bool distant = false;
    Vec3 place;     // unit direction to its middle, or the middle
    float size = 0; // radius, rad or m

    // Unit direction to its middle, and the sine of half the angle that it fills.
    Vec3 from(Vec3 p) const { return distant ? place : normalize(place - p); }
    float sine(Vec3 p) const { return distant ? size : size / length(place - p); }
};

// The brightest of those that rays can hit, at most so many.
std::vector<GlintLight> glintLights(const Scene&, std::size_t most);

class Light;

// A rectangle of the film, as CameraSample::film, half-open.
struct FilmBox {
    Vec2 lower, upper;

    bool contains(Vec2 p) const { return p.x >= lower.x && p.x < upper.x && p.y >= lower.y && p.y < upper.y; }
    bool overlaps(const FilmBox& b) const {
        return lower.x < b.upper.x && b.lower.x < upper.x && lower.y < b.upper.y && b.lower.y < upper.y;
    }
    FilmBox united(const FilmBox& b) const {
        return {{std::min(lower.x, b.lower.x), std::min(lower.y, b.lower.y)},
                {std::max(upper.x, b.upper.x), std::max(upper.y, b.upper.y)}};
    }
    // Empty where they do not overlap.
    FilmBox common(const FilmBox& b) const {
        return {{std::max(lower.x, b.lower.x), std::max(lower.y, b.lower.y)},
                {std::min(upper.x, b.upper.x), std::min(upper.y, b.upper.y)}};
    }
    float area() const { return std::max(0.f, upper.x - lower.x) * std::max(0.f, upper.y - lower.y); }
};

// One small image of a light on the film. In the box, by that chain.
struct Glint {
    ChainSignature chain;
    FilmBox box;
    std::uint32_t side = 2; // side² probes of it belong to every sample of a pixel that sees the box
};

// The glints of a render. Frozen before light is gathered. Which light that is: a camera path whose place on the film
// is in a glint's box has hit delta interfaces alone, with exactly the glint's events, and then one of the lights.
// Camera paths leave it out; instead samples of the pixels that see a box send probes into it, which take exactly these
// events and so need not find them by chance (glint_path.h). How well the boxes fit decides on the noise alone.
class GlintPlan {
  public:
    GlintPlan() = default;
    // `lights`: whose glints are meant. `reach`: radius of the pixel filter, pixels. Boxes of the same chain that
    // overlap are put together.
    GlintPlan(PixelBounds frame, float reach, std::vector<Glint> glints, std::unordered_set<const Light*> lights);

    bool empty() const { return glints_.empty(); }
    const std::vector<Glint>& glints() const { return glints_; }
    bool has(const Light* light) const { return lights_.contains(light); }
    // Those that pixels of a row of the frame may see, by their places in glints().
    std::span<const std::uint32_t> ofRow(int y) const;
    // Whether light of one of the plan's lights that was hit by `chain` from there is left to probes. `row`: ofRow() of
    // a pixel that has that place within reach.
    bool covers(std::span<const std::uint32_t> row, const ChainSignature& chain, Vec2 film) const {
        for (const std::uint32_t i : row)
            if (glints_[i].chain == chain && glints_[i].box.contains(film)) return true;
        return false;
    }

  private:
    PixelBounds frame_;
    std::vector<Glint> glints_;
    std::unordered_set<const Light*> lights_;
    std::vector<std::vector<std::uint32_t>> rows_; // of the frame
};

} // namespace abbe
