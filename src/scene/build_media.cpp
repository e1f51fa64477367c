// Media that fill shapes, and volumes that stand by themselves.
#include "media/atmosphere.h"
#include "media/homogeneous.h"
#include "scene/filled_material.h"
#include "scene/scene_builder.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

using schema::Kind;

schema::Reference SceneBuilder::mediumReference(const Definition& d) {
    if (d.type && d.type->name == "noise") {
        auto medium = makeNoiseMedium(d);
        return medium ? schema::Reference{keepMedium(std::move(medium), d)} : schema::Reference{};
    }
    const auto params = bound<HomogeneousParams>(d);
    if (!params) return {};
    const auto optics = opticsOf(*params, d);
    if (!optics) return {};
    if (const auto fault = findContradiction(*params, *optics, params->temperature > 0); !fault.empty()) {
        diagnostics_.error("E0647", d.span, "this medium cannot shine so", std::string(fault));
        return {};
    }
    const auto glow = makeGlow(*params, *optics, params->temperature > 0);
    auto medium = std::make_unique<HomogeneousMedium>(*optics, glow, params->temperature);
    evenMedia_.push_back(medium.get());
    return {keepMedium(std::move(medium), d)};
}

std::uint32_t SceneBuilder::keepMedium(std::unique_ptr<Medium> medium, const Definition& d) {
    medium->number = static_cast<std::uint16_t>(media_.size());
    built_->declared[medium.get()] = d.nameSpan;
    media_.push_back(std::move(medium));
    mediumSpans_.push_back(d.span);
    built_->scene.mediumUses.push_back({nameOf(d), MediumUse::Place::nowhere});
    return static_cast<std::uint32_t>(media_.size() - 1);
}

std::optional<MediumOptics> SceneBuilder::opticsOf(const MediumParams& params, const Definition& d) {
    if (const auto fault = findContradiction(params); !fault.empty()) {
        diagnostics_.error("E0640", d.span, "a medium has extinction and albedo, or scattering and absorption",
                           std::string(fault));
        return std::nullopt;
    }
    return makeOptics(params, params.phase.valid() ? phases_[params.phase.index] : nullptr, curves_.constant(0),
                      curves_.constant(1));
}

void SceneBuilder::placeVolume(const Definition& d, const Place& place) {
    const std::string_view type = d.type ? d.type->name : "";
    if (place.object || place.motion.moves()) {
        diagnostics_
            .error("E0644", d.span, "a volume stands still, at the top level or in a group",
                   place.object ? "in an object" : "what holds it moves")
            .help = "media that fill shapes (`interior`) may move and be instanced";
        return;
    }
    if (leavesOut({SwitchedEffect::medium, nameOf(d)}, d.span)) return; // before it becomes a light
    const Transform toRender = atOpening(place.motion);
    std::unique_ptr<Medium> medium;
    if (type == "atmosphere") {
        if (const auto p = bound<AtmosphereParams>(d)) medium = makeAtmosphere(*p, d, toRender);
    } else if (type == "vdb") {
        medium = loadVdb(d, toRender);
    } else if (type == "noise") {
        medium = makeNoiseVolume(d, toRender);
    } else {
        bound<MediumParams>(d);
    }
    if (!medium) return;
    openMedia_.emplace_back(media_[keepMedium(std::move(medium), d)].get(), d.span);
}

// An unknown name has been reported.
void SceneBuilder::placeAtmosphere(const Definition& d) {
    const Definition* const named = tree_.find(Kind::medium, d.target);
    if (!named) return;
    if (const schema::Reference medium = reference(*named, diagnostics_);
        medium.valid() && !leavesOut({SwitchedEffect::medium, nameOf(*named)}, d.span))
        openMedia_.emplace_back(media_[medium.index].get(), d.span);
}

std::unique_ptr<Medium> SceneBuilder::makeAtmosphere(const AtmosphereParams& params, const Definition& d,
                                                     const Transform& toRender) {
    const auto optics = opticsOf(params, d);
    if (!optics) return nullptr;
    const Vec3d up = tree_.header.zUp ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
    const double ground = dot(toRender.point(up * params.ground), up);
    return std::make_unique<Atmosphere>(*optics, Vec3(up), ground, params.scaleHeight);
}

void SceneBuilder::noteInterior(const Medium& medium) {
    if (std::ranges::find(interiorAskers_, &medium, &std::pair<const Medium*, Span>::first) != interiorAskers_.end())
        return;
    for (std::size_t i = 0; i < media_.size(); ++i)
        if (media_[i].get() == &medium) interiorAskers_.emplace_back(&medium, mediumSpans_[i]);
}

