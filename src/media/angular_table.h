// Densities over the sphere that are given by numbers at angles of scattering.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

// Angles of scattering as nodes in t = 1 - cos, from 0 to 2. Detail closer to straight on or straight back than single
// precision tells cosines apart (0.04 degrees) is averaged there, with its integral kept.
class AngularGrid {
  public:
    // Requires: rad, increasing, the first 0 and the last π.
    explicit AngularGrid(std::span<const double> angles);

    std::span<const double> nodes() const { return nodes_; }
    // Values at the angles as values at the nodes, >= 0 like them.
    std::vector<double> atNodes(std::span<const double> values) const;
    // ∫ over the sphere of what is linear in the cosine between nodes.
    double integral(std::span<const double> atNodes) const;
    // 2π ∫ cos …, the same with the cosine as a weight.
    double firstMoment(std::span<const double> atNodes) const;

  private:
    std::vector<double> all_, nodes_;
    std::size_t first_ = 0, last_ = 0; // of all_, those that are nodes besides both ends
};

// A density that is linear in the cosine between nodes, sampled by the exact inverse of its distribution. Immutable,
// thread-safe.
class AngularTable {
  public:
    // Requires: values at the nodes, finite, >= 0, not all 0. They are normalised.
    AngularTable(const AngularGrid&, std::span<const double> atNodes);

    struct Place {
        std::uint32_t cell;
        float fraction; // within it, 0 … 1
    };
    Place find(float cosine) const noexcept;
    float value(Place) const noexcept; // 1/sr
    float value(float cosine) const noexcept { return value(find(cosine)); }
    float sampleCosine(float u) const noexcept; // u in [0, 1)

  private:
    std::vector<double> t_, cumulative_;
    std::vector<float> values_;
};

} // namespace abbe
