// Motion: spans of time, transforms that change with it, and their keys.
#pragma once

#include "math/transform.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

// A span of time, in s.
struct Interval {
    double open = 0, duration = 0;

    bool operator==(const Interval&) const = default;
    double at(double position) const { return open + position * duration; } // position in [0, 1]
};

// An affine map taken apart for interpolation: matrices mixed entry by entry shear and shrink what they turn.

// A unit quaternion w + xi + yj + zk.
struct Quaternion {
    double w = 1;
    Vec3d v{};

    bool operator==(const Quaternion&) const = default;
};

// A = R S: a rotation after a stretch. S is symmetric; a mirror makes all of S negative, so that R always is a proper
// rotation [Shoemake1992]. Requires an invertible map.
struct Decomposition {
    Vec3d translation;
    Quaternion rotation;
    std::array<std::array<double, 3>, 3> stretch{};

    bool operator==(const Decomposition&) const = default;

    static Decomposition of(const Transform&);
    Transform compose() const;
};

// Translation and stretch linearly, rotation along the shorter arc at constant speed [Shoemake1985]. u in [0, 1].
Decomposition interpolate(const Decomposition&, const Decomposition&, double u);

// A transform that changes with time, as a scene writes it: steps whose numbers have keys.

// One step of a transform block, kept apart so that its numbers can be interpolated.
struct TransformStep {
    enum class Kind : std::uint8_t { translate, rotate, scale, matrix };
    Kind kind = Kind::translate;
    Vec3d vector{};     // of a translation or scale; the axis of a rotation
    double angle = 0;   // rad, of a rotation
    Transform matrix{}; // of any other step

    bool operator==(const TransformStep&) const = default;

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

        bool operator==(const Key&) const = default;
    };

    KeyedTransform() = default; // the identity, always
    KeyedTransform(const Transform& still) : keys_{{0, {{TransformStep::Kind::matrix, {}, 0, still}}}} {}
    // Requires strictly increasing finite times and invertible steps. Keys that are all the same stand still.
    explicit KeyedTransform(std::vector<Key>);

    bool operator==(const KeyedTransform&) const = default;

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
    bool operator==(const Motion&) const = default;

  private:
    // Applied first to last: each link's map, then what stood still behind it.
    struct Link {
        Transform before;
        KeyedTransform keyed;

        bool operator==(const Link&) const = default;
    };
    std::vector<Link> links_;
    Transform outer_; // after the last link
};

// Keys at any times, put onto equally spaced ones, as acceleration structures want them.

// A state between key `key` and the next one: 0 is the key itself, and the only fraction of the last.
struct KeyPosition {
    std::size_t key = 0;
    double fraction = 0;

    friend bool operator==(const KeyPosition&, const KeyPosition&) = default;
};

// Where `time` lies among the keys; before the first and after the last these hold. Requires increasing times.
KeyPosition keyPosition(std::span<const double> times, double time);

// Linear interpolation between equally spaced steps in place of linear interpolation between keys.
struct KeyGrid {
    // A key that is no step: it is replaced by what lies between this step and the next.
    struct Between {
        std::size_t key = 0, step = 0;
        double fraction = 0;
    };
    std::vector<KeyPosition> steps; // the first when the interval begins, the last when it ends; one if nothing changes
    std::vector<Between> offGrid;   // empty: the grid says the same as the keys
};

// As few steps as hold all keys of the interval exactly; `maxSteps`, at least 2, if there are none so few.
// Requires increasing times and a duration >= 0.
KeyGrid makeKeyGrid(std::span<const double> times, Interval, std::size_t maxSteps);

} // namespace abbe
