#include "scene/build_context.h"

#include "schema/suggest.h"
#include "spectrum/curve.h"
#include "spectrum/dispersion.h"
#include "spectrum/emission_curves.h"
#include "spectrum/named_spectra.h"
#include "spectrum/rgb_upsampling.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

BindParams BuildContext::binder(const Definition& definition, Diagnostics& found) {
    return [this, &definition, &found](void* params) {
        return schema::bind(definition, tree, types, resolver_, params, found);
    };
}

const std::string& BuildContext::nameOf(const Definition& d) {
    if (!d.name.empty()) return d.name;
    // Inline definitions have no lasting address.
    std::string& name = givenNames_[{static_cast<std::uint32_t>(d.span.file), d.span.begin}];
    if (name.empty()) {
        const auto type = std::string(d.type ? d.type->name : schema::keyword(d.kind));
        name = fmt::format("{}-{}", type, ++nameless_[type]);
    }
    return name;
}

const schema::Definition* BuildContext::only(schema::Kind kind, std::string_view name) {
    const Definition* first = nullptr;
    for (const Definition& d : tree.definitions) {
        if (d.kind != kind) continue;
        if (!name.empty() && d.name == name) return &d;
        if (name.empty() && !first)
            first = &d;
        else if (name.empty() && kind != schema::Kind::camera) {
            Diagnostic& e = diagnostics.error("E0608", d.nameSpan,
                                              fmt::format("a scene has one `{}`", schema::keyword(kind)), "second one");
            e.related.push_back({first->nameSpan, "the first one is here"});
            e.help =
                fmt::format("to change the first one in a layer, write `override {} {{ … }}`", schema::keyword(kind));
        }
    }
    return first;
}

// What other buildings made.

namespace {

// The counters of what is made and of what is taken over.
std::pair<std::size_t&, std::size_t&> countersOf(Reused kind, ReuseCounters& c) {
    switch (kind) {
    case Reused::shape:
        return {c.shapesLoaded, c.shapesKept};
    case Reused::place:
        return {c.placesMade, c.placesKept};
    case Reused::texture:
        return {c.texturesRead, c.texturesKept};
    case Reused::volume:
        return {c.volumesRead, c.volumesKept};
    case Reused::table:
        break;
    }
    return {c.tablesMade, c.tablesKept};
}

constexpr std::size_t kNowhere = ~std::size_t{0};

// Which of the spans each of a diagnostic is; nothing if one is none of them.
std::optional<std::vector<std::size_t>> placesOf(const Diagnostic& d, std::span<const Span> spans) {
    std::vector<std::size_t> places;
    const auto add = [&](Span span) {
        const auto found = std::ranges::find(spans, span);
        places.push_back(span.valid() ? static_cast<std::size_t>(found - spans.begin()) : kNowhere);
        return !span.valid() || found != spans.end();
    };
    bool known = add(d.span) && d.fixes.empty();
    for (const Label& label : d.related) known = known && add(label.span);
    return known ? std::optional(std::move(places)) : std::nullopt;
}

} // namespace

BuildContext::Making BuildContext::takeOver(Reused kind, const Digest& key, const Digest& view,
                                            std::span<const Span> spans) {
    Making now{nullptr, diagnostics.all().size(), diagnostics.errorCount() + diagnostics.warningCount(),
               built.facts.files.size()};
    const SceneReuse::Kept* const kept = reuse->find(key, view);
    if (!kept) return now;
    ++countersOf(kind, reuse->count()).second;
    now.kept = kept->thing;
    for (std::size_t i = 0; i < kept->warnings.size(); ++i) {
        Diagnostic d = kept->warnings[i];
        const auto spanOf = [&](std::size_t place) { return place == kNowhere ? Span{} : spans[place]; };
        d.span = spanOf(kept->warnedAt[i][0]);
        for (std::size_t k = 0; k < d.related.size(); ++k) d.related[k].span = spanOf(kept->warnedAt[i][k + 1]);
        diagnostics.add(std::move(d));
    }
    built.facts.files.insert(built.facts.files.end(), kept->files.begin(), kept->files.end());
    return now;
}

