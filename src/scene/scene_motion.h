// What moves while the shutter is open: it is built where it is when the shutter opens, and carried on from there as
// one instance.
#pragma once

#include "lights/light_context.h"
#include "math/bounds.h"
#include "math/motion.h"
#include "scene/build_context.h"

#include <optional>
#include <span>

namespace abbe {

// Motions during the exposure of the scene, which is known when the camera is made.
class SceneMotion {
  public:
    explicit SceneMotion(BuildContext& context) : context_(context) {}

    bool moves(const KeyedTransform&) const;          // while the shutter is open
    bool deforms(std::span<const double> keys) const; // likewise
    Motion within(const Motion& outer, const KeyedTransform& own) const;
    double opening() const { return context_.built.shutter.open; } // s
    Transform atOpening(const Motion& motion) const { return motion.at(opening()); }
    Motion fromOpening(const Motion&) const; // requires an invertible map at the opening
    // Whether something can be placed so all the time; false after an error.
    bool check(const Motion&, Span where) const;
    Bounds3 swept(const Motion&, const Bounds3&) const;
    // False after an error; nothing if the light stands still.
    bool ofLight(const Motion& toRender, Span where, std::optional<LightMotion>&) const;

  private:
    BuildContext& context_;
};

} // namespace abbe
