#include "integrators/tile_kernel.h"

namespace abbe {

template TileResult renderTile<kTracedFullKernel.bits()>(const PathContext&, Film&, const TileJob&);

} // namespace abbe
