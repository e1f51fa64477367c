#include "media/noise_types.h"

namespace abbe {

using namespace schema;

namespace {

template <typename P> void addPatternFields(std::vector<FieldInfo>& fields) {
    fields.push_back(field<P, Choice>(FieldType::choice, "pattern", &P::kindWord)
                         .choices({"gradient", "billow", "cellular"})
                         .byDefault("gradient")
                         .synonyms({"noise", "basis", "type"})
                         .doc("Soft patches and wisps (gradient), round heaps (billow) or puffs (cellular).")
                         .example("pattern billow"));
    fields.push_back(field<P, double>(FieldType::quantity, "scale", &P::scale)
                         .unit({Dimension::length})
                         .range(1e-6, 1e9)
                         .byDefault("1 m")
                         .synonyms({"feature-size", "wavelength", "period"})
                         .doc("Distance between the features of the first octave, before the transform.")
                         .example("scale 40 cm"));
    fields.push_back(field<P, int>(FieldType::integer, "octaves", &P::octaves)
                         .range(1, 16)
                         .byDefault("5")
                         .synonyms({"detail", "levels"})
                         .doc("How many noises are added, each finer and weaker than the one before.")
                         .example("octaves 6"));
    fields.push_back(field<P, double>(FieldType::number, "lacunarity", &P::lacunarity)
                         .range(1, 8)
                         .byDefault("2")
                         .doc("How much finer each octave is.")
                         .example("lacunarity 2.1"));
    fields.push_back(field<P, double>(FieldType::number, "gain", &P::gain)
                         .range(0, 1)
                         .byDefault("0.5")
                         .synonyms({"roughness", "persistence"})
                         .doc("How strong each octave is against the one before.")
                         .example("gain 0.4"));
    fields.push_back(field<P, double>(FieldType::number, "warp", &P::warp)
                         .range(0, 10)
                         .byDefault("0")
                         .synonyms({"distortion", "turbulence"})
                         .doc("How far another noise distorts the pattern, in units of `scale`.")
                         .example("warp 0.4"));
}

template <typename P> void addAmountFields(std::vector<FieldInfo>& fields) {
    fields.push_back(field<P, double>(FieldType::number, "coverage", &P::coverage)
                         .range(0.001, 1)
                         .byDefault("0.5")
                         .synonyms({"threshold", "fill", "amount"})
                         .doc("Share of space where the pattern is more than nothing.")
                         .example("coverage 0.3"));
    fields.push_back(
        field<P, double>(FieldType::number, "softness", &P::softness)
            .range(0.001, 1)
            .byDefault("0.5")
            .synonyms({"sharpness", "feather"})
            .doc("How slowly density rises to 1: 0.05 has crisp edges, 1 is 1 at the thickest places alone.")
            .example("softness 0.3"));
    fields.push_back(field<P, double>(FieldType::number, "contrast", &P::contrast)
                         .range(0, 1)
                         .byDefault("1")
                         .doc("1: nothing between the patches; 0: density 1 everywhere.")
                         .example("contrast 0.6"));
    fields.push_back(field<P, std::uint32_t>(FieldType::integer, "seed", &P::seed)
                         .range(0, 4294967295.0)
                         .byDefault("0")
                         .doc("Another number gives another pattern of the same kind.")
                         .example("seed 7"));
}

FieldInfo corner(std::string_view name, std::optional<Vec3d> NoiseVolumeParams::*member, std::string_view doc,
                 std::string_view example) {
    return field<NoiseVolumeParams, std::optional<Vec3d>>(FieldType::vector3, name, member)
        .unit({Dimension::length})
        .doc(doc)
        .example(example);
}

void addBoxFields(std::vector<FieldInfo>& fields) {
    using P = NoiseVolumeParams;
    fields.push_back(field<P, std::optional<Vec3d>>(FieldType::vector3, "size", &P::size)
                         .unit({Dimension::length})
                         .range(1e-6, 1e9)
                         .synonyms({"dimensions", "extent"})
                         .doc("Lengths of the edges of the box along x, y and z; 1 1 1 when absent.")
                         .example("size 12 2 12 m"));
    fields.push_back(corner("center", &P::center, "Middle of the box; not beside `min` and `max`.", "center 0 1 0"));
    fields.push_back(
        corner("min", &P::lowest, "Corner with the smallest coordinates, instead of `size`.", "min -6 0 -6"));
    fields.push_back(
        corner("max", &P::highest, "Corner with the largest coordinates, together with `min`.", "max 6 2 6"));
    fields.push_back(field<P, double>(FieldType::quantity, "edge", &P::edge)
                         .unit({Dimension::length})
                         .range(0, 1e9)
                         .byDefault("0")
                         .synonyms({"falloff", "fade"})
                         .doc("Distance from the faces of the box over which density rises from 0.")
                         .example("edge 50 cm"));
    fields.push_back(field<P, double>(FieldType::quantity, "scale-height", &P::scaleHeight)
                         .unit({Dimension::length})
                         .range(1e-6, 1e9)
                         .synonyms({"height_falloff"})
                         .doc("Height over which density falls to 1/e, from the bottom of the box; none when absent.")
                         .example("scale-height 60 cm"));
}

template <typename P> FieldInfo placement() {
    return field<P, Transform>(FieldType::transform, "transform", &P::transform)
        .synonyms({"to_world", "toWorld", "xform"})
        .doc("Places the pattern: steps from top to bottom.")
        .example("transform { rotate y 30 deg }");
}

} // namespace

NoisePattern patternOf(const NoiseMediumParams& params) {
    NoisePattern pattern = params;
    pattern.kind = params.kindWord.word == "billow"     ? NoiseKind::billow
                   : params.kindWord.word == "cellular" ? NoiseKind::cellular
                                                        : NoiseKind::gradient;
    return pattern;
}

std::variant<NoiseBox, std::string_view> boxOf(const NoiseVolumeParams& p, bool zUp) {
    NoiseBox box;
    if (p.lowest || p.highest) {
        if (!p.lowest || !p.highest) return "`min` and `max` go together";
        if (p.size || p.center) return "`min` and `max` leave nothing for `size` and `center` to say";
        box.lower = *p.lowest;
        box.upper = *p.highest;
    } else {
        const Vec3d size = p.size.value_or(Vec3d{1, 1, 1}), center = p.center.value_or(Vec3d{});
        box.lower = center - size * 0.5;
        box.upper = center + size * 0.5;
    }
    if (!(minComponent(box.upper - box.lower) > 0)) return "the box has no volume";
    box.edge = p.edge;
    box.scaleHeight = p.scaleHeight;
    box.up = zUp ? 2 : 1;
    return box;
}

TypeInfo noiseMediumType() {
    std::vector<FieldInfo> fields;
    addPatternFields<NoiseMediumParams>(fields);
    addAmountFields<NoiseMediumParams>(fields);
    addOpticsFields<NoiseMediumParams>(fields);
    fields.push_back(placement<NoiseMediumParams>());
    return {Kind::medium,
            "noise",
            "Patches, heaps or puffs by fractal noise, wherever the shape that it fills is.",
            "medium smoke noise { scale 20 cm; coverage 0.4; extinction 8 per-m; albedo 0.7 }",
            false,
            std::move(fields)};
}

TypeInfo noiseVolumeType() {
    std::vector<FieldInfo> fields;
    addBoxFields(fields);
    addPatternFields<NoiseVolumeParams>(fields);
    addAmountFields<NoiseVolumeParams>(fields);
    addOpticsFields<NoiseVolumeParams>(fields);
    fields.push_back(placement<NoiseVolumeParams>());
    return {Kind::volume,
            "noise",
            "A box of mist, smoke or cloud by fractal noise.",
            "volume mist noise { size 20 2 20 m; scale 1.5 m; scale-height 50 cm; extinction 0.5 per-m }",
            false,
            std::move(fields)};
}

} // namespace abbe
