// Textures, materials and media.
#include "exchange/pbrt_export/pbrt_writer.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

struct PbrtMaterialText {
    std::string type;
    PbrtList list;
};

using PbrtMaterialMaker = PbrtMaterialText (*)(const StatedThing&, PbrtWriter&);

// ---- textures

void addImageParams(PbrtList& list, const StatedThing& image, bool spectrum, PbrtWriter& w) {
    const auto* const file = image.value<schema::Text>("file");
    if (!file) return;
    list.text("string", "filename", w.out.files.refer(file->value));
    for (const auto& [key, value] : file->keys) {
        if (key != "space") continue;
        if (value == "data" || value == "lin_rec709_scene")
            list.text("string", "encoding", "linear");
        else if (value == "g22_rec709_scene")
            list.text("string", "encoding", "gamma 2.2");
        else if (value == "g18_rec709_scene")
            list.text("string", "encoding", "gamma 1.8");
        else if (value != "srgb_rec709_scene")
            w.out.approximated(file->span, fmt::format("`space={}`", value), "pbrt goes by the file itself");
    }
    if (!spectrum && std::ranges::none_of(file->keys, [](const auto& key) { return key.first == "space"; }))
        list.text("string", "encoding", "sRGB");
    const std::string wrap = image.word("wrap");
    if (wrap == "clamp" || wrap == "black") list.text("string", "wrap", wrap);
    if (wrap == "mirror") w.out.approximated(image.span, "`wrap mirror`", "the picture is repeated");
}

std::string pbrtTextureLine(const StatedThing& texture, bool spectrum, const std::string& name, PbrtWriter& w) {
    PbrtList list;
    std::string type;
    double size = 0; // of a pattern in space
    const auto color = [&](const char* param, const char* property, double otherwise) {
        if (const StatedSpectrum s = texture.spectrum(property); s && spectrum)
            pbrtWriteColor(list, param, s, w);
        else if (s && s.texture)
            pbrtWriteAmount(list, param, {0, s.texture}, w);
        else if (s)
            list.number(param, s.curve->at(550));
        else
            list.add(spectrum ? "rgb" : "float", param,
                     spectrum ? fmt::format("{0} {0} {0}", pbrtNumber(otherwise)) : pbrtNumber(otherwise));
    };
    if (texture.type == "image") {
        type = "imagemap";
        addImageParams(list, texture, spectrum, w);
    } else if (texture.type == "checker") {
        type = "checkerboard";
        color("tex1", "even", 0.8);
        color("tex2", "odd", 0.2);
        const auto* const scale = texture.quantity("scale");
        const double squares = texture.number("scale", 8);
        if (scale && scale->dimension == schema::Dimension::length) { // cubes of that size in space
            list.integer("dimension", 3);
            size = squares;
        } else if (squares != 1)
            list.number("uscale", squares).number("vscale", squares);
    } else if (texture.type == "product" && !spectrum) {
        type = "scale";
        color("tex", "first", 1);
        color("scale", "second", 1);
    } else if (texture.type == "channel" && texture.textured("of", 0).texture) {
        w.out.approximated(texture.span, "`channel`", "pbrt takes the mean of the channels");
        return pbrtTextureLine(*texture.textured("of", 0).texture, spectrum, name, w);
    } else {
        return {};
    }
    w.out.leaveOutUnused(texture);
    const std::string line =
        fmt::format("Texture \"{}\" \"{}\" \"{}\"{}\n", name, spectrum ? "spectrum" : "float", type, list.str());
    if (size == 0) return line;
    return fmt::format("AttributeBegin\n    Scale {0} {0} {0}\n    {1}AttributeEnd\n", pbrtNumber(size), line);
}

// ---- materials

// The text of a texture whose values are squares of another's: α of a roughness.
std::string squareOf(const StatedThing& texture, PbrtWriter& w) {
    const std::string base = pbrtTextureName(texture, false, w);
    if (base.empty()) return {};
    const std::string name = PbrtWriter::take(w.textureNames, base + "-squared", {});
    w.definitions += fmt::format(
        "Texture \"{0}\" \"float\" \"scale\" \"texture tex\" [ \"{1}\" ] \"texture scale\" [ \"{1}\" ]\n", name, base);
    return name;
}

