// Light from a latitude–longitude image of everything around the scene.
#pragma once

#include "lights/amount.h"
#include "lights/light_context.h"
#include "lights/window_light.h"
#include "math/distribution.h"
#include "math/frame.h"
#include "render/light.h"
#include "render/visible_field.h"

#include <memory>
#include <vector>

namespace abbe {

// Linear RGB, row by row from the top. The image shows the surroundings unmirrored: its middle lies in the direction
// -z (north; +y in a z-up scene), its right half towards +x (east), its first row at the zenith.
struct EnvironmentImage {
    int width = 0, height = 0;
    std::vector<float> rgb; // 3 width height values
};

// From linear RGB to spectral radiance: linear in the scale of the triple, and white (1, 1, 1) has Y = 1 in the scale
// of spectrum/sensor.h. Called for every ray that leaves the scene.
class RgbRadiance {
  public:
    virtual ~RgbRadiance() = default;
    // Requires: components finite and >= 0.
    virtual Spectrum at(Vec3 rgb, const Wavelengths&) const noexcept = 0;
};

struct EnvironmentLightParams : VisibleParams, PortalParams {
    schema::Text image;                        // resolved path; key `space`
    std::optional<schema::Quantity> luminance; // cd/m² of a texel of (1, 1, 1); default: 683 ∫ȳ dλ = 72 983
    double exposure = 0;                       // stops, on top of that
    KeyedTransform transform;                  // light to parent; a rotation, mirrored or not, and a uniform scale
};

schema::TypeInfo environmentLightType();

// Radiance is interpolated bilinearly between the centres of the texels, in RGB, and upsampled after.
class EnvironmentLight final : public DistantLight {
  public:
    // `compensated` takes the mean radiance off the sampling density [Karlik2019]: better, but only right beside BSDF
    // sampling, as dim directions are then never sampled from here. `toRender` turns the image's axes (+y its zenith)
    // into render space; its matrix is orthogonal. Requires: a checked image, scale >= 0.
    EnvironmentLight(EnvironmentImage, std::unique_ptr<const RgbRadiance>, double scale, const Transform& toRender,
                     bool compensated);

    void commit(const Bounds3&) override;
    // No power: all texels are black, and the light must be left out. The irradiance is between that of an even sky, a
    // quarter, and that of a sun, all of it; daylight's share of visible light.
    LightOutput output() const override {
        constexpr double share = LightOutput::kDaylightShare;
        return {power_, share * power_, share * 0.5 * fluence_, powerShape_.get(), even_};
    }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float) const noexcept override;
    Spectrum escaped(Vec3 w, const Wavelengths&, float) const noexcept override;
    float pdfEscaped(const Receiver&, Vec3 w, float) const noexcept override;
    // By the image, and evenly for what compensation took off.
    std::optional<LightSample> sampleDistant(Vec2 u, const Wavelengths&, float) const noexcept override;
    float pdfDistant(Vec3 w, float) const noexcept override;

  private:
    float pdfImage(Vec3 w) const noexcept;
    LightSample sampleImage(Vec2 u, const Wavelengths&) const noexcept;
    Vec2 imagePoint(Vec3 local) const noexcept;
    Vec3 texel(int column, int row) const noexcept;
    Vec3 lookup(Vec2 point) const noexcept;
    Distribution2D density(bool compensated); // sets dimShare_ and even_
    double cellSolidAngle(int row) const noexcept;
    Vec3d cellMean(int column, int row) const noexcept;
    Vec3d integratedRadiance() const; // ∫ rgb dω for a scale of 1

    EnvironmentImage image_;
    std::unique_ptr<const RgbRadiance> upsampling_;
    float scale_;
    Frame axes_;                    // x, y, z of the image's axes in render space (left-handed when mirrored)
    std::vector<double> rowCosine_; // cos θ at the upper edge of each row, and at the lower edge of the last
    Vec3d channelWeights_;          // of the sampling density
    double dimShare_ = 0;           // of all light: what compensation took off
    bool even_ = false;             // nothing stands out from the mean
    Distribution2D distribution_;
    std::unique_ptr<const Curve> powerShape_; // null where all is black
    double fluence_;                          // ∫∫ L dω dλ, W/m²
    double power_;
};

// Rejects sizes that do not fit, values that are not finite, and pixels that make too much or too little light for
// kSkyRadiance when they are multiplied by `scale`; counts negative ones, which are set to zero with a warning. False
// after an error.
bool checkEnvironmentImage(EnvironmentImage&, double scale, Span, Diagnostics&);

// Null after an error.
std::unique_ptr<DistantLight> makeEnvironmentLight(const EnvironmentLightParams&, EnvironmentImage,
                                                   std::unique_ptr<const RgbRadiance>, bool compensated,
                                                   const LightContext&, Diagnostics&);

} // namespace abbe
