#include "integrators/tile_kernel.h"

namespace abbe {

TileResult renderTileDispersion(const PathContext& context, Film& film, const TileJob& job) {
    return TileKernel<(Effects(Effect::absorption) | Effect::dispersion).bits()>(context, film, job).run();
}

} // namespace abbe
