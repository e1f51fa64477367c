#include "integrators/tile_kernel.h"

namespace abbe {

TileResult renderTileAbsorption(const PathContext& context, Film& film, const TileJob& job) {
    return TileKernel<static_cast<EffectBits>(Effect::absorption)>(context, film, job).run();
}

} // namespace abbe
