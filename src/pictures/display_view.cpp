#include "pictures/display_view.h"

#include "io/file.h"
#include "spectrum/color_space.h"

#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

namespace abbe {

namespace {

// Calls `use` with the configuration's file, empty for the built-in one.
template <typename Use> auto withConfig(const ViewOptions& options, const Use& use) {
    if (options.config == OcioView::builtInConfig) return use(std::string());
    if (!options.config.empty()) return use(options.config);
    const char* variable = std::getenv("OCIO");
    if (!variable || !*variable) return use(std::string());
    try {
        return use(std::string(variable));
    } catch (const IoError& e) {
        throw IoError(fmt::format("{}\n($OCIO names `{}`; `--ocio FILE` takes another configuration, `--ocio {}` the "
                                  "built-in one)",
                                  e.what(), variable, OcioView::builtInConfig));
    }
}

OcioView makeView(ViewInput input, const ViewOptions& o) {
    const std::string display = o.display.empty() ? OcioView::defaultDisplay : o.display;
    const std::string view = o.view.empty() ? OcioView::defaultView : o.view;
    return withConfig(o, [&](const std::string& file) { return OcioView(input, display, view, file); });
}

ViewInput inputOf(OutputSpace space) {
    return space == OutputSpace::acescg ? ViewInput::acescg : ViewInput::aces2065_1;
}

bool same(Chromaticity a, Chromaticity b) { return std::abs(a.x - b.x) < 1e-5 && std::abs(a.y - b.y) < 1e-5; }

} // namespace

DisplayView::DisplayView(OutputSpace space, const ViewOptions& options)
    : space_(space), exposure_(options.exposure), view_(makeView(inputOf(space), options)) {}

void DisplayView::apply(std::span<float> rgb) const {
    const bool aces = space_ == OutputSpace::aces2065_1 || space_ == OutputSpace::acescg;
    if (!aces) convertToAces(rgb, rgbSpace(space_), adoptedNeutral(space_));
    const auto gain = static_cast<float>(std::exp2(exposure_));
    if (gain != 1)
        for (float& v : rgb) v *= gain;
    view_.apply(rgb);
}

std::string DisplayView::name() const {
    return fmt::format("{}, {}, {:g} stops, {}", view_.display(), view_.view(), exposure_, view_.config().name);
}

void checkView(const ViewOptions& options, bool png) {
    if (png)
        makeView(ViewInput::aces2065_1, options);
    else
        viewIdentity(options);
}

std::vector<ImageAttribute> viewIdentity(const ViewOptions& options) {
    const OcioIdentity config = withConfig(options, [](const std::string& file) { return OcioView::identify(file); });
    return {{"abbe.ocio", config.name}, {"abbe.ocioHash", config.hash}};
}

void convertToAces(std::span<float> rgb, const RgbSpace& space, Chromaticity neutral) {
    const Matrix3 m = rgb::ap0.fromXyz() * adaptation(whiteXyz(neutral), whiteXyz(rgb::ap0.white)) * space.toXyz();
    for (std::size_t i = 0; i + 2 < rgb.size(); i += 3) {
        const auto v = m.apply<Vec3d>(Vec3d(rgb[i], rgb[i + 1], rgb[i + 2]));
        rgb[i] = static_cast<float>(v.x);
        rgb[i + 1] = static_cast<float>(v.y);
        rgb[i + 2] = static_cast<float>(v.z);
    }
}

OutputSpace makeViewable(RgbImage& image) {
    const RgbSpace space = image.chromaticities->space();
    const Chromaticity neutral = image.adoptedNeutral.value_or(space.white);
    if (same(neutral, rgb::ap0.white) && image.chromaticities->matches(rgb::ap1)) return OutputSpace::acescg;
    if (!same(neutral, rgb::ap0.white) || !image.chromaticities->matches(rgb::ap0))
        convertToAces(image.rgb, space, neutral);
    return OutputSpace::aces2065_1;
}

} // namespace abbe
