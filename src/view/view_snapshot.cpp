// Snapshots of a view, with all that an image of `abbe render` says about how it was made.
#include "base/parallel.h"
#include "film/error_certificate.h"
#include "io/file.h"
#include "pictures/film_picture.h"
#include "pictures/image_output.h"
#include "reports/image_header.h"
#include "reports/render_text.h"
#include "study/cost.h"
#include "view/camera_moves.h"
#include "view/live_render.h"
#include "view/view_session.h"

#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostSnapshots = 9999; // beside one scene

} // namespace

// Of a number that nothing has yet.
std::string ViewSession::nextSnapshot(std::uint64_t& number) const {
    const std::string stem = fs::path(request_.input.path).stem().string();
    std::error_code ignored;
    for (; number <= kMostSnapshots; ++number) {
        const std::string path = (scene_.folder() / fmt::format("{}.view-{:04}", stem, number)).string();
        if (!fs::exists(path + ".exr", ignored) && !fs::exists(path + ".png", ignored)) return path;
    }
    throw ViewFault(fmt::format("there are {} snapshots of this scene already", kMostSnapshots),
                    "move some of them elsewhere");
}

std::vector<ImageAttribute> ViewSession::snapshotHeader(const RestingFilm& resting, const LiveReport& report,
                                                        double noise) const {
    const LiveShot& shot = resting.shot;
    auto list = provenance({shot.loaded.get(), &request_.input, &shot.built, &resting.film.settings,
                            &resting.film.statistics, request_.commandLine, std::string(spaceName(shot.film.space)),
                            noise, report.elapsed, resting.film.film.replicates()});
    ErrorCertificate::Picture picture{
        shot.film.whiteBalance, rgbSpace(shot.film.space).fromXyz(), shot.built.exposure, {}};
    const DisplayView view(shot.film.space, request_.view);
    picture.display = [&view](std::span<float> rgb) { view.apply(rgb); };
    ErrorCertificate certificate = ErrorCertificate::of(resting.film.film, picture);
    certificate.view = view.name();
    for (ImageAttribute& a : certificateAttributes(certificate, resting.film.statistics)) list.push_back(std::move(a));
    for (ImageAttribute& a : viewIdentity(request_.view)) list.push_back(std::move(a));
    if (resting.film.settings.adaptive) list.push_back({"abbe.adaptive", std::string("frozen plan (unbiased)")});
    if (resting.moved) {
        const schema::Header& header = shot.loaded->tree.header;
        list.push_back(
            {"abbe.viewCamera", poseLines(resting.pose, header.length, header.zUp ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0})});
    }
    // A camera that was edited stays in the space of the one before it: bits are not those of `abbe render` then.
    if (report.reuse.viewKept) list.push_back({"abbe.viewKept", 1});
    return list;
}

Json ViewSession::snapshot() {
    const std::lock_guard one(writing_);
    std::uint64_t number = 1;
    const std::string path = nextSnapshot(number);
    const LiveReport report = render_.report();
    std::string fault = "there is no finished picture yet";
    render_.whileResting([&](RestingFilm& resting) {
        LiveFilm& film = resting.film;
        if (film.cell > 1 || film.state.empty()) return;
        fault.clear();
        try {
            film.statistics.stopped = film.state.reached() < film.settings.range(film.film.replicates()).last;
            const double noise = film.film.relativeNoise();
            FilmPicture picture(film.film, resting.shot.film, resting.shot.built.exposure,
                                resting.shot.built.scene.origin);
            auto header = snapshotHeader(resting, report, noise);
            const WorkReading work = render_.work();
            header.push_back(costAttribute(makeCostReport(
                {&work, &film.statistics, &resting.shot.built.scene, render_.seconds(), threadCount()})));
            Diagnostics ignored; // half floats that overflow are in the picture as well
            writeImage(path + ".exr", picture, resting.shot.film, std::move(header), ignored);
            DisplayPicture shown{
                picture.image.bounds.width(), picture.image.bounds.height(), {}, resting.shot.film.space};
            shown.rgb.reserve(3 * picture.image.r.size());
            for (std::size_t i = 0; i < picture.image.r.size(); ++i)
                shown.rgb.insert(shown.rgb.end(), {picture.image.r[i], picture.image.g[i], picture.image.b[i]});
            writeDisplayPng(path + ".png", std::move(shown), request_.view, 8);
        } catch (const IoError& e) {
            fault = e.what();
        }
    });
    if (!fault.empty()) throw ViewFault(fault, "look at it again when samples have been taken");
    Json files = Json::list();
    for (const char* ending : {".exr", ".png"}) files.push(fs::path(path + ending).filename().string());
    return Json::object({{"files", files}});
}

} // namespace abbe
