#include "exchange/pbrt/pbrt_materials.h"

#include "exchange/pbrt/pbrt_media.h"
#include "schema/suggest.h"
#include "spectrum/named_spectra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <span>
#include <utility>

namespace abbe::exchange {

struct PbrtMaterials::Making {
    const std::string& type;
    const PbrtParams& params;
    PbrtMaterial& material;

    SceneNode& node() { return material.node; }
};

namespace {

// The types of pbrt-v3 that v4 does not have.
constexpr std::array<std::string_view, 11> kPbrtOldMaterials = {"matte",        "plastic", "metal",       "glass",
                                                                "mirror",       "uber",    "translucent", "substrate",
                                                                "kdsubsurface", "fourier", "disney"};

// α of GGX is √roughness where `remaproughness` is true, else roughness itself [Pharr2023, sec. 9.6]; ours is √α.
double pbrtOurRoughness(double roughness, bool remap) {
    return std::clamp(std::pow(std::max(roughness, 0.0), remap ? 0.25 : 0.5), 0.0, 1.0);
}

std::vector<Vec2d> pbrtRoughnessStops(bool remap) {
    std::vector<Vec2d> stops{{0, 0}};
    for (const double ours : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0})
        stops.push_back({remap ? std::pow(ours, 4) : ours * ours, ours});
    return stops;
}

} // namespace

void PbrtMaterials::spectrum(Making& m, SceneNode& parent, std::string_view property, std::string_view param,
                             double absent) {
    textures_.writeSpectrum(parent.child(std::string(property)), m.params, param, PbrtSpectrum::flat(absent),
                            m.material.uvs);
}

void PbrtMaterials::roughness(Making& m, SceneNode& parent, std::string_view prefix, bool canStretch, double absent) {
    Diagnostics& faults = shared_.faults();
    const bool remap = m.params.flag("remaproughness", true, faults);
    const auto name = [&](std::string_view which) { return fmt::format("{}{}", prefix, which); };
    const std::string both = name("roughness"), u = name("uroughness"), v = name("vroughness");
    for (const std::string& which : {both, u})
        if (const PbrtTexture* texture = textures_.named(m.params, which, false)) {
            m.params.find(v);
            if (m.params.has(u) && m.params.texture(v) != m.params.texture(u))
                shared_.out.approximated(&m.node(), m.params.spanOf(u), "a roughness by direction",
                                         "that along u counts for all directions");
            PbrtTextures::addUvs(m.material.uvs, texture->uvs);
            if (texture->isPlain)
                parent.child("roughness").number(pbrtOurRoughness(texture->plain.value, remap));
            else
                textures_.writeMapped(parent.child("roughness"), *texture, pbrtRoughnessStops(remap));
            return;
        }
    const double even = m.params.number(both, absent, faults);
    const double alongU = m.params.number(u, even, faults), alongV = m.params.number(v, even, faults);
    if (alongU == alongV) {
        if (alongU > 0) parent.child("roughness").number(pbrtOurRoughness(alongU, remap));
        return;
    }
    const auto alpha = [&](double r) { return square(pbrtOurRoughness(r, remap)); };
    const double au = alpha(alongU), av = alpha(alongV), mean = std::sqrt((au * au + av * av) / 2);
    parent.child("roughness").number(std::sqrt(mean));
    if (canStretch && av < au) {
        parent.child("anisotropy").number(1 - av / au);
        m.material.isStretched = true;
    } else {
        shared_.out.approximated(&m.node(), m.params.spanOf(u), "a roughness by direction",
                                 canStretch ? "highlights stretch along u only, so the mean counts for all directions"
                                            : "the mean counts for all directions");
    }
}

void PbrtMaterials::refractiveIndex(Making& m, SceneNode& parent, std::string_view name, double absent) {
    const PbrtParam* param = m.params.find(name);
    const auto index = param ? pbrtSpectrum(*param, PbrtUse::index, shared_) : std::nullopt;
    if (!index && absent == 1.5) return; // our default, too
    (index ? *index : PbrtSpectrum::flat(absent)).write(parent.child("ior"), PbrtUse::index);
}