// What was warned of at a place that the next building cannot find is made again.
void BuildContext::leave(Reused kind, const Digest& key, const Digest& view, std::span<const Span> spans,
                         const Making& start, std::shared_ptr<const void> made) {
    ++countersOf(kind, reuse->count()).first;
    const auto& all = diagnostics.all();
    const std::size_t counted = diagnostics.errorCount() + diagnostics.warningCount() - start.counted;
    if (!made || counted != all.size() - start.diagnostics) return; // some are not listed
    SceneReuse::Kept kept;
    kept.thing = std::move(made);
    kept.view = view;
    for (std::size_t i = start.diagnostics; i < all.size(); ++i) {
        auto places = placesOf(all[i], spans);
        if (!places || all[i].severity == Severity::error) return;
        kept.warnings.push_back(all[i]);
        kept.warnedAt.push_back(std::move(*places));
    }
    kept.files.assign(built.facts.files.begin() + static_cast<std::ptrdiff_t>(start.files), built.facts.files.end());
    reuse->keep(key, std::move(kept));
}

// What a scene needs simulated, who asked for it, and what the scene forbids.

namespace {

// Physics that no scene can ask for yet: forbidding it holds, and says so to who reads the scene.
constexpr std::string_view kNeverSimulated[] = {"fluorescence", "polarization", "diffraction"};

const EffectInfo* findEffect(std::string_view word) {
    const auto found = std::ranges::find(kEffectTable, word, &EffectInfo::word);
    return found == kEffectTable.end() ? nullptr : &*found;
}

void unknownEffect(const schema::TableCell& cell, Diagnostics& diagnostics) {
    std::vector<std::string_view> words(std::begin(kNeverSimulated), std::end(kNeverSimulated));
    for (const EffectInfo& info : kEffectTable) words.push_back(info.word);
    const std::string_view near = schema::nearest(cell.text, words);
    diagnostics.error("E0683", cell.span, fmt::format("no effect is called `{}`", cell.text), "in `forbid`").help =
        near.empty() ? fmt::format("effects are {}", fmt::join(words, ", ")) : schema::didYouMean(near);
}

} // namespace

std::string_view wordOf(SwitchedEffect effect) {
    constexpr std::string_view words[] = {"dispersion", "absorption",   "motion",    "depth-of-field",
                                          "bumps",      "displacement", "thin-film", "volume"};
    return words[static_cast<std::size_t>(effect)];
}

bool BuildContext::leavesOut(EffectSwitch effect, Span where) {
    auto& users = built.effectUsers;
    if (std::ranges::find(users, effect, &EffectUser::effect) == users.end()) users.push_back({effect, where});
    return effect.effect == SwitchedEffect::medium ? options.without.leavesOutMedium(effect.medium)
                                                   : options.without.leavesOut(effect.effect);
}

void BuildContext::noteEffect(Effect effect, Span where, std::string_view why) {
    built.scene.effects |= effect;
    if (effect == Effect::motion) leavesOut({SwitchedEffect::motion}, where); // noted here, whatever moves
    auto& reasons = built.scene.reasons;
    const bool known = std::ranges::any_of(
        reasons, [&](const EffectReason& r) { return r.effect == effect && r.place == where && r.why == why; });
    if (!known) reasons.push_back({effect, where, std::string(why)});
}

// Where this build lacks an effect, as those that measure what it costs do.
void BuildContext::checkCompiled() {
    for (const EffectReason& reason : built.scene.reasons) {
        if (!kLoopEffects.has(reason.effect) || isCompiled(reason.effect)) continue;
        diagnostics
            .error("E0685", reason.place, fmt::format("this build has no {}", infoOf(reason.effect).title), reason.why)
            .help = "build without the CMake option ABBE_WITHOUT";
    }
}

// At the line that needs what is forbidden: there it can be mended.
void BuildContext::checkForbidden() {
    for (const schema::TableRow& row : built.render.forbid.rows) {
        const EffectInfo* const info = findEffect(row.cells[0].text);
        if (!info && std::ranges::find(kNeverSimulated, row.cells[0].text) == std::end(kNeverSimulated)) {
            unknownEffect(row.cells[0], diagnostics);
        } else if (row.cells.size() > 1) {
            diagnostics.error("E0309", row.cells[1].span, "a row of `forbid` is one word", "is one too many").help =
                fmt::format("for example `forbid {{ {}; motion }}`", row.cells[0].text);
        }
        if (!info) continue;
        for (const EffectReason& reason : built.scene.reasons) {
            if (reason.effect != info->effect) continue;
            Diagnostic& d = diagnostics.error("E0684", reason.place.valid() ? reason.place : row.span,
                                              fmt::format("this scene forbids {}", info->title), reason.why);
            if (reason.place.valid()) d.related.push_back({row.span, "forbidden here"});
            d.help = fmt::format("leave it out, or take `{}` out of `forbid`", info->word);
        }
    }
}

using schema::SpectrumRole;
using schema::SpectrumValue;
using Form = SpectrumValue::Form;

