#include "scene/shape_builder.h"

#include "geometry/mesh.h"
#include "scene/registry.h"
#include "schema/suggest.h"

#include <algorithm>
#include <fmt/format.h>
#include <span>

namespace abbe {

namespace {

// OBJ files may put faces into several groups at once: `g head skin`.
std::vector<std::string_view> wordsOf(std::string_view names) {
    std::vector<std::string_view> words;
    for (std::size_t begin = 0; begin < names.size();) {
        const std::size_t end = std::min(names.find_first_of(" \t", begin), names.size());
        if (end > begin) words.push_back(names.substr(begin, end - begin));
        begin = end + 1;
    }
    return words;
}

bool isNamed(std::string_view names, std::string_view wanted) {
    return names == wanted || std::ranges::count(wordsOf(names), wanted) > 0;
}

void unknownGroup(const schema::GroupReference& asked, const std::vector<std::string>& names,
                  Diagnostics& diagnostics) {
    std::vector<std::string_view> known;
    for (const std::string& name : names)
        for (const std::string_view word : wordsOf(name))
            if (std::ranges::find(known, word) == known.end()) known.push_back(word);
    const auto meant = schema::nearest(asked.group, known);
    auto& error = diagnostics.error("E0615", asked.span, fmt::format("no group of faces is named `{}`", asked.group),
                                    meant.empty() ? "unknown group" : schema::didYouMean(meant));
    constexpr std::size_t most = 12;
    const std::size_t more = known.size() > most ? known.size() - most : 0;
    known.resize(known.size() - more);
    error.help = known.empty() ? "only OBJ and glTF files have groups, and this one names none"
                               : fmt::format("the groups are {}{}", schema::quotedList(known),
                                             more > 0 ? fmt::format(" and {} more", more) : "");
}

} // namespace

std::optional<std::vector<std::uint16_t>> ShapeBuilder::groupChoices(const ShapeParams& params,
                                                                     const std::vector<std::string>& names) {
    std::vector<std::uint16_t> choices(names.size());
    bool sound = true;
    for (std::size_t m = 0; m < params.groupMaterials.size(); ++m) {
        bool known = false;
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (!isNamed(names[i], params.groupMaterials[m].group)) continue;
            choices[i] = static_cast<std::uint16_t>(m + 1);
            known = true;
        }
        if (!known) unknownGroup(params.groupMaterials[m], names, scene.diagnostics);
        sound = sound && known;
    }
    return sound ? std::optional(std::move(choices)) : std::nullopt;
}

void ShapeBuilder::chooseFaceMaterials(LoadedShape& shape, const FaceGroups& groups) {
    const auto choices = groupChoices(shape.common, groups.names);
    if (!choices) {
        shape.sound = false;
        return;
    }
    shape.faceMaterials.clear();
    if (choices->empty()) return;
    shape.faceMaterials.reserve(groups.triangles.size() + groups.quads.size());
    for (const std::uint32_t g : groups.triangles) shape.faceMaterials.push_back((*choices)[g]);
    for (const std::uint32_t g : groups.quads) shape.faceMaterials.push_back((*choices)[g]);
}

std::shared_ptr<const Shape> ShapeBuilder::withFaceMaterials(const LoadedShape& loaded,
                                                             std::shared_ptr<const Shape> shape) {
    std::vector<const Material*> used{nullptr};
    for (const schema::GroupReference& group : loaded.common.groupMaterials) {
        used.push_back(materials.ofGroup(group, loaded.common));
        media.notePlaced(*used.back(), kEverything, false);
        if (used.back()->focuses())
            scene.built.scene.focusing.push_back({kEverything, scene.nameOf(*loaded.definition)});
    }
    return std::make_shared<const FaceMaterials>(std::move(shape), std::move(used), loaded.faceMaterials);
}

ShapeEmission ShapeBuilder::emissionOf(const LoadedShape& shape) {
    const schema::TexturedSpectrum& emission = shape.common.emission;
    if (emission.texture) return {{textures.white(*emission.texture), 1}, emission.texture, emission.span};
    if (emission.curve) return {{emission.curve, 1}, nullptr, {}};
    const Material* material = materials.ofShape(shape.common);
    const SurfaceEmission own = material ? material->emission() : SurfaceEmission{};
    if (!(own.luminance > 0)) return {};
    const Curve* color = own.color ? own.color : scene.curves.daylight();
    const auto ofWhite = scaleFor({own.luminance, schema::Dimension::luminance, {}}, *scene.curves.daylight(), 1);
    return {{color, ofWhite.value_or(0)}, own.texture, shape.definition->span, own.bothSides, own.veil};
}

