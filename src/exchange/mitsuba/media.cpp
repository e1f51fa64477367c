#include "exchange/mitsuba/media.h"

#include "exchange/mitsuba/xml_values.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr int kMostNestedPhases = 8; // they may double at every level

// Values at even steps of the cosine from −1 (straight back) to 1.
void writeTabulatedPhase(SceneNode& at, const XmlObject& phase, MitsubaContext& ctx) {
    const XmlParam* const param = phase.find("values");
    const auto values = param ? xmlNumbers(param->text) : std::nullopt;
    if (!values || values->size() < 2) {
        ctx.import.diagnostics.error("E0802", phase.span, "`tabphase` has at least two `values`");
        at.word("isotropic");
        return;
    }
    SceneNode& rows = at.word("table").child("values");
    for (std::size_t i = values->size(); i-- > 0;) {
        const double cosine = -1 + 2 * static_cast<double>(i) / static_cast<double>(values->size() - 1);
        rows.child("-").number(std::acos(std::clamp(cosine, -1.0, 1.0)) / kDegree).number((*values)[i]);
    }
}

bool writeCoefficient(SceneNode& medium, const char* property, const XmlObject& object, std::string_view name,
                      double otherwise, double scale, SpectrumUse use, MitsubaContext& ctx) {
    const XmlParam* const stated = object.find(name);
    const XmlParam* const param = constantOf(stated);
    if (stated && !param) return false;
    if (!param) {
        medium.child(property).number(otherwise * scale);
        return true;
    }
    if (const auto spectrum = readSpectrum(*param, use, ctx))
        writeSpectrum(medium.child(property), scaled(*spectrum, scale), use, param->span, ctx);
    return true;
}

bool writeMedium(SceneNode& medium, const XmlObject& object, MitsubaContext& ctx) {
    const double scale = mitsubaNumber(object, "scale", 1, ctx.import);
    mitsubaIgnore(object, {"sample_emitters", "has_spectral_extinction", "majorant_resolution_factor", "id"});
    if (object.plugin != "homogeneous" && object.plugin != "heterogeneous") {
        ctx.import.leftOut(nullptr, object.span, fmt::format("medium `{}`", object.plugin),
                           "the language has no media of this kind");
        return false;
    }
    medium.word("homogeneous");
    bool constant = true;
    if (object.has("sigma_s") || object.has("sigma_a")) { // of version 0.5
        constant = writeCoefficient(medium, "scattering", object, "sigma_s", 0, scale, SpectrumUse::positive, ctx) &&
                   writeCoefficient(medium, "absorption", object, "sigma_a", 0, scale, SpectrumUse::positive, ctx);
    } else {
        constant = writeCoefficient(medium, "extinction", object, "sigma_t", 1, scale, SpectrumUse::positive, ctx) &&
                   writeCoefficient(medium, "albedo", object, "albedo", 0.75, 1, SpectrumUse::reflectance, ctx);
    }
    if (!constant) {
        ctx.import.leftOut(nullptr, object.span, "a medium of voxels inside a visible surface",
                           "voxels have a place of their own: they fill no shape but one with a `null` surface");
        return false;
    }
    if (const XmlParam* const emission = object.find("emission"); emission)
        if (const XmlParam* const value = constantOf(emission))
            if (const auto spectrum = readSpectrum(*value, SpectrumUse::light, ctx))
                writeSpectrum(medium.child("emission"), *spectrum, SpectrumUse::light, value->span, ctx);
    if (const auto phases = object.objects("phase"); !phases.empty())
        writePhase(medium.child("phase"), *phases[0], 0, ctx);
    return true;
}

} // namespace

