// Media in which light goes less far between two collisions than positions can be told apart.
#include "media/homogeneous.h"
#include "scene/scene_builder.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

// Of the distance from the camera to the far end of what the medium fills: some forty steps of single precision. Where
// collisions are nearer to the surface than a point on it is known to, light is lost: 2 % of what a medium of albedo
// 0.9 sends back here, a quarter at a twentieth of it, and below that paths do not find out again.
constexpr double kLeastFreePath = 4e-6;

double farthest(const Bounds3& b) {
    const Vec3 far = max(abs(b.lower), abs(b.upper));
    return static_cast<double>(std::max({far.x, far.y, far.z}));
}

std::string lengthText(double metres) {
    if (metres < 1e-6) return fmt::format("{:.2g} nm", metres * 1e9);
    if (metres < 1e-3) return fmt::format("{:.2g} µm", metres * 1e6);
    return fmt::format("{:.2g} mm", metres * 1e3);
}

} // namespace

// How far light spreads in such a medium nobody can see: it is less than an eightieth of a pixel of a picture 2000
// pixels wide. What a deep medium sends back does not depend on the unit of length, so that another free path gives the
// same picture, but for that spread, and for what shines through sheets that are not many free paths thick.
void SceneBuilder::limitDenseMedia() {
    const double all = bounds_.empty() ? 0 : farthest({Vec3(bounds_.lower), Vec3(bounds_.upper)});
    for (HomogeneousMedium* medium : evenMedia_) {
        double far = 0;
        for (const PlacedShape& shape : placedShapes_) // planes and objects are as large as the scene
            if (shape.material->interior() == medium) far = std::max(far, std::min(farthest(shape.box), all));
        const double least = kLeastFreePath * far, densest = medium->extinction().maximum();
        if (!(least * densest > 1)) continue;
        const Span span = mediumSpans_[medium->number];
        if (medium->emission()) {
            diagnostics_
                .error("E0651", span,
                       fmt::format("light goes {} in this medium, which shines", lengthText(1 / densest)), "too dense")
                .help =
                fmt::format("at its distance from the camera positions are told apart to {}: let it be thinner, "
                            "or make the shape a light with a surface",
                            lengthText(least));
            continue;
        }
        diagnostics_
            .warning("W0697", span,
                     fmt::format("light goes {} between collisions, which is less than positions here can tell; it is "
                                 "taken to go {}",
                                 lengthText(1 / densest), lengthText(least)),
                     "what is thicker than that looks the same")
            .help = "if this was meant to be seen, its unit is wrong: `mean-free-path 1 mm`; if not, `material "
                    "diffuse` is the same and faster";
        medium->limitExtinction(1 / least);
    }
}

} // namespace abbe
