#include "app/small_size.h"

#include <algorithm>
#include <cmath>

namespace abbe {

Vec2i smallSize(const LoadedScene& loaded, const BuildOptions& options, int side) {
    BuildOptions look = options;
    look.geometry = false;
    Diagnostics ignored; // they come again
    const Vec2d size = buildScene(loaded.tree, loaded.types, look, ignored).film.size;
    const double scale = std::min(1.0, side / std::max({size.x, size.y, 1.0}));
    const auto scaled = [scale](double v) { return std::max(1, static_cast<int>(std::lround(v * scale))); };
    return {scaled(size.x), scaled(size.y)};
}

} // namespace abbe
