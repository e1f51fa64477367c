#include "media/vdb_type.h"

namespace abbe {

namespace {

using namespace schema;

FieldKey gridKey() {
    FieldKey key{"grid", {}, "The grid's name, as if it stood behind the property's."};
    key.value = true;
    return key;
}

FieldKey numberKey(std::string_view name, double lower, std::string_view doc) {
    FieldKey key{name, {}, doc};
    key.number = true;
    key.lower = lower;
    key.upper = 1e12;
    return key;
}

Field<VdbParams, std::optional<Text>> gridField(std::string_view name, std::optional<Text> VdbParams::*member) {
    return field<VdbParams, std::optional<Text>>(FieldType::text, name, member).key(gridKey());
}

std::vector<FieldInfo> gridFields() {
    using P = VdbParams;
    return {
        gridField("density", &P::density)
            .key(numberKey("scale", 0, "Factor of its values; 1 when absent."))
            .byDefault("density")
            .synonyms({"grid", "grid_name", "field", "density_grid"})
            .doc("Name of the grid that is the density.")
            .example("density smoke scale=2.5"),
        gridField("temperature", &P::temperature)
            .key(numberKey("scale", 0, "Kelvin per unit of its values; 1 when absent."))
            .key(numberKey("offset", -1e12, "Kelvin where its values are 0; 0 when absent."))
            .synonyms({"temperature_grid", "heat", "temp"})
            .doc("Name of the grid of temperatures. The medium emits by Kirchhoff's law: what it absorbs, times a "
                 "black body of that temperature.")
            .example("temperature heat scale=1500 offset=300"),
        gridField("flame", &P::flame)
            .key(numberKey("scale", 0, "Factor of its values; 1 when absent."))
            .synonyms({"flames", "fire", "flame_grid", "emission_grid"})
            .doc("Name of the grid that is the amount of what shines; the density when absent.")
            .example("flame flames scale=3"),
        gridField("color", &P::color)
            .synonyms({"Cd", "albedo_grid", "scattering_grid"})
            .doc("Name of the grid of vectors that tints the albedo, a factor of it: scene-linear Rec. 709 within 0 "
                 "and 1.")
            .example("color Cd"),
        gridField("velocity", &P::velocity)
            .key(numberKey("scale", -1e12, "Factor of its values; 1 when absent."))
            .synonyms({"vel", "v", "velocity_grid", "motion"})
            .doc("Name of the grid of vectors, in units of the file's world per second, with which all grids drift "
                 "while the shutter is open.")
            .example("velocity v scale=24"),
        field<P, std::optional<double>>(FieldType::quantity, "time", &P::time)
            .unit({Dimension::time})
            .range(-1e9, 1e9)
            .synonyms({"frame", "moment"})
            .doc("With `velocity`: the moment at which things are where the file has them; when the shutter opens if "
                 "absent.")
            .example("time 0.5 s"),
    };
}

} // namespace

TypeInfo vdbType() {
    using P = VdbParams;
    std::vector<FieldInfo> fields = {
        field<P, Text>(FieldType::file, "file", &P::file)
            .argument(0)
            .required()
            .synonyms({"filename", "path"})
            .doc("OpenVDB file.")
            .example("file \"cloud.vdb\""),
    };
    for (FieldInfo& f : gridFields()) fields.push_back(std::move(f));
    fields.push_back(field<P, bool>(FieldType::toggle, "level-set", &P::levelSet)
                         .byDefault("off")
                         .doc("Whether a level set may be the density: it becomes fog of density 1 with a soft edge.")
                         .example("level-set on"));
    addOpticsFields<P>(fields);
    addGlowFields<P>(fields);
    fields.push_back(field<P, Transform>(FieldType::transform, "transform", &P::transform)
                         .synonyms({"to_world", "toWorld", "xform"})
                         .doc("Places the volume: steps from top to bottom, as applied to the object.")
                         .example("transform { scale 2; translate 0 1 0 }"));
    return {Kind::volume,
            "vdb",
            "Cloud, smoke and fire from the grids of an OpenVDB file.",
            "volume cloud vdb \"cloud.vdb\" { extinction 0.08 per-m; phase henyey-greenstein 0.85 }",
            false,
            std::move(fields)};
}

} // namespace abbe
