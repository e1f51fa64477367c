#include "checkpoints/checkpoint_records.h"

#include "math/byte_hash.h"

#include <algorithm>

namespace abbe {

BlockKind blockOf(const FilmPlane& plane) {
    if (plane.ofLightPaths()) return plane.ofLayers() ? layerSplatBlock : splatBlock;
    return plane.ofLayers() ? layerBlock : tileBlock;
}

bool hasPlanesIn(const FilmPlanes& planes, BlockKind kind) {
    return std::ranges::any_of(planes, [kind](const auto& plane) { return blockOf(*plane) == kind; });
}

std::uint64_t hashOfBlock(const BlockHead& head, std::span<const std::byte> bytes) {
    ByteHash hash;
    hash.add(std::as_bytes(std::span(&head, 1)));
    hash.add(bytes);
    return hash.value();
}

namespace {

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

} // namespace

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
           h.pilot <= RenderSettings::kMostPilot && h.pilot % RenderSettings::kGuidePilot <= RenderSettings::kFullPilot;
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

} // namespace abbe
