#include "integrators/tile_kernel.h"

namespace abbe {

template TileResult renderTile<kTexturesKernel.bits()>(const PathContext&, Film&, const TileJob&);

} // namespace abbe