void PbrtMaterials::diffuse(Making& m) {
    m.node().word("diffuse");
    spectrum(m, m.node(), "reflectance", "reflectance", 0.5);
}

void PbrtMaterials::thinDielectric(Making& m) {
    m.node().word("thin-dielectric");
    refractiveIndex(m, m.node(), "eta", 1.5);
    for (const char* ignored : {"roughness", "uroughness", "vroughness", "remaproughness"}) m.params.find(ignored);
}

void PbrtMaterials::dielectric(Making& m) {
    m.node().word("dielectric");
    m.material.lightEnters = true;
    refractiveIndex(m, m.node(), "eta", 1.5);
    roughness(m, m.node(), "", false);
}

// The complex index of a conductor over that of what lies on it.
void PbrtMaterials::metalIndex(Making& m, SceneNode& index, std::string_view prefix, double relativeTo) {
    const std::string etaName = fmt::format("{}eta", prefix), kName = fmt::format("{}k", prefix);
    const PbrtParam *etaParam = m.params.find(etaName), *kParam = m.params.find(kName);
    const PbrtParam* reflectance = m.params.find("reflectance");
    if (reflectance && (etaParam || kParam))
        shared_.faults().error("E0802", reflectance->span, "a conductor has either `reflectance` or `eta` and `k`");
    auto eta = etaParam ? pbrtSpectrum(*etaParam, PbrtUse::index, shared_) : pbrtNamedSpectrum("metal-Cu-eta");
    auto k = kParam ? pbrtSpectrum(*kParam, PbrtUse::index, shared_) : pbrtNamedSpectrum("metal-Cu-k");
    if (!eta || !k) return void(index.word("metal").word("Cu"));
    if (reflectance && !etaParam && !kParam) {
        // n = 1 and k = 2 √r / √(1 - r), which reflects r at normal incidence [Pharr2023, sec. 9.3.6].
        const auto colour = pbrtSpectrum(*reflectance, PbrtUse::albedo, shared_);
        const auto curve = (colour ? *colour : PbrtSpectrum::flat(0.5)).curve(PbrtUse::albedo);
        eta = PbrtSpectrum::flat(1);
        k->kind = PbrtSpectrum::Kind::table;
        k->pairs.clear();
        for (double nm = 360; nm <= 830; nm += 5) {
            const double r = std::clamp(curve->at(nm), 0.0, 0.9999);
            k->pairs.insert(k->pairs.end(), {nm, 2 * std::sqrt(r) / std::sqrt(1 - r)});
        }
        if (curve->isConstant()) k = PbrtSpectrum::flat(k->pairs[1]);
    }
    if (eta->kind == PbrtSpectrum::Kind::metalEta && k->kind == PbrtSpectrum::Kind::metalK && eta->name == k->name &&
        relativeTo == 1)
        return void(index.word("metal").name(eta->name));
    eta->write(index.child("n"), PbrtUse::index, 1 / relativeTo);
    k->write(index.child("k"), PbrtUse::index, 1 / relativeTo);
}

void PbrtMaterials::conductor(Making& m) {
    if (const PbrtTexture* colour = textures_.named(m.params, "reflectance", true); colour && !colour->isPlain) {
        m.node().word("openpbr");
        m.node().child("base-metalness").number(1);
        spectrum(m, m.node(), "base-color", "reflectance", 0.5);
        SceneNode gloss("gloss");
        roughness(m, gloss, "", false);
        bool isRough = false;
        for (const SceneNode& child : gloss.children())
            if (child.kind() == "roughness") {
                SceneNode& ours = m.node().child("specular-roughness");
                ours.word(child.values());
                for (const SceneNode& inner : child.children()) ours.adopt(inner);
                isRough = true;
            }
        if (!isRough) m.node().child("specular-roughness").number(0);
        shared_.out.approximated(&m.node(), m.params.spanOf("reflectance"), "a conductor of textured `reflectance`",
                                 "towards grazing angles it brightens as OpenPBR's metal does");
        return;
    }
    m.node().word("conductor");
    metalIndex(m, m.node().child("index"), "", 1);
    roughness(m, m.node(), "", true);
}

