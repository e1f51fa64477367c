#include "scene/rgb_radiance.h"

#include "spectrum/named_spectra.h"

#include <fmt/format.h>

namespace abbe {

namespace {

// L(λ) = 2 m R(λ; rgb / 2m) I(λ), m the largest component: reflectances of at most a half stay where the model is
// smooth, and white is the illuminant of the space with Y = 1 [Jakob2019, sec. 4].
class TableRadiance final : public RgbRadiance {
  public:
    TableRadiance(const RgbSpace& space, const NamedSpectrum& white)
        : table_(UpsamplingTable::loadOrBuild(space)), white_(illuminantCurve(white)) {}

    Spectrum at(Vec3 rgb, const Wavelengths& lambda) const noexcept override {
        const float scale = 2 * maxComponent(rgb);
        if (!(scale > 0)) return Spectrum(0.f);
        return table_.lookup(rgb * (1 / scale)).at(lambda) * white_->at(lambda) * scale;
    }

  private:
    UpsamplingTable table_;
    std::unique_ptr<const Curve> white_;
};

} // namespace

std::unique_ptr<const RgbRadiance> makeRgbRadiance(const RgbSpace& space, std::string& error) {
    const auto white = findIlluminant(space.illuminant);
    if (!white) {
        error = fmt::format("no spectrum is known for the white of `{}`", space.name);
        return nullptr;
    }
    return std::make_unique<TableRadiance>(space, *white);
}

} // namespace abbe
