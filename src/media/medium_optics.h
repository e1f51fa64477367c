// The optics that all media of the language share, whatever their density: extinction, albedo, phase function.
#pragma once

#include "render/medium.h"
#include "schema/type.h"

#include <memory>
#include <vector>

namespace abbe {

// Optics as a scene states them. Extinction and albedo, or scattering and absorption; neither: extinction 1/m and
// albedo 1.
struct MediumParams {
    const Curve* extinction = nullptr; // 1/m at density 1
    const Curve* albedo = nullptr;
    const Curve* scattering = nullptr; // 1/m at density 1
    const Curve* absorption = nullptr; // 1/m at density 1
    schema::Reference phase;
};

// What collisions do in a medium. The curves must outlive it.
struct MediumOptics {
    const Curve* extinction = nullptr; // 1/m at density 1, >= 0
    const Curve* albedo = nullptr;     // 0 … 1
    std::shared_ptr<const PhaseFunction> phase;
    std::vector<std::shared_ptr<const Curve>> own; // those made for it
};

// `zero` and `one`: curves of these values. `phase`: null for isotropic. Requires no second way of saying the same.
MediumOptics makeOptics(const MediumParams&, std::shared_ptr<const PhaseFunction> phase, const Curve* zero,
                        const Curve* one);
// What was said twice, or an empty text.
std::string_view findContradiction(const MediumParams&);

template <typename P> void addOpticsFields(std::vector<schema::FieldInfo>& fields) {
    using namespace schema;
    const auto coefficient = [](std::string_view name, const Curve* P::*member) {
        return field<P, const Curve*>(FieldType::spectrum, name, member)
            .role(SpectrumRole::unbounded)
            .unit({Dimension::inverseLength, Dimension::none})
            .range(0, 1e12);
    };
    fields.push_back(coefficient("extinction", &P::extinction)
                         .group("extinction")
                         .synonyms({"sigma_t", "density_scale"})
                         .doc("Share of the light that meets a particle per metre, at density 1; 1 when absent.")
                         .example("extinction 0.08 per-m"));
    fields.push_back(field<P, const Curve*>(FieldType::spectrum, "albedo", &P::albedo)
                         .role(SpectrumRole::albedo)
                         .range(0, 1)
                         .synonyms({"single_scattering_albedo", "color", "scattering_color"})
                         .doc("Share of the light met that is scattered and not absorbed; 1 when absent.")
                         .example("albedo 0.99"));
    fields.push_back(coefficient("scattering", &P::scattering)
                         .group("extinction")
                         .synonyms({"sigma_s"})
                         .doc("With absorption instead of extinction and albedo: what is scattered per metre.")
                         .example("scattering rgb 2.5 3.2 3.8 per-mm"));
    fields.push_back(coefficient("absorption", &P::absorption)
                         .synonyms({"sigma_a"})
                         .doc("With scattering, or alone: what is absorbed per metre.")
                         .example("absorption 0.002 per-mm"));
    fields.push_back(field<P, Reference>(FieldType::reference, "phase", &P::phase)
                         .to(Kind::phase)
                         .synonyms({"phase_function"})
                         .doc("Where scattered light goes; evenly when absent.")
                         .example("phase henyey-greenstein 0.85"));
}

// A medium with such optics. Leaves to its heirs where the medium is and how dense.
class OpticalMedium : public Medium {
  public:
    const Curve& extinction() const final { return *optics_.extinction; }
    const Curve& albedo() const final { return *optics_.albedo; }
    const PhaseFunction& phase() const final { return *optics_.phase; }

  protected:
    explicit OpticalMedium(MediumOptics optics) : optics_(std::move(optics)) {}
    void replaceExtinction(std::shared_ptr<const Curve> curve) {
        optics_.extinction = curve.get();
        optics_.own.push_back(std::move(curve));
    }

  private:
    MediumOptics optics_;
};

} // namespace abbe
