#include "materials/hair.h"

#include "materials/fresnel.h"
#include "render/surface_input.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

Spectrum power(const Wavelengths& lambda, float atGreen, float exponent) {
    return exp(log(Spectrum(550.f) / lambda.nm) * exponent) * atGreen;
}

// Of many fibres that show this colour together, a fit to simulated hair [Chiang2016, eq. 9].
Spectrum absorptionOfColor(Spectrum color, float bn) {
    const float scale = 5.969f + bn * (-0.215f + bn * (2.532f + bn * (-10.73f + bn * (5.574f + bn * 0.245f))));
    const Spectrum root = log(max(color, Spectrum(1e-4f))) / scale; // darker is the same black
    return root * root;
}

class Hair final : public Material {
  public:
    explicit Hair(const HairParams& p)
        : eumelanin_(p.eumelanin, 0, kMostMelanin), pheomelanin_(p.pheomelanin, 0, kMostMelanin),
          absorption_(p.absorption), color_(p.color, 1), longitudinal_(p.longitudinalRoughness, 0, 1),
          azimuthal_(p.azimuthalRoughness, 0, 1) {
        fibre_.eta = static_cast<float>(p.ior);
        fibre_.sinScale = static_cast<float>(std::sin(p.scaleAngle));
        fibre_.cosScale = static_cast<float>(std::cos(p.scaleAngle));
        traits_ = {
            .needs = Effect::interfaces,
            .reversible = false,
            .focuses = false,
            .usesTextures = eumelanin_.textured() || pheomelanin_.textured() || color_.textured() ||
                            longitudinal_.textured() || azimuthal_.textured(),
            .mayBeOpen = true,
        };
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        HairBsdf::Fibre fibre = fibre_;
        fibre.h = 1 - 2 * hit.uv.y; // curves: v runs along x × wo
        const float bn = azimuthal_.at(hit);
        fibre.variance = hairVariance(longitudinal_.at(hit));
        fibre.width = hairAzimuthalWidth(bn);
        if (absorption_) fibre.absorption = absorption_->at(lambda);
        if (!color_.absent()) fibre.absorption = absorptionOfColor(color_.at(hit, lambda), bn);
        if (const float c = eumelanin_.at(hit); c > 0) fibre.absorption += eumelaninAbsorption(lambda) * c;
        if (const float c = pheomelanin_.at(hit); c > 0) fibre.absorption += pheomelaninAbsorption(lambda) * c;
        return arena.make<HairBsdf>(fibre);
    }
    // All that happens in a fibre has happened where light hit it from outside: on its way out of a tube it goes on.
    float opacity(const SurfaceHit& hit) const noexcept override { return dot(hit.arrival, hit.ng) > 0 ? 0.f : 1.f; }

    static constexpr float kMostMelanin = 100;

  private:
    NumberInput eumelanin_, pheomelanin_;
    const Curve* absorption_; // null: none
    SpectrumInput color_;
    NumberInput longitudinal_, azimuthal_;
    HairBsdf::Fibre fibre_; // what is the same everywhere
};

} // namespace

Spectrum eumelaninAbsorption(const Wavelengths& lambda) { return power(lambda, 0.697f, 3.33f); }
Spectrum pheomelaninAbsorption(const Wavelengths& lambda) { return power(lambda, 0.4f, 4.75f); }

