#include "integrators/tile_kernel.h"

namespace abbe {

template TileResult renderTile<kTracedInterfacesKernel.bits()>(const PathContext&, Film&, const TileJob&);

} // namespace abbe
