#include "media/phase_types.h"

#include "base/check.h"
#include "media/draine.h"
#include "media/henyey_greenstein.h"

namespace abbe {

namespace {

struct NoParams {};
struct HenyeyGreensteinParams {
    double g = 0;
};
struct DraineParams {
    double g = 0, alpha = 1;
};

template <typename P> schema::FieldInfo asymmetry() {
    return schema::field<P, double>(schema::FieldType::number, "g", &P::g)
        .range(-0.9999, 0.9999)
        .byDefault("0")
        .argument(0)
        .synonyms({"anisotropy", "asymmetry", "eccentricity"})
        .doc("Mean cosine of the turn: 0 scatters evenly, above it forward, below backward.")
        .example("g 0.85");
}

template <typename P> bool fill(const std::function<bool(void*)>& bind, P& params) { return bind(&params); }

} // namespace

std::vector<schema::TypeInfo> phaseTypes() {
    using namespace schema;
    return {
        {Kind::phase, "isotropic", "Scatters evenly into all directions.", "phase even isotropic", false, {}},
        {Kind::phase,
         "henyey-greenstein",
         "One lobe, forward or backward: smoke, cloud.",
         "phase cloud henyey-greenstein 0.85",
         false,
         {asymmetry<HenyeyGreensteinParams>()}},
        {Kind::phase,
         "rayleigh",
         "Particles far smaller than the wavelength: clean air.",
         "phase air rayleigh",
         false,
         {}},
        {Kind::phase,
         "draine",
         "Henyey-Greenstein times 1 + alpha cos²: dust and small drops.",
         "phase dust draine { g 0.6; alpha 0.5 }",
         false,
         {asymmetry<DraineParams>(), field(FieldType::number, "alpha", &DraineParams::alpha)
                                         .range(0, 1e6)
                                         .byDefault("1")
                                         .doc("Weight of cos²; 0 is Henyey-Greenstein, 1 with g 0 is Rayleigh.")
                                         .example("alpha 0.5")}},
    };
}

std::shared_ptr<const PhaseFunction> makePhase(std::string_view type, const std::function<bool(void*)>& bind) {
    if (NoParams none; type == "isotropic" || type == "rayleigh") {
        if (!fill(bind, none)) return nullptr;
        if (type == "isotropic") return std::make_shared<HenyeyGreenstein>(0);
        return std::make_shared<Draine>(0, 1);
    }
    if (HenyeyGreensteinParams p; type == "henyey-greenstein")
        return fill(bind, p) ? std::make_shared<HenyeyGreenstein>(p.g) : nullptr;
    if (DraineParams p; type == "draine") return fill(bind, p) ? std::make_shared<Draine>(p.g, p.alpha) : nullptr;
    ABBE_CHECK(!"a registered phase function");
    return nullptr;
}

} // namespace abbe
