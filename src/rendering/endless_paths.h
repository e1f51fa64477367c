// Paths that go round and round and lose nothing.
#pragma once

#include "caustics/shared/kernel_jobs.h"
#include "render/first_look.h"
#include "transport/pilot_film.h"

namespace abbe {

// So many rays of a path, in the mean over the frame, are worth a look at why.
inline constexpr double kManyRays = 100;

// Takes the samples of the cells with the most rays again and looks where their paths go after kLongPath
// vertices: nothing if that is hardly ever where surfaces take no light away. Whose rays are counted is the context of
// the pilot, with its roulette.
EndlessPaths findEndlessPaths(const PathContext&, TileFunction, const PilotFilm&, const RouletteReference&);

} // namespace abbe
