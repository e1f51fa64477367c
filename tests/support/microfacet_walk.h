// Light on its way among the microfacets of a rough dielectric interface, followed until it leaves: all orders of
// reflection and refraction [Heitz2016a]. What energy compensation is made from and compared with.
#pragma once

#include "support/ggx_reference.h"
#include "support/statistics.h"

namespace abbe::test {

// Shares of the light; `first`: off one microfacet only.
struct WalkShares {
    double reflected = 0, transmitted = 0, firstReflected = 0, firstTransmitted = 0;
};

// Heights are even in [-1, 1]; which does not matter, only their order does.
class MicrofacetWalk {
  public:
    // eta: far side over near side; light from the direction of cosine mu.
    MicrofacetWalk(double mu, double alpha, double eta)
        : ggx_{alpha, alpha}, wo_{safeSqrt(1 - mu * mu), 0, mu}, eta_(eta) {}

    // Light turned by all orders, by `count` pairs of walks: what the first microfacet reflects and what it refracts
    // both go on, and of each what the others do not stop is known, so that only what they stop is followed.
    WalkShares operator()(int count, std::uint64_t seed) const {
        Random random(seed);
        WalkShares shares;
        for (int i = 0; i < count; ++i) {
            const double t = (i + 0.5) / count, u = std::fmod((i + 0.5) * 0.6180339887498949, 1.0);
            const Vec3d m = ggx_.visibleNormal(wo_, u, t);
            const double c = dot(wo_, m);
            if (!(c > 0)) continue;
            const double height = climb(-wo_, 1, random.uniformDouble()), f = referenceFresnel(c, eta_);
            follow({mirrored(wo_, m), height, true, f / count}, true, shares, random);
            if (f < 1) follow({refracted(wo_, m, c, eta_), height, false, (1 - f) / count}, true, shares, random);
        }
        return shares;
    }

  private:
    struct Light {
        Vec3d w; // where it goes
        double height;
        bool outside;
        double weight;
    };

    static Vec3d mirrored(Vec3d w, Vec3d m) { return m * (2 * dot(w, m)) - w; }
    static Vec3d refracted(Vec3d w, Vec3d m, double c, double eta) {
        return m * (c / eta - safeSqrt(1 - (1 - c * c) / (eta * eta))) - w * (1 / eta);
    }
    // Smith's Λ, of directions downwards too: Λ(-w) = -1 - Λ(w).
    double lambda(Vec3d w) const {
        const double up = ggx_.lambda(w);
        return w.z > 0 ? up : -1 - up;
    }
    // Probability of leaving upwards unhindered from a height.
    double escape(Vec3d w, double height) const {
        if (!(w.z > 0)) return 0;
        return std::pow(std::clamp((height + 1) / 2, 0.0, 1.0), lambda(w));
    }
    // Where light that does not leave is stopped, u even in [0, 1).
    double climb(Vec3d w, double height, double u) const {
        if (std::abs(w.z) < 1e-6) return height;
        const double below = std::clamp((height + 1) / 2, 0.0, 1.0);
        return std::clamp(2 * below / std::pow(1 - u, 1 / lambda(w)) - 1, -1.0, 1.0);
    }
    // Inside, the surface is upside down.
    void follow(Light l, bool first, WalkShares& shares, Random& random) const {
        for (int order = 1; order < 1000; ++order) {
            const double side = l.outside ? 1 : -1;
            const Vec3d w{l.w.x, l.w.y, side * l.w.z};
            const double height = side * l.height, leaves = escape(w, height), u = random.uniformDouble();
            const double share = first ? l.weight * leaves : l.weight;
            if (first || u < leaves) (l.outside ? shares.reflected : shares.transmitted) += share;
            if (first) (l.outside ? shares.firstReflected : shares.firstTransmitted) += share;
            if (!first && u < leaves) return;
            const double stopped = first ? u * (1 - leaves) : u - leaves;
            if (first) l.weight *= 1 - leaves;
            first = false;
            l.height = side * climb(w, height, std::clamp(1 - leaves - stopped, 0.0, 1 - 1e-12));
            scatter(l, w, side, random);
        }
    }
    // Off a microfacet that light going w (seen from its side) meets. Rare choices are made more often, with less
    // weight.
    void scatter(Light& l, Vec3d w, double side, Random& random) const {
        const Vec3d from = -w, m = ggx_.visibleNormal(from, random.uniformDouble(), random.uniformDouble());
        const double eta = l.outside ? eta_ : 1 / eta_, c = std::max(dot(from, m), 1e-9), f = referenceFresnel(c, eta);
        const double chosen = f < 1 ? std::clamp(f, 0.1, 0.9) : 1;
        const bool back = random.uniformDouble() < chosen;
        l.weight *= back ? f / chosen : (1 - f) / (1 - chosen);
        const Vec3d next = normalize(back ? mirrored(from, m) : refracted(from, m, c, eta));
        l.w = {next.x, next.y, side * next.z};
        l.outside = back == l.outside;
    }

    ReferenceGgx ggx_;
    Vec3d wo_;
    double eta_;
};

} // namespace abbe::test
