#include "scene_checks/wording.h"

#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::checks {

std::string lengthText(double metres) {
    struct Step {
        double from, unit;
        const char* name;
    };
    constexpr std::array<Step, 5> kSteps = {
        {{1e4, 1e3, "km"}, {1, 1, "m"}, {0.01, 0.01, "cm"}, {1e-4, 1e-3, "mm"}, {0, 1e-6, "um"}}};
    for (const Step& step : kSteps)
        if (std::abs(metres) >= step.from) {
            const double number = metres / step.unit;
            return std::abs(number) >= 100 ? fmt::format("{:.0f} {}", number, step.name)
                                           : fmt::format("{:.3g} {}", number, step.name);
        }
    return fmt::format("{:.3g} m", metres);
}

std::string pointText(Vec3 p, const BuiltScene& built, const schema::Header& header) {
    const Vec3d q = (Vec3d(p) + built.scene.origin) / header.length;
    const auto number = [](double v) { return std::abs(v) < 1e-9 ? 0.0 : v; };
    return fmt::format("{:.4g} {:.4g} {:.4g}", number(q.x), number(q.y), number(q.z));
}

std::string quotedName(const void* thing, const BuiltScene& built) {
    const auto found = built.scene.names.find(thing);
    return found == built.scene.names.end() ? std::string("a shape") : fmt::format("`{}`", found->second);
}

Span placeOf(const void* thing, const BuiltScene& built) {
    const auto found = built.declared.find(thing);
    return found == built.declared.end() ? Span{} : found->second;
}

} // namespace abbe::checks
