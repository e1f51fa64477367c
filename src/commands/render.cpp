#include "base/memory_limit.h"
#include "command_line/arguments.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "render_run/frame_run.h"
#include "render_run/render_run.h"

#include <fmt/format.h>

namespace abbe {

const char* const kRenderHelp = R"(Renders a scene to an OpenEXR image.

Examples:
  abbe render room.scene -o room.exr
  abbe render room.scene --size 640x360 --samples 64 --png=look.png    another name than room.png; --png off: none
  abbe render room.scene --noise 0.5% --time 45min     ends at whichever comes first
  abbe render prism.scene -D prism-turn='-32.9 deg'    sets a parameter of the scene
  abbe render room.scene --json                        progress as JSON lines on stdout
  abbe render room.scene --resume                      goes on where it was interrupted
  abbe render room.scene --tev                         shows the picture in tev while it renders
  abbe render room.scene --part 2/4                    a quarter of the samples, for `abbe merge`
  abbe render shot.scene --frames 1-240 -o shot.####.exr    an animation, frame after frame
  abbe render shot.scene --frames 1-24 --contact-sheet sheet.png --clip clip.mp4    and all of it at a glance

Ctrl-C writes the image and a checkpoint; a second one leaves at once.)";

namespace {

constexpr const char* kStudies = "For studies"; // heading of flags that compare ways to render

// When the render ends, and what it may take until then.
void addGoals(Arguments& a, RenderOptions& o) {
    constexpr const char* kCacheSize = "an amount of memory such as 512MiB, 16MiB or more";
    constexpr const char* kMemorySize = "an amount of memory such as 4GiB, 16MiB or more";
    BuildOptions& b = o.build;
    const auto within = [](schema::Dimension dimension, double most) {
        return [dimension, most](const std::string& text) {
            const auto value = readQuantity(text, dimension);
            return value && *value >= 0 && *value <= most ? value : std::nullopt;
        };
    };
    a.value("--samples", "N", &b.samples, "Samples per pixel").between(1, 4294967295.0);
    a.read("--noise", "ERROR", b.noise, "a relative error such as 0.5%", within(schema::Dimension::fraction, 1),
           "Stop at this relative error: 0.5%");
    a.read("--texture-cache", "SIZE", b.textureCache, kCacheSize, readMebibytes,
           "Most memory for tiles of image textures: 512MiB, 4GiB");
    a.read("--memory", "SIZE", o.memory, kMemorySize, readMebibytes,
           "Most memory to take: 4GiB; without it all there is");
    a.read("--time", "TIME", b.timeLimit, "a time such as 45min", within(schema::Dimension::time, 1e9),
           "Stop after this time: 90, 45min, 2h");
    a.read("--adaptive", "on|off", b.adaptive, "on or off", readSwitch,
           "More samples where there is more noise, at the same cost");
}

std::string readCheckpoint(const std::string& text, CheckpointOptions& checkpoint) {
    checkpoint.off = text == "off";
    checkpoint.keep = text == "keep";
    if (checkpoint.off || checkpoint.keep) return {};
    const auto interval = readTime(text);
    if (!interval) return "`" + text + "` is not a time such as 5min, off or keep";
    checkpoint.interval = *interval;
    return {};
}

// What is kept of a render that is interrupted, or made in pieces.
void addPieces(Arguments& a, RenderOptions& o) {
    CheckpointOptions& checkpoint = o.checkpoint;
    a.value(
        "--checkpoint", "TIME|off|keep",
        [&checkpoint](const std::string& text) { return readCheckpoint(text, checkpoint); },
        "Save what was done every so often (25s); off: never; keep: also when done");
    a.flag("--resume", &checkpoint.resume, "Go on from the checkpoint, if there is one");
    a.read("--crop", "X0,Y0,X1,Y1", o.crop, "a rectangle such as 0,0,640,360", readCrop, "Render these pixels only");
    a.read("--part", "K/N", o.part, "a part such as 2/4", readPart,
           "Take the K-th of N ranges of the samples and write a part for `merge`");
    a.value("--skip", "N", &o.skip, "With --part: leave out the first N samples per pixel, which earlier parts have");
}

// What contradicts an animation.
std::optional<ArgumentFault> frameContradiction(const RenderOptions& o) {
    const std::pair<const char*, bool> ofFrames[] = {
        {"--fps", o.build.fps.has_value()}, {"--contact-sheet", !o.sheet.empty()}, {"--clip", !o.clip.empty()}};
    for (const auto& [name, given] : ofFrames) {
        if (given && o.frames.empty())
            return ArgumentFault{name, "it is for the frames of an animation; write `--frames 1-24`"};
        if (given && name != std::string_view("--fps") && (o.pixel || o.part))
            return ArgumentFault{name, fmt::format("{} makes no pictures of frames; leave one of them out",
                                                   o.part ? "--part" : "--pixel")};
    }
    if (o.frames.empty()) return std::nullopt;
    for (const std::string& pattern : {o.output, o.png.path})
        if (std::string fault = framePatternFault(pattern); !fault.empty())
            return ArgumentFault{pattern == o.output ? "--output" : "--png", std::move(fault)};
    if (o.pixel && o.frames.size() > 1)
        return ArgumentFault{"--pixel", fmt::format("it looks at one frame; write `--frames {}`", o.frames.front())};
    for (const std::string& define : o.input.defines)
        if (define.starts_with("frame="))
            return ArgumentFault{"-D", "the parameter `frame` is set by `--frames`; leave one of them out"};
    return std::nullopt;
}

void addFrames(Arguments& a, RenderOptions& o) {
    const auto read = [&o](const std::string& text) {
        std::string fault;
        o.frames = readFrames(text, &fault);
        return fault;
    };
    a.value("--frames", "LIST", read, "Render these frames of an animation: 7, 1-240, 1-240x2, 1-10,20");
    addRate(a, o.build);
    a.value("--contact-sheet", "FILE", &o.sheet, "With --frames: a PNG with the pictures of all frames");
    a.value("--clip", "FILE", &o.clip, "With --frames: a film of them (.mp4, .mov, .mkv), by ffmpeg");
    a.afterwards([&o] { return frameContradiction(o); });
}

void addViewer(Arguments& a, RenderOptions& o) {
    addTev(a, o.tev, "Show the picture and its layers in tev while it renders; 127.0.0.1:14158");
    a.afterwards([&o]() -> std::optional<ArgumentFault> {
        if (!o.tev || (!o.part && !o.pixel)) return std::nullopt;
        return ArgumentFault{"--tev", fmt::format("{} makes no picture that could be shown; leave one of them out",
                                                  o.part ? "--part" : "--pixel")};
    });
}

} // namespace

