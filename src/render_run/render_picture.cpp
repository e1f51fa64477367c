// What a render shows to people: how bright its picture is, its key figures, and the PNG beside the image.
#include "pictures/display_view.h"
#include "pictures/picture_figures.h"
#include "render_run/render_run.h"
#include "reports/render_warnings.h"

#include <fmt/format.h>

namespace abbe {

// `exposure auto`. Of everything that makes pixel values, so that all of them agree; a part holds none.
void RenderRun::meter() {
    Exposure& exposure = built_.cameraExposure;
    if (!exposure.automatic || options_.part) return;
    const auto stops = meterExposure(built_.scene, *integrator_, settings_.maxDepth, exposure.sensitivity);
    if (!stops) {
        Diagnostics diagnostics;
        diagnostics
            .warning("W0645", built_.cameraSpan, "a look at the scene found no light to choose an exposure by",
                     "`exposure auto` is taken as 0 stops")
            .help = "write the stops, `exposure 3 stops`, if the picture is not meant to be black";
        report_->diagnostics(diagnostics, loaded_->sources);
        ++summary_.warnings;
        return;
    }
    exposure.stops = *stops;
    built_.exposure = exposure.factor();
}

// The PNG is for looking at. Nobody may have asked for it: then it gives way to whatever is in its place.
ExitCode RenderRun::checkPng() {
    const PngOptions& png = options_.png;
    summary_.png = options_.part ? std::string() : pngPath(png, summary_.image);
    if (summary_.png.empty()) {
        checkView(options_.view, false);
        return ExitCode::done;
    }
    if (!isPngName(summary_.png))
        return refuse("E0432", fmt::format("the picture `{}` must be a PNG", summary_.png),
                      "name it `….png`; other programs make other formats of it", ExitCode::usage);
    if (png.asked) {
        checkView(options_.view, true);
        if (!png.named && isForeignPng(summary_.png)) // who asks for a view may not know of it
            return refuse("E0430", fmt::format("`{}` is there already, and was not made by this program", summary_.png),
                          "`--png=FILE` writes it elsewhere, `--png` replaces it", ExitCode::faulty);
        if (std::string fault = writeFault(summary_.png); !fault.empty())
            return refuse("E0430", std::move(fault), "`--png=FILE` writes it elsewhere", ExitCode::system);
        return ExitCode::done;
    }
    std::string reason;
    checkView(options_.view, false);
    if (isForeignPng(summary_.png))
        reason = fmt::format("`{}` is there already, and was not made by this program", summary_.png);
    else if (std::string fault = writeFault(summary_.png); !fault.empty())
        reason = std::move(fault);
    else
        static_cast<void>(displayView(reason));
    if (reason.empty()) return ExitCode::done;
    warn("W0646", fmt::format("no PNG will be written: {}", reason),
         "`--png=FILE` writes it elsewhere, `--png off` writes none");
    summary_.png.clear();
    return ExitCode::done;
}

std::optional<DisplayView> RenderRun::displayView(std::string& reason) const {
    try {
        return DisplayView(film_.space, options_.view);
    } catch (const IoError& e) {
        reason = e.what();
        return std::nullopt;
    }
}

void RenderRun::writePng(const ResolvedImage& image) {
    if (summary_.png.empty()) return;
    DisplayPicture picture{image.bounds.width(), image.bounds.height(), {}, film_.space};
    picture.rgb.reserve(3 * image.r.size());
    for (std::size_t i = 0; i < image.r.size(); ++i)
        picture.rgb.insert(picture.rgb.end(), {image.r[i], image.g[i], image.b[i]});
    cutOut(picture, {image.bounds.x0, image.bounds.y0, image.bounds.x1, image.bounds.y1},
           {0, 0, film_.width, film_.height});
    try {
        writeDisplayPng(summary_.png, std::move(picture), options_.view, 8);
    } catch (const IoError& e) {
        if (options_.png.asked) throw;
        warn("W0646", fmt::format("the PNG was not written: {}", e.what()), "`abbe convert` makes one of the image");
        summary_.png.clear();
        return;
    }
    report_->image(summary_.png, summary_.partial);
}

// Key figures, and a warning where they say that nobody will see anything.
void RenderRun::judgePicture(const PixelFilm& film, const ResolvedImage& image, Diagnostics& warnings) {
    const WorkScope work(Work::certifying);
    std::string ignored; // the certificate says why there is no view
    const auto view = displayView(ignored);
    summary_.exposure = built_.cameraExposure;
    summary_.figures = figuresOf({film,
                                  image,
                                  {0, 0, film_.width, film_.height},
                                  built_.exposure,
                                  view ? &*view : nullptr,
                                  options_.view.exposure});
    if (options_.png.off) return; // nobody looks
    warnOfDisplay(*summary_.figures, {built_.cameraExposure.stops, options_.view.exposure, summary_.image},
                  built_.cameraSpan, warnings);
}

} // namespace abbe
