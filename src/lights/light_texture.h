// A picture or pattern on the surface of a light: a factor of its radiance, and where samples of the light go because
// of it.
#pragma once

#include "math/distribution.h"
#include "render/shape.h"
#include "render/surface_hit.h"
#include "render/surface_input.h"
#include "render/texture.h"
#include "spectrum/curve.h"

#include <optional>
#include <vector>

namespace abbe {

// Immutable after construction, thread-safe. Space of the shape: render space, or that at rest of a light that moves.
class LightTexture {
  public:
    // The shape, and the texture, which is ready for TextureUse::light, outlive it. `toOwn` takes the coordinates of
    // the shape to its own space; `light` is the spectrum where the texture is 1. Looks the texture up over the whole
    // shape, unless that is not `open`: it then counts as 1. Requires a finite area.
    LightTexture(const Shape&, const Texture&, const Transform& toOwn, const Curve& light, bool open);

    // The factor at a hit with a parametrisation.
    Spectrum at(const SurfaceHit& hit, const Wavelengths& lambda) const noexcept {
        const TextureWork work;
        return texture_.lightFactor(TextureQuery(hit), lambda);
    }
    // The light that leaves the shape, in the mean over its area.
    const Curve& spectrum() const { return spectrum_; }
    // Whether there is none, as far as a grid of lookups can tell.
    bool black() const { return !(spectrum_.maximum() > 0); }
    // How much of the visible light leaves a part; > 0 but where black.
    double share(std::uint32_t part) const { return shares_[part]; }

    // As Shape::sample, with the factor there. Where the texture has contrast and the shape has one chart
    // (Shape::uvPoint), half of the samples are drawn from the texture's luminance and half by the shape, which knows
    // where the receiver is: one density for both [Veach1997, sec. 9.2.4].
    std::optional<ShapeSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      Spectrum& factor) const noexcept;
    float pdfSolidAngle(const Receiver&, const SurfaceHit&) const noexcept;

    // The same with no regard to a receiver, as Shape::samplePoint and pdfPoint.
    std::optional<ShapePoint> samplePoint(std::uint32_t part, Vec2 u, const Wavelengths&,
                                          Spectrum& factor) const noexcept;
    float pdfPoint(std::uint32_t part, Vec3 p, Vec3 ng) const noexcept;
    // A point of a part with its parametrisation.
    std::optional<SurfaceHit> hitAt(Vec3 p, Vec3 ng, std::uint32_t part) const noexcept;

  private:
    struct Survey;
    bool surveyChart(Survey&);
    double cellArea(int column, int row) const;
    double surveyCell(Survey&, int column, int row) const;
    void surveyParts(Survey&);
    double surveyPart(Survey&, std::uint32_t part, int points) const;
    double pdfChartArea(Vec2 uv) const noexcept; // 1/m²
    float pdfMixed(std::uint32_t part, Vec3 ng, Vec2 uv) const noexcept;
    float pdfChart(Vec3 from, Vec3 p, Vec3 ng, Vec2 uv) const noexcept;

    const Shape& shape_;
    SamplingOf sampling_;
    const Texture& texture_;
    OwnSpace own_;
    float nearness_; // for rayOnto()
    SampledCurve spectrum_;
    std::vector<double> shares_;
    std::optional<Distribution2D> chart_;
};

} // namespace abbe
