#include "exchange/obj/mtl.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>

namespace abbe::exchange {

namespace {

constexpr double kUsualMtlIndex = 1.5;

// What is computed is as exact as what is stated: nobody wants to read more.
double inFourDigits(double v) { return std::round(v * 1e4) / 1e4; }

// The exponent of a highlight as the width α of the microfacets that have one as wide [Walter2007], and α as roughness.
double roughnessOfExponent(double exponent) {
    return inFourDigits(std::sqrt(std::sqrt(2 / (std::max(exponent, 0.0) + 2))));
}

Vec3d asReflectance(const Vec3d& c) {
    return {std::clamp(c.x, 0.0, 1.0), std::clamp(c.y, 0.0, 1.0), std::clamp(c.z, 0.0, 1.0)};
}

Vec3d scaledReflectance(const Vec3d& c, double factor) {
    if (factor == 1) return asReflectance(c);
    return asReflectance({inFourDigits(c.x * factor), inFourDigits(c.y * factor), inFourDigits(c.z * factor)});
}

void writeMtlColor(SceneNode& at, const Vec3d& c) {
    if (c.x == c.y && c.y == c.z)
        at.number(c.x);
    else
        at.word("rgb").vector(c);
}

// Writes one material.
class MtlWriter {
  public:
    MtlWriter(const MtlMaterial& m, const MtlSurface& surface, Import& import)
        : m_(m), surface_(surface), import_(import),
          illum_(static_cast<int>(std::clamp(m.number("illum", -1), -1.0, 100.0))) {}

    void write(SceneNode& at);
    void writeEmission(SceneNode& shape);

  private:
    bool isPhysical() const;
    double opacity() const;
    double glassShare() const;
    bool emits() const {
        const auto ke = m_.values.find("ke");
        return m_.maps.contains("map_ke") || (ke != m_.values.end() && ke->second.largest() > 0);
    }
    double index() const { return std::clamp(m_.number("ni", kUsualMtlIndex), 1.0, 4.0); }
    Vec3d color(std::string_view keyword, const Vec3d& otherwise);

    void picture(SceneNode& at, const MtlMap&, bool data);
    void coloured(SceneNode& at, std::string_view keyword, const Vec3d& factor);
    void matte(SceneNode& at, std::string_view property, double scale);
    void roughness(SceneNode& at, std::string property);
    void number(SceneNode& at, const char* property, const char* keyword, const char* map);

    void physical(SceneNode& at);
    void glass(SceneNode& at, double share);
    void mirror(SceneNode& at, double strength);
    void glossy(SceneNode& at);
    void surfaceOf(SceneNode& at);
    void normals(SceneNode& at);

