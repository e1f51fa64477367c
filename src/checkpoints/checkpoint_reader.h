// Reads renders that were written to disk.
#pragma once

#include "base/file.h"
#include "checkpoints/checkpoint_file.h"
#include "checkpoints/checkpoint_records.h"

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

namespace abbe {

class ByteReader;

// Reads without holding more than some megabytes in memory; adds with as many threads as there are.
class CheckpointReader {
  public:
    // Throws IoError if the file cannot be read and CheckpointFault if it is no sound checkpoint as far as its header.
    explicit CheckpointReader(const std::string& path);

    const std::string& path() const { return path_; }
    const CheckpointHeader& header() const { return header_; }
    // Adds everything to a film whose planes have the header's names and whose bounds contain the header's; says how
    // far that render had come. Once. Throws as the constructor; the film is then good for nothing.
    RenderState addTo(const FilmPlanes&);

    // The same in two steps: all but the layers, of which the film needs no pixel,
    RenderState addPicture(const FilmPlanes&);
    // which may be said early by another thread. Of a damaged file as far as it can be followed.
    void expectPicture(const std::stop_token&) const;
    // Memory that is used again by whoever adds layers, one thread at a time.
    struct Scratch {
        std::vector<std::byte> block, plane;
    };
    // and then, as often as they are wanted, the layers of those pixels of the header's bounds that are `within`: what
    // samples, or light paths, added to them. Threads may add to different pixels at once. The first one says early
    // that they will be wanted, so that the disk is at work meanwhile.
    void expectLayers(PixelBounds within, bool ofLightPaths) const;
    void addLayers(const FilmPlanes&, PixelBounds within, bool ofLightPaths, Scratch&) const;

  private:
    struct Block {
        std::uint32_t kind = 0, reserved = 0;
        std::uint64_t begin = 0; // in the file
        std::vector<std::byte> bytes;
        std::uint64_t hash = 0; // as it is stated
    };
    // Where the layers of each tile are: whole blocks.
    struct Place {
        std::uint64_t begin = 0, size = 0;
    };
    using Places = std::vector<Place>;

    BlockHead headAt(std::uint64_t begin) const;
    void readBlock(Block&);
    void verify(const Block&) const;
    struct Batch {
        std::vector<Block> blocks;
        Places layers; // of the blocks, if there are any
    };
    Batch nextBatch(std::size_t most, bool layersFollow);
    const Block& next();
    Place passLayers(BlockKind);
    [[noreturn]] void damaged(std::uint64_t at, const char* how) const;
    void readHeader();
    void addTiles(const FilmPlanes&, RenderState&);
    void addTile(const Block&, const FilmPlanes&, RenderState&) const;
    bool hasExamples(const TileState&) const;
    void addLight(const FilmPlanes&, RenderState&);
    struct Target {
        const FilmPlanes& planes;
        BlockKind kind;
        PixelBounds pixels, within;
    };
    void addPlanes(ByteReader&, std::uint64_t begin, const Target&, std::vector<std::byte>& unpacked) const;

    // False at the end of the file.
    bool read(void* to, std::size_t size);

    std::string path_;
    RegularFile file_;
    std::uint64_t position_ = 0, picture_ = 0; // what is read next; where what follows the header begins
    Block block_;
    CheckpointHeader header_;
    Places layers_, layerSplats_;
};

} // namespace abbe