ShapeContext ShapeBuilder::contextOf(const Definition& d) {
    return {d.span,
            scene.diagnostics,
            scene.up(),
            scene.tree.headerOf(d.span).length,
            scene.tree.headerOf(d.span).zUp,
            scene.built.shutter,
            scene.built.facts.files};
}

void ShapeBuilder::noteFiles(const std::vector<ShapeKey>& keys) {
    for (const ShapeKey& key : keys)
        if (!key.file.value.empty()) scene.noteFile(key.file.value);
}

namespace {

// What is no part of a shape's geometry. Transforms are: as the map that places it.
constexpr std::string_view kNotGeometry[] = {"material", "interior", "emission", "visible-to", "transform"};

bool hasKeys(const schema::Definition& d) {
    return std::ranges::any_of(d.properties, [](const schema::Node& property) { return property.name() == "at"; });
}

Digest marked(const Digest& digest, std::string_view mark) {
    DigestWriter writer;
    writer.text(mark);
    writer.add(digest);
    return writer.digest();
}

// A shape in its place, and what placing it said of it.
struct PlacedShape {
    std::shared_ptr<const Shape> shape;
    std::vector<std::uint16_t> faceMaterials;
    std::size_t dicedTriangles = 0, dicedQuads = 0;
};

} // namespace

// Shapes that are alike and stand at one place are counted: each is a shape of its own.
Digest ShapeBuilder::placeDigest(const LoadedShape& shape, const Transform& to, bool inObject) {
    DigestWriter writer;
    writer.text("place");
    writer.add(shape.meaning.digest);
    writer.add(to);
    writer.number(inObject);
    if (hasKeys(*shape.definition))
        writer.number(scene.built.shutter.open), writer.number(scene.built.shutter.duration);
    if (shape.subdivided) writer.number(scene.options.without.leavesOut(SwitchedEffect::displacement));
    const Digest once = writer.digest();
    writer.number(scene.reuse->timesAsked(once));
    return writer.digest();
}

std::shared_ptr<const Shape> ShapeBuilder::placed(LoadedShape& shape, const Transform& to, bool inObject) {
    const auto make = [&]() -> std::shared_ptr<const PlacedShape> {
        inObject_ = inObject;
        std::shared_ptr<const Shape> made = shape.place(to);
        inObject_ = false;
        if (!made) return nullptr;
        return std::make_shared<const PlacedShape>(
            PlacedShape{std::move(made), shape.faceMaterials, shape.dicedTriangles, shape.dicedQuads});
    };
    std::shared_ptr<const PlacedShape> placed;
    if (scene.reuse) {
        DigestWriter view;
        if (shape.view) shape.view(view, inObject);
        placed = scene.reused<PlacedShape>(Reused::place, placeDigest(shape, to, inObject), shape.meaning.spans, make,
                                           view.digest());
    } else {
        placed = make();
    }
    if (!placed) return nullptr;
    shape.faceMaterials = placed->faceMaterials;
    shape.dicedTriangles = placed->dicedTriangles;
    shape.dicedQuads = placed->dicedQuads;
    return shape.common.groupMaterials.empty() ? placed->shape : withFaceMaterials(shape, placed->shape);
}

std::shared_ptr<const Shape> ShapeBuilder::lightSurface(const Definition& d, const Transform& place,
                                                        const std::function<void(DigestWriter&)>& addMeaning,
                                                        const std::function<std::unique_ptr<const Shape>()>& make) {
    if (!scene.reuse) return make();
    DigestWriter writer;
    writer.text("light");
    addMeaning(writer);
    writer.add(place);
    writer.number(scene.reuse->timesAsked(writer.digest()));
    return scene.reused<Shape>(Reused::place, writer.digest(), std::span(&d.span, 1),
                               [&] { return std::shared_ptr<const Shape>(make()); });
}

LoadedShape& ShapeBuilder::loaded(const Definition& d) {
    const auto [found, isNew] = loaded_.try_emplace(&d);
    LoadedShape& shape = found->second;
    if (!isNew) return shape;
    shape.definition = &d;
    if (scene.reuse) shape.meaning = meaningOf(d, scene.tree, kNotGeometry);
    const auto bindInto = scene.binder(d);
    if (d.type)
        makerOf<LoadShape> (*d.type)(bindInto, *this, shape);
    else
        bindInto(nullptr); // unknown type: report what is wrong besides
    if (shape.sound && shape.infinite && emissionOf(shape).radiance.curve) {
        scene.diagnostics.error("E0606", d.span, "an infinite plane cannot emit",
                                "give it an end: use a quad or a disk");
        shape.sound = false;
    }
    checkInterior(shape);
    return shape;
}

