#include "integrators/light_kernel.h"

namespace abbe {

template TileResult renderTile<kTracedInterfacesKernel.bits()>(const PathContext&, Film&, const TileJob&);

const TracedKernel kTracedInterfaces = {
    renderTile<kTracedInterfacesKernel.bits()>, traceLight<kTracedInterfacesKernel.bits()>,
    listenToLight<kTracedInterfacesKernel.bits()>, merge<kTracedInterfacesKernel.bits()>,
    searchGlints<kTracedInterfacesKernel.bits()>};

} // namespace abbe
