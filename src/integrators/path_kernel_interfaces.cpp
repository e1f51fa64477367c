#include "integrators/tile_kernel.h"

namespace abbe {

TileResult renderTileInterfaces(const PathContext& context, Film& film, const TileJob& job) {
    return TileKernel<(Effects(Effect::absorption) | Effect::textures | Effect::interfaces).bits()>(context, film, job)
        .run();
}

} // namespace abbe
