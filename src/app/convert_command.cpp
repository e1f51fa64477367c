#include "app/image_output.h"
#include "app/options.h"
#include "io/image.h"

#include <fmt/format.h>

namespace abbe {

ExitCode run(const ConvertOptions& options, const CommonOptions& common) {
    RgbImage image = readImage(options.input);
    DisplayPicture picture;
    if (image.chromaticities && image.chromaticities->matches(rgb::ap1)) {
        picture.space = OutputSpace::acescg;
    } else if (!image.chromaticities || !image.chromaticities->matches(rgb::ap0)) {
        common.console.error(fmt::format("`{}` is neither ACES2065-1 nor ACEScg, as its chromaticities say; a view "
                                         "would show wrong colours",
                                         options.input));
        return ExitCode::faulty;
    }
    picture.width = image.width();
    picture.height = image.height();
    picture.rgb = std::move(image.rgb);
    writeDisplayPng(options.output, std::move(picture), options.view, options.bits);
    common.console.line(fmt::format("image {}", options.output));
    return ExitCode::done;
}

} // namespace abbe