void PbrtMaterials::diffuseTransmission(Making& m) {
    constexpr std::array<const char*, 2> kSides = {"reflectance", "transmittance"};
    m.node().word("diffuse-transmission");
    double scale = m.params.number("scale", 1, shared_.faults());
    std::array<PbrtSpectrum, 2> values;
    double most = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        const PbrtParam* param = m.params.texture(kSides[i]) ? nullptr : m.params.find(kSides[i]);
        const auto given = param ? pbrtSpectrum(*param, PbrtUse::albedo, shared_) : std::nullopt;
        values[i] = given ? *given : PbrtSpectrum::flat(0.25);
        most += values[i].curve(PbrtUse::albedo)->maximum();
    }
    if (scale * most > 1 || scale < 0) {
        scale = std::max(0.0, 1 / most - 1e-6);
        shared_.out.approximated(&m.node(), m.params.directive, "a sheet that sends on more light than it gets",
                                 "both shares are scaled to 1 together");
    }
    for (std::size_t i = 0; i < 2; ++i) {
        SceneNode& child = m.node().child(kSides[i]);
        if (!m.params.texture(kSides[i])) {
            values[i].write(child, PbrtUse::albedo, scale);
        } else if (scale != 1) {
            SceneNode& product = child.word("product");
            spectrum(m, product, "first", kSides[i], 0.25);
            product.child("second").number(scale);
        } else {
            textures_.writeSpectrum(child, m.params, kSides[i], values[i], m.material.uvs);
        }
    }
}

// pbrt's coat is a slab of `thickness`, through which exp(-thickness / cos) of the light passes where its `albedo` is 0
// [Pharr2023, sec. 14.3]; that is an absorption of 1 per m over as many metres.
void PbrtMaterials::coat(Making& m, SceneNode& layered) {
    Diagnostics& faults = shared_.faults();
    const double thickness = m.params.number("thickness", 0.01, faults);
    double share = 1;
    if (const PbrtParam* albedo = m.params.find("albedo"); albedo && !m.params.texture("albedo")) {
        const auto colour = pbrtSpectrum(*albedo, PbrtUse::albedo, shared_);
        if (colour && !colour->isBlack()) {
            share = std::max(0.0, 1 - colour->curve(PbrtUse::albedo)->at(550));
            shared_.out.approximated(&m.node(), albedo->span, "a coat that scatters light",
                                     "it absorbs what it does not scatter, and is clear otherwise");
        }
    } else if (m.params.texture("albedo")) {
        shared_.out.leftOut(&m.node(), m.params.spanOf("albedo"), "a texture for the `albedo` of a coat",
                            "coats do not scatter light");
    }
    for (const char* ofScattering : {"g", "maxdepth", "nsamples"}) m.params.find(ofScattering);
    if (thickness * share > 0) {
        layered.child("absorption").number(share).word("per-m");
        layered.child("thickness").number(std::min(thickness, 1.0)).word("m");
    }
    shared_.out.approximated(&m.node(), m.params.directive, fmt::format("the material `{}`", m.type),
                             "`layered` shares the light by albedos, where pbrt follows it between the layers");
}

void PbrtMaterials::coatedDiffuse(Making& m) {
    m.node().word("layered");
    SceneNode& base = m.node().child("base").word("diffuse");
    spectrum(m, base, "reflectance", "reflectance", 0.5);
    refractiveIndex(m, m.node(), "eta", 1.5);
    roughness(m, m.node(), "", false);
    coat(m, m.node());
}

