#include "app/image_output.h"

#include "app/version.h"
#include "io/atomic_file.h"
#include "io/io_error.h"
#include "io/ocio_view.h"
#include "io/png_writer.h"
#include "spectrum/color_space.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

void warnOfLosses(const ExrReport& report, const std::string& path, Diagnostics& diagnostics) {
    if (report.halfOverflows > 0)
        diagnostics
            .warning("W0630", {},
                     fmt::format("{} values of `{}` exceed 65504, the largest half float", report.halfOverflows, path))
            .help = "leave out `half` in the film's output, or lower the exposure";
    for (const std::string& channel : report.leftOut)
        diagnostics.warning("W0631", {},
                            fmt::format("`{}` is an ACES container, which cannot hold `{}`", path, channel));
}

} // namespace

std::string imagePath(const RenderOptions& options, const FilmSettings& film) {
    if (!options.output.empty()) return options.output;
    if (!film.output.empty()) return film.output;
    return std::filesystem::path(options.input.path).filename().replace_extension(".exr").string();
}

std::string pngPath(const RenderOptions& options, const std::string& imagePath) {
    if (!options.png) return {};
    if (!options.png->empty()) return *options.png;
    return std::filesystem::path(imagePath).replace_extension(".png").string();
}

std::string writeFault(const std::string& path) {
    try {
        const AtomicFile probe(path);
        return {};
    } catch (const IoError& e) {
        return e.what();
    }
}

ResolvedImage resolveImage(const PixelFilm& film, const FilmSettings& settings, double exposure) {
    return film.resolve(rgbSpace(settings.space).fromXyz(), exposure);
}

void writeImage(const std::string& path, const ResolvedImage& image, const FilmSettings& film,
                std::vector<ImageAttribute> attributes, Diagnostics& diagnostics) {
    ExrPicture picture;
    const PixelBounds& b = image.bounds;
    picture.window = {b.x0, b.y0, b.x1, b.y1};
    picture.display = {0, 0, film.width, film.height};
    picture.r = image.r;
    picture.g = image.g;
    picture.b = image.b;
    if (!image.variance.empty()) picture.more.push_back({"variance.Y", image.variance});
    picture.chromaticities = Chromaticities::of(rgbSpace(film.space));
    picture.compression = findExrCompression(film.compression).value_or(ExrCompression::zip);
    picture.half = film.half;
    picture.attributes = std::move(attributes);
    warnOfLosses(writeExr(path, picture), path, diagnostics);
}

void writeDisplayPng(const std::string& path, DisplayPicture picture, const ViewOptions& options, int bits) {
    const ViewInput input = picture.space == OutputSpace::acescg ? ViewInput::acescg : ViewInput::aces2065_1;
    const OcioView view(input, options.display.empty() ? OcioView::defaultDisplay : options.display,
                        options.view.empty() ? OcioView::defaultView : options.view, options.config);
    const auto gain = static_cast<float>(std::exp2(options.exposure));
    if (gain != 1)
        for (float& v : picture.rgb) v *= gain;
    view.apply(picture.rgb);
    PngPicture png;
    png.width = picture.width;
    png.height = picture.height;
    png.rgb = picture.rgb;
    png.bits = bits;
    png.srgb = view.isSrgb();
    png.texts = {{"Software", "abbe " + versionNumber()},
                 {"Display", view.display()},
                 {"View", view.view()},
                 {"Exposure", fmt::format("{:g} stops", options.exposure)}};
    writePng(path, png);
}

std::string_view spaceName(OutputSpace space) { return space == OutputSpace::acescg ? "ACEScg" : "ACES2065-1"; }

} // namespace abbe
