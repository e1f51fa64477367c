#include "lights/upsampled_radiance.h"

#include "spectrum/named_spectra.h"

namespace abbe {

UpsampledRadiance::UpsampledRadiance(UpsamplingTable table, std::unique_ptr<const Curve> illuminant)
    : table_(std::move(table)), illuminant_(std::move(illuminant)) {}

std::unique_ptr<const RgbRadiance> UpsampledRadiance::make(const RgbSpace& space) {
    return std::make_unique<UpsampledRadiance>(UpsamplingTable::loadOrBuild(space),
                                               illuminantCurve(*findIlluminant(space.illuminant)));
}

Spectrum UpsampledRadiance::at(Vec3 rgb, const Wavelengths& lambda) const noexcept {
    const float most = maxComponent(rgb);
    if (!(most > 0)) return Spectrum(0.f);
    // At half brightness the curves are smoothest.
    const SigmoidCoefficients reflectance = table_.lookup(rgb * (0.5f / most));
    return reflectance.at(lambda) * illuminant_->at(lambda) * (2 * most);
}

} // namespace abbe
