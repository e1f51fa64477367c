// Light from a latitude–longitude image of everything around the scene.
#pragma once

#include "lights/amount.h"
#include "lights/light_context.h"
#include "lights/window_light.h"
#include "math/digest.h"
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

// An image with all that sampling it takes, wherever it is turned and however bright it is. Immutable.
class EnvironmentTables {
  public:
    // `compensated` as EnvironmentLight has it. Requires a checked image.
    EnvironmentTables(EnvironmentImage, std::unique_ptr<const RgbRadiance>, bool compensated);

    const EnvironmentImage image;
    const std::unique_ptr<const RgbRadiance> upsampling;
    const std::vector<double> rowCosine; // cos θ at the upper edge of each row, and at the lower edge of the last

  private:
    const Vec3d channelWeights_; // of the sampling density

  public:
    double dimShare = 0; // of all light: what compensation took off
    bool even = false;   // nothing stands out from the mean
    const Distribution2D distribution;
    std::unique_ptr<const Curve> powerShape; // null where all is black
    double fluence = 0;                      // ∫∫ L dω dλ for a scale of 1, W/m²

    Vec3 texel(int column, int row) const noexcept;
    double cellSolidAngle(int row) const noexcept;

  private:
    Distribution2D density(bool compensated); // sets dimShare and even
    Vec3d cellMean(int column, int row) const noexcept;
    Vec3d integratedRadiance() const; // ∫ rgb dω for a scale of 1
};

// Radiance is interpolated bilinearly between the centres of the texels, in RGB, and upsampled after.
class EnvironmentLight final : public DistantLight {
  public:
    // `compensated` takes the mean radiance off the sampling density [Karlik2019]: better, but only right beside BSDF
    // sampling, as dim directions are then never sampled from here. `toRender` turns the image's axes (+y its zenith)
    // into render space; its matrix is orthogonal. Requires: a checked image, scale >= 0.
    EnvironmentLight(EnvironmentImage, std::unique_ptr<const RgbRadiance>, double scale, const Transform& toRender,
                     bool compensated);
    EnvironmentLight(std::shared_ptr<const EnvironmentTables>, double scale, const Transform& toRender);

    void commit(const Bounds3&) override;
    // No power: all texels are black, and the light must be left out. The irradiance is between that of an even sky, a
    // quarter, and that of a sun, all of it; daylight's share of visible light.
    LightOutput output() const override {
        constexpr double share = LightOutput::kDaylightShare;
        return {power_, share * power_, share * 0.5 * fluence_, tables_->powerShape.get(), tables_->even};
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
    Vec3 lookup(Vec2 point) const noexcept;

    std::shared_ptr<const EnvironmentTables> tables_;
    float scale_;
    Frame axes_;     // x, y, z of the image's axes in render space (left-handed when mirrored)
    double fluence_; // ∫∫ L dω dλ, W/m²
    double power_;
};

// Rejects sizes that do not fit, values that are not finite, and pixels that make too much or too little light for
// kSkyRadiance when they are multiplied by `scale`; counts negative ones, which are set to zero with a warning. False
// after an error.
bool checkEnvironmentImage(EnvironmentImage&, double scale, Span, Diagnostics&);

// How many times brighter than the image a light is.
double environmentScale(const EnvironmentLightParams&);
// Of an image that was checked for a scale; `image` stands for the tables. Null after an error.
std::unique_ptr<DistantLight> makeEnvironmentLight(const EnvironmentLightParams&,
                                                   std::shared_ptr<const EnvironmentTables>, const Digest& image,
                                                   const LightContext&, Diagnostics&);
// The last of these checks alone, of an image that passed the others.
bool checkBrightestPixel(const EnvironmentImage&, double scale, Span, Diagnostics&);

// Null after an error.
std::unique_ptr<DistantLight> makeEnvironmentLight(const EnvironmentLightParams&, EnvironmentImage,
                                                   std::unique_ptr<const RgbRadiance>, bool compensated,
                                                   const LightContext&, Diagnostics&);

} // namespace abbe
