#include "scene/medium_builder.h"

#include "media/atmosphere.h"
#include "media/homogeneous.h"
#include "media/noise_medium.h"
#include "media/noise_types.h"
#include "scene/registry.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

// Of the distance from the camera to the far end of what the medium fills: some forty steps of single precision. Where
// collisions are nearer to the surface than a point on it is known to, light is lost: 2 % of what a medium of albedo
// 0.9 sends back here, a quarter at a twentieth of it, and below that paths do not find out again.
constexpr double kLeastFreePath = 4e-6;

double farthest(const Bounds3& b) {
    const Vec3 far = max(abs(b.lower), abs(b.upper));
    return static_cast<double>(std::max({far.x, far.y, far.z}));
}

std::string lengthText(double metres) {
    if (metres < 1e-6) return fmt::format("{:.2g} nm", metres * 1e9);
    if (metres < 1e-3) return fmt::format("{:.2g} µm", metres * 1e6);
    return fmt::format("{:.2g} mm", metres * 1e3);
}

} // namespace

schema::Reference MediumBuilder::reference(const Definition& d) {
    const auto bindInto = context_.binder(d);
    if (!d.type) {
        bindInto(nullptr);
        return {};
    }
    MadeMedium made = makerOf<MakeMedium>(*d.type)(bindInto, {context_, d, *this});
    return made.medium ? schema::Reference{keep(std::move(made.medium), d)} : schema::Reference{};
}

MadeMedium MediumBuilder::makeVolume(const Definition& d, const Transform& toRender) {
    if (context_.leavesOut({SwitchedEffect::medium, context_.nameOf(d)}, d.span))
        return {}; // before it becomes a light
    const auto bindInto = context_.binder(d);
    if (d.type) return makerOf<MakeMedium>(*d.type)(bindInto, {context_, d, *this, toRender});
    bindInto(nullptr);
    return {};
}

std::uint32_t MediumBuilder::keep(std::unique_ptr<Medium> medium, const Definition& d) {
    if (auto* const noise = dynamic_cast<NoiseMedium*>(medium.get())) noise_.push_back(noise);
    if (auto* const even = dynamic_cast<HomogeneousMedium*>(medium.get())) even_.push_back(even);
    medium->number = static_cast<std::uint16_t>(media_.size());
    context_.built.declared[medium.get()] = d.nameSpan;
    media_.push_back(std::move(medium));
    spans_.push_back(d.span);
    context_.built.scene.mediumUses.push_back({context_.nameOf(d), MediumUse::Place::nowhere});
    return static_cast<std::uint32_t>(media_.size() - 1);
}

std::optional<MediumOptics> MediumBuilder::opticsOf(const MediumParams& params, const Definition& d) {
    if (const auto fault = findContradiction(params); !fault.empty()) {
        context_.diagnostics.error("E0640", d.span, "a medium has extinction and albedo, or scattering and absorption",
                                   std::string(fault));
        return std::nullopt;
    }
    return makeOptics(params, params.phase.valid() ? phases_[params.phase] : nullptr, context_.curves.constant(0),
                      context_.curves.constant(1));
}

void MediumBuilder::noteInterior(const Medium& medium) {
    if (std::ranges::find(interior_, &medium, &std::pair<const Medium*, Span>::first) != interior_.end()) return;
    for (std::size_t i = 0; i < media_.size(); ++i)
        if (media_[i].get() == &medium) interior_.emplace_back(&medium, spans_[i]);
}

void MediumBuilder::notePlaced(const Material& material, const Bounds3& box, bool repeated) {
    if (material.interior() || material.seesOutside()) placed_.push_back({box, &material, repeated});
}

