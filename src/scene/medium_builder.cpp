#include "scene/medium_builder.h"

#include "lights/light_context.h"
#include "math/vec.h"
#include "media/atmosphere.h"
#include "media/homogeneous.h"
#include "media/mie_phase.h"
#include "media/noise_media.h"
#include "media/phase_functions.h"
#include "media/phase_types.h"
#include "scene/registry.h"
#include "schema/files.h"
#include "transport/surroundings.h"

#include <algorithm>
#include <cmath>
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
    const auto touch = [](const PlacedShape* a, const PlacedShape* b) {
        return a == b ? a->repeated : a->box.overlaps(b->box);
    };
    for (const PlacedShape* a : outer)
        if (std::ranges::any_of(inner, [&](const PlacedShape* b) { return touch(a, b); })) return true;
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
        scene.mediumUses[medium->number].lit = false; // unless one of what follows lets light in
        noteEffects(*medium, span, "the shapes that this medium fills");
        context_.noteEffect(Effect::subsurface, span, "it fills shapes");
    }
    for (const auto& [medium, span] : open_) {
        noteEffects(*medium, span, "this volume");
        scene.openMedia.push_back(medium);
        scene.mediumUses[medium->number].place = MediumUse::Place::space;
        scene.mediumUses[medium->number].lit = true;
    }
    for (const PlacedShape& shape : placed_)
        if (const Medium* medium = shape.material->interior()) {
            MediumUse& use = scene.mediumUses[medium->number];
            use.place = shape.material->isBoundary() ? MediumUse::Place::space : MediumUse::Place::solid;
            use.lit |= shape.material->isBoundary() || shape.material->mayBeOpen();
        }
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

// Looks at the middles and corners of some of the parts of each. A light that is missed is found by scattering alone.
void noteLightsInside(Scene& scene) {
    constexpr std::uint32_t kMost = 16; // parts of a light
    constexpr std::size_t kMany = 4096; // lights that are not worth the time: then any may be anywhere
    const auto look = [&](Vec3 p) {
        const MediumStack media = surroundingsAt(scene, p, 0).media();
        for (int i = 0; i < media.size(); ++i) scene.mediumUses[media[i]->number].lit = true;
    };
    if (std::ranges::all_of(scene.mediumUses, &MediumUse::lit)) return;
    if (scene.lights.size() > kMany) {
        for (MediumUse& use : scene.mediumUses) use.lit = true;
        return;
    }
    for (const auto& light : scene.lights) {
        const std::uint32_t step = std::max(1u, light->parts() / kMost);
        for (std::uint32_t part = 0; part < light->parts(); part += step) {
            const auto bounds = light->bounds(part);
            if (!bounds || bounds->box.empty()) continue;
            const Vec3 a = bounds->box.lower, b = bounds->box.upper;
            look((a + b) * 0.5f);
            for (unsigned corner = 0; corner < 8; ++corner)
                look({corner & 1 ? a.x : b.x, corner & 2 ? a.y : b.y, corner & 4 ? a.z : b.z});
        }
    }
}

