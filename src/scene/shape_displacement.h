// Displacement in scenes: what a shape may say about it, and how that becomes geometry/displacement.h.
#pragma once

#include "base/diagnostic.h"
#include "geometry/displacement.h"
#include "math/mesh_data.h"
#include "schema/type.h"

#include <optional>
#include <vector>

namespace abbe {

struct DisplacementParams {
    std::optional<schema::Quantity> displacement;
    schema::Reference displacementMap;
    std::optional<double> midpoint; // unset: 0.5 for a scalar, 0 for a vector
    std::optional<schema::Choice> displacementKind, displacementSpace;
};

// The map of a definition applied to a cage; `moves` is false without one, or where nothing would move.
struct DisplacementChoice {
    Displacement displacement;
    bool moves = false;
};

// Checks that map and cage fit; nothing after an error. `map` is null where the definition names none.
std::optional<DisplacementChoice> chooseDisplacement(const DisplacementParams&, const Texture* map,
                                                     const SubdivisionCage&, Diagnostics&);

template <typename P> schema::FieldInfo displacementField() {
    using namespace schema;
    return field<P, std::optional<Quantity>>(FieldType::quantity, "displacement", &P::displacement)
        .unit({Dimension::length})
        .range(-1e9, 1e9)
        .synonyms({"displace", "bump", "height"})
        .elsewhere(
            "only `shape subdivision` is displaced; for a polygon mesh write `shape subdivision … { scheme bilinear }`")
        .doc("Moves the surface by the length times the map less its midpoint, in the shape's own space.")
        .example("displacement 2 mm { map noise { scale 1 cm } }")
        .block({
            field<P, Reference>(FieldType::reference, "map", &P::displacementMap)
                .to(Kind::texture)
                .synonyms({"texture", "image"})
                .doc("Name of a texture, or one written in place.")
                .example("map image \"bark.exr\" space=data"),
            field<P, std::optional<double>>(FieldType::number, "midpoint", &P::midpoint)
                .range(-1e9, 1e9)
                .synonyms({"zero-value", "midlevel"})
                .doc("Value of the map that moves nothing; when absent 0.5, with `kind vector` 0.")
                .example("midpoint 0.5"),
            field<P, std::optional<Choice>>(FieldType::choice, "kind", &P::displacementKind)
                .choices({"scalar", "vector"})
                .doc("`scalar` (when absent): the first channel, along the normal. `vector`: three channels.")
                .example("kind vector"),
            field<P, std::optional<Choice>>(FieldType::choice, "space", &P::displacementSpace)
                .choices({"tangent", "object"})
                .doc("What the channels of a vector mean. `tangent` (when absent): along the texture's u, across it, "
                     "and along the normal. `object`: x, y and z.")
                .example("space object"),
        });
}

} // namespace abbe
