// The kernels of a path tracer, and what one of their calls came to.
#pragma once

#include "integrators/light_kernel.h"
#include "render/render_state.h"

#include <array>
#include <utility>

namespace abbe {

struct Kernel {
    Effects effects;
    const char* name;
    TileFunction render;
    const TracedKernel& traced() const { return effects.has(Effect::media) ? kTracedFull : kTracedInterfaces; }
};
template <EffectBits E> constexpr Kernel kernel(const char* name) {
    return {Effects::fromBits(E), name, renderTile<E>};
}
// The cheapest first.
inline constexpr Kernel kAllKernels[] = {
    kernel<kPlainKernel.bits()>("plain"),
    kernel<kTexturesKernel.bits()>("textures"),
    kernel<kAbsorptionKernel.bits()>("absorption"),
    kernel<kInterfacesKernel.bits()>("absorption+textures+interfaces"),
    kernel<kDispersionKernel.bits()>("absorption+dispersion"),
    kernel<kSpectralInterfacesKernel.bits()>("absorption+textures+interfaces+dispersion"),
    kernel<kMediaKernel.bits()>("absorption+textures+interfaces+media"),
    kernel<kFullKernel.bits()>("all"),
};

// Those that this build has.
template <std::size_t... I> constexpr auto compiledKernels(std::index_sequence<I...>) {
    constexpr std::size_t count = (std::size_t{kCompiledEffects.contains(kAllKernels[I].effects)} + ...);
    std::array<Kernel, count> kernels{};
    std::size_t next = 0;
    for (const Kernel& k : kAllKernels)
        if (kCompiledEffects.contains(k.effects)) kernels[next++] = k;
    return kernels;
}
inline constexpr auto kKernels = compiledKernels(std::make_index_sequence<std::size(kAllKernels)>());

inline PathTally tallyOf(const TileResult& r, double seconds) {
    const PathCounters& c = r.counters;
    if (r.lightPaths == 0)
        return {c.paths, c.vertices, c.shadowRays, c.capped, r.dropped, r.excess, c.effects, seconds, 0, 0, 0, 0};
    const std::uint64_t rays = c.vertices + c.shadowRays + c.effects.crossings + c.effects.shadowCrossings;
    return {0, 0, 0, c.capped, r.dropped, r.excess, {}, seconds, r.lightPaths, rays, r.splats, r.rounds};
}

} // namespace abbe
