// What makes two renders one: everything that their samples depend on. And parts of one render, by ranges of samples or
// by crops, put together to the bits of the whole.
#pragma once

#include "app/load.h"
#include "checkpoints/checkpoint_file.h"
#include "film/film_params.h"
#include "render/integrator.h"

#include <string>
#include <vector>

namespace abbe {

struct IdentityInput {
    const LoadedScene* loaded = nullptr;
    const FilmSettings* film = nullptr;
    const RenderSettings* settings = nullptr;
    int replicates = 1;
    std::string camera; // as chosen on the command line
};

// Program, settings, and the scene as it was understood, property by property as far as it is small: parameters
// replaced, comments and spelling gone. Files that the scene names are read for their fingerprints. Not in it: which
// pixels and samples are taken, goals, and how the image is written.
std::vector<Fact> renderIdentity(const IdentityInput&);

// A line for each fact that is not the same in both, at most `most` of them and then how many more; none if all are.
std::vector<std::string> differences(const std::vector<Fact>& theirs, const std::vector<Fact>& ours,
                                     const std::string& their, const std::string& our, std::size_t most = 6);

// Where the part `part.x` of `part.y` goes, beside the image: "room.part2.abbe".
std::string partPath(const std::string& imagePath, Vec2i part);

class RenderParts {
  public:
    // Opens the files. Throws CheckpointFault, IoError; here and below.
    explicit RenderParts(const std::vector<std::string>& paths);

    // That all are parts of the same render, and that of the scene given; that nothing is missing or twice.
    void check(const std::vector<Fact>& identity) const;
    // The smallest rectangle around all parts. Requires check().
    PixelBounds bounds() const;
    // Adds all of them to an empty film of these bounds. Requires check().
    RenderStatistics addTo(const FilmPlanes&);
    // RenderSettings::pilot of all of them. Requires check().
    int pilot() const { return readers_[0].header().pilot; }
    // Where the time of all parts went. After addTo().
    const WorkReading& work() const { return work_; }

  private:
    void checkDisjoint() const;
    void checkComplete() const;

    std::vector<CheckpointReader> readers_;
    WorkReading work_;
};

} // namespace abbe