// α is `roughness` without pbrt's own map; ours is its root.
void addRoughness(PbrtList& list, const StatedThing& m, const char* property, const std::string& prefix,
                  double otherwise, PbrtWriter& w) {
    const StatedNumber r = m.textured(property, otherwise);
    const double stretch = m.textured("anisotropy", 0).value;
    if (r.texture) {
        const std::string squared = squareOf(*r.texture, w);
        if (!squared.empty())
            list.text("texture", prefix + "roughness", squared);
        else
            list.number(prefix + "roughness", 0.09);
    } else if (stretch != 0 && r.value > 0) {
        const double u = r.value * r.value * std::sqrt(2 / (1 + (1 - stretch) * (1 - stretch)));
        list.number(prefix + "uroughness", u).number(prefix + "vroughness", (1 - stretch) * u);
    } else {
        list.number(prefix + "roughness", r.value * r.value);
    }
    list.flag("remaproughness", false);
}

void addIndex(PbrtList& list, const std::string& name, const StatedSpectrum& ior, double otherwise) {
    if (!ior.curve) return void(list.number(name, otherwise));
    if (ior.curve->isConstant()) return void(list.number(name, ior.curve->at(550)));
    // Glasses that pbrt has by the same name.
    constexpr std::pair<std::string_view, std::string_view> kGlasses[] = {
        {"BK7", "BK7"},       {"N-BK7", "BK7"}, {"BAF10", "BAF10"}, {"FK51A", "FK51A"}, {"N-FK51A", "FK51A"},
        {"N-LASF9", "LASF9"}, {"N-SF5", "SF5"}, {"SF10", "SF10"},   {"SF11", "SF11"}};
    for (const auto& [ours, theirs] : kGlasses)
        if (ior.curve->stated.form == schema::SpectrumValue::Form::glass && ior.curve->stated.text == ours)
            return void(list.text("spectrum", name, fmt::format("glass-{}", theirs)));
    list.spectrum(name, plainSpectrum(*ior.curve));
}

void addReflectance(PbrtList& list, const char* param, const StatedThing& m, const char* property, double otherwise,
                    PbrtWriter& w) {
    if (const StatedSpectrum s = m.spectrum(property))
        pbrtWriteColor(list, param, s, w);
    else
        list.add("rgb", param, fmt::format("{0} {0} {0}", pbrtNumber(otherwise)));
}

// n and k, times the index of what lies on the metal.
void addMetal(PbrtList& list, const StatedThing& m, const char* property, const std::string& prefix, double relative) {
    const auto* const index = m.value<schema::ComplexIndex>(property);
    if (!index) return;
    const auto &n = static_cast<const StatedCurve&>(*index->n), &k = static_cast<const StatedCurve&>(*index->k);
    constexpr std::pair<std::string_view, std::string_view> kPbrtMetals[] = {
        {"Ag", "Ag"}, {"Al", "Al"}, {"Au", "Au"}, {"Cu", "Cu"}, {"brass", "CuZn"}, {"CuZn", "CuZn"}};
    using Form = schema::SpectrumValue::Form;
    if (n.stated.form == Form::metal && k.stated.form == Form::metal && relative == 1)
        for (const auto& [ours, theirs] : kPbrtMetals)
            if (n.stated.text == ours) {
                list.text("spectrum", prefix + "eta", fmt::format("metal-{}-eta", theirs));
                list.text("spectrum", prefix + "k", fmt::format("metal-{}-k", theirs));
                return;
            }
    for (const auto& [name, curve] : {std::pair<const char*, const StatedCurve*>{"eta", &n}, {"k", &k}}) {
        PlainSpectrum s = plainSpectrum(*curve, relative);
        if (s.form == PlainSpectrum::Form::flat) {
            s.form = PlainSpectrum::Form::table;
            s.rows = {{360, s.value}, {830, s.value}};
        }
        list.spectrum(prefix + name, s);
    }
}

