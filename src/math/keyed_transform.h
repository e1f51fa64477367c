// A transform that changes with time, as a scene writes it: steps whose numbers have keys.
#pragma once

#include "math/transform.h"

#include <cstdint>
#include <vector>

namespace abbe {

// One step of a transform block, kept apart so that its numbers can be interpolated.
struct TransformStep {
    enum class Kind : std::uint8_t { translate, rotate, scale, matrix };
    Kind kind = Kind::translate;
    Vec3d vector{};     // of a translation or scale; the axis of a rotation
    double angle = 0;   // rad, of a rotation
    Transform matrix{}; // of any other step

    Transform transform() const;
};

// Keys at increasing times. Between two keys whose steps are alike (same kinds, same axes, no matrix that changes) the
// numbers of the steps are interpolated, so that a turn by 360° is a full turn; between others the composed maps are
// taken apart (Decomposition). Before the first key and after the last the map stands still.
class KeyedTransform {
  public:
    struct Key {
        double time = 0; // s
        std::vector<TransformStep> steps;
    };

    KeyedTransform() = default; // the identity, always
    // Requires strictly increasing finite times and invertible steps.
    explicit KeyedTransform(std::vector<Key>);

    bool moves() const { return keys_.size() > 1; }
    Transform at(double time) const;
    const std::vector<Key>& keys() const { return keys_; }

  private:
    std::vector<Key> keys_;
};

} // namespace abbe