namespace {

bool isLight(SpectrumRole role) {
    return role == SpectrumRole::emission || role == SpectrumRole::shape || role == SpectrumRole::tint;
}

std::string_view purpose(SpectrumRole role) {
    switch (role) {
    case SpectrumRole::albedo:
        return "a reflectance";
    case SpectrumRole::unbounded:
        return "a coefficient";
    case SpectrumRole::emission:
        return "emitted light";
    case SpectrumRole::index:
        return "a refractive index";
    case SpectrumRole::shape:
    case SpectrumRole::tint:
        return "the colour of light";
    }
    return "";
}

void unknownName(std::string_view what, std::string_view name, Span span, const std::vector<std::string_view>& known,
                 Diagnostics& diagnostics) {
    Diagnostic& d = diagnostics.error("E0211", span, fmt::format("no {} is named `{}`", what, name), "unknown name");
    if (const auto near = schema::nearest(name, known); !near.empty())
        d.help = fmt::format("did you mean `{}`?", near);
    else
        d.notes.push_back(fmt::format("known names: {}", fmt::join(known, " ")));
}

void wrongUse(const SpectrumValue& value, std::string_view what, SpectrumRole role, Diagnostics& diagnostics) {
    diagnostics.error("E0330", value.span, fmt::format("{} cannot serve as {}", what, purpose(role)),
                      "wrong kind of spectrum");
}

// Sellmeier's six numbers are B1 C1 B2 C2 B3 C3.
std::unique_ptr<const Curve> sellmeier(const std::vector<double>& v) {
    std::vector<double> strengths, resonances;
    for (std::size_t i = 0; i + 1 < v.size(); i += 2) {
        strengths.push_back(v[i]);
        resonances.push_back(v[i + 1]);
    }
    return std::make_unique<SellmeierCurve>(0, strengths, resonances);
}

std::unique_ptr<const Curve> cauchy(const std::vector<double>& v) {
    const auto term = [&](std::size_t i) { return i < v.size() ? v[i] : 0.0; };
    if (v.size() <= 3) return std::make_unique<CauchyCurve>(term(0), term(1), term(2));
    return std::make_unique<SampledCurve>([&](double nm) {
        const double s = 1e6 / (nm * nm);
        return term(0) + s * (term(1) + s * (term(2) + s * term(3)));
    });
}

} // namespace

const Curve* CurveLibrary::keep(std::unique_ptr<const Curve> curve) {
    return curves_.emplace_back(std::move(curve)).get();
}

const Curve* CurveLibrary::constant(double value) { return keep(std::make_unique<ConstantCurve>(value)); }

const Curve* CurveLibrary::daylight() {
    if (!daylight_) daylight_ = keep(illuminantCurve(*findIlluminant("D65")));
    return daylight_;
}

const Curve* CurveLibrary::white(const RgbSpace& space) { return keep(emissionFromRgb({1, 1, 1}, space).curve); }

const Curve* CurveLibrary::rgb(const SpectrumValue& value, SpectrumRole role, Diagnostics& diagnostics) {
    if (role == SpectrumRole::index) return wrongUse(value, "an RGB colour", role, diagnostics), nullptr;
    const Vec3d colour{value.numbers[0], value.numbers[1], value.numbers[2]};
    const RgbSpace& space = rgbSpace(value.space);
    UpsampledCurve fit = role == SpectrumRole::albedo      ? reflectanceFromRgb(colour, space)
                         : role == SpectrumRole::unbounded ? unboundedFromRgb(colour, space)
                                                           : emissionFromRgb(colour, space);
    if (fit.deltaE > 1)
        diagnostics
            .warning("W0331", value.span,
                     fmt::format("no smooth spectrum has this colour; the nearest is ΔE {:.1f} away", fit.deltaE),
                     "outside what reflectances can reach")
            .notes.push_back("give a measured `table` for a colour this saturated");
    return keep(std::move(fit.curve));
}

const Curve* CurveLibrary::table(const SpectrumValue& value, SpectrumRole role) {
    std::vector<double> nm, values;
    for (std::size_t i = 0; i + 1 < value.numbers.size(); i += 2) {
        nm.push_back(value.numbers[i]);
        values.push_back(value.numbers[i + 1]);
    }
    return keep(std::make_unique<SampledCurve>(isLight(role) ? SampledCurve::fromEmissionPoints(nm, values)
                                                             : SampledCurve::fromPoints(nm, values)));
}