PbrtMaterialText makeDiffuse(const StatedThing& m, PbrtWriter& w) {
    PbrtMaterialText made{"diffuse", {}};
    addReflectance(made.list, "reflectance", m, "reflectance", 0.5, w);
    return made;
}

PbrtMaterialText makeConductor(const StatedThing& m, PbrtWriter& w) {
    PbrtMaterialText made{"conductor", {}};
    addMetal(made.list, m, "index", "", 1);
    addRoughness(made.list, m, "roughness", "", 0, w);
    return made;
}

PbrtMaterialText makeDielectric(const StatedThing& m, PbrtWriter& w) {
    PbrtMaterialText made{"dielectric", {}};
    addIndex(made.list, "eta", m.spectrum("ior"), 1.5);
    addRoughness(made.list, m, "roughness", "", 0, w);
    Export::ignore(m, {"absorption", "attenuation-color", "attenuation-distance"}); // a medium of the shape
    return made;
}

PbrtMaterialText makeThin(const StatedThing& m, PbrtWriter&) {
    PbrtMaterialText made{"thindielectric", {}};
    addIndex(made.list, "eta", m.spectrum("ior"), 1.5);
    return made;
}

PbrtMaterialText makeMix(const StatedThing& m, PbrtWriter& w) {
    PbrtMaterialText made{"mix", {}};
    const StatedThing *const first = m.reference("first"), *const second = m.reference("second");
    if (first && second)
        made.list.add("string", "materials",
                      fmt::format("\"{}\" \"{}\"", pbrtMaterialName(*first, w), pbrtMaterialName(*second, w)));
    pbrtWriteAmount(made.list, "amount", m.textured("amount", 0.5), w);
    return made;
}

// The slab of pbrt's coat lets exp(−thickness) of straight light through; ours absorbs by a coefficient and a length.
void addCoat(PbrtList& list, const StatedThing& m, PbrtWriter& w) {
    const StatedSpectrum absorption = m.spectrum("absorption");
    double depth = 0;
    if (absorption.curve) {
        depth = absorption.curve->at(550) * m.number("thickness", 1e-4);
        if (!absorption.curve->isConstant())
            w.out.approximated(m.span, "the colour of a coat", "it absorbs as much at every wavelength");
    }
    m.has("thickness");
    list.number("thickness", depth);
    w.out.approximated(m.span, "`layered`", "pbrt follows the light between the layers");
}

PbrtMaterialText makeLayered(const StatedThing& m, PbrtWriter& w) {
    const StatedThing* const base = m.reference("base");
    if (base && base->type == "conductor") {
        PbrtMaterialText made{"coatedconductor", {}};
        const StatedSpectrum ior = m.spectrum("ior");
        addMetal(made.list, *base, "index", "conductor.", ior.curve ? ior.curve->at(587.6) : 1.5);
        addIndex(made.list, "interface.eta", ior, 1.5);
        addRoughness(made.list, m, "roughness", "interface.", 0, w);
        const double r = base->textured("roughness", 0).value;
        made.list.number("conductor.roughness", r * r);
        addCoat(made.list, m, w);
        return made;
    }
    if (!base || base->type != "diffuse") {
        w.out.leftOut(m.span, "the base of `layered`", "pbrt has coats on matte surfaces and metals alone");
        return makeDiffuse(m, w);
    }
    PbrtMaterialText made{"coateddiffuse", {}};
    addReflectance(made.list, "reflectance", *base, "reflectance", 0.5, w);
    addIndex(made.list, "eta", m.spectrum("ior"), 1.5);
    addRoughness(made.list, m, "roughness", "", 0, w);
    addCoat(made.list, m, w);
    return made;
}

