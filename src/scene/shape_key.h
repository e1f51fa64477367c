// `at TIME { … }` blocks of shapes that deform: where their points are at that time.
#pragma once

#include "schema/type.h"

#include <optional>
#include <vector>

namespace abbe {

// One block. Either a file or points; what else may stand in it depends on the type of the shape.
struct ShapeKey {
    double time = 0; // s
    Span span;
    schema::Text file;
    std::vector<Vec3d> points;
    std::optional<double> radius; // curves and points
    std::vector<double> radii;
    std::vector<Vec3d> normals; // points
};

// Fields of a block, by the type of the shape.
std::vector<schema::FieldInfo> meshKeyFields();
std::vector<schema::FieldInfo> curvesKeyFields();
std::vector<schema::FieldInfo> pointsKeyFields();

// The property `at` of a type. Requires a member P::keys.
template <typename P> schema::FieldInfo keysField(std::vector<schema::FieldInfo> block) {
    return schema::field<P, std::vector<ShapeKey>>(schema::FieldType::moments, "at", &P::keys)
        .doc("Where the points are at a time, instead of `file` and `points`: the shape deforms. The same points at "
             "every time, in straight lines from one to the next.")
        .example("at \"1/48\" s { points { - 0 0 0; - 1 0 0; - 1 1 0.2 } }")
        .block(std::move(block));
}

} // namespace abbe
