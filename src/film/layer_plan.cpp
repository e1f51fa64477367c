#include "film/layer_plan.h"

#include <cmath>

namespace abbe {

int SpectralBins::count() const { return static_cast<int>(std::lround((last - first) / width)); }

bool LayerPlan::empty() const {
    return offsets().total == 0 && !samples && !seconds && !invalid && !halves && !deep && !coversObjects() &&
           !coversMaterials();
}

LayerPlan::Offsets LayerPlan::offsets() const {
    Offsets o;
    const auto take = [&](bool wanted, int count) {
        const int at = o.total;
        if (wanted) o.total += count;
        return at;
    };
    o.surface = take(position || depth || uv, 1);
    o.position = take(position, 3);
    o.depth = take(depth, 1);
    o.uv = take(uv, 2);
    o.followed = take(motion, 1);
    o.motion = take(motion, 2);
    o.looks = take(normal, 1);
    o.normal = take(normal, 3);
    o.albedo = take(albedo, 3);
    o.groups = take(groupCount() > 0, 3 * groupCount());
    o.components = take(components, 9);
    o.spectral = take(spectral.has_value(), spectral ? spectral->count() : 0);
    return o;
}

} // namespace abbe
