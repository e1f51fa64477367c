#include "integrators/tile_kernel.h"

namespace abbe {

TileResult renderTileFull(const PathContext& context, Film& film, const TileJob& job) {
    return TileKernel<kAllEffects.bits()>(context, film, job).run();
}

} // namespace abbe
