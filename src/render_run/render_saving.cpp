// What a render writes: checkpoints, snapshots, the image, and what can be rescued when that fails.
#include "base/path_lock.h"
#include "checkpoints/render_identity.h"
#include "pictures/display_view.h"
#include "render_run/frame_run.h"
#include "render_run/render_run.h"
#include "reports/image_header.h"
#include "reports/render_text.h"
#include "reports/render_warnings.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <numeric>

namespace abbe {

namespace {

// How long one render may keep another one from writing the same files.
constexpr double kMostPatience = 30; // s

// One that only this user can look into, of a name that nobody could foresee: the folder of temporary files is
// everybody's.
std::filesystem::path makePrivateFolder() {
    std::error_code error;
    const auto temporary = std::filesystem::temp_directory_path(error);
    std::string pattern = ((error ? "/tmp" : temporary) / "abbe-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) throw IoError(fmt::format("cannot make `{}`: {}", pattern, std::strerror(errno)));
    return pattern;
}

// Has `write` put what could not be written beside the image where there may be room. What became of it, for the end of
// a message.
template <typename Write> std::string savedElsewhere(const std::string& name, const char* what, const Write& write) {
    std::filesystem::path folder;
    try {
        folder = makePrivateFolder();
        const std::string path = (folder / std::filesystem::path(name).filename()).string();
        write(path);
        return fmt::format("; the {} was saved as `{}`", what, path);
    } catch (const IoError& e) {
        std::error_code ignored;
        if (!folder.empty()) std::filesystem::remove_all(folder, ignored);
        return fmt::format("; nor could it be saved elsewhere ({})", e.what());
    }
}

} // namespace

std::vector<Fact> RenderRun::identity() const {
    return renderIdentity({loaded_.get(), &film_, &settings_, static_cast<int>(built_.render.replicates),
                           options_.build.camera, built_.render.fps});
}

CheckpointHeader RenderRun::checkpointHeader() const {
    CheckpointHeader header;
    header.words = common_.words;
    header.folder = std::filesystem::current_path().string();
    header.bounds = film_.crop;
    header.replicates = static_cast<int>(built_.render.replicates);
    const SampleRange range = settings_.range(header.replicates);
    header.first = range.first;
    header.last = range.last;
    header.whole = settings_.samplesPerReplicate(header.replicates);
    header.pilot = options_.build.pilot.value_or(-1); // one that is asked for must be that of the checkpoint
    return header;
}

// Of a part the checkpoint is the file that is wanted in the end.
ExitCode RenderRun::openCheckpoint(PixelFilm& film, RenderState& state) {
    const CheckpointOptions& options = options_.checkpoint;
    if (options_.inMemory && !options_.part) return ExitCode::done;
    if (options.off && !options.resume && !options_.part) return ExitCode::done;
    const std::string path = options_.part ? summary_.image : summary_.image + ".ckpt";
    if (!options.resume && isForeignCheckpoint(path))
        return refuse("E0661", fmt::format("`{}` is there already, and was not made by this program", path),
                      options_.part ? "`-o FILE` writes the part elsewhere"
                                    : "move it, or write the image elsewhere with `-o FILE`; `--checkpoint off` "
                                      "renders without a checkpoint",
                      ExitCode::faulty);
    checkpoint_.emplace(path, checkpointHeader(), [this] { return identity(); });
    if (options.resume && checkpoint_->exists()) {
        try {
            checkpoint_->resume(film.planes(), state);
            earlier_ = state.work;
        } catch (const CheckpointFault& fault) {
            return refuse(fault.code.c_str(), fault.what(), fault.help, ExitCode::faulty);
        }
    } else if (options.resume && !options_.frame) { // most frames of an animation have none
        warn("W0664", fmt::format("there is no checkpoint `{}`; the render begins anew", path), {});
    } else if (!options_.part && checkpoint_->exists()) {
        warn("W0663", fmt::format("`{}` holds an earlier state of a render; this one will replace it", path),
             "`--resume` goes on with it");
    }
    checkpoint_->chargeBy([this] { return clock_.read(); });
    checkpoint_->writeOnlyIf([this] { return texturesReadable(); });
    checkpoint_->start(film.planes(), state, options.off ? 0 : options.interval);
    return ExitCode::done;
}

// What is rendered without a texture that was there is worth nothing, and must not get into a checkpoint.
bool RenderRun::texturesReadable() const {
    Diagnostics found;
    for (const auto& texture : built_.scene.textures) texture->reportLookups(found);
    return std::none_of(found.all().begin(), found.all().end(), [](const Diagnostic& d) { return d.code == "W0458"; });
}

// Of writing in the background.
void RenderRun::tellFault() {
    const auto fault = checkpoint_ ? checkpoint_->takeFault() : std::nullopt;
    if (fault) warn("W0662", fmt::format("the checkpoint was not written: {}", *fault), "the render goes on");
}

// What is most dear is saved first: the image can be made from it.
void RenderRun::closeCheckpoint() {
    if (!checkpoint_) return;
    checkpoint_->stop();
    tellFault();
    if (!hasSamples_) return;
    if (options_.part) return savePart();
    if (!summary_.partial && !options_.checkpoint.keep) return; // it goes when the image is there
    if (options_.checkpoint.off) return;
    try {
        checkpoint_->save();
    } catch (const IoError& e) {
        warn("W0662", fmt::format("the checkpoint was not written: {}", e.what()), "the image follows");
    }
}

void RenderRun::savePart() {
    try {
        checkpoint_->save();
    } catch (const IoError& e) {
        const auto elsewhere = [this](const std::string& path) { checkpoint_->saveAs(path); };
        throw IoError(e.what() + savedElsewhere(summary_.image, "part", elsewhere));
    }
    report_->image(summary_.image, summary_.partial);
}

void RenderRun::tellHowToResume() const {
    if (options_.quiet || !checkpoint_->isThere()) return;
    common_.console.line(
        fmt::format("to go on:  {}{}", common_.commandLine, options_.checkpoint.resume ? "" : " --resume"));
}

// In the middle of a render that goes on; whatever fails is told and no reason to end it.
void RenderRun::snapshot(const PixelFilm& film, const RenderStatistics& statistics) {
    const RenderStatistics before = std::exchange(summary_.statistics, statistics);
    const WorkScope work(Work::writing);
    try {
        if (checkpoint_) checkpoint_->save();
        if (!options_.part) {
            Diagnostics ignored; // told at the end
            summary_.partial = true;
            summary_.noise = film.relativeNoise();
            certify(film);
            FilmPicture picture = pictureOf(film);
            const PathLock lock(summary_.image, kMostPatience);
            writeImage(summary_.image, picture, film_, attributes(film), ignored);
            report_->image(summary_.image, true);
            writeCertificate();
            writePng(picture.image);
        }
    } catch (const IoError& e) {
        warn("W0662", fmt::format("the snapshot was not written: {}", e.what()), "the render goes on");
    }
    summary_.partial = false;
    summary_.statistics = before;
}

// Of all runs, up to now.
CostReport RenderRun::cost() {
    WorkReading work = earlier_;
    work.add(clock_.read());
    return makeCostReport(
        {&work, &summary_.statistics, &built_.scene, earlier_.seconds + whole_.seconds(), threadCount()});
}

std::vector<ImageAttribute> RenderRun::attributes(const PixelFilm& film) {
    double seconds = 0;
    for (const auto& phase : summary_.phases) seconds += phase.second;
    auto list =
        provenance({loaded_.get(), &options_.input, &built_, &settings_, &summary_.statistics, common_.commandLine,
                    std::string(spaceName(film_.space)), summary_.noise, seconds, film.replicates()});
    if (summary_.certificate)
        for (ImageAttribute& a : certificateAttributes(*summary_.certificate, summary_.statistics))
            list.push_back(std::move(a));
    for (ImageAttribute& a : viewIdentity(options_.view)) list.push_back(std::move(a));
    list.push_back(costAttribute(cost()));
    if (!summary_.faults.empty()) list.push_back({"abbe.droppedSamples", listText(summary_.faults)});
    if (lookedAt_ > 0) list.push_back({"abbe.pixelsOfFirstLook", static_cast<int>(lookedAt_)});
    if (settings_.adaptive) list.push_back({"abbe.adaptive", std::string("frozen plan (unbiased)")});
    if (options_.input.frame)
        list.push_back({kFrameFingerprint, frameFingerprint(options_, {loaded_.get(), &built_, film_.crop})});
    if (!options_.parts.empty()) list.push_back({"abbe.parts", static_cast<int>(options_.parts.size())});
    return list;
}

// Without a view that can be made, which nobody may have asked for, the error is stated in linear units alone.
void RenderRun::certify(const PixelFilm& film) {
    const WorkScope work(Work::certifying);
    ErrorCertificate::Picture picture{film_.whiteBalance, rgbSpace(film_.space).fromXyz(), built_.exposure, {}};
    std::string reason;
    const auto view = displayView(reason);
    if (view) picture.display = [&view](std::span<float> rgb) { view->apply(rgb); };
    summary_.certificate = ErrorCertificate::of(film, picture);
    summary_.certificate->view = view ? view->name() : std::string();
    summary_.certificate->displayReason = reason;
}

// Beside the image. All of it is in the header of the image too, so a fault is no reason to end the render.
void RenderRun::writeCertificate() {
    if (!certificateAlso_) return;
    try {
        const std::string path = summary_.image + ".json";
        writeCertificateFile(path, {&summary_, settings_.seed, static_cast<int>(options_.parts.size()),
                                    sceneHash(*loaded_, options_.input)});
    } catch (const IoError& e) {
        warn("W0667", fmt::format("the certificate was not written: {}", e.what()), "the header of the image has it");
    }
}

void RenderRun::write(const PixelFilm& film) {
    const WorkScope work(Work::writing);
    certify(film);
    FilmPicture picture = pictureOf(film);
    if (settings_.adaptive) summary_.spread = sampleSpread(film);
    Diagnostics warnings;
    writeFiles(film, picture, warnings);
    endPhase("writing", watch_.lap());
    if (tev_) tev_->finish(picture);
    tellOfTev();
    warnOfDroppedSamples(summary_.statistics, summary_.faults, replayCommand(), warnings);
    warnOfCappedPaths(summary_.statistics, built_, warnings);
    warnOfDensities(summary_.statistics.excess, warnings);
    const auto& dropped = summary_.statistics.dropped;
    if (!summary_.partial)
        warnOfMissingSamples(
            {lookedAt_, film.bounds(), allBegun_, std::accumulate(dropped.begin(), dropped.end(), std::uint64_t{0})},
            warnings);
    for (const auto& texture : built_.scene.textures) texture->reportLookups(warnings);
    warnOfMissingLight(summary_.statistics, warnings);
    // What was not begun says nothing of the scene.
    if (summary_.certificate->fewest > 0) warnOfBlackImage(picture.image, warnings);
    judgePicture(film, picture.image, warnings);
    warnOfHeavyTail(summary_.certificate->relative, warnings);
    report_->diagnostics(warnings, loaded_->sources);
    summary_.warnings += warnings.warningCount();
}

// Of renders to one image that end at once, each writes all of its files before the next one does.
void RenderRun::writeFiles(const PixelFilm& film, FilmPicture& picture, Diagnostics& warnings) {
    if (host_) host_->take(holdImage(picture, film_, attributes(film)));
    if (options_.inMemory) return;
    const PathLock lock(summary_.image, kMostPatience);
    if (lock.refused())
        warn("W0670", fmt::format("another render has been writing `{}` for {} s", summary_.image, kMostPatience),
             "files beside the image may be of that one");
    try {
        writeImage(summary_.image, picture, film_, attributes(film), warnings);
    } catch (const IoError& e) {
        writeRescued(picture, attributes(film), e);
    }
    report_->image(summary_.image, summary_.partial);
    if (picture.hasDeep()) report_->image(summary_.deep, summary_.partial);
    writeCertificate();
    writePng(picture.image);
}

// The disk filled up or went away while rendering: what was computed is saved where temporary files go, and a
// checkpoint beside the image if there is room for that.
void RenderRun::writeRescued(FilmPicture& picture, std::vector<ImageAttribute> attributes, const IoError& why) {
    std::string saved = savedElsewhere(summary_.image, "image", [&](const std::string& path) {
        Diagnostics ignored;
        writeImage(path, picture, film_, std::move(attributes), ignored);
    });
    if (checkpoint_) {
        try {
            checkpoint_->save();
            saved += fmt::format("; the render was saved as `{}`", checkpoint_->path());
        } catch (const IoError&) {
            if (checkpoint_->isThere())
                saved += fmt::format("; an earlier state of the render is in `{}`", checkpoint_->path());
        }
    }
    throw IoError(why.what() + saved);
}

} // namespace abbe
