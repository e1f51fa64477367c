#include "integrators/light_kernel.h"

namespace abbe {

template TileResult renderTile<kTracedFullKernel.bits()>(const PathContext&, Film&, const TileJob&);

const TracedKernel kTracedFull = {renderTile<kTracedFullKernel.bits()>, traceLight<kTracedFullKernel.bits()>,
                                  listenToLight<kTracedFullKernel.bits()>, merge<kTracedFullKernel.bits()>,
                                  searchGlints<kTracedFullKernel.bits()>};

} // namespace abbe