// Whether any shape to which it matters may be in another's dielectric: those that are dielectrics themselves, or all
// others. By their boxes: what is apart for certain need not be followed from one into the other.
bool MediumBuilder::mayLieInDielectric(bool dielectrics) const {
    constexpr std::size_t kManyPairs = 100'000; // not worth the time
    std::vector<const PlacedShape*> outer, inner;
    for (const PlacedShape& shape : placed_) {
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

void MediumBuilder::noteEffects(const Medium& medium, Span span, std::string_view what) {
    context_.noteEffect(Effect::media, span, fmt::format("light is scattered in {}", what));
    if (medium.needs().has(Effect::dispersion))
        context_.noteEffect(Effect::dispersion, span, "its extinction varies with wavelength");
    if (medium.emission()) context_.noteEffect(Effect::glow, span, "it gives off light");
}

void MediumBuilder::noteUses() {
    Scene& scene = context_.built.scene;
    for (const auto& [medium, span] : interior_) {
        noteEffects(*medium, span, "the shapes that this medium fills");
        context_.noteEffect(Effect::subsurface, span, "it fills shapes");
    }
    for (const auto& [medium, span] : open_) {
        noteEffects(*medium, span, "this volume");
        scene.openMedia.push_back(medium);
        scene.mediumUses[medium->number].place = MediumUse::Place::space;
    }
    for (const PlacedShape& shape : placed_)
        if (const Medium* medium = shape.material->interior())
            scene.mediumUses[medium->number].place =
                shape.material->isBoundary() ? MediumUse::Place::space : MediumUse::Place::solid;
    for (const PlacedShape& shape : placed_)
        if (shape.material->ior() || shape.material->interior()) scene.filled.push_back(shape.box);
}

void MediumBuilder::finish(const Bounds3* extent) {
    Scene& scene = context_.built.scene;
    // What fills shapes may be made before it is known where render space has its origin.
    for (NoiseMedium* medium : noise_) medium->setOrigin(scene.origin);
    limitDense(extent);
    noteUses();
    scene.nested = mayLieInDielectric(true);
    const bool immersed = mayLieInDielectric(false);
    if (scene.nested) context_.noteEffect(Effect::interfaces, {}, "dielectrics touch or may lie in one another");
    if (immersed) context_.noteEffect(Effect::interfaces, {}, "what may lie in a dielectric looks otherwise there");
    scene.media = std::move(media_);
}

// Media in which light goes less far between two collisions than positions can be told apart.
// How far light spreads in such a medium nobody can see: it is less than an eightieth of a pixel of a picture 2000
// pixels wide. What a deep medium sends back does not depend on the unit of length, so that another free path gives the
// same picture, but for that spread, and for what shines through sheets that are not many free paths thick.
void MediumBuilder::limitDense(const Bounds3* extent) {
    const double all = extent ? farthest(*extent) : 0;
    for (HomogeneousMedium* medium : even_) {
        double far = 0;
        for (const PlacedShape& shape : placed_) // planes and objects are as large as the scene
            if (shape.material->interior() == medium) far = std::max(far, std::min(farthest(shape.box), all));
        const double least = kLeastFreePath * far, densest = medium->extinction().maximum();
        if (!(least * densest > 1)) continue;
        const Span span = spanOf(*medium);
        if (medium->emission()) {
            context_.diagnostics
                .error("E0651", span,
                       fmt::format("light goes {} in this medium, which shines", lengthText(1 / densest)), "too dense")
                .help =
                fmt::format("at its distance from the camera positions are told apart to {}: let it be thinner, "
                            "or make the shape a light with a surface",
                            lengthText(least));
            continue;
        }
        context_.diagnostics
            .warning("W0697", span,
                     fmt::format("light goes {} between collisions, which is less than positions here can tell; it is "
                                 "taken to go {}",
                                 lengthText(1 / densest), lengthText(least)),
                     "what is thicker than that looks the same")
            .help = "if this was meant to be seen, its unit is wrong: `mean-free-path 1 mm`; if not, `material "
                    "diffuse` is the same and faster";
        medium->limitExtinction(1 / least);
    }
}

MadeMedium makeHomogeneous(const HomogeneousParams& params, const MediumContext& context) {
    const auto optics = context.media.opticsOf(params, context.definition);
    if (!optics) return {};
    const bool hot = params.temperature > 0;
    if (const auto fault = findContradiction(params, *optics, hot); !fault.empty()) {
        context.scene.diagnostics.error("E0647", context.definition.span, "this medium cannot shine so",
                                        std::string(fault));
        return {};
    }
    return {std::make_unique<HomogeneousMedium>(*optics, makeGlow(params, *optics, hot), params.temperature)};
}

MadeMedium makeAtmosphere(const AtmosphereParams& params, const MediumContext& context) {
    const auto optics = context.media.opticsOf(params, context.definition);
    if (!optics) return {};
    const Vec3d up = context.scene.up();
    const double ground = dot(context.toRender.point(up * params.ground), up);
    return {std::make_unique<Atmosphere>(*optics, Vec3(up), ground, params.scaleHeight)};
}

MadeMedium makeNoiseVolume(const NoiseVolumeParams& params, const MediumContext& context) {
    Diagnostics& diagnostics = context.scene.diagnostics;
    const Span span = context.definition.span;
    const auto optics = context.media.opticsOf(params, context.definition);
    const auto box = boxOf(params, context.scene.tree.header.zUp);
    const Transform place = params.transform.then(context.toRender);
    if (const auto* fault = std::get_if<std::string_view>(&box))
        diagnostics.error("E0614", span, std::string(*fault)).help =
            "`size 1 2 1` with `center`, or `min 0 0 0; max 1 2 1`";
    if (!place.inverse())
        diagnostics.error("E0641", span, "the transform of this volume flattens it", "has no inverse");
    if (!optics || !place.inverse() || !std::holds_alternative<NoiseBox>(box)) return {};
    return {std::make_unique<NoiseVolume>(*optics, patternOf(params), std::get<NoiseBox>(box), place)};
}

MadeMedium makeNoiseMedium(const NoiseMediumParams& params, const MediumContext& context) {
    const auto optics = context.media.opticsOf(params, context.definition);
    if (!params.transform.inverse())
        context.scene.diagnostics.error("E0641", context.definition.span, "the transform of this medium flattens it",
                                        "has no inverse");
    if (!optics || !params.transform.inverse()) return {};
    return {std::make_unique<NoiseMedium>(*optics, patternOf(params), params.transform)};
}

} // namespace abbe