using namespace schema;

namespace {

using K = ShapeKey;

FieldInfo fileField() {
    return withGltfKeys(field(FieldType::file, "file", &K::file)
                            .doc("File with the points at this time.")
                            .example("file \"flag.0102.ply\""));
}

FieldInfo pointsField() {
    return field(FieldType::points, "points", &K::points)
        .unit({Dimension::length})
        .doc("Points at this time, one row of three numbers each, or one long list.")
        .example("points { - 0 0 0; - 1 0 0; - 1 1 0.2 }");
}

} // namespace

FieldInfo withGltfKeys(FieldInfo file) {
    FieldKey time{"time", {}, "Pose of a glTF file: its animation at this time in seconds."};
    time.number = true;
    file.keys.push_back({"node", {}, "Take this node of a glTF file, and those below it."});
    file.keys.push_back({"mesh", {}, "Take this mesh of a glTF file."});
    file.keys.push_back(
        {"animation", {}, "Pose of a glTF file: this animation; the first one if only `time` is given."});
    file.keys.push_back(std::move(time));
    return file;
}

std::vector<FieldInfo> meshKeyFields() { return {fileField(), pointsField()}; }

std::vector<FieldInfo> curvesKeyFields() {
    return {fileField(), pointsField(),
            field(FieldType::quantity, "radius", &K::radius)
                .unit({Dimension::length})
                .range(0, 1e15)
                .doc("Radius everywhere at this time.")
                .example("radius 0.05 mm"),
            field(FieldType::numbers, "radii", &K::radii)
                .unit({Dimension::length})
                .range(0, 1e15)
                .doc("Radius at each point at this time.")
                .example("radii 2 2 1 0 mm")};
}

std::vector<FieldInfo> pointsKeyFields() {
    std::vector<FieldInfo> fields = curvesKeyFields();
    fields.push_back(field(FieldType::points, "normals", &K::normals)
                         .unit({Dimension::none})
                         .doc("Direction of the outer side of each disk at this time.")
                         .example("normals { - 0 1 0; - 0 1 0.5 }"));
    return fields;
}

OpenEdges ShapeBuilder::edgesOf(const LoadedShape& shape) {
    if (!shape.mesh) return shape.cageEdges;
    return *scene.reused<OpenEdges>(Reused::table, marked(shape.meaning.digest, "edges"), shape.meaning.spans,
                                    [&] { return std::make_shared<const OpenEdges>(openEdges(*shape.mesh)); });
}

// Media fill what has an inside: a plane has one, below it; a disk has none.
void ShapeBuilder::checkInterior(LoadedShape& shape) {
    if (!shape.sound || !materials.holdsMedium(shape.common)) return;
    const bool own = shape.common.interior.valid();
    Span span = shape.definition->span;
    for (const schema::Node& property : shape.definition->properties)
        if (property.name() == (own ? "interior" : "material")) span = property.nameSpan();
    const schema::Reference material = shape.common.material;
    if (own && material.valid() && materials[material].interior()) {
        scene.diagnostics.error("E0725", span, "this shape is filled twice", "its material fills it already").help =
            "take a `dielectric` for the surface of an `interior`";
        shape.sound = false;
        return;
    }
    if (own && material.valid() && materials[material].isOpaque())
        scene.diagnostics.warning("W0695", span, "nothing is seen of this `interior`", "the material lets no light in")
            .help = "a medium needs a surface that light passes: `dielectric`, or `boundary` for a body without one";
    const std::string_view type = shape.definition->type->name;
    if (const std::string_view open = shape.openBecause; !open.empty()) {
        scene.diagnostics.error("E0645", span, fmt::format("this `{}` cannot hold a medium", type), std::string(open))
            .help = "a medium fills closed shapes: a sphere, a box, a cylinder with caps, a mesh without holes";
        shape.sound = false;
        return;
    }
    const OpenEdges edges = edgesOf(shape);
    if (edges.closed()) return;
    const auto number = [](std::uint64_t n, std::string_view what) {
        return fmt::format("{} {}", n, n == 1 ? fmt::format("edge {}", what) : fmt::format("edges {}", what));
    };
    scene.diagnostics
        .warning("W0694", span, fmt::format("this `{}` is not closed, but holds a medium", type),
                 edges.open == 0     ? number(edges.turned, "between faces that are turned against each other")
                 : edges.turned == 0 ? number(edges.open, "of a single face")
                                     : fmt::format("{}, {}", number(edges.open, "of a single face"),
                                                   number(edges.turned, "between faces turned against each other")))
        .help = "light that enters through a face and leaves through a hole takes the medium along";
}

} // namespace abbe
