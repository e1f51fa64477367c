// Media of pbrt scenes: fog and liquids of one density, and grids of which only some have a counterpart.
#pragma once

#include "exchange/pbrt/pbrt_spectrum.h"
#include "exchange/shared/vdb_writer.h"

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace abbe::exchange {

struct PbrtMedium {
    std::string word;         // of a medium of the scene file; empty: a volume, which stands where it is by itself
    SceneNode node{"volume"}; // of a volume, until a shape first names it
    bool isPlaced = false;
};

class PbrtMedia {
  public:
    explicit PbrtMedia(PbrtShared& shared) : shared_(shared) {}

    // `MakeNamedMedium`, where space is moved by `place`.
    void define(const std::string& name, const PbrtParams&, const Transform& place);
    // E0802 and null for a name that is not defined. A volume is placed in the world the first time.
    const PbrtMedium* use(const std::string& name, Span);

  private:
    void homogeneous(SceneNode& medium, const PbrtParams&);
    void phase(SceneNode& medium, const PbrtParams&);
    void coefficient(SceneNode&, const PbrtParams&, const char* param, const char* property, double scale);
    std::optional<std::array<int, 3>> counts(const PbrtParams&, std::string_view grid, std::size_t channels);
    void grid(PbrtMedium&, const PbrtParams&, const Transform& place, const std::string& stem,
              std::array<int, 3> counts, std::span<const VdbGrid> grids);
    std::vector<float> temperatures(const PbrtParams&, std::size_t voxels);
    std::vector<float> flames(SceneNode&, const PbrtParams&, std::span<const float> density,
                              std::span<const float> kelvin);
    void uniformGrid(PbrtMedium&, const PbrtParams&, const Transform& place, const std::string& name);
    void rgbGrid(PbrtMedium&, const PbrtParams&, const Transform& place, const std::string& name);
    void nanovdb(PbrtMedium&, const PbrtParams&, const Transform& place);
    void nanovdbEmission(SceneNode&, const PbrtParams&, const std::filesystem::path& file);
    void cloud(PbrtMedium&, const PbrtParams&, const Transform& place);

    PbrtShared& shared_;
    std::map<std::string, PbrtMedium, std::less<>> media_;
};

// `scattering` and `absorption` of a medium from sigma_s and sigma_a, or from the parameter that names a preset.
void pbrtCoefficients(SceneNode& medium, const PbrtParams&, std::string_view presetParam, double scale, PbrtShared&);

} // namespace abbe::exchange
