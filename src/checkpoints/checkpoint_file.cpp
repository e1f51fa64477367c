#include "checkpoints/checkpoint_file.h"

#include "base/check.h"
#include "base/packed_bytes.h"
#include "base/parallel.h"
#include "checkpoints/checkpoint_records.h"
#include "io/file.h"

#include <cstring>
#include <future>
#include <numeric>
#include <utility>

namespace abbe {

namespace {

using Bytes = std::vector<std::byte>;

void writeBytes(AtomicFile& file, const void* data, std::size_t size) {
    file.write({static_cast<const char*>(data), size});
}

void writeBlock(AtomicFile& file, BlockKind kind, const Bytes& bytes, std::uint64_t hash) {
    const BlockHead head{kind, 0, bytes.size()};
    writeBytes(file, &head, sizeof head);
    writeBytes(file, bytes.data(), bytes.size());
    writeBytes(file, &hash, sizeof hash);
}

void writeBlock(AtomicFile& file, BlockKind kind, const Bytes& bytes) {
    writeBlock(file, kind, bytes, hashOfBlock({kind, 0, bytes.size()}, bytes));
}

void writePlanes(const FilmPlanes& planes, BlockKind kind, PixelBounds pixels, Bytes& bytes) {
    Bytes whole;
    for (const auto& plane : planes) {
        if (blockOf(*plane) != kind) continue;
        whole.clear();
        plane->store(pixels, whole);
        ByteWriter(bytes).number(static_cast<std::uint64_t>(whole.size()));
        const std::size_t at = bytes.size();
        ByteWriter(bytes).number(std::uint64_t{0});
        appendPacked(whole, bytes);
        const std::uint64_t size = bytes.size() - at - sizeof size;
        std::memcpy(bytes.data() + at, &size, sizeof size);
    }
}

// A tile's blocks, of those kinds that the film has planes of: what samples add to, or what light paths do.
class TileBlocks {
  public:
    TileBlocks(const FilmPlanes& planes, const RenderState& state, bool ofLightPaths)
        : planes_(planes),
          state_(state), kinds_{ofLightPaths ? splatBlock : tileBlock, ofLightPaths ? layerSplatBlock : layerBlock},
          layers_(hasPlanesIn(planes, kinds_[1])) {}

    // Requires the tile's mutex to be held.
    void copy(std::size_t i) {
        for (std::size_t k = 0; k < (layers_ ? 2 : 1); ++k) {
            bytes_[k].clear();
            ByteWriter out(bytes_[k]);
            out.number(static_cast<std::uint64_t>(i));
            if (kinds_[k] == tileBlock) writeTile(state_.tile(i), out);
            writePlanes(planes_, kinds_[k], state_.pixels(i), bytes_[k]);
        }
    }
    void hash() {
        for (std::size_t k = 0; k < (layers_ ? 2 : 1); ++k)
            hashes_[k] = hashOfBlock({kinds_[k], 0, bytes_[k].size()}, bytes_[k]);
    }
    void write(AtomicFile& file) const {
        for (std::size_t k = 0; k < (layers_ ? 2 : 1); ++k) writeBlock(file, kinds_[k], bytes_[k], hashes_[k]);
    }

