#include "checkpoints/checkpoint_reader.h"

#include "base/memory_limit.h"
#include "base/packed_bytes.h"
#include "base/parallel.h"
#include "io/file.h"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>

namespace abbe {

CheckpointReader::CheckpointReader(const std::string& path) : path_(path), file_(path) {
    if (!file_.good()) throw IoError(fmt::format("cannot read `{}`: {}", path, file_.why()));
    readHeader();
    picture_ = position_;
}

void CheckpointReader::damaged(std::uint64_t at, const char* how) const {
    throw CheckpointFault("E0662", fmt::format("`{}` is damaged: {} at byte {} of {}", path_, how, at, file_.size()),
                          "the render can only be begun again: leave out `--resume`, or render this part anew");
}

bool CheckpointReader::read(void* to, std::size_t size) {
    const std::size_t got = file_.readAt(position_, {static_cast<char*>(to), size});
    position_ += got;
    return got == size;
}

// Of a block that ends within the file.
BlockHead CheckpointReader::headAt(std::uint64_t begin) const {
    BlockHead head;
    const std::uint64_t left = file_.size() - begin;
    if (file_.copyAt(begin, {reinterpret_cast<char*>(&head), sizeof head}) != sizeof head ||
        left < sizeof head + sizeof(Block::hash) || head.size > left - sizeof head - sizeof(Block::hash))
        damaged(begin, "the file ends within a block");
    return head;
}

void CheckpointReader::readBlock(Block& block) {
    block.begin = position_;
    const BlockHead head = headAt(position_);
    position_ += sizeof head;
    requireMemory(static_cast<double>(head.size));
    block.kind = head.kind;
    block.reserved = head.reserved;
    block.bytes.resize(head.size);
    if (!read(block.bytes.data(), block.bytes.size()) || !read(&block.hash, sizeof block.hash))
        damaged(block.begin, "the file ends within a block");
}

// Over the block that is next; where it is.
CheckpointReader::Place CheckpointReader::passLayers(BlockKind kind) {
    const std::uint64_t begin = position_;
    const BlockHead head = headAt(begin);
    if (head.kind != kind) damaged(begin, "an unexpected block");
    position_ += sizeof head + head.size + sizeof(Block::hash);
    return {begin, position_ - begin};
}

void CheckpointReader::verify(const Block& block) const {
    if (block.hash != hashOfBlock({block.kind, block.reserved, block.bytes.size()}, block.bytes))
        damaged(block.begin, "the checksum of a block is wrong");
}

const CheckpointReader::Block& CheckpointReader::next() {
    readBlock(block_);
    verify(block_);
    return block_;
}

// Some of the blocks that are still to come, read one after the other and checked by many threads. Layers are passed
// over.
CheckpointReader::Batch CheckpointReader::nextBatch(std::size_t most, bool layersFollow) {
    constexpr std::size_t kMostBlocks = 256, kMostBytes = std::size_t{64} << 20;
    Batch batch;
    for (std::size_t bytes = 0; batch.blocks.size() < std::min(most, kMostBlocks) && bytes < kMostBytes;) {
        Block& block = batch.blocks.emplace_back();
        readBlock(block);
        bytes += block.bytes.size();
        if (layersFollow) batch.layers.push_back(passLayers(block.kind == tileBlock ? layerBlock : layerSplatBlock));
    }
    parallelFor(batch.blocks.size(), [&](std::size_t i) { verify(batch.blocks[i]); });
    return batch;
}

void CheckpointReader::readHeader() {
    char magic[sizeof kCheckpointMagic] = {};
    std::uint32_t version[2] = {};
    if (!read(magic, sizeof magic) || !read(version, sizeof version) ||
        std::memcmp(magic, kCheckpointMagic, sizeof magic) != 0)
        throw CheckpointFault("E0661", fmt::format("`{}` is no checkpoint of a render", path_),
                              "checkpoints end in `.ckpt`, parts of renders in `.abbe`");
    if (version[0] != kCheckpointVersion || version[1] != 0)
        throw CheckpointFault("E0661",
                              fmt::format("`{}` is a checkpoint of version {}; this program knows version {}", path_,
                                          version[0], kCheckpointVersion),
                              "continue it with the program that made it");
    const Block& block = next();
    if (block.kind != headerBlock || !readHeaderBytes(block.bytes, header_)) damaged(block.begin, "no header");
    // Before anything of that size is made: a tile takes far more than this.
    if (static_cast<std::uint64_t>(header_.bounds.area()) / 256 > file_.size() / 64 ||
        header_.lightBlocks > file_.size() / 64)
        damaged(block.begin, "too few tiles");
}

// The rest of the block that begins there.
void CheckpointReader::addPlanes(ByteReader& in, std::uint64_t begin, const Target& to,
                                 std::vector<std::byte>& unpacked) const {
    constexpr std::uint64_t kMuch = 1 << 20; // of a tile; packed bytes may stand for eight times as many
    for (const auto& plane : to.planes) {
        if (blockOf(*plane) != to.kind) continue;
        const auto size = in.number<std::uint64_t>();
        const auto packed = in.take(in.number<std::uint64_t>());
        if (size > kMuch) requireMemory(static_cast<double>(std::min<std::uint64_t>(size, 8 * packed.size())));
        if (!in.sound() || !unpack(packed, size, unpacked) || !plane->addWithin(to.within, to.pixels, unpacked))
            damaged(begin, "a tile of another size");
    }
    if (!in.atEnd()) damaged(begin, "a tile of another size");
}

// Of samples that there can be.
bool CheckpointReader::hasExamples(const TileState& tile) const {
    const PixelBounds& b = header_.bounds;
    return std::ranges::all_of(tile.examples, [&](const DroppedSample& s) {
        return s.x >= b.x0 && s.x < b.x1 && s.y >= b.y0 && s.y < b.y1 && s.replicate >= 0 &&
               s.replicate < header_.replicates && s.cause <= DropCause::negative;
    });
}

void CheckpointReader::addTile(const Block& block, const FilmPlanes& planes, RenderState& state) const {
    ByteReader in(block.bytes);
    const auto i = in.number<std::uint64_t>();
    if (!readTile(in, state.tile(i)) || !hasExamples(state.tile(i))) damaged(block.begin, "a tile of another size");
    const TileState& tile = state.tile(i);
    if (tile.reached < header_.first) damaged(block.begin, "a tile before its first sample");
    const auto units = static_cast<std::uint64_t>(state.pixels(i).area() * header_.replicates);
    if (tile.cut && tile.cut->at.unit >= units) damaged(block.begin, "a portion that was cut behind its end");
    std::vector<std::byte> unpacked;
    addPlanes(in, block.begin, {planes, tileBlock, state.pixels(i), state.pixels(i)}, unpacked);
}

// Tiles come in any order, each once; threads add to different ones.
void CheckpointReader::addTiles(const FilmPlanes& planes, RenderState& state) {
    const bool layers = hasPlanesIn(planes, layerBlock);
    std::vector<bool> seen(state.pixelTileCount());
    layers_.resize(layers ? seen.size() : 0);
    for (std::size_t done = 0; done < seen.size();) {
        const Batch batch = nextBatch(seen.size() - done, layers);
        for (std::size_t k = 0; k < batch.blocks.size(); ++k) {
            const Block& block = batch.blocks[k];
            const auto i = ByteReader(block.bytes).number<std::uint64_t>();
            if (block.kind != tileBlock || i >= seen.size() || seen[i]) damaged(block.begin, "an unexpected block");
            seen[i] = true;
            if (layers) layers_[i] = batch.layers[k];
        }
        parallelFor(batch.blocks.size(), [&](std::size_t i) { addTile(batch.blocks[i], planes, state); });
        done += batch.blocks.size();
    }
}

// In the order of writeLight().
void CheckpointReader::addLight(const FilmPlanes& planes, RenderState& state) {
    for (std::size_t i = state.pixelTileCount(); i < state.tileCount(); ++i) {
        const Block& block = next();
        ByteReader in(block.bytes);
        if (block.kind != lightBlock || in.number<std::uint64_t>() != i) damaged(block.begin, "an unexpected block");
        if (!readTile(in, state.tile(i)) || !in.sound() || !in.atEnd() || !hasExamples(state.tile(i)))
            damaged(block.begin, "light paths of another size");
        if (state.tile(i).reached < header_.first) damaged(block.begin, "light paths before their first sample");
    }
    if (!hasPlanesIn(planes, splatBlock)) return;
    const bool layers = hasPlanesIn(planes, layerSplatBlock);
    layerSplats_.resize(layers ? state.pixelTileCount() : 0);
    for (std::size_t done = 0; done < state.pixelTileCount();) {
        const Batch batch = nextBatch(state.pixelTileCount() - done, layers);
        std::ranges::copy(batch.layers, layerSplats_.begin() + static_cast<std::ptrdiff_t>(done));
        parallelFor(batch.blocks.size(), [&](std::size_t i) {
            const Block& block = batch.blocks[i];
            const PixelBounds pixels = state.pixels(done + i);
            ByteReader in(block.bytes);
            if (block.kind != splatBlock || in.number<std::uint64_t>() != done + i)
                damaged(block.begin, "an unexpected block");
            std::vector<std::byte> unpacked;
            addPlanes(in, block.begin, {planes, splatBlock, pixels, pixels}, unpacked);
        });
        done += batch.blocks.size();
    }
}

RenderState CheckpointReader::addTo(const FilmPlanes& planes) {
    RenderState state = addPicture(planes);
    parallelFor(state.pixelTileCount(), [&](std::size_t i) {
        Scratch scratch;
        for (const bool ofLightPaths : {false, true}) addLayers(planes, state.pixels(i), ofLightPaths, scratch);
    });
    return state;
}

RenderState CheckpointReader::addPicture(const FilmPlanes& planes) {
    RenderState state(header_.bounds, header_.first, header_.lightBlocks);
    addTiles(planes, state);
    addLight(planes, state);
    if (const Block& end = next(); end.kind != endBlock || position_ != file_.size()) damaged(end.begin, "no end");
    state.seconds = header_.seconds;
    state.work = header_.work;
    state.setPilot(header_.pilot);
    return state;
}

void CheckpointReader::expectPicture(const std::stop_token& stop) const {
    BlockHead head;
    for (std::uint64_t at = picture_; !stop.stop_requested() && at < file_.size();) {
        if (file_.copyAt(at, {reinterpret_cast<char*>(&head), sizeof head}) != sizeof head) return;
        if (head.size > file_.size() - at) return;
        const std::uint64_t size = sizeof head + head.size + sizeof(Block::hash);
        if (head.kind != layerBlock && head.kind != layerSplatBlock) file_.expect(at, size);
        at += size;
    }
}

void CheckpointReader::addLayers(const FilmPlanes& planes, PixelBounds within, bool ofLightPaths,
                                 Scratch& scratch) const {
    const Places& places = ofLightPaths ? layerSplats_ : layers_;
    const PixelBounds inside = common(within, header_.bounds);
    if (places.empty() || isEmpty(inside)) return;
    const BlockKind kind = ofLightPaths ? layerSplatBlock : layerBlock;
    const TileGrid grid(header_.bounds);
    for (const std::size_t i : grid.tilesIn(inside)) {
        const auto [begin, size] = places[i];
        requireMemory(static_cast<double>(size));
        scratch.block.resize(size);
        if (file_.copyAt(begin, {reinterpret_cast<char*>(scratch.block.data()), size}) != size)
            damaged(begin, "the file ends within a block");
        BlockHead head;
        std::uint64_t hash = 0;
        std::memcpy(&head, scratch.block.data(), sizeof head);
        std::memcpy(&hash, scratch.block.data() + size - sizeof hash, sizeof hash);
        if (head.size != size - sizeof head - sizeof hash) damaged(begin, "a tile of another size");
        const auto bytes = std::span(scratch.block).subspan(sizeof head, head.size);
        if (hash != hashOfBlock(head, bytes)) damaged(begin, "the checksum of a block is wrong");
        ByteReader in(bytes);
        if (head.kind != kind || in.number<std::uint64_t>() != i) damaged(begin, "an unexpected block");
        addPlanes(in, begin, {planes, kind, grid.pixels(i), inside}, scratch.plane);
    }
}

void CheckpointReader::expectLayers(PixelBounds within, bool ofLightPaths) const {
    const Places& places = ofLightPaths ? layerSplats_ : layers_;
    const PixelBounds inside = common(within, header_.bounds);
    if (places.empty() || isEmpty(inside)) return;
    for (const std::size_t i : TileGrid(header_.bounds).tilesIn(inside)) file_.expect(places[i].begin, places[i].size);
}

} // namespace abbe
