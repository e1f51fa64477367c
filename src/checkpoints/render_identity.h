// What makes two renders one: everything that their samples depend on.
#pragma once

#include "app/load.h"
#include "checkpoints/checkpoint_file.h"
#include "film/film_params.h"
#include "render/integrator.h"

#include <optional>
#include <string>
#include <vector>

namespace abbe {

struct IdentityInput {
    const LoadedScene* loaded = nullptr;
    const FilmSettings* film = nullptr;
    const RenderSettings* settings = nullptr;
    int replicates = 1;
    std::string camera; // as chosen on the command line
    double fps = 0;     // of an animation
};

// Program, settings, and the scene as it was understood, property by property as far as it is small: parameters
// replaced, comments and spelling gone. Files that the scene names are read for their fingerprints. Not in it: which
// pixels and samples are taken, goals, and how the image is written.
std::vector<Fact> renderIdentity(const IdentityInput&);

// What `film` and `render` say, which is no part of the identity.
std::vector<Fact> settingFacts(const LoadedScene&);

// The frame of an animation that an identity is of; nothing if it is of a still.
std::optional<int> frameOf(const std::vector<Fact>& identity);

// A line for each fact that is not the same in both, at most `most` of them and then how many more; none if all are.
std::vector<std::string> differences(const std::vector<Fact>& theirs, const std::vector<Fact>& ours,
                                     const std::string& their, const std::string& our, std::size_t most = 6);

} // namespace abbe