// Media in which light goes less far between two collisions than positions can be told apart.
// How far light spreads in such a medium nobody can see: it is less than an eightieth of a pixel of a picture 2000
// pixels wide. What a deep medium sends back does not depend on the unit of length, so that another free path gives the
// same picture, but for that spread, and for light that comes through sheets that are not many free paths thick.
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
                       fmt::format("the mean free path in this medium, which emits, is {}", lengthText(1 / densest)),
                       "too dense")
                .help = fmt::format("at its distance from the camera positions resolve {}: make it thinner, "
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
        context.scene.diagnostics.error("E0647", context.definition.span, "this medium cannot emit like this",
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
    return {std::make_unique<NoiseVolume>(*optics, patternOf(params), std::get<NoiseBox>(box), place,
                                          context.scene.tables())};
}

MadeMedium makeNoiseMedium(const NoiseMediumParams& params, const MediumContext& context) {
    const auto optics = context.media.opticsOf(params, context.definition);
    if (!params.transform.inverse())
        context.scene.diagnostics.error("E0641", context.definition.span, "the transform of this medium flattens it",
                                        "has no inverse");
    if (!optics || !params.transform.inverse()) return {};
    return {std::make_unique<NoiseMedium>(*optics, patternOf(params), params.transform)};
}

namespace {

// Angles in degrees and values with where each pair was written.
struct PhaseTable {
    std::vector<double> angles, values;
    std::vector<Span> spans;
    std::vector<int> lines; // of a file
    std::string file;
};

void fault(Diagnostics& diagnostics, const PhaseTable& table, std::size_t row, std::string message, std::string label) {
    auto& d = diagnostics.error("E0648", table.spans[row], std::move(message), std::move(label));
    if (!table.lines.empty()) d.notes.push_back(fmt::format("line {} of {}", table.lines[row], table.file));
}

bool readRows(const schema::TableRows& rows, PhaseTable& table, Diagnostics& diagnostics) {
    for (const schema::TableRow& row : rows.rows) {
        if (row.cells.size() != 2 || !row.cells[0].number || !row.cells[1].number) {
            diagnostics.error("E0648", row.span, "a row is `- angle value`", "not two numbers");
            return false;
        }
        table.angles.push_back(*row.cells[0].number);
        table.values.push_back(*row.cells[1].number);
        table.spans.push_back(row.span);
    }
    return true;
}

bool readFile(const schema::Text& file, PhaseTable& table, Diagnostics& diagnostics) {
    const schema::SpectrumFile read = schema::readSpectrumFile(file.value, "angle");
    table.file = file.value;
    if (!read.error.empty()) {
        auto& d = diagnostics.error("E0402", file.span, fmt::format("`{}` cannot be read as a table", file.value),
                                    read.error);
        if (read.errorLine > 0) d.notes.push_back(fmt::format("line {} of {}", read.errorLine, file.value));
        return false;
    }
    for (std::size_t i = 0; i < read.lines.size(); ++i) {
        table.angles.push_back(read.numbers[2 * i]);
        table.values.push_back(read.numbers[2 * i + 1]);
        table.spans.push_back(file.span);
    }
    table.lines = read.lines;
    return true;
}

bool check(const PhaseTable& table, Diagnostics& diagnostics) {
    const std::size_t n = table.angles.size();
    for (std::size_t i = 0; i < n; ++i) {
        const double angle = table.angles[i], value = table.values[i];
        std::string message;
        if (!(angle >= 0 && angle <= 180))
            message = "an angle of scattering lies between 0 and 180 degrees";
        else if (i > 0 && !(angle > table.angles[i - 1]))
            message = "the angles must increase";
        if (!message.empty()) return fault(diagnostics, table, i, message, fmt::format("is {:g}", angle)), false;
        if (!(value >= 0 && std::isfinite(value)))
            return fault(diagnostics, table, i, "a value is finite and at least 0", fmt::format("is {:g}", value)),
                   false;
    }
    if (table.angles[0] != 0)
        return fault(diagnostics, table, 0, "the angles go from 0 to 180 degrees",
                     fmt::format("begins at {:g}", table.angles[0])),
               false;
    if (table.angles[n - 1] != 180)
        return fault(diagnostics, table, n - 1, "the angles go from 0 to 180 degrees",
                     fmt::format("ends at {:g}", table.angles[n - 1])),
               false;
    if (std::ranges::max(table.values) > 0) return true;
    return fault(diagnostics, table, 0, "all values are 0", "nothing would be scattered"), false;
}

} // namespace

// Parts are made on the way, so that meeting a phase function that is open is a cycle. One that is inline cannot be met
// again.
schema::Reference PhaseBuilder::reference(const schema::Definition& d) {
    const auto bindInto = context_.binder(d);
    if (std::ranges::find(open_, &d) != open_.end()) {
        if (d.type) // else an error has been reported
            context_.diagnostics.error("E0649", d.nameSpan, fmt::format("phase `{}` contains itself", d.name),
                                       "a part of itself");
        return {};
    }
    open_.push_back(&d);
    if (!d.type) {
        bindInto(nullptr);
        open_.pop_back();
        return {};
    }
    auto phase = makerOf<MakePhase>(*d.type)(bindInto, {context_, d, phases_});
    open_.pop_back();
    if (!phase) return {};
    phases_.push_back(std::move(phase));
    return {static_cast<std::uint32_t>(phases_.size() - 1)};
}

std::shared_ptr<const PhaseFunction> makeKeptMiePhase(const MiePhaseParams& params, const PhaseContext& context) {
    DigestWriter key("mie");
    key.number(params.radius), key.number(params.spread);
    for (const Curve* curve : {params.index, params.absorption, params.surroundings}) {
        key.number(curve != nullptr);
        for (std::size_t i = 0; curve && i < MiePhase::kWavelengths; ++i)
            key.number(curve->at(MiePhase::wavelength(i) * 1e9));
        if (curve) addCurve(key, *curve);
    }
    return KeptTables::get<PhaseFunction>(context.scene.tables(), key.digest(), [&] { return makeMiePhase(params); });
}

std::shared_ptr<const PhaseFunction> makeTablePhase(const TablePhaseParams& params, const PhaseContext& context) {
    Diagnostics& diagnostics = context.scene.diagnostics;
    PhaseTable table;
    const bool read = params.file.value.empty() ? readRows(params.values, table, diagnostics)
                                                : readFile(params.file, table, diagnostics);
    if (!read || !check(table, diagnostics)) return nullptr;
    if (!params.file.value.empty()) context.scene.noteFile(params.file.value);
    for (double& angle : table.angles) angle *= kPiD / 180;
    const double largest = std::ranges::max(table.values); // so that no sum overflows
    for (double& value : table.values) value /= largest;
    return std::make_shared<TabulatedPhase>(table.angles, table.values);
}

std::shared_ptr<const PhaseFunction> makeMixPhase(const MixPhaseParams& params, const PhaseContext& context) {
    std::vector<MixedPhase::Part> parts;
    double total = 0;
    for (const schema::WeightedReference& part : params.parts) {
        parts.push_back({context.made[part.reference.index], part.weight});
        total += part.weight;
    }
    if (total > 0 && std::isfinite(total)) return std::make_shared<MixedPhase>(std::move(parts));
    context.scene.diagnostics.error("E0649", context.definition.span, "a mix needs a part with a weight above 0",
                                    total > 0 ? "their sum is too large" : "all weights are 0");
    return nullptr;
}

} // namespace abbe
