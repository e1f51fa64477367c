#include "render_run/frame_run.h"

#include "app/identity.h"
#include "checkpoints/render_identity.h"
#include "checkpoints/render_parts.h"
#include "io/exr_reader.h"
#include "io/file.h"
#include "render_run/frame_overview.h"
#include "render_run/render_run.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

std::string frameImagePath(const std::string& asked, int frame, std::optional<Vec2i> part) {
    std::string image = framePath(asked, frame);
    if (!part) return image;
    // Of "shot" the number is no extension that gives way to that of a part.
    const auto extension = std::filesystem::path(image).extension();
    if (extension != ".exr" && extension != ".abbe") image += ".exr";
    return partPath(image, *part);
}

std::string frameFingerprint(const RenderOptions& options, const FrameFacts& in) {
    const BuildOptions& b = options.build;
    const RenderParams& render = in.built->render;
    const FilmSettings film = filmSettings(in.built->film);
    const RenderSettings settings = renderSettings(render);
    auto facts =
        renderIdentity({in.loaded, &film, &settings, static_cast<int>(render.replicates), b.camera, render.fps});
    const auto add = [&](const char* name, const auto& value) { facts.push_back({name, fmt::format("{}", value)}); };
    add("samples", render.samples);
    add("noise", render.noise);
    add("time", render.timeLimit);
    add("crop", fmt::format("{} {} {} {}", in.crop.x0, in.crop.y0, in.crop.x1, in.crop.y1));
    if (b.pilot) add("pilot", *b.pilot);
    for (const std::string& word : {options.view.display, options.view.view, options.view.config}) add("view", word);
    add("exposure", options.view.exposure);
    for (Fact& fact : settingFacts(*in.loaded)) facts.push_back(std::move(fact));
    Hash128 hash;
    for (const Fact& fact : facts) {
        hash.addField(fact.name);
        hash.addField(fact.value);
    }
    return hash.digits();
}

namespace {

class FrameRun {
  public:
    FrameRun(const RenderOptions& options, const CommonOptions& common)
        : options_(options), common_(common), overview_(options, common) {}

    ExitCode run() {
        const std::vector<int>& frames = options_.frames;
        std::set<std::string> told;
        if (const ExitCode code = overview_.check(); code != ExitCode::done) return code;
        for (std::size_t i = 0; i < frames.size(); ++i) {
            const RenderOptions one = optionsOf({frames[i], i + 1, frames.size(), &told});
            if (one.checkpoint.resume && isThere(one)) continue;
            try {
                checks_.forgetAll();
                RenderRun render(one, common_, &carry_);
                if (const ExitCode code = render.run(); code != ExitCode::done) {
                    overview_.fail();
                    end(frames[i], code);
                    return code;
                }
                if (!one.part) overview_.add(render.image());
            } catch (...) { // what went wrong is told by who catches it in the end
                overview_.fail();
                end(frames[i], ExitCode::system);
                throw;
            }
            done_.push_back(frames[i]);
        }
        return end(std::nullopt, ExitCode::done);
    }

  private:
    RenderOptions optionsOf(const FrameOfRun& frame) const {
        RenderOptions one = options_;
        one.frames.clear();
        one.frame = frame;
        one.input.frame = frame.number;
        if (!one.png.path.empty()) one.png.path = framePath(one.png.path, frame.number);
        return one;
    }

    // Whether the image of a frame needs nothing more. What is wrong with the scene is told by the render.
    bool isThere(const RenderOptions& one) {
        if (one.part) return false; // parts say for themselves what they lack
        const auto loaded = carry_.scenes.load(one.input);
        if (!loaded->readable || loaded->diagnostics.hasErrors()) return false;
        BuildOptions build = one.build;
        build.geometry = false;
        const BuiltScene built = buildScene(loaded->tree, loaded->types, build, loaded->diagnostics, &checks_);
        if (loaded->diagnostics.hasErrors() || !findFaults(built.film).empty()) return false;
        const FilmSettings film = filmSettings(built.film);
        const std::string asked = imagePath(one.output, film, one.input.path);
        if (!framePatternFault(asked).empty()) return false;
        const std::string image = frameImagePath(asked, one.frame->number, {});
        if (!isWhole(image) || (built.layers.deep && !std::filesystem::exists(deepPath(image)))) return false;
        if (fingerprintOf(image) != frameFingerprint(one, {loaded.get(), &built, one.crop.value_or(film.crop)}))
            return false;
        skipped_.push_back(one.frame->number);
        overview_.add(image);
        tellSkipped(one, image);
        return true;
    }

    static const ImageAttribute* find(const std::vector<ImageAttribute>& list, std::string_view name) {
        const auto found = std::ranges::find(list, name, &ImageAttribute::name);
        return found == list.end() ? nullptr : &*found;
    }

    static std::vector<ImageAttribute> headerOf(const std::string& image) {
        try {
            return readExrInfo(image).attributes;
        } catch (const IoError&) { // it is not there, or no image
            return {};
        }
    }

    static bool isWhole(const std::string& image) {
        const auto header = headerOf(image);
        const ImageAttribute* const partial = find(header, "abbe.partial");
        const int* const value = partial ? std::get_if<int>(&partial->value) : nullptr;
        return value && *value == 0;
    }

    static std::string fingerprintOf(const std::string& image) {
        const auto header = headerOf(image);
        const ImageAttribute* const found = find(header, kFrameFingerprint);
        const auto* const value = found ? std::get_if<std::string>(&found->value) : nullptr;
        return value ? *value : std::string();
    }

    void tellSkipped(const RenderOptions& one, const std::string& image) const {
        if (common_.json)
            common_.console.data(
                Json::object({{"event", "skipped"}, {"image", image}, {"frame", one.frame->number}}).text() + "\n");
        else if (!options_.quiet)
            common_.console.line(fmt::format("{}: number {} is in {}", one.frame->text(), one.frame->number, image));
    }

    // Which frames are done; `failed` is the one that ended the run. The code, or that of an overview that failed.
    ExitCode end(std::optional<int> failed, ExitCode code) {
        if (!overview_.end() && code == ExitCode::done) code = ExitCode::system;
        std::vector<int> there = done_;
        there.insert(there.end(), skipped_.begin(), skipped_.end());
        std::ranges::sort(there);
        if (common_.json) {
            common_.console.data(Json::object({{"event", "frames"},
                                               {"exit", static_cast<int>(code)},
                                               {"failed", failed ? Json(*failed) : Json()},
                                               {"done", frameListText(there)},
                                               {"rendered", static_cast<std::uint64_t>(done_.size())},
                                               {"skipped", static_cast<std::uint64_t>(skipped_.size())}})
                                     .text() +
                                 "\n");
            return code;
        }
        const std::string list = there.empty() ? "no frame is done" : "frames that are done: " + frameListText(there);
        if (failed)
            common_.console.line(fmt::format("frame {} ended the animation; {}", *failed, list));
        else if (!options_.quiet && options_.frames.size() > 1)
            common_.console.line(fmt::format("{} of {} frames rendered, {} were there", done_.size(),
                                             options_.frames.size(), skipped_.size()));
        return code;
    }

    const RenderOptions& options_;
    const CommonOptions& common_;
    FrameOverview overview_;
    RenderCarry carry_;               // from frame to frame
    SceneReuse checks_;               // likewise, of scenes without geometry; until something is rendered
    std::vector<int> done_, skipped_; // numbers of frames
};

} // namespace

ExitCode runFrames(const RenderOptions& options, const CommonOptions& common) {
    return FrameRun(options, common).run();
}

} // namespace abbe