namespace {

using namespace schema;

std::vector<FieldInfo> pigmentFields() {
    return {
        field(FieldType::number, "eumelanin", &HairParams::eumelanin)
            .doc("Concentration of black and brown pigment: 0.3 blond, 1.3 brown, 8 black; none: white hair.")
            .example("eumelanin 1.3")
            .range(0, Hair::kMostMelanin)
            .byDefault("0")
            .synonyms({"melanin", "melanin_concentration"}),
        field(FieldType::number, "pheomelanin", &HairParams::pheomelanin)
            .doc("Concentration of red pigment.")
            .example("pheomelanin 0.8")
            .range(0, Hair::kMostMelanin)
            .byDefault("0")
            .synonyms({"melanin_redness"}),
        field(FieldType::spectrum, "absorption", &HairParams::absorption)
            .doc("Absorption by a dye, besides pigment: coefficient times the radius of the fibre.")
            .example("absorption table { - 400 0.2; - 700 3 }")
            .role(SpectrumRole::unbounded)
            .range(0, 1e6)
            .group("dye")
            .synonyms({"sigma_a", "absorption_coefficient"}),
        field(FieldType::spectrum, "color", &HairParams::color)
            .doc("Dye, as the colour of a head of hair, instead of absorption; below 0.0001 it is that.")
            .example("color rgb 0.5 0.1 0.3")
            .role(SpectrumRole::albedo)
            .range(0, 1)
            .group("dye")
            .synonyms({"reflectance", "base_color", "tint"}),
    };
}

std::vector<FieldInfo> shapeFields() {
    return {
        field(FieldType::number, "ior", &HairParams::ior)
            .doc("Refractive index of the fibre.")
            .example("ior 1.55")
            .range(1.05, 3)
            .byDefault("1.55")
            .synonyms({"eta", "index"}),
        field(FieldType::number, "longitudinal-roughness", &HairParams::longitudinalRoughness)
            .doc("Width of the highlights along the fibre (βm).")
            .example("longitudinal-roughness 0.2")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0.3")
            .synonyms({"beta_m", "roughness"})
            .note("below 0.0135 it is that"),
        field(FieldType::number, "azimuthal-roughness", &HairParams::azimuthalRoughness)
            .doc("Width of the highlights around the fibre (βn).")
            .example("azimuthal-roughness 0.4")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0.3")
            .synonyms({"beta_n", "radial_roughness"})
            .note("below 0.006 it is that"),
        field(FieldType::quantity, "scale-angle", &HairParams::scaleAngle)
            .doc("By how much the scales stand off; curves run from root to tip.")
            .example("scale-angle 3 deg")
            .unit({Dimension::angle})
            .range(-0.5, 0.5)
            .byDefault("2 deg")
            .synonyms({"alpha", "offset"}),
    };
}

} // namespace

schema::TypeInfo hairType() {
    std::vector<FieldInfo> fields = pigmentFields();
    for (FieldInfo& f : shapeFields()) fields.push_back(std::move(f));
    return {.kind = Kind::material,
            .name = "hair",
            .doc = "Hair and fur, for curves: a fibre that reflects, lets light through and reflects it inside.",
            .example = "material brown hair { eumelanin 1.3; pheomelanin 0.2 }",
            .fields = std::move(fields)};
}

std::unique_ptr<const Material> makeHair(const HairParams& params) { return std::make_unique<Hair>(params); }

namespace {

// e^-x I0(x) for x >= 0: finite where I0 is not [Abramowitz1964, 9.8.1 and 9.8.2]; relative error 2e-7.
float besselI0Scaled(float x) {
    if (x < 3.75f) {
        const float t = x / 3.75f, t2 = t * t;
        const float i0 =
            1 + t2 * (3.5156229f +
                      t2 * (3.0899424f + t2 * (1.2067492f + t2 * (0.2659732f + t2 * (0.0360768f + t2 * 0.0045813f)))));
        return std::exp(-x) * i0;
    }
    const float t = 3.75f / x;
    const float p =
        0.39894228f +
        t * (0.01328592f +
             t * (0.00225319f +
                  t * (-0.00157565f +
                       t * (0.00916281f +
                            t * (-0.02057706f + t * (0.02635537f + t * (-0.01647633f + t * 0.00392377f)))))));
    return p / std::sqrt(x);
}

float cosineAcross(Vec3 w) { return std::min(std::sqrt(w.y * w.y + w.z * w.z), 1.f); }

// To [-π, π].
float wrapped(float angle) { return std::remainder(angle, 2 * kPi); }

// The logistic distribution on [-π, π]: sech²(x / 2s) / (4 s tanh(π / 2s)) [Chiang2016, sec. 3.3].
float azimuthalDensity(float x, float s) {
    const float e = std::exp(-std::abs(x) / s);
    return e / (s * (1 + e) * (1 + e) * std::tanh(kPi / (2 * s)));
}
float sampleAzimuth(float u, float s) {
    const float t = std::clamp(2 * u - 1, -kOneMinusEpsilon, kOneMinusEpsilon);
    return std::clamp(2 * s * std::atanh(t * std::tanh(kPi / (2 * s))), -kPi, kPi);
}

// The inclination's sine for a density of hairLongitudinal() [dEon2013]: about the cone's axis turned to -θo it is
// 1 - cos of an exponentially distributed angle.
float sampleInclination(float sinO, float cosO, float v, float u, float uTurn) {
    const float lowered = -v * std::log((1 - u) + u * std::exp(-2 / v)); // 1 - cos θ'
    const float sine = safeSqrt(lowered * (2 - lowered));
    return std::clamp((lowered - 1) * sinO + sine * std::cos(2 * kPi * uTurn) * cosO, -1.f, 1.f);
}

} // namespace

