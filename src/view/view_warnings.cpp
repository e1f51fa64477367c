// What is suspicious about a picture that is finished, as `abbe render` tells it.
#include "film/error_certificate.h"
#include "pictures/film_picture.h"
#include "pictures/image_output.h"
#include "pictures/picture_figures.h"
#include "reports/render_warnings.h"
#include "reports/sample_report.h"
#include "view/live_render.h"
#include "view/view_session.h"

#include <fmt/format.h>

namespace abbe {

// What repeats a sample of this view. A camera that was moved has its place in the page alone.
std::string ViewSession::replayCommand() const {
    std::string command = "abbe replay " + shellQuoted(request_.input.path);
    const auto add = [&](const char* flag, std::string_view value) {
        command += fmt::format(" {} {}", flag, shellQuoted(value));
    };
    for (const auto& [flag, value] : flagsOf(request_.input)) add(flag, value);
    if (request_.input.frame) add("--frame", std::to_string(*request_.input.frame));
    if (!request_.build.camera.empty()) add("--camera", request_.build.camera);
    if (request_.build.size) add("--size", fmt::format("{}x{}", request_.build.size->x, request_.build.size->y));
    if (request_.build.seed) add("--seed", std::to_string(*request_.build.seed));
    return command;
}

std::vector<ViewDiagnostic> ViewSession::warningsOf(const RestingFilm& resting) const {
    const LiveShot& shot = resting.shot;
    const BuiltScene& built = shot.built;
    const PixelFilm& film = resting.film.film;
    const RenderStatistics& statistics = resting.film.statistics;
    Diagnostics found;
    std::vector<FoundFault> faults;
    if (!resting.moved) // else no command has this camera
        faults = findFaults(statistics.examples, *shot.integrator, built.scene, shot.loaded->tree, film,
                            resting.film.settings);
    warnOfDroppedSamples(statistics, faults, replayCommand(), found);
    warnOfCappedPaths(statistics, built, found);
    warnOfDensities(statistics.excess, found);
    warnOfMissingLight(statistics, found);
    for (const auto& texture : built.scene.textures) texture->reportLookups(found); // not read to their ends
    const ResolvedImage image = resolveImage(film, shot.film, built.exposure);
    warnOfBlackImage(image, found);
    const DisplayView view(shot.film.space, request_.view);
    const PictureFigures figures = figuresOf(
        {film, image, {0, 0, shot.film.width, shot.film.height}, built.exposure, &view, request_.view.exposure});
    warnOfDisplay(figures,
                  {built.cameraExposure.stops, request_.view.exposure, imagePath({}, shot.film, request_.input.path)},
                  built.cameraSpan, found);
    const ErrorCertificate certificate =
        ErrorCertificate::of(film, {shot.film.whiteBalance, rgbSpace(shot.film.space).fromXyz(), built.exposure, {}});
    warnOfHeavyTail(certificate.relative, found);
    return viewDiagnostics(found, shot.loaded->sources);
}

} // namespace abbe