PbrtMaterialText makeHair(const StatedThing& m, PbrtWriter& w) {
    PbrtMaterialText made{"hair", {}};
    if (const StatedSpectrum sigma = m.spectrum("absorption"); sigma.curve)
        made.list.spectrum("sigma_a", plainSpectrum(*sigma.curve));
    else if (const StatedSpectrum color = m.spectrum("color"))
        pbrtWriteColor(made.list, "reflectance", color, w);
    for (const char* pigment : {"eumelanin", "pheomelanin"})
        if (m.has(pigment)) pbrtWriteAmount(made.list, pigment, m.textured(pigment, 0), w);
    made.list.number("eta", m.number("ior", 1.55));
    pbrtWriteAmount(made.list, "beta_m", m.textured("longitudinal-roughness", 0.3), w);
    pbrtWriteAmount(made.list, "beta_n", m.textured("azimuthal-roughness", 0.3), w);
    made.list.number("alpha", m.number("scale-angle", 2 * kDegree) / kDegree);
    return made;
}

PbrtMaterialText makeSheet(const StatedThing& m, PbrtWriter& w) {
    PbrtMaterialText made{"diffusetransmission", {}};
    addReflectance(made.list, "reflectance", m, "reflectance", 0.25, w);
    addReflectance(made.list, "transmittance", m, "transmittance", 0.25, w);
    return made;
}

PbrtMaterialText makeSubsurface(const StatedThing& m, PbrtWriter& w) {
    PbrtMaterialText made{"subsurface", {}};
    addReflectance(made.list, "reflectance", m, "reflectance", 0.8, w);
    if (const StatedSpectrum path = m.spectrum("mean-free-path"); path.curve)
        made.list.spectrum("mfp", plainSpectrum(*path.curve));
    else
        made.list.add("rgb", "mfp", "0.001 0.001 0.001");
    if (const double g = m.number("anisotropy", 0); g != 0) made.list.number("g", g);
    addIndex(made.list, "eta", m.spectrum("ior"), 1.4);
    const StatedNumber r = m.textured("roughness", 0.3);
    made.list.number("roughness", r.value * r.value).flag("remaproughness", false);
    w.out.approximated(m.span, "`subsurface`", "pbrt has a table of where light comes out");
    return made;
}

PbrtMaterialText makeMeasuredFile(const StatedThing& m, PbrtWriter& w) {
    PbrtMaterialText made{"measured", {}};
    if (const auto* const file = m.value<schema::Text>("file"))
        made.list.text("string", "filename", w.out.files.refer(file->value));
    return made;
}

PbrtMaterialText makeInterface(const StatedThing&, PbrtWriter&) { return {"interface", {}}; }

// Metal, glass or a coat over a matte base, whichever weighs most.
PbrtMaterialText makeFromOpenPbr(const StatedThing& m, PbrtWriter& w) {
    w.out.approximated(m.span, "`openpbr`", "by metal, glass or a coat over a matte base, whichever weighs most");
    PbrtMaterialText made;
    const StatedNumber rough = m.textured("specular-roughness", 0.3);
    const double alpha = rough.texture ? 0.09 : rough.value * rough.value;
    if (m.textured("base-metalness", 0).value > 0.5) {
        made.type = "conductor";
        addReflectance(made.list, "reflectance", m, "base-color", 0.8, w);
    } else if (m.textured("transmission-weight", 0).value > 0.5) {
        made.type = "dielectric";
        addIndex(made.list, "eta", m.spectrum("specular-ior"), 1.5);
    } else {
        made.type = "coateddiffuse";
        addReflectance(made.list, "reflectance", m, "base-color", 0.8, w);
        addIndex(made.list, "eta", m.spectrum("specular-ior"), 1.5);
        made.list.number("thickness", 0);
    }
    made.list.number("roughness", alpha).flag("remaproughness", false);
    return made;
}

PbrtMaterialText makeSheenMatte(const StatedThing& m, PbrtWriter& w) {
    w.out.approximated(m.span, "`sheen`", "by its matte ground");
    PbrtMaterialText made{"diffuse", {}};
    addReflectance(made.list, "reflectance", m, "base-color", 0.5, w);
    Export::ignore(m, {"color", "roughness"});
    return made;
}