// [dEon2011, eq. 7] is e^-b I0(a) / (2 v sinh(1/v)) with a = cosθi cosθo / v and b = sinθi sinθo / v. The exponents are
// put together before they overflow: a - b - 1/v = (cos(θi + θo) - 1) / v, from differences that keep their digits.
float hairLongitudinal(float sinI, float cosI, float sinO, float cosO, float v) {
    const float dc = cosI - cosO, ds = sinI + sinO;
    return std::exp(-(dc * dc + ds * ds) / (2 * v)) * besselI0Scaled(cosI * cosO / v) / (v * -std::expm1(-2 / v));
}

float hairVariance(float b) {
    const float b4 = b * b * b * b, b8 = b4 * b4, b20 = b8 * b8 * b4;
    const float deviation = 0.726f * b + 0.812f * b * b + 3.7f * b20;
    return std::max(deviation * deviation, 1e-4f);
}

float hairAzimuthalWidth(float b) {
    const float b2 = b * b, b4 = b2 * b2, b16 = b4 * b4 * b4 * b4, b22 = b16 * b4 * b2;
    return std::max(0.626657069f * (0.265f * b + 1.194f * b2 + 5.372f * b22), 1e-3f); // √(π/8)
}

HairBsdf::HairBsdf(const Fibre& fibre) : fibre_(fibre) {
    constexpr float edge = 1 - 1e-6f; // beyond, the light would only touch the fibre
    fibre_.h = std::clamp(fibre.h, -edge, edge);
    gammaO_ = std::asin(fibre_.h);
}

