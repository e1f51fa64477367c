#include "scene/material_parts.h"

#include <fmt/format.h>

namespace abbe {

namespace {

// Boundaries are no surface to scatter at, and what shines would have to be a light.
bool canBePart(schema::Reference reference, std::string_view property, const MaterialContext& parts) {
    const Material& part = parts[reference];
    const bool boundary = part.isBoundary();
    if (!boundary && !(part.emission().luminance > 0)) return true;
    parts.diagnostics()
        .error("E0723", placeOf(parts.definition, property),
               boundary ? "a boundary cannot be a part of a material" : "a part of a material cannot shine",
               boundary ? "there is nothing that scatters" : "gives off light")
        .help = boundary ? "for a surface that lets light through, write `opacity`"
                         : "leave its emission out, or give the shape itself an `emission`";
    return false;
}

bool isOpaque(schema::Reference reference, std::string_view property, const MaterialContext& parts) {
    if (!hasInside(parts[reference])) return true;
    parts.diagnostics()
        .error("E0724", placeOf(parts.definition, property), fmt::format("`{}` must have no inside here", property),
               "light would enter the shape")
        .help = "take a material that is opaque, or thin";
    return false;
}

} // namespace

Span placeOf(const schema::Definition& d, std::string_view property) {
    for (const schema::Node& node : d.properties)
        if (node.name() == property) return node.headSpan();
    for (const schema::Key& key : d.keys)
        if (key.name == property) return key.nameSpan;
    return d.span;
}

std::unique_ptr<const Material> makeMixOf(const MixParams& params, const MaterialContext& parts) {
    if (!canBePart(params.first, "first", parts) || !canBePart(params.second, "second", parts)) return nullptr;
    const Material &first = parts[params.first], &second = parts[params.second];
    if (hasInside(first) && hasInside(second) && !sameInside(first, second)) {
        auto& d =
            parts.diagnostics().error("E0724", placeOf(parts.definition, "second"),
                                      "the parts of a mix fill the shape with different things", "this one differs");
        d.related.push_back({placeOf(parts.definition, "first"), "from this one"});
        d.help = "give both the same `ior`, `absorption` and interior; they may differ in roughness";
        return nullptr;
    }
    return makeMix(params, first, second);
}

std::unique_ptr<const Material> makeLayeredOf(const LayeredParams& params, const MaterialContext& parts) {
    if (!canBePart(params.base, "base", parts) || !isOpaque(params.base, "base", parts)) return nullptr;
    return makeLayered(params, parts[params.base]);
}

std::unique_ptr<const Material> makeTwoSidedOf(const TwoSidedParams& params, const MaterialContext& parts) {
    for (const auto& [reference, property] : {std::pair(params.front, "front"), std::pair(params.back, "back")})
        if (!canBePart(reference, property, parts) || !isOpaque(reference, property, parts)) return nullptr;
    return makeTwoSided(parts[params.front], parts[params.back]);
}

void leaveOutEffects(OpenPbrParams& p, const MaterialContext& context) {
    const auto leavesOut = [&](SwitchedEffect effect) {
        return context.scene.leavesOut({effect}, context.definition.span);
    };
    if (p.transmissionDispersionScale > 0 && leavesOut(SwitchedEffect::dispersion)) p.transmissionDispersionScale = 0;
    const bool filmed = p.thinFilmWeight.texture || p.thinFilmWeight.value > 0;
    if (filmed && p.thinFilmThickness > 0 && leavesOut(SwitchedEffect::thinFilm)) p.thinFilmWeight = {};
}

} // namespace abbe