  private:
    const FilmPlanes& planes_;
    const RenderState& state_;
    BlockKind kinds_[2];
    bool layers_;
    Bytes bytes_[2];
    std::uint64_t hashes_[2] = {};
};

void writeTiles(AtomicFile& file, const FilmPlanes& planes, RenderState& state) {
    std::vector<std::size_t> left(state.pixelTileCount()), busy;
    std::iota(left.begin(), left.end(), std::size_t{0});
    TileBlocks tile(planes, state, false);
    // Tiles in hand come last: waiting for one of them is then waiting for few.
    for (const bool wait : {false, true}) {
        for (const std::size_t i : left) {
            {
                std::unique_lock hold(state.mutex(i), std::defer_lock);
                if (wait) hold.lock();
                if (!wait && !hold.try_lock()) {
                    busy.push_back(i);
                    continue;
                }
                tile.copy(i);
            }
            tile.hash();
            tile.write(file);
        }
        left = std::exchange(busy, {});
    }
}

void writeLightBlocks(AtomicFile& file, const RenderState& state) {
    Bytes bytes;
    for (std::size_t i = state.pixelTileCount(); i < state.tileCount(); ++i) {
        bytes.clear();
        ByteWriter out(bytes);
        out.number(static_cast<std::uint64_t>(i));
        writeTile(state.tile(i), out);
        writeBlock(file, lightBlock, bytes);
    }
}

// Blocks of light paths and all that they add to, of one moment, tile by tile: a copy would take as much memory again.
void writeLight(AtomicFile& file, const FilmPlanes& planes, RenderState& state) {
    const bool splats = hasPlanesIn(planes, splatBlock);
    if (!splats && state.lightBlockCount() == 0) return;
    const auto closure = state.lightGate().close();
    writeLightBlocks(file, state);
    TileBlocks tile(planes, state, true);
    for (std::size_t i = 0; splats && i < state.pixelTileCount(); ++i) {
        tile.copy(i);
        tile.hash();
        tile.write(file);
    }
}

// Row by row of tiles, since the film has the layers of no more at a time; each row is packed by many threads, and
// written while the next one is fetched.
void writeRows(AtomicFile& file, const RenderState& state, const LayerFetch& fetch, bool ofLightPaths) {
    const auto columns = state.grid().columns();
    const auto policy = threadCount() > 1 ? std::launch::async | std::launch::deferred : std::launch::deferred;
    std::future<void> written;
    for (std::size_t first = 0; first < state.pixelTileCount(); first += columns) {
        PixelBounds rows = state.bounds();
        rows.y0 = state.pixels(first).y0;
        rows.y1 = state.pixels(first).y1;
        const FilmPlanes planes = fetch(rows, ofLightPaths);
        std::vector<TileBlocks> tiles(columns, TileBlocks(planes, state, ofLightPaths));
        parallelFor(columns, [&](std::size_t i) {
            tiles[i].copy(first + i);
            tiles[i].hash();
        });
        if (written.valid()) written.get();
        written = std::async(policy, [&file, tiles = std::move(tiles)] {
            for (const TileBlocks& tile : tiles) tile.write(file);
        });
    }
    if (written.valid()) written.get();
}

void begin(AtomicFile& file, const CheckpointHeader& header) {
    writeBytes(file, kCheckpointMagic, sizeof kCheckpointMagic);
    const std::uint32_t version[2] = {kCheckpointVersion, 0};
    writeBytes(file, version, sizeof version);
    writeBlock(file, headerBlock, bytesOf(header));
}

void end(AtomicFile& file, const RenderState& state) {
    Bytes bytes;
    ByteWriter(bytes).number(static_cast<std::uint64_t>(state.tileCount()));
    writeBlock(file, endBlock, bytes);
}

} // namespace

bool isForeignCheckpoint(const std::string& path) {
    RegularFile file(path);
    char magic[sizeof kCheckpointMagic] = {};
    return file.good() &&
           (file.readAt(0, magic) < sizeof magic || std::memcmp(magic, kCheckpointMagic, sizeof magic) != 0);
}

bool writeCheckpoint(const std::string& path, const CheckpointHeader& header, const FilmPlanes& planes,
                     RenderState& state, const std::function<bool()>& sound) {
    ABBE_CHECK(header.lightBlocks == state.lightBlockCount());
    AtomicFile file(path);
    begin(file, header);
    writeTiles(file, planes, state);
    writeLight(file, planes, state);
    end(file, state);
    if ((sound && !sound()) || header.pilot != state.pilot()) return false;
    file.commit();
    return true;
}

void writeMerged(const std::string& path, const CheckpointHeader& header, const RenderState& state, bool takesSplats,
                 const LayerFetch& fetch) {
    ABBE_CHECK(header.lightBlocks == state.lightBlockCount());
    AtomicFile file(path);
    begin(file, header);
    writeRows(file, state, fetch, false);
    writeLightBlocks(file, state);
    if (takesSplats) writeRows(file, state, fetch, true);
    end(file, state);
    file.commit();
}

} // namespace abbe
