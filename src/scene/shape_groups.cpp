// Materials of parts of a shape: `material horn group=horns`.
#include "geometry/face_materials.h"
#include "scene/scene_builder.h"
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

// For each group of faces the material that it has, by its position in `groupMaterials` from 1 on; 0: the shape's own.
std::optional<std::vector<std::uint16_t>> SceneBuilder::groupChoices(const ShapeParams& params,
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
        if (!known) unknownGroup(params.groupMaterials[m], names, diagnostics_);
        sound = sound && known;
    }
    return sound ? std::optional(std::move(choices)) : std::nullopt;
}

void SceneBuilder::chooseFaceMaterials(LoadedShape& shape, const FaceGroups& groups) {
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

std::unique_ptr<const Shape> SceneBuilder::withFaceMaterials(const LoadedShape& loaded,
                                                             std::unique_ptr<const Shape> shape) {
    std::vector<const Material*> materials{nullptr};
    for (const schema::GroupReference& group : loaded.common.groupMaterials) {
        usedMaterials_.insert(group.reference.index);
        materials.push_back(filled(materials_[group.reference.index].get(), loaded.common));
        notePlaced(*materials.back(), kEverything, false);
        noteFocusing(*materials.back(), {kEverything, nameOf(*loaded.definition)}, nullptr);
    }
    return std::make_unique<const FaceMaterials>(std::move(shape), std::move(materials), loaded.faceMaterials);
}

} // namespace abbe
