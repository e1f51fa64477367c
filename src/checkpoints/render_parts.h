// Parts of one render, by ranges of samples or by crops, put together to the bits of the whole.
#pragma once

#include "checkpoints/checkpoint_file.h"
#include "render/integrator.h"

#include <string>
#include <vector>

namespace abbe {

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
