#include "scene/planned_types.h"

#include <algorithm>

namespace abbe {

using namespace schema;

namespace {

struct SubsurfaceParams {
    const Curve* reflectance = nullptr;
    const Curve* meanFreePath = nullptr;
    double roughness = 0;
    const Curve* ior = nullptr;
};

TypeInfo subsurfaceType() {
    using P = SubsurfaceParams;
    return {.kind = Kind::material,
            .name = "subsurface",
            .doc = "Light that wanders under the surface. Not rendered by this version.",
            .example = "material subsurface { roughness 0.4; ior 1.4 }",
            .fields = {
                field(FieldType::spectrum, "reflectance", &P::reflectance)
                    .doc("Colour of the light that comes back, 0 … 1 at every wavelength.")
                    .example("reflectance 0.8"),
                field(FieldType::spectrum, "mean-free-path", &P::meanFreePath)
                    .role(SpectrumRole::unbounded)
                    .doc("Mean distance between scattering events, in m.")
                    .example("mean-free-path 0.001"),
                field(FieldType::number, "roughness", &P::roughness)
                    .range(0, 1)
                    .byDefault("0")
                    .doc("Roughness of the surface: 0 polished, 1 matte.")
                    .example("roughness 0.4"),
                field(FieldType::spectrum, "ior", &P::ior)
                    .role(SpectrumRole::index)
                    .byDefault("1.4")
                    .doc("Refractive index.")
                    .example("ior 1.4"),
            }};
}

} // namespace

std::vector<TypeInfo> plannedTypes() { return {subsurfaceType()}; }

bool isPlanned(Kind kind, std::string_view type) {
    const std::vector<TypeInfo> types = plannedTypes();
    return std::any_of(types.begin(), types.end(), [&](const TypeInfo& t) { return t.kind == kind && t.name == type; });
}

void bindPlanned(Kind kind, const std::function<void(void* params)>& bind) {
    if (kind != Kind::material) return;
    SubsurfaceParams params;
    bind(&params);
}

} // namespace abbe