void PbrtMaterials::coatedConductor(Making& m) {
    m.node().word("layered");
    SceneNode& base = m.node().child("base").word("conductor");
    const PbrtParam* eta = m.params.find("interface.eta");
    const auto index = eta ? pbrtSpectrum(*eta, PbrtUse::index, shared_) : std::nullopt;
    const double relative = index ? index->curve(PbrtUse::index)->at(587.6) : 1.5;
    metalIndex(m, base.child("index"), "conductor.", relative > 0 ? relative : 1);
    roughness(m, base, "conductor.", true);
    refractiveIndex(m, m.node(), "interface.eta", 1.5);
    roughness(m, m.node(), "interface.", false);
    coat(m, m.node());
}

void PbrtMaterials::hair(Making& m) {
    Diagnostics& faults = shared_.faults();
    m.node().word("hair");
    const bool hasDye = m.params.has("sigma_a") || m.params.has("reflectance") || m.params.has("color");
    if (m.params.has("sigma_a")) {
        const auto dye = pbrtSpectrum(*m.params.find("sigma_a"), PbrtUse::unbounded, shared_);
        if (dye) dye->write(m.node().child("absorption"), PbrtUse::unbounded);
    } else if (hasDye) {
        spectrum(m, m.node(), "color", m.params.has("reflectance") ? "reflectance" : "color", 0.5);
    }
    const bool hasPigment = m.params.has("eumelanin") || m.params.has("pheomelanin");
    const auto pigment = [&](const char* name, double absent) {
        if (m.params.texture(name))
            textures_.writeNumber(m.node().child(name), m.params, name, absent, m.material.uvs);
        else if (const double amount = m.params.number(name, absent, faults); amount > 0)
            m.node().child(name).number(std::min(amount, 100.0));
    };
    pigment("eumelanin", hasDye || hasPigment ? 0 : 1.3); // brown, when nothing is said
    pigment("pheomelanin", 0);
    m.node().child("ior").number(m.params.number("eta", 1.55, faults));
    textures_.writeNumber(m.node().child("longitudinal-roughness"), m.params, "beta_m", 0.3, m.material.uvs);
    textures_.writeNumber(m.node().child("azimuthal-roughness"), m.params, "beta_n", 0.3, m.material.uvs);
    const double scales = m.params.number("alpha", 2, faults);
    m.node().child("scale-angle").number(std::clamp(scales, -28.0, 28.0)).word("deg");
}

void PbrtMaterials::subsurface(Making& m) {
    Diagnostics& faults = shared_.faults();
    m.material.lightEnters = true;
    const double g = std::clamp(m.params.number("g", 0, faults), -0.99, 0.99);
    const double scale = m.params.number("scale", 1, faults);
    if (m.params.has("reflectance")) {
        m.node().word("subsurface");
        const PbrtTexture* texture = textures_.named(m.params, "reflectance", true);
        if (texture && !texture->isPlain) {
            m.node().child("reflectance").number(0.5);
            shared_.out.leftOut(&m.node(), m.params.spanOf("reflectance"), "a texture for the colour of an inside",
                                "an inside has one colour");
        } else {
            spectrum(m, m.node(), "reflectance", "reflectance", 1);
        }
        const PbrtParam* mfp = m.params.find("mfp");
        const auto path = mfp ? pbrtSpectrum(*mfp, PbrtUse::unbounded, shared_) : std::nullopt;
        SceneNode& ours = m.node().child("mean-free-path");
        (path ? *path : PbrtSpectrum::flat(1)).write(ours, PbrtUse::unbounded, scale);
        ours.word("m");
        if (g != 0) m.node().child("anisotropy").number(g);
        m.material.hasInterior = true;
    } else {
        m.node().word("dielectric");
        m.material.hasInterior = true;
        m.material.interior = shared_.mediumNames.take("inside", "inside");
        SceneNode medium("medium");
        medium.name(m.material.interior).word("homogeneous");
        pbrtCoefficients(medium, m.params, "name", scale, shared_);
        if (g != 0) medium.child("phase").word("henyey-greenstein").number(g);
        shared_.definitions.push_back(std::move(medium));
    }
    refractiveIndex(m, m.node(), "eta", 1.33);
    SceneNode& surface = m.node();
    roughness(m, surface, "", false);
    if (m.params.has("reflectance") &&
        std::ranges::none_of(surface.children(), [](const SceneNode& c) { return c.kind() == "roughness"; }))
        surface.child("roughness").number(0);
    shared_.out.approximated(&m.node(), m.params.directive, "the material `subsurface`",
                             "light is followed through the inside, where pbrt has a table of where it comes out");
}

