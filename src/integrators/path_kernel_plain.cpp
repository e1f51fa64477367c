#include "integrators/tile_kernel.h"

namespace abbe {

TileResult renderTilePlain(const PathContext& context, Film& film, const TileJob& job) {
    return TileKernel<0>(context, film, job).run();
}

} // namespace abbe