bool SceneBuilder::holdsMedium(const ShapeParams& params) const {
    const auto filling = [this](schema::Reference m) { return m.valid() && materials_[m.index]->interior(); };
    return params.interior.valid() || filling(params.material) ||
           std::ranges::any_of(params.groupMaterials, [&](const auto& g) { return filling(g.reference); });
}

// The surface and what it holds, as one material.
const Material* SceneBuilder::filled(const Material* surface, const ShapeParams& params) {
    if (!params.interior.valid()) {
        if (surface->interior()) noteInterior(*surface->interior());
        return surface;
    }
    const Medium& medium = *media_[params.interior.index];
    const std::size_t number = medium.number;
    if (leavesOut({SwitchedEffect::medium, built_->scene.mediumUses[number].name}, mediumSpans_[number]))
        return surface;
    auto& index = filled_[{surface, &medium}];
    if (!index) {
        index = static_cast<std::uint32_t>(materials_.size());
        materials_.push_back(std::make_unique<FilledMaterial>(*surface, medium));
        built_->scene.names[materials_.back().get()] = built_->scene.names[surface];
        usedMaterials_.insert(*index);
        noteInterior(medium);
    }
    return materials_[*index].get();
}

void SceneBuilder::notePlaced(const Material& material, const Bounds3& box, bool repeated) {
    if (material.interior() || material.seesOutside()) placedShapes_.push_back({box, &material, repeated});
}

// Whether any shape to which it matters may be in another's dielectric: those that are dielectrics themselves, or all
// others. By their boxes: what is apart for certain need not be followed from one into the other.
bool SceneBuilder::mayLieInDielectric(bool dielectrics) const {
    constexpr std::size_t kManyPairs = 100'000; // not worth the time
    std::vector<const PlacedShape*> outer, inner;
    for (const PlacedShape& shape : placedShapes_) {
        const bool isDielectric = shape.material->ior() != nullptr;
        if (isDielectric) outer.push_back(&shape);
        if (isDielectric == dielectrics && shape.material->seesOutside()) inner.push_back(&shape);
    }
    if (outer.size() * inner.size() > kManyPairs) return true;
    const auto meet = [](const PlacedShape* a, const PlacedShape* b) {
        return a == b ? a->repeated : a->box.overlaps(b->box);
    };
    for (const PlacedShape* a : outer)
        if (std::ranges::any_of(inner, [&](const PlacedShape* b) { return meet(a, b); })) return true;
    return false;
}

void SceneBuilder::noteMedia(Scene& scene) {
    placeNoise(scene.origin);
    limitDenseMedia();
    const auto note = [&](const Medium& medium, Span span, std::string_view what) {
        noteEffect(Effect::media, span, fmt::format("light is scattered in {}", what));
        if (medium.needs().has(Effect::dispersion))
            noteEffect(Effect::dispersion, span, "its extinction varies with wavelength");
        if (medium.emission()) noteEffect(Effect::glow, span, "it gives off light");
    };
    for (const auto& [medium, span] : interiorAskers_) {
        note(*medium, span, "the shapes that this medium fills");
        noteEffect(Effect::subsurface, span, "it fills shapes");
    }
    for (const auto& [medium, span] : openMedia_) {
        note(*medium, span, "this volume");
        scene.openMedia.push_back(medium);
        scene.mediumUses[medium->number].place = MediumUse::Place::space;
    }
    for (const PlacedShape& shape : placedShapes_)
        if (const Medium* medium = shape.material->interior())
            scene.mediumUses[medium->number].place =
                shape.material->isBoundary() ? MediumUse::Place::space : MediumUse::Place::solid;
    for (const PlacedShape& shape : placedShapes_)
        if (shape.material->ior() || shape.material->interior()) scene.filled.push_back(shape.box);
    scene.nested = mayLieInDielectric(true);
    const bool immersed = mayLieInDielectric(false);
    if (scene.nested) noteEffect(Effect::interfaces, {}, "dielectrics touch or may lie in one another");
    if (immersed) noteEffect(Effect::interfaces, {}, "what may lie in a dielectric looks otherwise there");
    scene.boundaries = scene.nested;
    for (const std::uint32_t index : usedMaterials_)
        scene.boundaries |= materials_[index]->isBoundary() || materials_[index]->mayBeOpen();
    embree_.setNested(scene.nested);
    scene.media = std::move(media_);
}

} // namespace abbe