void writePhase(SceneNode& at, const XmlObject& phase, int depth, MitsubaContext& ctx) {
    const std::string_view type = phase.plugin;
    if (depth > kMostNestedPhases) {
        ctx.import.diagnostics.error("E0802", phase.span, "too many phase functions inside of each other");
        at.word("isotropic");
        return;
    }
    if (type == "hg")
        at.word("henyey-greenstein").number(std::clamp(mitsubaNumber(phase, "g", 0.8, ctx.import), -0.9999, 0.9999));
    else if (type == "rayleigh" || type == "isotropic")
        at.word(type);
    else if (type == "tabphase")
        writeTabulatedPhase(at, phase, ctx);
    else if (type == "blendphase" && phase.objects("phase").size() == 2) {
        const double weight = std::clamp(mitsubaNumber(phase, "weight", 0.5, ctx.import), 0.0, 1.0);
        const auto parts = phase.objects("phase");
        at.word("mix");
        for (std::size_t i = 0; i < 2; ++i) {
            SceneNode part("part");
            writePhase(part, *parts[i], depth + 1, ctx);
            part.key("weight", std::max(1e-12, i == 0 ? 1 - weight : weight));
            at.adopt(std::move(part));
        }
    } else {
        ctx.import.leftOut(&at, phase.span, fmt::format("phase function `{}`", type),
                           "nothing here is like it; even scattering stands for it");
        at.word("isotropic");
        for (const XmlParam& param : phase.params) param.used = true;
    }
    warnOfUnused(phase, ctx.import);
}

// What a <volume type="constvolume"> or a plain parameter says; nothing for grids.
const XmlParam* constantOf(const XmlParam* param) {
    if (!param || !param->object || param->object->tag != "volume") return param;
    return param->object->plugin == "constvolume" ? param->object->find("value") : nullptr;
}

std::string mediumOf(const XmlObject& object, Span from, MitsubaContext& ctx) {
    if (!ctx.seesMedia) {
        if (ctx.media.emplace(&object, "-").second)
            ctx.import.leftOut(nullptr, from, "a medium",
                               "the integrator of this scene does not see media; `volpath` does");
        return {};
    }
    std::string& name = ctx.media[&object];
    if (name.empty()) {
        name = ctx.mediumNames.take(object.id, "medium");
        SceneNode made("medium");
        made.name(name);
        if (writeMedium(made, object, ctx))
            ctx.import.nodes.push_back(std::move(made));
        else
            name = "-";
        for (const XmlParam& param : object.params)
            if (name == "-") param.used = true;
        warnOfUnused(object, ctx.import);
    }
    return name == "-" ? std::string() : name;
}

ShapeMedia mediaOf(const XmlObject& shape, MitsubaContext& ctx) {
    ShapeMedia media;
    const auto read = [&](std::string_view name) -> const XmlObject* {
        const XmlParam* const param = shape.find(name);
        if (!param || !param->object || param->object->tag != "medium") return nullptr;
        if (ctx.seesMedia) return param->object;
        mediumOf(*param->object, param->span, ctx); // says why it is left out
        return nullptr;
    };
    media.inside = read("interior");
    media.outside = read("exterior");
    return media;
}

bool isAround(const XmlObject* medium, MitsubaContext& ctx) {
    const auto fills = [&](const XmlObject& shape) {
        if (shape.tag != "shape") return false;
        const auto side = [&](std::string_view name) {
            const auto found = std::ranges::find(shape.params, name, &XmlParam::name);
            return found == shape.params.end() ? nullptr : found->object;
        };
        return side("interior") == medium && side("exterior") != medium;
    };
    const auto [known, isNew] = ctx.surrounding.try_emplace(medium, false);
    if (isNew) known->second = medium == ctx.air || std::ranges::any_of(ctx.scene.objects, fills);
    return known->second;
}

void placeMedia(MitsubaContext& ctx) {
    const bool isEverywhere = ctx.air && !ctx.nesting.isHeldAt(ctx.air, ctx.eye);
    if (isEverywhere) ctx.define("atmosphere").name(ctx.media[ctx.air]);
    ctx.nesting.report(isEverywhere ? ctx.air : nullptr, "`exterior`", ctx.import);
}

} // namespace abbe::exchange
