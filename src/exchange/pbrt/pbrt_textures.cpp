#include "exchange/pbrt/pbrt_textures.h"

#include "schema/suggest.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

namespace abbe::exchange {

struct PbrtTextures::Making {
    const std::string& name;
    bool isSpectrum;
    const std::string& type;
    const PbrtParams& params;
    const Transform& place;
    const std::string& word; // in the scene file
    SceneNode* node;         // with its name, which the makers fill
};

namespace {

// The names of encodings stand for what is made of the numbers in a file of integers.
std::string pbrtImageSpace(const std::string& encoding, bool isSpectrum, const std::string& file, bool& nearly) {
    std::string ending = file.substr(std::min(file.rfind('.'), file.size()));
    for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    const bool isFloat = ending == ".exr" || ending == ".hdr" || ending == ".pfm";
    if (isFloat) return isSpectrum ? "" : "data";
    if (encoding.empty() || encoding == "sRGB") return isSpectrum ? "" : "srgb_rec709_scene";
    if (encoding == "linear") return isSpectrum ? "lin_rec709_scene" : "data";
    const double gamma = encoding.starts_with("gamma ") ? std::strtod(encoding.c_str() + 6, nullptr) : 0;
    nearly = gamma != 2.2 && gamma != 1.8;
    return std::abs(gamma - 1.8) < 0.2 ? "g18_rec709_scene" : "g22_rec709_scene";
}

const PbrtTexture* pbrtFind(const std::map<std::string, PbrtTexture, std::less<>>& table, std::string_view name) {
    const auto found = table.find(name);
    return found == table.end() ? nullptr : &found->second;
}

} // namespace

void PbrtTextures::addUvs(std::vector<PbrtUv>& to, const std::vector<PbrtUv>& more) {
    for (const PbrtUv& uv : more)
        if (std::ranges::find(to, uv) == to.end()) to.push_back(uv);
}

PbrtUv PbrtTextures::mapping(const Making& m) {
    Diagnostics& faults = shared_.faults();
    const std::string kind = m.params.text("mapping", "uv", faults);
    PbrtUv uv{m.params.number("uscale", 1, faults), m.params.number("vscale", 1, faults),
              m.params.number("udelta", 0, faults), m.params.number("vdelta", 0, faults)};
    if (kind == "uv") return uv;
    m.params.find("v1");
    m.params.find("v2");
    shared_.out.approximated(m.node, m.params.spanOf("mapping"), fmt::format("the mapping `{}` of a texture", kind),
                             "the shape's own texture coordinates are used");
    return {};
}

PbrtTexture PbrtTextures::finish(const Making& m, PbrtTexture made) {
    made.word = m.word;
    shared_.definitions.push_back(std::move(*m.node));
    return made;
}

PbrtTexture PbrtTextures::image(const Making& m) {
    Diagnostics& faults = shared_.faults();
    PbrtTexture made;
    const std::string file = m.params.text("filename", "", faults);
    const std::string encoding = m.params.text("encoding", "", faults);
    const std::string wrap = m.params.text("wrap", "repeat", faults);
    const double scale = m.params.number("scale", 1, faults);
    const bool invert = m.params.flag("invert", false, faults);
    for (const char* quality : {"filter", "maxanisotropy"}) m.params.find(quality); // filtering is automatic
    made.uvs = {mapping(m)};
    std::error_code error;
    if (!std::filesystem::is_regular_file(shared_.file(file), error))
        faults.error("E0802", m.params.spanOf("filename"), fmt::format("the image `{}` does not exist", file));
    const bool isWrapped = invert || (m.isSpectrum && scale != 1); // in a texture that does this to it
    SceneNode inner("texture");
    const std::string plain = isWrapped ? shared_.textureNames.take(m.name + "-image", "image") : m.word;
    SceneNode& node = isWrapped ? inner.name(plain) : *m.node;
    bool nearly = false;
    const std::string space = pbrtImageSpace(encoding, m.isSpectrum, file, nearly);
    node.word("image").text(shared_.out.files.refer(shared_.file(file)));
    if (!space.empty()) node.key("space", space);
    if (nearly)
        shared_.out.approximated(m.node, m.params.spanOf("encoding"), fmt::format("the encoding `{}`", encoding),
                                 fmt::format("`{}` is used", space));
    if (wrap == "clamp" || wrap == "black") node.child("wrap").word(wrap);
    if (wrap == "octahedralsphere")
        shared_.out.approximated(m.node, m.params.spanOf("wrap"), "`wrap` over an octahedral sphere",
                                 "the image repeats");
    if (!m.isSpectrum) made.factor = scale;
    if (isWrapped) {
        shared_.definitions.push_back(std::move(inner));
        wrapImage(m, plain, scale, invert);
    }
    return finish(m, std::move(made));
}

void PbrtTextures::wrapImage(const Making& m, const std::string& image, double scale, bool invert) {
    SceneNode& node = *m.node;
    if (!m.isSpectrum) { // only to turn it round: the scale is the texture's factor
        node.word("ramp").child("input").name(image);
        node.child("stop").number(0).number(1);
        node.child("stop").number(1).number(0);
        return;
    }
    if (invert)
        shared_.out.leftOut(&node, m.params.spanOf("invert"), "`invert` of a coloured image",
                            "there is no texture for one minus another one");
    if (scale > 1)
        shared_.out.approximated(&node, m.params.spanOf("scale"), "a `scale` above 1 of a coloured image",
                                 "textures are factors of at most 1, so the image is as it is");
    node.word("product").child("first").name(image);
    node.child("second").number(std::clamp(scale, 0.0, 1.0));
}

void PbrtTextures::input(const Making& m, SceneNode& node, std::string_view property, std::string_view param,
                         double absent, PbrtTexture& of) {
    SceneNode& child = node.child(std::string(property));
    if (m.isSpectrum)
        writeSpectrum(child, m.params, param, PbrtSpectrum::flat(absent), of.uvs);
    else
        writeNumber(child, m.params, param, absent, of.uvs);
}

// Of a number and a texture the number becomes the factor, as it may be above 1.
PbrtTexture PbrtTextures::product(const Making& m) {
    PbrtTexture made;
    SceneNode& node = *m.node;
    const PbrtTexture* tex = named(m.params, "tex", m.isSpectrum);
    const PbrtTexture* scale = named(m.params, "scale", false);
    if (!m.isSpectrum && (tex || scale) && !(tex && scale && !tex->isPlain && !scale->isPlain)) {
        const auto plainOf = [&](const PbrtTexture* t, std::string_view name) {
            return t ? t->plain.value : m.params.number(name, 1, shared_.faults());
        };
        const bool texVaries = tex && !tex->isPlain;
        made = texVaries ? *tex : scale && !scale->isPlain ? *scale : PbrtTexture();
        if (texVaries)
            made.factor *= plainOf(scale, "scale");
        else if (scale && !scale->isPlain)
            made.factor *= plainOf(tex, "tex");
        else
            made = {true, PbrtSpectrum::flat(plainOf(tex, "tex") * plainOf(scale, "scale")), {}};
        return made;
    }
    node.word("product");
    input(m, node, "first", "tex", 1, made);
    SceneNode& second = node.child("second");
    writeNumber(second, m.params, "scale", 1, made.uvs);
    return finish(m, std::move(made));
}

PbrtTexture PbrtTextures::mixture(const Making& m, bool byDirection) {
    PbrtTexture made;
    SceneNode& node = *m.node;
    node.word("ramp");
    SceneNode& amount = node.child("input");
    if (byDirection) {
        m.params.find("dir");
        amount.number(0.5);
        shared_.out.approximated(m.node, m.params.directive, "the texture `directionmix`",
                                 "both of its textures count half everywhere");
    } else {
        writeNumber(amount, m.params, "amount", 0.5, made.uvs);
    }
    const auto stop = [&](double at, std::string_view param, double absent) {
        SceneNode& child = node.child("stop").number(at);
        if (m.isSpectrum)
            writeSpectrum(child, m.params, param, PbrtSpectrum::flat(absent), made.uvs);
        else
            writeNumber(child, m.params, param, absent, made.uvs);
    };
    stop(0, "tex1", 0);
    stop(1, "tex2", 1);
    return finish(m, std::move(made));
}

PbrtTexture PbrtTextures::checker(const Making& m) {
    PbrtTexture made;
    SceneNode& node = *m.node;
    node.word("checker");
    input(m, node, "even", "tex1", 1, made);
    input(m, node, "odd", "tex2", 0, made);
    const int dimension = m.params.integer("dimension", 2, shared_.faults());
    if (dimension == 3) {
        const double size = m.place.uniformScale().value_or(1);
        node.child("scale").number(size > 0 ? size : 1).word("m");
        if (!isIdentity(m.place))
            shared_.out.approximated(m.node, m.params.directive, "the place of a pattern in space",
                                     "patterns are in the space of the shape that has them");
    } else {
        node.child("scale").number(1);
        PbrtTextures::addUvs(made.uvs, {mapping(m)});
    }
    return finish(m, std::move(made));
}

PbrtTexture PbrtTextures::pattern(const Making& m) {
    Diagnostics& faults = shared_.faults();
    PbrtTexture made;
    SceneNode& node = *m.node;
    const int octaves = m.params.integer("octaves", 8, faults);
    const double roughness = m.params.number("roughness", 0.5, faults);
    const double size = m.place.uniformScale().value_or(1);
    const auto noise = [&](SceneNode& at, double scale) {
        at.word("noise");
        at.child("scale").number(std::clamp(std::abs(size / (scale > 0 ? scale : 1)), 1e-9, 1e9)).word("m");
        at.child("octaves").number(std::clamp(octaves, 1, 16));
        at.child("gain").number(std::clamp(roughness, 0.0, 1.0));
    };
    if (m.type == "marble") {
        m.params.find("variation");
        node.word("ramp");
        noise(node.child("input"), m.params.number("scale", 1, faults));
        const auto stop = [&](double at, Vec3d rgb) { node.child("stop").number(at).word("rgb").vector(rgb); };
        stop(0.35, {0.2, 0.2, 0.33});
        stop(0.5, {0.55, 0.55, 0.56});
        stop(0.65, {0.6, 0.59, 0.58});
    } else {
        noise(node, 1);
    }
    shared_.out.approximated(m.node, m.params.directive, fmt::format("the texture `{}`", m.type),
                             "`noise` has other bumps of about that size and lies in the space of the shape");
    return finish(m, std::move(made));
}

// Values at the corners of the unit square: v10 where u is 1 and v is 0.
PbrtTexture PbrtTextures::bilinear(const Making& m) {
    PbrtTexture made;
    SceneNode& node = m.node->word("ramp");
    node.child("over").word("u");
    for (const int u : {0, 1}) {
        SceneNode& side = node.child("stop").number(u).word("ramp");
        side.child("over").word("v");
        for (const int v : {0, 1}) {
            SceneNode& corner = side.child("stop").number(v);
            const std::string name = fmt::format("v{}{}", u, v);
            if (m.isSpectrum)
                writeSpectrum(corner, m.params, name, PbrtSpectrum::flat(v), made.uvs);
            else
                writeNumber(corner, m.params, name, v, made.uvs);
        }
    }
    PbrtTextures::addUvs(made.uvs, {mapping(m)});
    return finish(m, std::move(made));
}

PbrtTexture PbrtTextures::constant(const Making& m) {
    PbrtTexture made;
    made.isPlain = true;
    made.plain = PbrtSpectrum::flat(1);
    if (!m.isSpectrum)
        made.plain = PbrtSpectrum::flat(m.params.number("value", 1, shared_.faults()));
    else if (const PbrtParam* value = m.params.find("value"))
        if (auto spectrum = pbrtSpectrum(*value, PbrtUse::unbounded, shared_)) made.plain = std::move(*spectrum);
    return made;
}

PbrtTexture PbrtTextures::dots(const Making& m) {
    m.params.find("inside");
    mapping(m);
    shared_.out.leftOut(m.node, m.params.directive, "the dots of a texture", "there is no such pattern");
    if (const PbrtTexture* outside = named(m.params, "outside", m.isSpectrum)) return *outside;
    PbrtTexture made;
    made.isPlain = true;
    made.plain = PbrtSpectrum::flat(0);
    if (const PbrtParam* value = m.params.find("outside"))
        if (auto spectrum = pbrtSpectrum(*value, PbrtUse::unbounded, shared_)) made.plain = std::move(*spectrum);
    return made;
}

void PbrtTextures::define(const std::string& name, bool isSpectrum, const std::string& type, const PbrtParams& params,
                          const Transform& place) {
    const std::string word = shared_.textureNames.take(name, "texture");
    SceneNode node("texture");
    node.name(word);
    const Making m{name, isSpectrum, type, params, place, word, &node};
    PbrtTexture made;
    if (type == "imagemap")
        made = image(m);
    else if (type == "scale")
        made = product(m);
    else if (type == "mix" || type == "directionmix")
        made = mixture(m, type == "directionmix");
    else if (type == "checkerboard")
        made = checker(m);
    else if (type == "fbm" || type == "wrinkled" || type == "windy" || type == "marble")
        made = pattern(m);
    else if (type == "bilerp")
        made = bilinear(m);
    else if (type == "constant")
        made = constant(m);
    else if (type == "dots")
        made = dots(m);
    else {
        made.isPlain = true;
        made.plain = PbrtSpectrum::flat(0.5);
        if (type == "ptex") {
            for (const char* known : {"filename", "encoding", "scale"}) params.find(known);
            shared_.out.leftOut(nullptr, params.directive, fmt::format("the texture `{}`", name),
                                "Ptex files are not read; 0.5 stands in its place");
        } else {
            shared_.faults().error("E0802", params.directive, fmt::format("there is no type of texture `{}`", type));
        }
    }
    params.reportUnused(fmt::format("the texture `{}`", type), shared_.faults());
    auto& table = isSpectrum ? spectra_ : floats_;
    if (table.contains(name))
        shared_.faults().error(
            "E0802", params.directive,
            fmt::format("the {} texture `{}` is defined twice", isSpectrum ? "spectrum" : "float", name));
    table.insert_or_assign(name, std::move(made));
}

const PbrtTexture* PbrtTextures::named(const PbrtParams& params, std::string_view param, bool isSpectrum) {
    const auto name = params.texture(param);
    if (!name) return nullptr;
    const auto& table = isSpectrum ? spectra_ : floats_;
    if (const PbrtTexture* found = pbrtFind(table, *name)) return found;
    auto& d =
        shared_.faults().error("E0802", params.spanOf(param),
                               fmt::format("there is no {} texture `{}`", isSpectrum ? "spectrum" : "float", *name));
    if (pbrtFind(isSpectrum ? floats_ : spectra_, *name))
        d.notes.push_back(fmt::format("there is a {} texture of that name", isSpectrum ? "float" : "spectrum"));
    for (const auto& [other, texture] : table)
        if (schema::editDistance(other, *name) <= 1 + name->size() / 4) d.help = schema::didYouMean(other);
    return nullptr;
}

void PbrtTextures::writeSpectrum(SceneNode& property, const PbrtParams& params, std::string_view name,
                                 const PbrtSpectrum& absent, std::vector<PbrtUv>& uvs) {
    if (params.texture(name)) {
        const PbrtTexture* texture = named(params, name, true);
        if (!texture) return void(property.number(0.5));
        addUvs(uvs, texture->uvs);
        if (!texture->isPlain) return void(property.name(texture->word));
        PbrtSpectrum plain = texture->plain;
        plain.rgb = min(plain.rgb, Vec3d(1, 1, 1));
        plain.value = std::min(plain.value, 1.0);
        return plain.write(property, PbrtUse::albedo);
    }
    const PbrtParam* param = params.find(name);
    const auto spectrum = param ? pbrtSpectrum(*param, PbrtUse::albedo, shared_) : std::nullopt;
    (spectrum ? *spectrum : absent).write(property, PbrtUse::albedo);
}

void PbrtTextures::writeMapped(SceneNode& property, const PbrtTexture& texture, std::span<const Vec2d> stops) {
    SceneNode& ramp = property.word("ramp");
    ramp.child("input").name(texture.word);
    for (const Vec2d& stop : stops) {
        const double at = stop.x / texture.factor;
        ramp.child("stop").number(std::min(at, 1.0)).number(stop.y);
        if (at >= 1) break;
    }
}

void PbrtTextures::writeNumber(SceneNode& property, const PbrtParams& params, std::string_view name, double absent,
                               std::vector<PbrtUv>& uvs) {
    if (!params.texture(name))
        return void(property.number(std::clamp(params.number(name, absent, shared_.faults()), 0.0, 1.0)));
    const PbrtTexture* texture = named(params, name, false);
    if (!texture) return void(property.number(absent));
    addUvs(uvs, texture->uvs);
    if (texture->isPlain) return void(property.number(std::clamp(texture->plain.value, 0.0, 1.0)));
    if (texture->factor == 1) return void(property.name(texture->word));
    if (texture->factor > 1) {
        const Vec2d stops[] = {{0, 0}, {1, 1}};
        return writeMapped(property, *texture, stops);
    }
    SceneNode& product = property.word("product");
    product.child("first").name(texture->word);
    product.child("second").number(std::max(texture->factor, 0.0));
}

} // namespace abbe::exchange