struct PbrtMaterialRow {
    std::string_view type;
    PbrtMaterialMaker make;
};
constexpr PbrtMaterialRow kPbrtMaterialRows[] = {
    {"diffuse", makeDiffuse},
    {"conductor", makeConductor},
    {"dielectric", makeDielectric},
    {"thin-dielectric", makeThin},
    {"mix", makeMix},
    {"layered", makeLayered},
    {"hair", makeHair},
    {"diffuse-transmission", makeSheet},
    {"subsurface", makeSubsurface},
    {"measured", makeMeasuredFile},
    {"boundary", makeInterface},
    {"openpbr", makeFromOpenPbr},
    {"sheen", makeSheenMatte},
};

void addRelief(PbrtList& list, const StatedThing& m, PbrtWriter& w) {
    if (const StatedThing* map = m.reference("bump.map")) {
        const std::string base = pbrtTextureName(*map, false, w);
        const std::string name = PbrtWriter::take(w.textureNames, base + "-height", {});
        if (!base.empty()) {
            w.definitions +=
                fmt::format("Texture \"{}\" \"float\" \"scale\" \"texture tex\" [ \"{}\" ] \"float scale\" [ {} ]\n",
                            name, base, pbrtNumber(m.number("bump", 0)));
            list.text("texture", "displacement", name);
        }
    }
    m.has("bump");
    if (const StatedThing* map = normalMapOf(m, w.out)) {
        const auto* const file = map->type == "image" ? map->value<schema::Text>("file") : nullptr;
        if (file)
            list.text("string", "normalmap", w.out.files.refer(file->value));
        else
            w.out.leftOut(map->span, "a normal map that is no image", "pbrt reads them from files alone");
    }
}

} // namespace

std::string pbrtTextureName(const StatedThing& texture, bool spectrum, PbrtWriter& w) {
    std::string& name = w.textures[{&texture, spectrum}];
    if (!name.empty()) return name == "-" ? std::string() : name;
    name = PbrtWriter::take(w.textureNames, texture.name, texture.type);
    const std::string line = pbrtTextureLine(texture, spectrum, name, w);
    if (line.empty()) {
        w.out.leftOut(texture.span, fmt::format("texture `{}`", texture.type),
                      "pbrt has nothing like it; grey stands for it");
        name = "-";
        return {};
    }
    w.definitions += w.remarks() + line;
    return name;
}

namespace {

PbrtMaterialText pbrtMaterialText(const StatedThing& material, PbrtWriter& w) {
    const auto row = std::ranges::find(kPbrtMaterialRows, std::string_view(material.type), &PbrtMaterialRow::type);
    PbrtMaterialText made =
        row == std::end(kPbrtMaterialRows) ? PbrtMaterialText{"diffuse", {}} : row->make(material, w);
    addRelief(made.list, material, w);
    Export::ignore(material, {"priority", "opacity"});
    w.out.leaveOutUnused(material);
    return made;
}

// pbrt has one material for both sides.
const StatedThing& frontOf(const StatedThing& material, PbrtWriter& w) {
    const StatedThing* const front = material.type == "two-sided" ? material.reference("front") : nullptr;
    if (!front) return material;
    w.out.approximated(material.span, "`two-sided`", "pbrt has the front on both sides");
    return *front;
}

} // namespace

std::string pbrtMaterialName(const StatedThing& stated, PbrtWriter& w) {
    const StatedThing& material = frontOf(stated, w);
    if (const auto found = w.materials.find(&material); found != w.materials.end()) return found->second;
    const std::string name = PbrtWriter::take(w.names, material.name, material.type);
    w.materials[&material] = name;
    const PbrtMaterialText made = pbrtMaterialText(material, w);
    w.definitions += w.remarks() + fmt::format("MakeNamedMaterial \"{}\" \"string type\" [ \"{}\" ]{}\n", name,
                                               made.type, made.list.str());
    return name;
}

