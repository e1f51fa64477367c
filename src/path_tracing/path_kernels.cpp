#include "path_tracing/path_kernels.h"

#include "path_tracing/tile_kernel.h"

namespace abbe {

namespace {

template <EffectBits E> constexpr Kernel kernel(const char* name) {
    return {Effects::fromBits(E), name, renderTile<E>,
            hasEffect(E, Effect::media) ? kAllWithLightPaths : kInterfacesWithLightPaths};
}

constexpr Effects kAbsorption = Effect::absorption;
constexpr Effects kInterfaces = kAbsorption | Effect::textures | Effect::interfaces;

// The cheapest first, so that the first with all effects of a scene is the one to take.
constexpr Kernel kKernels[] = {
    kernel<0>("plain"),
    kernel<Effects(Effect::textures).bits()>("textures"),
    kernel<kAbsorption.bits()>("absorption"),
    kernel<kInterfaces.bits()>("absorption+textures+interfaces"),
    kernel<(kAbsorption | Effect::dispersion).bits()>("absorption+dispersion"),
    kernel<(kInterfaces | Effect::dispersion).bits()>("absorption+textures+interfaces+dispersion"),
    kernel<(kInterfaces | Effect::media).bits()>("absorption+textures+interfaces+media"),
    kernel<kLoopEffects.bits()>("all"),
};

} // namespace

template Spectrum CameraPath<kLoopEffects.bits()>::radiance(Ray, const Wavelengths&, float, bool);

const Kernel& kernelFor(Effects required) {
    const Kernel* last = nullptr;
    for (const Kernel& kernel : kKernels) {
        if (!kCompiledEffects.contains(kernel.effects)) continue;
        last = &kernel;
        if (kernel.effects.contains(required & kLoopEffects)) break;
    }
    return *last;
}

} // namespace abbe
