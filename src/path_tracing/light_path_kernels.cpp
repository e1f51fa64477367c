#include "caustics/light_tracing/light_kernel.h"
#include "caustics/merging/merge_kernel.h"
#include "path_tracing/path_kernels.h"
#include "path_tracing/tile_kernel.h"

namespace abbe {

namespace {

template <EffectBits E> constexpr LightPathKernel lightPathKernel() {
    return {renderTile<E>, traceLight<E>, listenToLight<E>, merge<E>, searchGlints<E>};
}

constexpr Effects kAllBeside = kLoopEffects | Effect::lightPaths;

} // namespace

constexpr LightPathKernel kInterfacesWithLightPaths =
    lightPathKernel<kAllBeside.bits() & ~static_cast<Effects::Bits>(Effect::media)>();
constexpr LightPathKernel kAllWithLightPaths = lightPathKernel<kAllBeside.bits()>();

} // namespace abbe