const Curve* CurveLibrary::named(const SpectrumValue& value, SpectrumRole role, Diagnostics& diagnostics) {
    if (value.form == Form::illuminant) {
        if (!isLight(role)) return wrongUse(value, "an illuminant", role, diagnostics), nullptr;
        if (const auto found = findIlluminant(value.text)) return keep(illuminantCurve(*found));
        return unknownName("illuminant", value.text, value.span, illuminantNames(), diagnostics), nullptr;
    }
    if (value.form == Form::measured) {
        if (role == SpectrumRole::index) return wrongUse(value, "a measured reflectance", role, diagnostics), nullptr;
        if (const auto found = findMeasured(value.text)) return keep(reflectanceCurve(*found));
        return unknownName("measured spectrum", value.text, value.span, measuredNames(), diagnostics), nullptr;
    }
    if (value.form == Form::glass) {
        const auto found = findGlass(value.text);
        if (!found) return unknownName("glass", value.text, value.span, glassNames(), diagnostics), nullptr;
        if (role == SpectrumRole::index) return keep(indexCurve(*found));
        if (role != SpectrumRole::unbounded) return wrongUse(value, "a glass", role, diagnostics), nullptr;
        if (found->k.empty())
            diagnostics.warning("W0332", value.span,
                                fmt::format("no absorption is tabulated for `{}`; it is clear", found->name));
        return keep(absorptionCurve(*found));
    }
    const auto found = findMetal(value.text);
    if (!found) return unknownName("metal", value.text, value.span, metalNames(), diagnostics), nullptr;
    if (role != SpectrumRole::index) return wrongUse(value, "a metal", role, diagnostics), nullptr;
    return keep(indexCurve(*found));
}

// Numbers and reflectances are factors of D65, as `rgb` is; spectra of light have a brightness of their own, which does
// not count.
const Curve* CurveLibrary::tint(const SpectrumValue& value, Diagnostics& diagnostics) {
    const Curve* const light = curve(value, SpectrumRole::shape, diagnostics);
    if (!light || value.form == Form::rgb) return light;
    if (value.form == Form::flat || value.form == Form::measured)
        return keep(std::make_unique<SampledCurve>([&](double nm) { return light->at(nm) * daylight()->at(nm); }));
    const double y = integrate(*light).y;
    if (y > 0) return keep(std::make_unique<SampledCurve>([&](double nm) { return light->at(nm) / y; }));
    diagnostics.error("E0343", value.span, "this colour has no light that is seen", "luminance cannot be given to it")
        .help = "black is `rgb 0 0 0`";
    return nullptr;
}

const Curve* CurveLibrary::curve(const SpectrumValue& value, SpectrumRole role, Diagnostics& diagnostics) {
    if (role == SpectrumRole::tint) return tint(value, diagnostics);
    const auto usable = [&](std::unique_ptr<const Curve> c) -> const Curve* {
        if (role != SpectrumRole::index || usableIndex(*c)) return keep(std::move(c));
        diagnostics
            .error("E0331", value.span, "this refractive index leaves (0.2, 10) within 360 to 830 nm",
                   "not a usable index")
            .notes.push_back("coefficients take wavelengths in µm");
        return nullptr;
    };
    switch (value.form) {
    case Form::flat:
        return usable(std::make_unique<ConstantCurve>(value.numbers[0]));
    case Form::rgb:
        return rgb(value, role, diagnostics);
    case Form::table:
        return table(value, role);
    case Form::blackbody:
        if (!isLight(role)) return wrongUse(value, "a black body", role, diagnostics), nullptr;
        return keep(blackbodyCurve(value.numbers[0]));
    case Form::line:
        if (!isLight(role)) return wrongUse(value, "a spectral line", role, diagnostics), nullptr;
        return keep(lineCurve(value.numbers[0]));
    case Form::sellmeier:
        if (role != SpectrumRole::index) return wrongUse(value, "a dispersion formula", role, diagnostics), nullptr;
        return usable(sellmeier(value.numbers));
    case Form::cauchy:
        if (role != SpectrumRole::index) return wrongUse(value, "a dispersion formula", role, diagnostics), nullptr;
        return usable(cauchy(value.numbers));
    case Form::illuminant:
    case Form::measured:
    case Form::glass:
    case Form::metal:
        return named(value, role, diagnostics);
    }
    return nullptr;
}

schema::ComplexIndex CurveLibrary::metal(std::string_view name, Span span, Diagnostics& diagnostics) {
    const auto found = findMetal(name);
    if (!found) {
        unknownName("metal", name, span, metalNames(), diagnostics);
        return {};
    }
    return {keep(indexCurve(*found)), keep(extinctionCurve(*found))};
}

} // namespace abbe
