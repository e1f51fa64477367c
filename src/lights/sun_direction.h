// Where the sun stands, as `light sun` and `light daylight` state it.
#pragma once

#include "base/diagnostic.h"
#include "schema/type.h"

#include <optional>
#include <vector>

namespace abbe {

// Without anything: 45° high in the south-east.
struct SunPlace {
    std::optional<Vec3d> toward;     // direction in which the light travels
    std::optional<double> elevation; // rad above the horizon
    std::optional<double> azimuth;   // rad clockwise from north, seen from above
};

// Unit vector towards the sun in the axes of the file, where north is -z and east +x, or north +y where z is up.
// Nothing after an error.
std::optional<Vec3d> sunDirection(const SunPlace&, bool zUp, Span, Diagnostics&);

// The fields of SunPlace, for the table of a type derived from it.
template <typename Params> std::vector<schema::FieldInfo> sunPlaceFields() {
    constexpr double kDegree = kPiD / 180;
    using schema::FieldType;
    using Angle = std::optional<double>;
    return {schema::field<Params, std::optional<Vec3d>>(FieldType::vector3, "toward", &Params::toward)
                .group("direction")
                .doc("Direction in which the light travels, of any length.")
                .example("toward 1 -2 0")
                .synonyms({"direction", "to"}),
            schema::field<Params, Angle>(FieldType::quantity, "elevation", &Params::elevation)
                .unit({schema::Dimension::angle})
                .range(-90 * kDegree, 90 * kDegree)
                .doc("Height above the horizon. Default: 45 deg.")
                .example("elevation 30 deg")
                .synonyms({"altitude", "sun-elevation"}),
            schema::field<Params, Angle>(FieldType::quantity, "azimuth", &Params::azimuth)
                .unit({schema::Dimension::angle})
                .range(-360 * kDegree, 360 * kDegree)
                .doc("Clockwise from north, seen from above. North is -z (+y in a z-up scene), east is +x; the sun at "
                     "90 deg stands in the east. Default: 135 deg.")
                .example("azimuth 240 deg")
                .synonyms({"sun-azimuth", "rotation"})};
}

} // namespace abbe
