#include "checkpoints/checkpoint_file.h"

#include "base/check.h"
#include "base/memory_limit.h"
#include "base/parallel.h"
#include "checkpoints/checkpoint_bytes.h"
#include "checkpoints/packed_bytes.h"
#include "io/file.h"
#include "math/byte_hash.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <numeric>

namespace abbe {

namespace {

constexpr char kCheckpointMagic[8] = {'A', 'B', 'B', 'E', 'C', 'K', 'P', 'T'};
constexpr std::uint32_t kCheckpointVersion = 7;

enum BlockKind : std::uint32_t { headerBlock = 1, tileBlock = 2, endBlock = 3, lightBlock = 4, splatBlock = 5 };

// What comes before the bytes of a block; its hash comes after them.
struct BlockHead {
    std::uint32_t kind = 0, reserved = 0;
    std::uint64_t size = 0;
};

std::uint64_t hashOfBlock(const BlockHead& head, std::span<const std::byte> bytes) {
    ByteHash hash;
    hash.add(std::as_bytes(std::span(&head, 1)));
    hash.add(bytes);
    return hash.value();
}

void writeBytes(AtomicFile& file, const void* data, std::size_t size) {
    file.write({static_cast<const char*>(data), size});
}

void writeBlock(AtomicFile& file, BlockKind kind, const std::vector<std::byte>& bytes) {
    const BlockHead head{kind, 0, bytes.size()};
    const std::uint64_t hash = hashOfBlock(head, bytes);
    writeBytes(file, &head, sizeof head);
    writeBytes(file, bytes.data(), bytes.size());
    writeBytes(file, &hash, sizeof hash);
}

// Charges of nothing are left out.
void writeWork(const WorkReading& work, ByteWriter& out) {
    const auto charged = [](const WorkCharge& c) { return c.looks > 0; };
    out.number(work.seconds);
    out.number(static_cast<std::uint32_t>(std::ranges::count_if(work.charges, charged)));
    for (std::uint32_t i = 0; i < work.charges.size(); ++i) {
        const WorkCharge& c = work.charges[i];
        if (!charged(c)) continue;
        out.number(i);
        out.number(c.seconds);
        out.number(c.squares);
        out.number(c.looks);
    }
}

bool readWork(ByteReader& in, WorkReading& work) {
    work.seconds = in.number<double>();
    for (auto n = in.number<std::uint32_t>(); n > 0 && in.sound(); --n) {
        const auto i = in.number<std::uint32_t>();
        if (i >= work.charges.size()) return false;
        WorkCharge& c = work.charges[i];
        c.seconds = in.number<double>();
        c.squares = in.number<double>();
        c.looks = in.number<std::uint64_t>();
    }
    return in.sound();
}

// A record of counters, in the order of its list.
template <typename Record> void writeCounters(const Record& record, ByteWriter& out) {
    for (const auto& c : countersOf(record)) out.number(*c.place);
}

template <typename Record> void readCounters(ByteReader& in, Record& record) {
    for (const auto& c : countersOf(record)) *c.place = in.number<std::uint64_t>();
}

void writeEffects(const EffectCounts& e, ByteWriter& out) {
    writeCounters(e, out);
    std::uint32_t used = kVolumeWorks;
    while (used > 0 && e.volumes[used - 1] == VolumeCounts{}) --used;
    out.number(used);
    for (std::uint32_t i = 0; i < used; ++i) writeCounters(e.volumes[i], out);
}

bool readEffects(ByteReader& in, EffectCounts& e) {
    readCounters(in, e);
    const auto used = in.number<std::uint32_t>();
    if (used > e.volumes.size()) return false;
    for (std::uint32_t i = 0; i < used; ++i) readCounters(in, e.volumes[i]);
    return in.sound();
}

std::vector<std::byte> bytesOf(const CheckpointHeader& h) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    for (const int v : {h.bounds.x0, h.bounds.y0, h.bounds.x1, h.bounds.y1, h.replicates}) out.number(v);
    for (const std::uint32_t v : {h.first, h.last, h.whole, h.lightBlocks}) out.number(v);
    out.number(h.pilot);
    out.number(h.seconds);
    writeWork(h.work, out);
    out.texts(h.planes);
    out.texts(h.words);
    out.text(h.folder);
    out.number(static_cast<std::uint64_t>(h.identity.size()));
    for (const Fact& f : h.identity) {
        out.text(f.name);
        out.text(f.value);
    }
    return bytes;
}

bool readHeaderBytes(std::span<const std::byte> bytes, CheckpointHeader& h) {
    ByteReader in(bytes);
    for (int* v : {&h.bounds.x0, &h.bounds.y0, &h.bounds.x1, &h.bounds.y1, &h.replicates}) *v = in.number<int>();
    for (std::uint32_t* v : {&h.first, &h.last, &h.whole, &h.lightBlocks}) *v = in.number<std::uint32_t>();
    h.pilot = in.number<std::int32_t>();
    h.seconds = in.number<double>();
    if (!readWork(in, h.work)) return false;
    h.planes = in.texts();
    h.words = in.texts();
    h.folder = in.text();
    for (auto n = in.number<std::uint64_t>(); n > 0 && in.sound(); --n) {
        Fact& fact = h.identity.emplace_back();
        fact.name = in.text();
        fact.value = in.text();
    }
    // Of the largest image with its overscan.
    const auto sideOk = [](std::int64_t from, std::int64_t to) {
        return from >= -65536 && from < to && to <= 2 * 65536;
    };
    return in.sound() && in.atEnd() && sideOk(h.bounds.x0, h.bounds.x1) && sideOk(h.bounds.y0, h.bounds.y1) &&
           h.replicates >= 1 && h.first <= h.last && h.last <= h.whole && h.pilot >= -1 &&
           h.pilot <= RenderSettings::kFullPilot;
}

void writeTile(const TileState& tile, ByteWriter& out) {
    const PathTally& t = tile.tally;
    const CutPortion cut = tile.cut.value_or(CutPortion{});
    for (const std::uint32_t v : {tile.reached, cut.end, cut.at.unit, cut.at.done}) out.number(v);
    writeCounters(t, out);
    out.number(t.excess.most);
    out.number(t.coreSeconds);
    writeEffects(t.effects, out);
    out.number(static_cast<std::uint32_t>(tile.examples.size()));
    for (const DroppedSample& s : tile.examples) {
        for (const int v : {s.x, s.y, s.replicate}) out.number(v);
        out.number(s.index);
        out.number(s.cause);
    }
}

// Those that light paths add to, or all others.
void writePlanes(const FilmPlanes& planes, bool ofLightPaths, PixelBounds pixels, std::vector<std::byte>& bytes) {
    std::vector<std::byte> whole;
    for (const auto& plane : planes) {
        if (plane->ofLightPaths() != ofLightPaths) continue;
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

bool hasPlanesOfLight(const FilmPlanes& planes) {
    return std::ranges::any_of(planes, [](const auto& plane) { return plane->ofLightPaths(); });
}

// Requires the tile's mutex to be held.
void copyTile(std::size_t i, const RenderState& state, const FilmPlanes& planes, std::vector<std::byte>& bytes) {
    bytes.clear();
    ByteWriter out(bytes);
    out.number(static_cast<std::uint64_t>(i));
    writeTile(state.tile(i), out);
    writePlanes(planes, false, state.pixels(i), bytes);
}

// False if it makes no sense.
bool readTile(ByteReader& in, TileState& tile) {
    PathTally& t = tile.tally;
    CutPortion cut;
    for (std::uint32_t* v : {&tile.reached, &cut.end, &cut.at.unit, &cut.at.done}) *v = in.number<std::uint32_t>();
    if (cut.end > 0) tile.cut = cut;
    if (tile.cut && cut.end <= tile.reached) return false;
    readCounters(in, t);
    t.excess.most = in.number<float>();
    t.coreSeconds = in.number<double>();
    if (!readEffects(in, t.effects)) return false;
    for (auto n = in.number<std::uint32_t>(); n > 0 && in.sound(); --n) {
        DroppedSample& s = tile.examples.emplace_back();
        for (int* v : {&s.x, &s.y, &s.replicate}) *v = in.number<int>();
        s.index = in.number<std::uint32_t>();
        s.cause = in.number<DropCause>();
    }
    return true;
}

void writeTiles(AtomicFile& file, const FilmPlanes& planes, RenderState& state) {
    std::vector<std::size_t> left(state.pixelTileCount()), busy;
    std::iota(left.begin(), left.end(), std::size_t{0});
    std::vector<std::byte> bytes;
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
                copyTile(i, state, planes, bytes);
            }
            writeBlock(file, tileBlock, bytes);
        }
        left = std::exchange(busy, {});
    }
}

