// A material of a scene as Python holds it: what scatters at its surface, over arrays of directions and wavelengths.
#pragma once

#include "app/load.h"
#include "binding/diagnostic_records.h"
#include "render/bsdf.h"
#include "render/material.h"
#include "scene/build.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace abbe::python {

class LaneBlocks;

// Immutable after construction, thread-safe. Directions are rows of three numbers, unit vectors in the frame of the
// surface whose z is the normal, and point away from it. Wavelengths are in nm, within [360, 830], at least one.
// Results are rows of one number for each wavelength. Light outside is in air.
class MaterialHandle {
  public:
    // Of the scene that has it under that name. Without a camera or light the scene is good enough.
    MaterialHandle(const SceneInput&, const std::string& name);

    // Where it has errors, or nothing is found, nothing below may be asked.
    const std::shared_ptr<DiagnosticLog>& log() const { return log_; }
    const std::vector<std::string>& names() const { return names_; } // of all materials of the scene
    bool found() const { return material_ != nullptr; }
    // Why it cannot be evaluated by directions alone; empty: it can.
    std::string obstacle() const;
    bool choosesLobe() const { return material_->choosesLobe(); }
    // Share of the light that hits the surface at all.
    float opacity() const { return material_->opacity(hit_); }

    // f(wo, wi) |cos θi|, 1/sr, without delta lobes.
    void eval(std::span<const double> wo, std::span<const double> wi, std::span<const double> nanometres, Transport,
              float* fcos) const;
    // Density with which sample() finds wi for these wavelengths, 1/sr, without delta lobes: one number a pair.
    void pdf(std::span<const double> wo, std::span<const double> wi, std::span<const double> nanometres,
             float* density) const;
    // `u`: rows of three numbers in [0, 1), the third of which chooses the lobe. Rows of what was not found are 0.
    struct Samples {
        float *wi, *weight, *pdf; // pdf: of delta lobes the probability of the lobe
        bool* delta;
    };
    void sample(std::span<const double> wo, std::span<const double> u, std::span<const double> nanometres, Transport,
                Samples) const;

  private:
    const Bsdf& bsdf(const Wavelengths&, Arena&) const;
    void weighDelta(const BsdfSample&, const Bsdf& drawn, Vec3 wo, const LaneBlocks&, Transport, float* weight) const;

    std::shared_ptr<DiagnosticLog> log_ = std::make_shared<DiagnosticLog>();
    std::unique_ptr<LoadedScene> loaded_;
    BuiltScene built_;
    std::vector<std::string> names_;
    const Material* material_ = nullptr;
    SurfaceHit hit_; // `arrival` stays 0: a sheet has then both of its sides
};

} // namespace abbe::python