void addArguments(Arguments& a, RenderOptions& o) {
    a.argument("scene", &o.input.path, "Scene file").require();
    a.value("-o,--output", "FILE", &o.output, "Image to write (EXR)");
    addFrames(a, o);
    addFrame(a, o.build);
    addGoals(a, o);
    addPieces(a, o);
    addDefines(a, o.input.defines);
    addLayers(a, o.input.layers);
    addThreads(a);
    addPng(a, o.png, o.view);
    addView(a, o.view);
    a.read("--preview", "on|off", o.preview, "on or off", readSwitch,
           "A PNG of what there is so far, until the image is written");
    addViewer(a, o);
    addJson(a, "Progress as JSON lines on stdout");
    a.read("--progress", "TIME", o.progressEvery, "a time such as 5s", readTime,
           "With --json: a line of it that often, 0.25s");
    a.flag("--cost,--bill", &o.cost, "Print what the time was spent on");
    a.flag("--quiet,-q", &o.quiet, "Say nothing but warnings and errors");
    a.flag("--strict", &o.strict, "Exit with 4 when there were warnings");
    a.choice<bool>("--kernel", o.largestKernel, {{"auto", false}, {"all", true}},
                   "all: the path loop with every effect")
        .under(kStudies);
    addTechniques(a, o.build, "How light is found", "Where random numbers come from", kStudies);
    a.read("--pixel", "X,Y", o.pixel, "a pixel such as 12,34", readPixel, "Render one pixel and print its value");
}

ExitCode run(const RenderOptions& options, const CommonOptions& common) {
    if (options.memory) setMemoryLimit(*options.memory * (1 << 20)); // for all readers, too
    return options.frames.empty() ? RenderRun(options, common).run() : runFrames(options, common);
}

} // namespace abbe