// Blocks of light paths and all that they add to, of one moment, tile by tile: a copy would take as much memory again.
void writeLight(AtomicFile& file, const FilmPlanes& planes, RenderState& state) {
    const bool splats = hasPlanesOfLight(planes);
    if (!splats && state.lightBlockCount() == 0) return;
    const auto closure = state.lightGate().close();
    std::vector<std::byte> bytes;
    for (std::size_t i = state.pixelTileCount(); i < state.tileCount(); ++i) {
        bytes.clear();
        ByteWriter out(bytes);
        out.number(static_cast<std::uint64_t>(i));
        writeTile(state.tile(i), out);
        writeBlock(file, lightBlock, bytes);
    }
    for (std::size_t i = 0; splats && i < state.pixelTileCount(); ++i) {
        bytes.clear();
        ByteWriter(bytes).number(static_cast<std::uint64_t>(i));
        writePlanes(planes, true, state.pixels(i), bytes);
        writeBlock(file, splatBlock, bytes);
    }
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
    writeBytes(file, kCheckpointMagic, sizeof kCheckpointMagic);
    const std::uint32_t version[2] = {kCheckpointVersion, 0};
    writeBytes(file, version, sizeof version);
    writeBlock(file, headerBlock, bytesOf(header));
    writeTiles(file, planes, state);
    writeLight(file, planes, state);
    std::vector<std::byte> bytes;
    ByteWriter(bytes).number(static_cast<std::uint64_t>(state.tileCount()));
    writeBlock(file, endBlock, bytes);
    if ((sound && !sound()) || header.pilot != state.pilot()) return false;
    file.commit();
    return true;
}

