// Parts of one render, by ranges of samples or by crops, put together to the bits of the whole.
#pragma once

#include "checkpoints/checkpoint_reader.h"
#include "checkpoints/render_identity.h"
#include "film/pixel_film.h"

#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace abbe {

// Where the part `part.x` of `part.y` goes, beside the image: "room.part2.abbe".
std::string partPath(const std::string& imagePath, Vec2i part);

// What parts have to be together.
enum class PartsWanted : std::uint8_t {
    whole, // all samples of all pixels of a rectangle, each in one part
    range, // the same rectangle in all of them, and their samples follow each other: together they are a part
    soFar, // what there is, also of parts that are not finished; none twice
};

class RenderParts {
  public:
    // Opens the files. Throws CheckpointFault, IoError; here and below.
    explicit RenderParts(const std::vector<std::string>& paths, PartsWanted wanted = PartsWanted::whole);

    // That all are parts of the same render, and that of the scene given; that nothing is missing or twice.
    void check(const std::vector<Fact>& identity) const;
    // The smallest rectangle around all parts. Requires check().
    PixelBounds bounds() const;
    // Adds all of them, but for the layers, to an empty film of these bounds. Requires check().
    RenderStatistics addTo(PixelFilm&);
    // Fills the film's layers with those of some rows, as often as they are wanted. After addTo(). The file that they
    // come from is checked as they are read, so that a fault may show here.
    void bringLayers(PixelFilm&, PixelBounds rows) const;
    // RenderSettings::pilot of all of them. Requires check().
    int pilot() const { return readers_[0].header().pilot; }
    // Where the time of all parts went. After addTo().
    const WorkReading& work() const { return work_; }
    // Samples of each replicate of the render that they are parts of; of rounds, up to the end of the last one.
    std::uint32_t whole() const;
    // Writes the film as one part that stands for all of them. After addTo(); requires PartsWanted::range.
    void write(const std::string& path, PixelFilm&);

  private:
    std::vector<std::jthread> expectPictures(std::size_t first) const;
    void addLayers(const FilmPlanes&, PixelBounds rows, bool ofLightPaths) const;
    void checkFacts(const std::vector<Fact>& identity) const;
    void checkDisjoint() const;
    void checkComplete() const;
    void checkRange() const;

    std::vector<CheckpointReader> readers_; // in the order of their samples
    PartsWanted wanted_;
    WorkReading work_;
    std::optional<RenderState> total_; // of a range: where all of them stand
};

} // namespace abbe
