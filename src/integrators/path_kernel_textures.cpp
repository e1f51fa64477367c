#include "integrators/tile_kernel.h"

namespace abbe {

TileResult renderTileTextures(const PathContext& context, Film& film, const TileJob& job) {
    return TileKernel<Effects(Effect::textures).bits()>(context, film, job).run();
}

} // namespace abbe
