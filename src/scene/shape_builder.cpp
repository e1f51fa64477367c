#include "scene/shape_builder.h"

#include "geometry/face_materials.h"
#include "scene/registry.h"
#include "scene/shape_key.h"
#include "schema/suggest.h"

#include <algorithm>
#include <fmt/format.h>

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

std::unique_ptr<const Shape> ShapeBuilder::withFaceMaterials(const LoadedShape& loaded,
                                                             std::unique_ptr<const Shape> shape) {
    std::vector<const Material*> used{nullptr};
    for (const schema::GroupReference& group : loaded.common.groupMaterials) {
        used.push_back(materials.ofGroup(group, loaded.common));
        media.notePlaced(*used.back(), kEverything, false);
        if (used.back()->focuses())
            scene.built.scene.focusing.push_back({kEverything, scene.nameOf(*loaded.definition)});
    }
    return std::make_unique<const FaceMaterials>(std::move(shape), std::move(used), loaded.faceMaterials);
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
            scene.tree.header.length,
            scene.tree.header.zUp,
            scene.built.shutter,
            scene.built.facts.files};
}

void ShapeBuilder::noteFiles(const std::vector<ShapeKey>& keys) {
    for (const ShapeKey& key : keys)
        if (!key.file.value.empty()) scene.noteFile(key.file.value);
}

std::unique_ptr<const Shape> ShapeBuilder::placeInObject(const LoadedShape& shape, const Transform& toObject) {
    inObject_ = true;
    auto placed = shape.place(toObject);
    inObject_ = false;
    return placed;
}

LoadedShape& ShapeBuilder::loaded(const Definition& d) {
    const auto [found, isNew] = loaded_.try_emplace(&d);
    LoadedShape& shape = found->second;
    if (!isNew) return shape;
    shape.definition = &d;
    const auto bindInto = scene.binder(d);
    if (d.type)
        makerOf<LoadShape> (*d.type)(bindInto, *this, shape);
    else
        bindInto(nullptr); // unknown type: report what is wrong besides
    if (shape.sound && !shape.common.groupMaterials.empty())
        shape.place = [this, &shape, inner = std::move(shape.place)](const Transform& t) {
            auto placed = inner(t);
            return placed ? withFaceMaterials(shape, std::move(placed)) : nullptr;
        };
    if (shape.sound && shape.infinite && emissionOf(shape).radiance.curve) {
        scene.diagnostics.error("E0606", d.span, "an infinite plane cannot emit",
                                "give it an end: use a quad or a disk");
        shape.sound = false;
    }
    checkInterior(shape);
    return shape;
}

} // namespace abbe
