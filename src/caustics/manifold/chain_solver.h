// Finds chains of delta interfaces that lead to a point of a light.
#pragma once

#include "caustics/manifold/chain_tracer.h"

namespace abbe {

// Newton's method for the first direction of a chain whose last one points at the target: shooting, where
// [Hanika2015] and [Zeltner2020] move all vertices at once. The only unknown is a direction, whatever the length of the
// chain, and every iterate is a path that light can take. Deterministic: which solution it finds, or none, is a
// function of the direction that it starts from.
class ChainSolver {
  public:
    // Misses of solutions are below this (rad).
    static constexpr double kTolerance = 1e-10;
    static constexpr int kMaxIterations = 32;
    static constexpr int kMaxHalvings = 10;
    // Determinants below this share of the squared entries count as 0: no step, and no solution.
    static constexpr double kSingular = 1e-12;

    // `reach`: half the angle (rad) that the first interface fills, at least about: no step is longer.
    ChainSolver(ChainTracer& tracer, double reach) : tracer_(tracer), reach_(reach) {}

    // Null if none was found. What is returned belongs to the solver, until the next call.
    const SpecularChain* solve(Vec3d direction, ChainSignature, const Shape* first);
    // The same, to complete it (ChainTracer::reachesLight).
    SpecularChain& solution() { return chains_[current_]; }
    std::uint64_t iterations() const { return iterations_; }

  private:
    bool step(ChainSignature, const Shape* first);

    ChainTracer& tracer_;
    double reach_;
    SpecularChain chains_[2]; // the present one, and the one that is tried
    std::size_t current_ = 0;
    std::uint64_t iterations_ = 0;
};

} // namespace abbe
