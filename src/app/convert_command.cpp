#include "app/image_output.h"
#include "app/options.h"
#include "io/image.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

// A view shows the colours that the header states. Without such a statement, or with two that differ, none is guessed.
std::string spaceFault(const std::string& path, const RgbImage& image) {
    if (!image.chromaticities)
        return fmt::format("`{}` does not say what its colours are: it has no chromaticities", path);
    const std::string_view name = image.chromaticities->space().name;
    if (image.interopId.empty() || image.interopId == name || (image.interopId == "unknown" && name.empty())) return {};
    return fmt::format("`{}` contradicts itself: its colorInteropID is `{}`, its chromaticities are {}", path,
                       image.interopId, name.empty() ? "of no known space" : fmt::format("those of `{}`", name));
}

bool same(Chromaticity a, Chromaticity b) { return std::abs(a.x - b.x) < 1e-5 && std::abs(a.y - b.y) < 1e-5; }

} // namespace

ExitCode run(const ConvertOptions& options, const CommonOptions& common) {
    RgbImage image = readImage(options.input);
    if (const std::string fault = spaceFault(options.input, image); !fault.empty()) {
        common.console.error(fault);
        return ExitCode::faulty;
    }
    DisplayPicture picture;
    const RgbSpace space = image.chromaticities->space();
    const Chromaticity neutral = image.adoptedNeutral.value_or(space.white);
    if (same(neutral, rgb::ap0.white) && image.chromaticities->matches(rgb::ap1))
        picture.space = OutputSpace::acescg;
    else if (!same(neutral, rgb::ap0.white) || !image.chromaticities->matches(rgb::ap0))
        convertToAces(image.rgb, space, neutral);
    picture.width = image.width();
    picture.height = image.height();
    picture.rgb = std::move(image.rgb);
    writeDisplayPng(options.output, std::move(picture), options.view, options.bits);
    common.console.line(fmt::format("image {}", options.output));
    return ExitCode::done;
}

} // namespace abbe