std::array<HairBsdf::Order, HairBsdf::kOrders> HairBsdf::orders(Vec3 wo) const {
    const float sinO = std::clamp(wo.x, -1.f, 1.f), cosO = cosineAcross(wo), h = fibre_.h;
    // Across the fibre the index is η' = √(η² - sin²θo) / cosθo [Marschner2003, app. B].
    const float root = std::sqrt(fibre_.eta * fibre_.eta - sinO * sinO);
    const float sinGammaT = std::clamp(h * cosO / root, -1.f, 1.f), cosGammaT = safeSqrt(1 - sinGammaT * sinGammaT);
    const float gammaT = std::asin(sinGammaT), cosThetaT = root / fibre_.eta;
    const float f = fresnelDielectric(cosO * safeSqrt((1 - h) * (1 + h)), fibre_.eta);
    const Spectrum passed = exp(fibre_.absorption * (-2 * cosGammaT / cosThetaT));

    std::array<Order, kOrders> result;
    result[0].share = Spectrum(f);
    result[1].share = passed * ((1 - f) * (1 - f));
    result[2].share = result[1].share * passed * f;
    // The rest is a geometric series; f = 1 lets nothing in.
    const Spectrum inside = passed * f;
    result[3].share = result[2].share * inside / max(Spectrum(1.f) - inside, Spectrum(1e-7f));

    // Scales lean towards the tip, so their normals lean to the root by α: reflection turns the cone by 2α, each
    // passage by α back, each reflection inside by 2α more.
    const float sa = fibre_.sinScale, ca = fibre_.cosScale, s2 = 2 * sa * ca, c2 = ca * ca - sa * sa;
    const float s4 = 2 * s2 * c2, c4 = c2 * c2 - s2 * s2;
    const float sines[kOrders] = {s2, -sa, -s4, 0}, cosines[kOrders] = {c2, ca, c4, 1};
    const float variances[kOrders] = {1, 0.25f, 4, 4}; // [Chiang2016, sec. 3.2]
    float total = 0;
    for (int p = 0; p < kOrders; ++p) {
        Order& o = result[static_cast<std::size_t>(p)];
        o.sinO = std::clamp(sinO * cosines[p] + cosO * sines[p], -1.f, 1.f);
        o.cosO = std::abs(cosO * cosines[p] - sinO * sines[p]);
        o.variance = std::max(variances[p] * fibre_.variance, 1e-4f);
        o.azimuth = static_cast<float>(p) * (2 * gammaT + kPi) - 2 * gammaO_; // [Marschner2003, eq. 3]
        o.chance = mean(o.share);
        total += o.chance;
    }
    for (Order& o : result) o.chance /= total; // f > 0: not 0
    return result;
}

BsdfEval HairBsdf::evalOrders(const std::array<Order, kOrders>& orders, Vec3 wo, Vec3 wi) const {
    const float sinI = std::clamp(wi.x, -1.f, 1.f), cosI = cosineAcross(wi);
    const float turn = std::atan2(wi.z, wi.y) - std::atan2(wo.z, wo.y);
    BsdfEval e;
    for (int p = 0; p < kOrders; ++p) {
        const Order& o = orders[static_cast<std::size_t>(p)];
        const float across =
            p == kOrders - 1 ? 1 / (2 * kPi) : azimuthalDensity(wrapped(turn - o.azimuth), fibre_.width);
        const float density = hairLongitudinal(sinI, cosI, o.sinO, o.cosO, o.variance) * across;
        e.fcos = fma(o.share, Spectrum(density), e.fcos);
        e.pdfSolidAngle += o.chance * density;
    }
    return e;
}

BsdfEval HairBsdf::eval(Vec3 wo, Vec3 wi, Transport) const noexcept { return evalOrders(orders(wo), wo, wi); }

std::optional<BsdfSample> HairBsdf::sample(Vec3 wo, float uLobe, Vec2 u, Transport) const noexcept {
    const auto all = orders(wo);
    std::size_t p = 0;
    while (p < kOrders - 1 && uLobe >= all[p].chance) uLobe -= all[p++].chance;
    const Order& o = all[p];
    // What is left of the number that chose is a number again.
    const float uTurn = o.chance > 0 ? std::clamp(uLobe / o.chance, 0.f, kOneMinusEpsilon) : 0;
    const float sinI = sampleInclination(o.sinO, o.cosO, o.variance, u.x, uTurn);
    const float turn = p == kOrders - 1 ? 2 * kPi * u.y : o.azimuth + sampleAzimuth(u.y, fibre_.width);
    const float phi = std::atan2(wo.z, wo.y) + turn, cosI = safeSqrt((1 - sinI) * (1 + sinI));
    const Vec3 wi{sinI, cosI * std::cos(phi), cosI * std::sin(phi)};
    const BsdfEval e = evalOrders(all, wo, wi);
    if (!(e.pdfSolidAngle > 0)) return std::nullopt;
    const bool reflected = wo.z * wi.z > 0;
    return std::optional<BsdfSample>(std::in_place, wi, e.fcos / e.pdfSolidAngle, e.pdfSolidAngle,
                                     Lobes(Lobe::glossy) | (reflected ? Lobe::reflection : Lobe::transmission));
}

} // namespace abbe
