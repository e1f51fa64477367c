// Checkpoints whose checksums are right, whatever is in them: header, tiles, planes of every kind, light paths.
#include "checkpoints/checkpoint_reader.h"
#include "film/pixel_film.h"
#include "fuzz/target.h"
#include "fuzz/targets/reading.h"
#include "math/byte_hash.h"

#include <cstring>

using namespace abbe;

namespace {

constexpr std::size_t kFileHead = 16, kBlockHead = 16;

// The checksum of every block as far as the sizes of blocks lead.
void repair(std::string& bytes) {
    for (std::size_t at = kFileHead; bytes.size() - std::min(bytes.size(), at) >= kBlockHead + 8;) {
        std::uint64_t size = 0;
        std::memcpy(&size, bytes.data() + at + 8, sizeof size);
        if (size > bytes.size() - at - kBlockHead - 8) return;
        const std::uint64_t hash = hashOf(std::as_bytes(std::span(bytes.data() + at, kBlockHead + size)));
        std::memcpy(bytes.data() + at + kBlockHead + size, &hash, sizeof hash);
        at += kBlockHead + size + 8;
    }
}

LayerPlan planOfLayers() {
    LayerPlan plan;
    plan.deep = 4;
    plan.components = true;
    return plan;
}

void read(const std::string& path) {
    CheckpointReader reader(path);
    const CheckpointHeader& h = reader.header();
    if (h.bounds.width() > 64 || h.bounds.height() > 64 || h.replicates > 4) return; // a film of it is never made
    PixelFilm film(h.bounds, PixelFilter(FilterShape::box, 0.5), h.replicates);
    if (h.planes.size() > 2) film.keepLayers(planOfLayers(), {}, rgb::ap0);
    if (h.lightBlocks > 0) {
        film.keepSplats();
        film.keepMerged();
    }
    const RenderState state = reader.addTo(film.planes());
    state.tally();
    for (const DroppedSample& s : state.examples())
        fuzz::require(s.x >= h.bounds.x0 && s.x < h.bounds.x1 && s.replicate < h.replicates, "a sample of nowhere");
    for (int y = h.bounds.y0; y < h.bounds.y1; ++y)
        for (int x = h.bounds.x0; x < h.bounds.x1; ++x) film.mean(x, y);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string bytes = fuzz::bytesOf(data, size);
    repair(bytes);
    const fuzz::MemoryFile file(bytes);
    try {
        fuzz::reading([&] { read(file.path()); });
    } catch (const CheckpointFault&) {
    }
    return 0;
}
