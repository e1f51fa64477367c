// The scene under study.
#pragma once

#include "film/film_params.h"
#include "render/integrator.h"
#include "scene/build.h"

namespace abbe {

struct StudySubject {
    const BuiltScene* built = nullptr; // outlives the study
    FilmSettings film;                 // of the whole frame
    RenderSettings settings;           // as rendered, but without goals of noise and time
    int replicates = 2;                // of its film
    bool largestKernel = false;        // the instantiation with all effects
};

} // namespace abbe
