#include "denoise/tiles.h"

#include "base/parallel.h"
#include "denoise/lanes.h"

#include <algorithm>

namespace abbe {

void forEachTile(int width, int height, const std::function<void(const Tile&)>& body) {
    for (int round = 0; round < 4; ++round) {
        const int startX = (round & 1) * Tile::kSize, startY = (round >> 1) * Tile::kSize;
        constexpr int kStep = 2 * Tile::kSize;
        const int columns = std::max(0, (width - startX + kStep - 1) / kStep);
        const int rows = std::max(0, (height - startY + kStep - 1) / kStep);
        parallelFor(static_cast<std::size_t>(columns * rows), [&](std::size_t index) {
            const int i = static_cast<int>(index);
            Tile t{startX + i % columns * kStep, startY + i / columns * kStep, 0, 0};
            t.width = std::min(Tile::kSize, (width - t.x0 + kLanes - 1) / kLanes * kLanes);
            t.height = std::min(Tile::kSize, height - t.y0);
            body(t);
        });
    }
}

} // namespace abbe
