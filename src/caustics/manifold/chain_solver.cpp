#include "caustics/manifold/chain_solver.h"

namespace abbe {

namespace {

bool isSingular(const SpecularChain& chain) {
    double size = 0;
    for (const auto& row : chain.jacobian) size += square(row[0]) + square(row[1]);
    return !(std::abs(chain.determinant()) > ChainSolver::kSingular * size); // NaN is
}

} // namespace

// One step that comes closer; false if there is none.
bool ChainSolver::step(ChainSignature signature, const Shape* first) {
    const SpecularChain& here = chains_[current_];
    const auto& j = here.jacobian;
    const double scale = -1 / here.determinant();
    Vec2d s{(j[1][1] * here.miss.x - j[0][1] * here.miss.y) * scale,
            (j[0][0] * here.miss.y - j[1][0] * here.miss.x) * scale};
    const double size = std::hypot(s.x, s.y);
    if (!std::isfinite(size)) return false;
    if (size > reach_) s = s * (reach_ / size);
    const auto [x, y] = tangentsOf(here.direction);
    const std::size_t other = 1 - current_;
    for (int halvings = 0; halvings < kMaxHalvings; ++halvings, s = s * 0.5) {
        const Vec3d next = normalize(here.direction + x * s.x + y * s.y);
        if (!tracer_.trace(next, signature, first, chains_[other])) continue;
        if (!(chains_[other].miss2() < here.miss2())) continue;
        current_ = other;
        return true;
    }
    return false;
}

const SpecularChain* ChainSolver::solve(Vec3d direction, ChainSignature signature, const Shape* first) {
    if (!tracer_.trace(direction, signature, first, chains_[current_])) return nullptr;
    for (int i = 0; i < kMaxIterations; ++i) {
        const SpecularChain& here = chains_[current_];
        if (isSingular(here)) return nullptr;
        if (here.miss2() < square(kTolerance)) return &here;
        ++iterations_;
        if (!step(signature, first)) return nullptr;
    }
    return nullptr;
}

} // namespace abbe