CheckpointReader::CheckpointReader(const std::string& path) : path_(path), file_(path) {
    if (!file_.good()) throw IoError(fmt::format("cannot read `{}`: {}", path, file_.why()));
    readHeader();
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

void CheckpointReader::readBlock(Block& block) {
    block.begin = position_;
    BlockHead head;
    if (!read(&head, sizeof head) || file_.size() - position_ < sizeof block.hash ||
        head.size > file_.size() - position_ - sizeof block.hash)
        damaged(block.begin, "the file ends within a block");
    requireMemory(static_cast<double>(head.size));
    block.kind = head.kind;
    block.reserved = head.reserved;
    block.bytes.resize(head.size);
    if (!read(block.bytes.data(), block.bytes.size()) || !read(&block.hash, sizeof block.hash))
        damaged(block.begin, "the file ends within a block");
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

// Some of the blocks that are still to come, read one after the other and checked by many threads.
std::vector<CheckpointReader::Block> CheckpointReader::nextBatch(std::size_t most) {
    constexpr std::size_t kMostBlocks = 256, kMostBytes = std::size_t{64} << 20;
    std::vector<Block> batch;
    for (std::size_t bytes = 0; batch.size() < std::min(most, kMostBlocks) && bytes < kMostBytes;) {
        readBlock(batch.emplace_back());
        bytes += batch.back().bytes.size();
    }
    parallelFor(batch.size(), [&](std::size_t i) { verify(batch[i]); });
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

// The rest of the block.
void CheckpointReader::addPlanes(ByteReader& in, const Block& block, const FilmPlanes& planes, bool ofLightPaths,
                                 PixelBounds pixels) const {
    constexpr std::uint64_t kMuch = 1 << 20; // of a tile; packed bytes may stand for eight times as many
    std::vector<std::byte> unpacked;
    for (const auto& plane : planes) {
        if (plane->ofLightPaths() != ofLightPaths) continue;
        const auto size = in.number<std::uint64_t>();
        const auto packed = in.take(in.number<std::uint64_t>());
        if (size > kMuch) requireMemory(static_cast<double>(std::min<std::uint64_t>(size, 8 * packed.size())));
        if (!in.sound() || !unpack(packed, size, unpacked) || !plane->add(pixels, unpacked))
            damaged(block.begin, "a tile of another size");
    }
    if (!in.atEnd()) damaged(block.begin, "a tile of another size");
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
    addPlanes(in, block, planes, false, state.pixels(i));
}

// Tiles come in any order, each once; threads add to different ones.
void CheckpointReader::addTiles(const FilmPlanes& planes, RenderState& state) {
    std::vector<bool> seen(state.pixelTileCount());
    for (std::size_t done = 0; done < seen.size();) {
        const std::vector<Block> batch = nextBatch(seen.size() - done);
        for (const Block& block : batch) {
            const auto i = ByteReader(block.bytes).number<std::uint64_t>();
            if (block.kind != tileBlock || i >= seen.size() || seen[i]) damaged(block.begin, "an unexpected block");
            seen[i] = true;
        }
        parallelFor(batch.size(), [&](std::size_t i) { addTile(batch[i], planes, state); });
        done += batch.size();
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
    if (!hasPlanesOfLight(planes)) return;
    for (std::size_t done = 0; done < state.pixelTileCount();) {
        const std::vector<Block> batch = nextBatch(state.pixelTileCount() - done);
        parallelFor(batch.size(), [&](std::size_t i) {
            const Block& block = batch[i];
            ByteReader in(block.bytes);
            if (block.kind != splatBlock || in.number<std::uint64_t>() != done + i)
                damaged(block.begin, "an unexpected block");
            addPlanes(in, block, planes, true, state.pixels(done + i));
        });
        done += batch.size();
    }
}

RenderState CheckpointReader::addTo(const FilmPlanes& planes) {
    RenderState state(header_.bounds, header_.first, header_.lightBlocks);
    addTiles(planes, state);
    addLight(planes, state);
    if (const Block& end = next(); end.kind != endBlock || position_ != file_.size()) damaged(end.begin, "no end");
    state.seconds = header_.seconds;
    state.work = header_.work;
    state.setPilot(header_.pilot);
    return state;
}

} // namespace abbe