std::string pbrtMaterialLine(const StatedThing& stated, PbrtWriter& w) {
    const StatedThing& material = frontOf(stated, w);
    if (!material.name.empty()) return fmt::format("NamedMaterial \"{}\"", pbrtMaterialName(material, w));
    const PbrtMaterialText made = pbrtMaterialText(material, w);
    return fmt::format("Material \"{}\"{}", made.type, made.list.str());
}

namespace {

PlainSpectrum tabled(const std::function<double(double)>& f) {
    PlainSpectrum s;
    s.form = PlainSpectrum::Form::table;
    for (double nm = 360; nm <= 830; nm += 5) s.rows.emplace_back(nm, f(nm));
    const bool flat = std::ranges::all_of(s.rows, [&](const auto& row) { return row.second == s.rows[0].second; });
    if (flat) {
        s.form = PlainSpectrum::Form::flat;
        s.value = s.rows[0].second;
    }
    return s;
}

void addPhase(PbrtList& list, const StatedThing* phase, PbrtWriter& w) {
    if (!phase || phase->type == "isotropic") return;
    if (phase->type == "henyey-greenstein")
        list.number("g", phase->number("g", 0));
    else
        w.out.approximated(phase->span, fmt::format("phase function `{}`", phase->type),
                           "pbrt has that of Henyey and Greenstein alone: light is scattered evenly");
}

std::string defineMedium(std::string_view name, const PbrtList& list, PbrtWriter& w) {
    w.definitions +=
        w.remarks() + fmt::format("MakeNamedMedium \"{}\" \"string type\" [ \"homogeneous\" ]{}\n", name, list.str());
    return std::string(name);
}

} // namespace

std::string pbrtMediumName(const StatedThing& m, PbrtWriter& w) {
    std::string& name = w.media[&m];
    if (!name.empty()) return name;
    if (m.type != "homogeneous") {
        w.out.leftOut(m.span, fmt::format("medium `{}`", m.type), "pbrt has no noise that fills a shape");
        return {};
    }
    name = PbrtWriter::take(w.names, m.name, "medium");
    PbrtList list;
    const auto curve = [&](const char* property) { return m.spectrum(property).curve; };
    const StatedCurve *scattering = curve("scattering"), *absorption = curve("absorption");
    if (scattering || absorption) {
        const auto plain = [](const StatedCurve* c) { return c ? plainSpectrum(*c) : PlainSpectrum(); };
        list.spectrum("sigma_s", plain(scattering)).spectrum("sigma_a", plain(absorption));
    } else {
        const StatedCurve *extinction = curve("extinction"), *albedo = curve("albedo");
        const auto at = [](const StatedCurve* c, double nm) { return c ? c->at(nm) : 1; };
        list.spectrum("sigma_s", tabled([&](double nm) { return at(extinction, nm) * at(albedo, nm); }));
        list.spectrum("sigma_a", tabled([&](double nm) { return at(extinction, nm) * (1 - at(albedo, nm)); }));
    }
    addPhase(list, m.reference("phase"), w);
    w.out.leaveOutUnused(m);
    return defineMedium(name, list, w);
}

std::string pbrtAbsorptionName(const StatedThing& material, PbrtWriter& w) {
    if (material.type != "dielectric") return {};
    const StatedCurve *absorption = material.spectrum("absorption").curve,
                      *color = material.spectrum("attenuation-color").curve;
    if (!absorption && !color) return {};
    std::string& name = w.media[&material];
    if (!name.empty()) return name;
    name = PbrtWriter::take(w.names, material.name.empty() ? "" : material.name + "-inside", "inside");
    const double distance = material.number("attenuation-distance", 1);
    PbrtList list;
    list.spectrum("sigma_s", PlainSpectrum());
    if (absorption)
        list.spectrum("sigma_a", plainSpectrum(*absorption));
    else
        list.spectrum("sigma_a",
                      tabled([&](double nm) { return -std::log(std::max(1e-6, color->at(nm))) / distance; }));
    return defineMedium(name, list, w);
}

} // namespace abbe::exchange
