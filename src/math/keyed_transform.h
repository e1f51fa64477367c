// A transform that changes with time, as a scene writes it: steps whose numbers have keys.
#pragma once

#include "math/decomposition.h"

#include <array>
#include <cstdint>
#include <optional>
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
    KeyedTransform(const Transform& still) : keys_{{0, {{TransformStep::Kind::matrix, {}, 0, still}}}} {}
    // Requires strictly increasing finite times and invertible steps. Keys that are all the same stand still.
    explicit KeyedTransform(std::vector<Key>);

    bool moves() const { return keys_.size() > 1; }
    // Whether it changes between two times, the first of which is the earlier one or the same.
    bool movesDuring(double from, double to) const;
    Transform at(double time) const;

  private:
    bool changesAfter(std::size_t key) const; // up to the next one
    std::vector<Key> keys_;
    // Between key i and the next: both composed maps taken apart, or nothing where the steps are alike.
    std::vector<std::optional<std::array<Decomposition, 2>>> apart_;
};

// Several of them one after another, from the inside out: an object that moves in a group that moves.
class Motion {
  public:
    Motion() = default;
    explicit Motion(const Transform& still) : outer_(still) {}

    Motion then(const KeyedTransform&) const;
    Motion then(const Transform&) const;
    Motion then(const Motion&) const;
    bool moves() const { return !links_.empty(); }
    Transform at(double time) const;

  private:
    // Applied first to last: each link's map, then what stood still behind it.
    struct Link {
        Transform before;
        KeyedTransform keyed;
    };
    std::vector<Link> links_;
    Transform outer_; // after the last link
};

} // namespace abbe