    const MtlMaterial& m_;
    const MtlSurface& surface_;
    Import& import_;
    int illum_;
};

// Whether it says anything of the extension for physically based materials.
bool MtlWriter::isPhysical() const {
    return std::ranges::any_of(std::to_array<std::string_view>(
                                   {"pr", "pm", "ps", "pc", "pcr", "aniso", "anisor", "map_pr", "map_pm", "map_ps"}),
                               [&](std::string_view keyword) { return m_.has(keyword); });
}

double MtlWriter::opacity() const {
    const double d = m_.values.contains("d") ? m_.number("d", 1) : 1 - m_.number("tr", 0);
    return std::clamp(d, 0.0, 1.0);
}

// How much of the surface is glass. Some programs write `illum 4` for everything, so that one says little: glass bends
// light (`Ni`), and is not opaque (`d`) or has a colour (`Tf`).
double MtlWriter::glassShare() const {
    const bool refracts = illum_ == 6 || illum_ == 7, clear = illum_ == 4 || illum_ == 9;
    if ((!refracts && !clear) || m_.maps.contains("map_d")) return 0;
    if (m_.number("ni", refracts ? kUsualMtlIndex : 1) <= 1) return 0;
    const double share = 1 - opacity();
    if (share > 0) return share > 0.949 ? 1 : inFourDigits(share);
    return refracts || m_.values.contains("tf") ? 1 : 0;
}

Vec3d MtlWriter::color(std::string_view keyword, const Vec3d& otherwise) {
    const auto found = m_.values.find(keyword);
    if (found == m_.values.end()) return otherwise;
    const Vec3d& c = found->second.rgb;
    const Vec3d clamped = asReflectance(c);
    if (clamped != c)
        import_.approximated(nullptr, found->second.span, fmt::format("a colour of {} {} {}", c.x, c.y, c.z),
                             "a surface reflects no more than 1 and no less than 0");
    return clamped;
}

void MtlWriter::picture(SceneNode& at, const MtlMap& map, bool data) {
    if (map.channel == 'm' || map.channel == 'z')
        import_.leftOut(nullptr, map.span, fmt::format("`-imfchan {}`", map.channel),
                        "the colours of a picture are read; its first channel stands for it");
    SceneNode* inner = &at;
    if (data && (map.channel == 'g' || map.channel == 'b')) {
        at.word("channel").child("take").word(map.channel == 'g' ? "green" : "blue");
        inner = &at.child("of");
    }
    if (map.scale[0] != 1 || map.scale[1] != 1 || map.offset[0] != 0 || map.offset[1] != 0) {
        inner->word("placed");
        SceneNode& placed = inner->child("map");
        if (map.scale[0] != 1 || map.scale[1] != 1) inner->child("scale").number(map.scale[0]).number(map.scale[1]);
        if (map.offset[0] != 0 || map.offset[1] != 0)
            inner->child("offset").number(map.offset[0]).number(map.offset[1]);
        inner = &placed;
    }
    inner->word("image").text(import_.files.refer(map.path));
    if (data) inner->key("space", "data");
    if (map.clamp) inner->child("wrap").word("clamp");
}

// A colour times the picture of the same quantity, if there is one.
void MtlWriter::coloured(SceneNode& at, std::string_view keyword, const Vec3d& factor) {
    const MtlMap* const map = m_.map(fmt::format("map_{}", keyword));
    if (!map) return writeMtlColor(at, factor);
    if (factor == Vec3d(1, 1, 1)) return picture(at, *map, false);
    at.word("product");
    writeMtlColor(at.child("first"), factor);
    picture(at.child("second"), *map, false);
}

// Some programs write a black `Kd` beside a picture; a product with it would be black.
void MtlWriter::matte(SceneNode& at, std::string_view property, double scale) {
    const bool mapped = m_.maps.contains("map_kd");
    Vec3d kd = color("kd", mapped ? Vec3d(1, 1, 1) : Vec3d(0.5, 0.5, 0.5));
    if (mapped && kd == Vec3d(0, 0, 0)) {
        import_.approximated(nullptr, m_.values.at("kd").span, "`Kd 0` with a `map_Kd`",
                             "the picture alone; their product would be black");
        kd = {1, 1, 1};
    }
    coloured(at.child(std::string(property)), "kd", scaledReflectance(kd, scale));
}

void MtlWriter::roughness(SceneNode& at, std::string property) {
    const double exponent = m_.number("ns", 0);
    const MtlMap* const map = m_.map("map_ns");
    SceneNode& node = at.child(std::move(property));
    if (!map) {
        node.number(roughnessOfExponent(exponent));
        return;
    }
    const double most = m_.values.contains("ns") ? exponent : 1;
    node.word("ramp");
    picture(node.child("input"), *map, true);
    constexpr int kStops = 12; // closer where the curve is steeper
    for (int i = 0; i <= kStops; ++i) {
        const double x = static_cast<double>(i * i) / (kStops * kStops);
        node.child("stop").number(x).number(roughnessOfExponent(most * x));
    }
}

void MtlWriter::number(SceneNode& at, const char* property, const char* keyword, const char* map) {
    const MtlMap* const factor = m_.map(map);
    const double value = std::clamp(m_.number(keyword, factor ? 1 : 0), 0.0, 1.0);
    if (!factor && !m_.values.contains(keyword)) return;
    SceneNode& node = at.child(property);
    if (!factor) {
        node.number(value);
    } else if (value == 1) {
        picture(node, *factor, true);
    } else {
        node.word("product");
        node.child("first").number(value);
        picture(node.child("second"), *factor, true);
    }
}

void MtlWriter::physical(SceneNode& at) {
    at.word("openpbr");
    matte(at, "base-color", 1);
    number(at, "base-metalness", "pm", "map_pm");
    number(at, "specular-roughness", "pr", "map_pr");
    if (m_.values.contains("ni")) at.child("specular-ior").number(index());
    number(at, "specular-roughness-anisotropy", "aniso", "");
    if (m_.values.contains("anisor"))
        at.child("geometry-tangent").number(std::clamp(m_.number("anisor", 0), -1.0, 1.0));
    number(at, "fuzz-weight", "ps", "map_ps");
    number(at, "coat-weight", "pc", "");
    number(at, "coat-roughness", "pcr", "");
    if (const double share = glassShare(); share > 0) {
        at.child("transmission-weight").number(share);
        if (m_.values.contains("tf")) writeMtlColor(at.child("transmission-color"), color("tf", {1, 1, 1}));
    }
}

void MtlWriter::glass(SceneNode& at, double share) {
    const Vec3d tint = color("tf", {1, 1, 1});
    if (share >= 1 && tint == Vec3d(1, 1, 1)) {
        at.word("dielectric").child("ior").number(index());
        return;
    }
    at.word("openpbr");
    if (share < 1) matte(at, "base-color", 1);
    at.child("specular-roughness").number(0);
    at.child("specular-ior").number(index());
    at.child("transmission-weight").number(share);
    if (tint != Vec3d(1, 1, 1)) writeMtlColor(at.child("transmission-color"), tint);
}

// Kd + Ks without Fresnel's factor: a metal of colour Ks / w on a share w of the surface, and Kd / (1 − w) on the rest.
void MtlWriter::mirror(SceneNode& at, double strength) {
    const auto metal = [&](SceneNode& node, double share) {
        node.word("openpbr");
        coloured(node.child("base-color"), "ks", scaledReflectance(color("ks", {1, 1, 1}), 1 / share));
        node.child("base-metalness").number(1);
        roughness(node, "specular-roughness");
    };
    const auto kd = m_.values.find("kd");
    const double matteShare = kd == m_.values.end() ? 0.5 : std::clamp(kd->second.largest(), 0.0, 1.0);
    if (matteShare == 0 && !m_.maps.contains("map_kd")) return metal(at, 1);
    const double share = strength / (strength + std::max(matteShare, 1e-3));
    if (strength + matteShare > 1)
        import_.approximated(&at, m_.span, "`Kd` and `Ks`", "they reflect no more than 1 together");
    at.word("mix");
    SceneNode& first = at.child("first").word("diffuse");
    matte(first, "reflectance", 1 / (1 - share));
    metal(at.child("second"), share);
    at.child("amount").number(inFourDigits(share));
}

// Ks times a highlight is the gloss of a dielectric of the index `Ni`, all of it where Ks is 1.
void MtlWriter::glossy(SceneNode& at) {
    const Vec3d ks = color("ks", {1, 1, 1});
    const double weight = std::max({ks.x, ks.y, ks.z});
    at.word("openpbr");
    matte(at, "base-color", 1);
    if (weight < 1) at.child("specular-weight").number(weight);
    if (const Vec3d tint = scaledReflectance(ks, 1 / weight); m_.maps.contains("map_ks") || tint != Vec3d(1, 1, 1))
        coloured(at.child("specular-color"), "ks", tint);
    roughness(at, "specular-roughness");
    const double ni = m_.number("ni", kUsualMtlIndex);
    at.child("specular-ior").number(ni > 1 ? std::min(ni, 4.0) : kUsualMtlIndex);
}

void MtlWriter::surfaceOf(SceneNode& at) {
    const bool highlights = (illum_ < 0 || illum_ >= 2) && m_.has("ks");
    const auto ks = m_.values.find("ks");
    const double strength = ks == m_.values.end() ? 1 : std::clamp(ks->second.largest(), 0.0, 1.0);
    if (isPhysical()) return physical(at);
    if (const double share = glassShare(); share > 0) return glass(at, share);
    if (highlights && strength > 0) return illum_ == 3 || illum_ == 8 ? mirror(at, strength) : glossy(at);
    at.word("diffuse");
    matte(at, "reflectance", 1);
}

// Whether a picture of heights is one of normals, which many programs name `map_Bump`: by its name alone.
bool isNormalMapByName(const MtlMap& map) {
    std::string name = map.path.stem().string();
    for (char& c : name)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return name.find("normal") != std::string::npos || name.find("nrm") != std::string::npos ||
           name.find("ddn") != std::string::npos || name.ends_with("_n") || name.ends_with("_nor");
}

void MtlWriter::normals(SceneNode& at) {
    const auto normal = [&](const MtlMap& map) {
        SceneNode& node = at.child("normal");
        picture(node, map, true);
        if (map.bump != 1) node.key("strength", map.bump);
    };
    const MtlMap* const bump = m_.map("map_bump");
    if (const MtlMap* const norm = m_.map("norm")) normal(*norm);
    if (!bump) return;
    if (isNormalMapByName(*bump) && !m_.maps.contains("norm")) {
        import_.approximated(&at, bump->span, "`map_Bump`", "its name says that it holds normals, not heights");
        return normal(*bump);
    }
    constexpr double kUsualHeight = 0.002; // of the model
    const double digits = std::pow(10.0, std::ceil(std::log10(std::max(surface_.size, 1e-12))) - 5);
    const double height =
        std::clamp(std::round(bump->bump * kUsualHeight * surface_.size / digits) * digits, -1e9, 1e9);
    import_.approximated(&at, bump->span, "`map_Bump`",
                         "the format does not say how high it is; 0.2 % of the model, times `-bm`");
    SceneNode& node = at.child("bump").number(height).word("m");
    picture(node.child("map"), *bump, true);
}

void MtlWriter::write(SceneNode& at) {
    surfaceOf(at);
    normals(at);
    if (illum_ == 0)
        import_.approximated(&at, m_.values.at("illum").span, "`illum 0`",
                             "a matte surface, in the light of the scene");
    if (illum_ == 10)
        import_.leftOut(&at, m_.values.at("illum").span, "`illum 10`", "what only takes shadows is shown as it is");
    const bool clear = glassShare() > 0;
    const MtlMap* const mask = m_.map("map_d");
    const MtlMap* const colors = m_.map("map_kd");
    if (emits() && (mask || (!clear && opacity() < 1)))
        import_.leftOut(&at, m_.span, "`d` beside `Ke`", "what emits light is opaque");
    else if (mask && colors && mask->path == colors->path && mask->channel == 0)
        import_.leftOut(&at, mask->span, "`map_d`", "it is the picture of `map_Kd`, whose alpha is not read");
    else if (mask)
        number(at, "opacity", "d", "map_d");
    else if (!clear && opacity() < 1)
        at.child("opacity").number(inFourDigits(opacity()));
}

void MtlWriter::writeEmission(SceneNode& shape) {
    if (!emits()) return;
    const auto found = m_.values.find("ke");
    const MtlMap* const map = m_.map("map_ke");
    Vec3d ke = found == m_.values.end() ? Vec3d() : max(found->second.rgb, Vec3d());
    if (ke == Vec3d()) ke = {1, 1, 1}; // written by programs that mean the picture
    if (!map) {
        writeMtlColor(shape.child("emission"), ke);
        return;
    }
    if (asReflectance(ke) != ke)
        import_.approximated(&shape, found->second.span, "`Ke` above 1 with a `map_Ke`",
                             "1 times the picture; `emission-luminance` of `openpbr` is brighter");
    coloured(shape.child("emission"), "ke", asReflectance(ke));
}

MtlMaterial withoutMtlPictures(MtlMaterial m, Import& import) {
    if (!m.maps.empty())
        import.leftOut(nullptr, m.maps.begin()->second.span, fmt::format("the pictures of `{}`", m.name),
                       "the faces have no texture coordinates");
    m.maps.clear();
    return m;
}

} // namespace

void writeMtlMaterial(SceneNode& at, MtlMaterial material, const MtlSurface& surface, Import& import) {
    if (!surface.textured) material = withoutMtlPictures(std::move(material), import);
    MtlWriter(material, surface, import).write(at);
}

void writeMtlEmission(SceneNode& shape, const MtlMaterial& material, const MtlSurface& surface, Import& import) {
    MtlMaterial m = material;
    if (!surface.textured) m.maps.clear();
    MtlWriter(m, surface, import).writeEmission(shape);
}

} // namespace abbe::exchange