void PbrtMaterials::mix(Making& m) {
    m.node().word("mix");
    const PbrtParam* materials = m.params.find("materials");
    if (!materials || materials->texts.size() != 2) {
        shared_.faults().error("E0802", m.params.spanOf("materials"), "a `mix` takes the names of two `materials`");
        return;
    }
    for (int i = 0; i < 2; ++i) {
        const std::string& name = materials->texts[static_cast<std::size_t>(i)];
        m.node().child(i == 0 ? "first" : "second").name(wordOf(name, materials->span));
        if (const PbrtMaterial* part = find(name)) {
            PbrtTextures::addUvs(m.material.uvs, part->uvs);
            m.material.lightEnters |= part->lightEnters;
            m.material.isStretched |= part->isStretched;
        }
    }
    textures_.writeNumber(m.node().child("amount"), m.params, "amount", 0.5, m.material.uvs);
}

void PbrtMaterials::measured(Making& m) {
    const std::string file = m.params.text("filename", "", shared_.faults());
    if (file.empty()) {
        shared_.faults().error("E0802", m.params.directive, "`measured` needs a `filename`");
        m.node().word("diffuse");
        return;
    }
    m.material.isStretched = true; // perhaps: files may be of brushed surfaces
    m.node().word("measured").text(shared_.out.files.refer(shared_.file(file)));
}

void PbrtMaterials::surface(Making& m) {
    if (const PbrtTexture* heights = textures_.named(m.params, "displacement", false); heights && !heights->isPlain) {
        PbrtTextures::addUvs(m.material.uvs, heights->uvs);
        SceneNode& bump = m.node().child("bump").number(std::abs(heights->factor)).word("m");
        bump.child("map").name(heights->word);
        if (heights->factor < 0)
            shared_.out.approximated(&m.node(), m.params.spanOf("displacement"), "a negative displacement",
                                     "its heights are taken as positive");
    }
    const std::string map = m.params.text("normalmap", "", shared_.faults());
    if (map.empty()) return;
    PbrtTextures::addUvs(m.material.uvs, {PbrtUv()});
    m.node().child("normal").word("image").text(shared_.out.files.refer(shared_.file(map))).key("space", "data");
}

