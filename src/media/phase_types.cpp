#include "media/phase_types.h"

#include "media/mie_phase.h"
#include "media/phase_functions.h"

namespace abbe {

namespace {

template <typename P> schema::FieldInfo asymmetry() {
    return schema::field<P, double>(schema::FieldType::number, "g", &P::g)
        .range(-0.9999, 0.9999)
        .byDefault("0")
        .argument(0)
        .synonyms({"anisotropy", "asymmetry", "eccentricity"})
        .doc("Mean cosine of the turn: 0 scatters evenly, above it forward, below backward.")
        .example("g 0.85");
}

} // namespace

schema::TypeInfo miePhaseType() {
    using namespace schema;
    using P = MiePhaseParams;
    return {
        Kind::phase,
        "mie",
        "Drops and dust by Lorenz-Mie theory: corona, fogbow, glory, at every wavelength.",
        "phase fog mie { radius 8 um; spread 0.2 }",
        false,
        {field(FieldType::quantity, "radius", &P::radius)
             .unit({Dimension::length})
             .range(1e-9, 200e-6)
             .byDefault("10 um")
             .argument(0)
             .synonyms({"effective_radius", "size", "diameter"})
             .note("larger drops are rain: they need geometric optics")
             .doc("Effective radius of the spheres: the mean, weighed by cross-section.")
             .example("radius 8 um"),
         field(FieldType::number, "spread", &P::spread)
             .unit({Dimension::none, Dimension::fraction})
             .range(0, 1)
             .byDefault("0.2")
             .synonyms({"variance", "sigma", "effective_variance"})
             .doc("Standard deviation of the lognormal radii over their mean, weighed in the same way; 0: all alike.")
             .example("spread 0.15"),
         field(FieldType::spectrum, "ior", &P::index)
             .role(SpectrumRole::index)
             .range(0.05, 20)
             .byDefault("glass water")
             .synonyms({"eta", "index", "refractive_index"})
             .doc("Refractive index of the spheres.")
             .example("ior 1.46"),
         field(FieldType::spectrum, "k", &P::absorption)
             .role(SpectrumRole::unbounded)
             .range(0, 20)
             .byDefault("0")
             .synonyms({"absorption", "extinction"})
             .doc("Imaginary part of their refractive index. It shapes scattering; the albedo is the medium's.")
             .example("k 0.01"),
         field(FieldType::spectrum, "surroundings", &P::surroundings)
             .role(SpectrumRole::index)
             .range(0.05, 20)
             .byDefault("1")
             .synonyms({"ior_medium", "outside"})
             .doc("Refractive index of what the spheres are in; `glass water` for fat in milk.")
             .example("surroundings glass water")}};
}

schema::TypeInfo tablePhaseType() {
    using namespace schema;
    using P = TablePhaseParams;
    return {Kind::phase,
            "table",
            "Values at angles from 0 to 180 degrees, from measurement or another program.",
            "phase measured table { values { - 0 40; - 10 4; - 60 0.3; - 180 0.5 } }",
            false,
            {field(FieldType::file, "file", &P::file)
                 .group("values")
                 .required()
                 .argument(0)
                 .synonyms({"filename"})
                 .doc("A text file with an angle and a value on each line.")
                 .example("file \"phase.csv\""),
             field(FieldType::table, "values", &P::values)
                 .group("values")
                 .required()
                 .doc("Rows of an angle of scattering in degrees (0 goes straight on) and a relative value; linear in "
                      "the cosine between.")
                 .example("values { - 0 40; - 10 4; - 60 0.3; - 180 0.5 }")}};
}

schema::TypeInfo mixPhaseType() {
    using namespace schema;
    return {Kind::phase,
            "mix",
            "Several kinds of particles together.",
            "phase haze mix { part henyey-greenstein 0.8 weight=0.7; part rayleigh weight=0.3 }",
            false,
            {field(FieldType::weighted, "part", &MixPhaseParams::parts)
                 .to(Kind::phase)
                 .required()
                 .key({"weight", {}, "Its share of what is scattered, relative to the others'; 1 when absent."})
                 .synonyms({"phase", "lobe"})
                 .doc("A phase function with its weight.")
                 .example("part rayleigh weight=0.3")}};
}

schema::TypeInfo isotropicPhaseType() {
    return {schema::Kind::phase,    "isotropic", "Scatters evenly into all directions.",
            "phase even isotropic", false,       {}};
}

schema::TypeInfo henyeyGreensteinPhaseType() {
    return {schema::Kind::phase,
            "henyey-greenstein",
            "One lobe, forward or backward: smoke, cloud.",
            "phase cloud henyey-greenstein 0.85",
            false,
            {asymmetry<HenyeyGreensteinPhaseParams>()}};
}

schema::TypeInfo rayleighPhaseType() {
    return {schema::Kind::phase,  "rayleigh", "Particles far smaller than the wavelength: clean air.",
            "phase air rayleigh", false,      {}};
}

schema::TypeInfo drainePhaseType() {
    using namespace schema;
    using P = DrainePhaseParams;
    return {Kind::phase,
            "draine",
            "Henyey-Greenstein times 1 + alpha cos²: dust and small drops.",
            "phase dust draine { g 0.6; alpha 0.5 }",
            false,
            {asymmetry<P>(), field(FieldType::number, "alpha", &P::alpha)
                                 .range(0, 1e6)
                                 .byDefault("1")
                                 .doc("Weight of cos²; 0 is Henyey-Greenstein, 1 with g 0 is Rayleigh.")
                                 .example("alpha 0.5")}};
}

std::shared_ptr<const PhaseFunction> makeIsotropicPhase(const IsotropicPhaseParams&) {
    return std::make_shared<HenyeyGreenstein>(0);
}

std::shared_ptr<const PhaseFunction> makeHenyeyGreensteinPhase(const HenyeyGreensteinPhaseParams& p) {
    return std::make_shared<HenyeyGreenstein>(p.g);
}

std::shared_ptr<const PhaseFunction> makeRayleighPhase(const RayleighPhaseParams&) {
    return std::make_shared<Draine>(0, 1);
}

std::shared_ptr<const PhaseFunction> makeDrainePhase(const DrainePhaseParams& p) {
    return std::make_shared<Draine>(p.g, p.alpha);
}

std::shared_ptr<const PhaseFunction> makeMiePhase(const MiePhaseParams& p) {
    return std::make_shared<MiePhase>(MiePhase::Spheres{{p.radius, p.spread}, p.index, p.absorption, p.surroundings});
}

} // namespace abbe
