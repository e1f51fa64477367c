// A tile that is so dear that idle threads take part in it.
#pragma once

#include "caustics/shared/kernel_jobs.h"

namespace abbe {

// What render(context, film, job) does, row by row of the tile's pixels on as many threads as have nothing else to do:
// the same samples, to the film when all rows are through. If any was cut short, the film has what was done up to the
// first place of a cut, and what was done behind it is lost. The caller may hold locks. Requires a film without
// recorders, which are told of samples as these are taken.
TileResult renderShared(TileFunction render, const PathContext& context, Film& film, const TileJob& job);

} // namespace abbe