const PbrtMaterial* PbrtMaterials::define(const std::string& name, const std::string& type, const PbrtParams& params) {
    if (type == "interface" || type.empty() || type == "none") {
        PbrtMaterial& made = all_.emplace_back();
        made.isInterface = true;
        if (!name.empty()) {
            made.word = wordOf(name, params.directive);
            made.node.name(made.word).word("boundary");
            shared_.definitions.push_back(made.node);
            named_.insert_or_assign(name, &made);
        }
        params.reportUnused("the material `interface`", shared_.faults());
        return &made;
    }
    if (std::ranges::find(kPbrtOldMaterials, type) != kPbrtOldMaterials.end())
        throw PbrtOldScene{params.directive, fmt::format("the material `{}`", type)};
    using Maker = void (PbrtMaterials::*)(Making&);
    static const std::map<std::string_view, Maker> kMakers = {
        {"diffuse", &PbrtMaterials::diffuse},
        {"conductor", &PbrtMaterials::conductor},
        {"dielectric", &PbrtMaterials::dielectric},
        {"thindielectric", &PbrtMaterials::thinDielectric},
        {"diffusetransmission", &PbrtMaterials::diffuseTransmission},
        {"coateddiffuse", &PbrtMaterials::coatedDiffuse},
        {"coatedconductor", &PbrtMaterials::coatedConductor},
        {"hair", &PbrtMaterials::hair},
        {"subsurface", &PbrtMaterials::subsurface},
        {"mix", &PbrtMaterials::mix},
        {"measured", &PbrtMaterials::measured}};
    const auto maker = kMakers.find(type);
    if (maker == kMakers.end()) {
        auto& d = shared_.faults().error("E0802", params.directive, fmt::format("there is no material `{}`", type));
        for (const auto& [known, function] : kMakers)
            if (schema::editDistance(known, type) <= 1 + type.size() / 4) d.help = schema::didYouMean(known);
        return nullptr;
    }
    PbrtMaterial& made = all_.emplace_back();
    made.word = name.empty() ? shared_.materialNames.take(fmt::format("{}-{}", type, ++unnamed_), "material")
                             : wordOf(name, params.directive);
    made.node.name(made.word);
    Making m{type, params, made};
    (this->*maker->second)(m);
    surface(m);
    params.reportUnused(fmt::format("the material `{}`", type), shared_.faults());
    shared_.definitions.push_back(made.node);
    if (!name.empty()) {
        if (named_.contains(name))
            shared_.faults().error("E0802", params.directive, fmt::format("the material `{}` is defined twice", name));
        named_.insert_or_assign(name, &made);
    }
    return &made;
}

const PbrtMaterial* PbrtMaterials::find(std::string_view name) const {
    const auto found = named_.find(name);
    return found == named_.end() ? nullptr : found->second;
}

std::string PbrtMaterials::wordOf(const std::string& name, Span span) {
    const auto found = mentioned_.find(name);
    if (found != mentioned_.end()) return found->second.first;
    const std::string word = shared_.materialNames.take(name, "material");
    mentioned_.emplace(name, std::pair(word, span));
    return word;
}

const PbrtMaterial* PbrtMaterials::withOpacity(const PbrtMaterial& of, const PbrtParams& shape) {
    SceneNode opacity("opacity");
    std::vector<PbrtUv> uvs;
    textures_.writeNumber(opacity, shape, "alpha", 1, uvs);
    const std::string key = of.word + '\n' + printScene(std::span(&opacity, 1));
    if (const auto found = translucent_.find(key); found != translucent_.end()) return found->second;
    PbrtMaterial& made = all_.emplace_back(of);
    made.word = shared_.materialNames.take((of.word.empty() ? "grey" : of.word) + "-cut", "material");
    PbrtTextures::addUvs(made.uvs, uvs);
    made.node = SceneNode("material");
    made.node.name(made.word);
    if (of.word.empty()) made.node.word("diffuse");
    // What stands behind the name of the other one.
    const std::size_t name = SceneNode("material").name(of.word).values().size();
    if (!of.word.empty()) made.node.word(of.node.values().substr(std::min(name + 1, of.node.values().size())));
    for (const SceneNode& child : of.node.children()) made.node.adopt(child);
    made.node.adopt(std::move(opacity));
    shared_.definitions.push_back(made.node);
    translucent_.emplace(key, &made);
    return &made;
}

void PbrtMaterials::finish() {
    for (const auto& [name, mention] : mentioned_) {
        if (named_.contains(name)) continue;
        auto& d = shared_.faults().error("E0802", mention.second, fmt::format("there is no material `{}`", name));
        for (const auto& [known, material] : named_)
            if (schema::editDistance(known, name) <= 1 + name.size() / 4) d.help = schema::didYouMean(known);
    }
}

} // namespace abbe::exchange
