// Cloth and dust: a layer of fuzz on a matte ground.
#pragma once

#include "math/vec.h"
#include "render/material.h"
#include "schema/type.h"

#include <algorithm>
#include <memory>

namespace abbe {

struct SheenParams {
    schema::TexturedSpectrum color;     // of the fuzz, 0 … 1; absent: 1
    schema::TexturedSpectrum baseColor; // reflectance of the ground, 0 … 1; absent: 0.2
    schema::TexturedNumber roughness{0.3, nullptr, {}};
};

schema::TypeInfo sheenType();
// Curves and textures must outlive the material.
std::unique_ptr<const Material> makeSheen(const SheenParams&);

// The gleam of fuzz: cloth, dust, peach skin. Light that short upright fibres throw back after any number of bounces
// among them.

// Multiple scattering in a layer of fibres (tests/support/sheen_layer.h), as a table of linearly transformed cosines
// [Zeltner2022; Heitz2016]: for each cosine and roughness the share that is thrown back, and a matrix that turns
// Lambert's lobe into the one nearest to the simulated one (of the greatest likelihood). Sampling is exact, and the
// albedo is known, so that a layer below keeps the rest. Not reciprocal: wo decides everything.
//
// Colourless and lossless: colour is the caller's factor. Directions are local unit vectors with wo.z >= 0; wi.z <= 0
// has no light.
class SheenLobe {
  public:
    // Roughness in [0, 1]: fibres upright … in all directions. Below kLeast it is kLeast: perfectly upright fibres
    // throw nothing back.
    explicit SheenLobe(float roughness);

    // Share of the light that comes back to wo of this cosine in [0, 1]; exactly ∫ eval().fcos dwi. Below 1.
    float albedo(float cosine) const { return at(cosine).albedo; }

    struct Value {
        float fcos = 0; // f |cos θi|, 1/sr
        float pdf = 0;  // solid angle
    };
    Value eval(Vec3 wo, Vec3 wi) const;
    // wi with the density eval().pdf; the weight is albedo(wo.z). Nearly horizontal ones may round to wi.z == 0.
    Vec3 sample(Vec3 wo, Vec2 u) const;

    static constexpr float kLeast = 0.02f;

    // Layout of the table, shared with the program that makes it (tools/make_sheen_table.cpp): nodes at equal steps of
    // the roughness and of the square root of the cosine.
    static constexpr int kCosines = 32, kRoughnesses = 24;

    // The lobe of one direction.
    struct Entry {
        float albedo, a, b; // M^-1 = (a 0 b; 0 a 0; 0 0 1), in the frame where wo has no y [Zeltner2022, sec. 4]
    };

  private:
    Entry at(float cosine) const;

    int row_;
    float rowShare_; // of the next row
};

} // namespace abbe
