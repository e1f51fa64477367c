// Renders on disk: to be continued, or to be put together from parts. docs/checkpoints.md describes the bytes.
#pragma once

#include "app/console.h"
#include "base/work_clock.h"
#include "film/film_planes.h"
#include "render/render_state.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace abbe {

// Something that renders must have in common to be one: "seed", "7".
struct Fact {
    std::string name, value;
    bool operator==(const Fact&) const = default;
};

// What a checkpoint says about its render.
struct CheckpointHeader {
    std::vector<Fact> identity;     // what the samples depend on, besides the pixels
    std::vector<std::string> words; // of the command line that made it
    std::string folder;             // where it was given
    PixelBounds bounds;             // what is rendered of the frame
    int replicates = 1;
    std::uint32_t first = 0, last = 0; // samples of each replicate that are meant to be in it
    std::uint32_t lightBlocks = 0;     // RenderState::lightBlockCount()
    std::int32_t pilot = -1;           // RenderState::pilot()
    std::uint32_t whole = 0;           // samples of each replicate of the render that this is a part of
    double seconds = 0;                // wall clock so far
    WorkReading work;                  // where it went
    std::vector<std::string> planes;   // names
};

// A file that is no checkpoint, is damaged, or does not belong.
struct CheckpointFault : CodedFault {
    using CodedFault::CodedFault;
};

// Writes the film's planes and the tiles in step with them; a render may go on meanwhile and is held up for one tile at
// a time, while that is copied. Light paths alone wait until all that they add to is written. The file is complete and
// on disk when it appears under its name, which it does only if `sound` still says so after the last tile, and if no
// plan was made meanwhile that the header does not know; returns whether it did. Throws IoError, and then an older file
// is as it was. Requires the header's lightBlocks to be the state's.
bool writeCheckpoint(const std::string& path, const CheckpointHeader&, const FilmPlanes&, RenderState&,
                     const std::function<bool()>& sound = {});

// Brings into the film what its layers have of some whole rows of tiles: what samples, or light paths, added. The
// planes of the film, until the next call.
using LayerFetch = std::function<FilmPlanes(PixelBounds rows, bool ofLightPaths)>;

// The same file of a render that nobody works on, whose film has the layers of a few rows at a time. Throws IoError,
// and what `fetch` throws.
void writeMerged(const std::string& path, const CheckpointHeader&, const RenderState&, bool takesSplats,
                 const LayerFetch& fetch);

// Whether a file is there that was never a checkpoint or part, of any version, and must not be lost unasked.
bool isForeignCheckpoint(const std::string& path);

} // namespace abbe
