// How an image was made, for its header.
#pragma once

#include "app/load.h"
#include "io/exr_writer.h"
#include "render/integrator.h"
#include "scene/build.h"

#include <string>
#include <vector>

namespace abbe {

struct ProvenanceInput {
    const LoadedScene* loaded = nullptr;
    const SceneInput* input = nullptr;
    const BuiltScene* built = nullptr;
    const RenderSettings* settings = nullptr;
    const RenderStatistics* statistics = nullptr;
    std::string commandLine;
    std::string space; // of the written RGB
    double noise = 0;
    double seconds = 0; // from the start of the program
    int replicates = 0;
};

// Names begin with "abbe."; docs/command_line.md lists them.
std::vector<ImageAttribute> provenance(const ProvenanceInput&);

// Fingerprint of the scene file's text and the parameters of the command line, whose order does not matter.
std::string sceneHash(const LoadedScene&, const SceneInput&);

// "absorption+dispersion", or "none".
std::string effectNames(Effects);

} // namespace abbe
