#include "app/identity.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "io/exr_deep.h"
#include "io/image.h"
#include "io/png_writer.h"
#include "pictures/display_view.h"
#include "pictures/image_output.h"
#include "pictures/layer_view.h"
#include "schema/scene_tree.h"
#include "schema/suggest.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

const char* const kConvertHelp = R"(Turns an EXR into a PNG through a display view of OpenColorIO.

Examples:
  abbe convert room.exr room.png
  abbe convert room.exr room.png --exposure 1.5 --view Raw
  abbe convert room.exr depth.png --layer depth
  abbe convert room.deep.exr room.png             deep samples put over each other)";

void addArguments(Arguments& a, ConvertOptions& o) {
    a.argument("input", &o.input, "EXR that says what its colours are").require();
    a.argument("output", &o.output, "PNG, by its name too: room.png").require();
    a.value("--layer", "NAME", &o.layer, "A layer, or a channel, instead of the picture: depth, S0.555nm");
    a.flag("--overscan", &o.overscan, "Show what lies beyond the edges of the picture, too");
    a.choice<int>("--bits", o.bits, {{"8", 8}, {"16", 16}}, "Bits per component");
    addView(a, o.view);
}

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

// Deep samples are put over each other.
RgbImage readFlat(const std::string& path, const ExrInfo& info) {
    const DeepPicture deep = readDeepExr(path);
    const FlatPicture flat = flatten(deep);
    RgbImage image;
    image.window = deep.window;
    image.display = deep.display;
    image.chromaticities = info.chromaticities;
    image.adoptedNeutral = info.adoptedNeutral;
    for (std::size_t i = 0; i < flat.r.size(); ++i)
        image.rgb.insert(image.rgb.end(), {flat.r[i], flat.g[i], flat.b[i]});
    countFaults(image);
    return image;
}

void cutToDisplay(const ConvertOptions& options, const RgbImage& image, DisplayPicture& picture) {
    if (!options.overscan) cutOut(picture, image.window, image.display);
}

void noSuchLayer(const ConvertOptions& options, const ExrInfo& info, const CommonOptions& common) {
    const std::vector<std::string> names = layerNames(info);
    const std::vector<std::string_view> views(names.begin(), names.end());
    const std::string_view near = schema::nearest(options.layer, views);
    Diagnostics diagnostics;
    diagnostics.error("E0657", {}, fmt::format("`{}` has no layer and no channel `{}`", options.input, options.layer))
        .help = names.empty()  ? "it has no layers"
                : near.empty() ? fmt::format("its layers are {}", fmt::join(names, ", "))
                               : schema::didYouMean(near);
    common.console.report(diagnostics, {});
}

ExitCode noSuchFormat(const ConvertOptions& options, const CommonOptions& common) {
    const std::string png = std::filesystem::path(options.output).replace_extension(".png").string();
    Diagnostics diagnostics;
    diagnostics.error("E0432", {}, fmt::format("the picture `{}` must be a PNG", options.output)).help =
        fmt::format("name it `{}`; other programs make other formats of it", png);
    common.console.report(diagnostics, {});
    return ExitCode::usage;
}

ExitCode showColours(RgbImage image, const ConvertOptions& options, const CommonOptions& common) {
    if (const std::string fault = spaceFault(options.input, image); !fault.empty()) {
        common.console.error(fault);
        return ExitCode::faulty;
    }
    DisplayPicture picture;
    picture.space = makeViewable(image);
    picture.width = image.width();
    picture.height = image.height();
    picture.rgb = std::move(image.rgb);
    cutToDisplay(options, image, picture);
    writeDisplayPng(options.output, std::move(picture), options.view, options.bits);
    common.console.line(fmt::format("image {}", options.output));
    return ExitCode::done;
}

// Numbers that are no light are shown as they are, without a view.
ExitCode showLayer(const ConvertOptions& options, const CommonOptions& common) {
    const ExrInfo info = readExrInfo(options.input);
    const auto gain = static_cast<float>(std::exp2(options.view.exposure));
    auto layer = layerPicture(options.input, info, options.layer, gain);
    if (!layer) {
        noSuchLayer(options, info, common);
        return ExitCode::faulty;
    }
    RgbImage image;
    image.window = info.window;
    image.display = info.display;
    image.rgb = std::move(layer->rgb);
    if (layer->colours) {
        image.chromaticities = info.chromaticities;
        image.adoptedNeutral = info.adoptedNeutral;
        return showColours(std::move(image), options, common);
    }
    DisplayPicture picture{image.width(), image.height(), std::move(image.rgb), OutputSpace::aces2065_1};
    cutToDisplay(options, image, picture);
    PngPicture png{picture.width, picture.height, picture.rgb,
                   options.bits,  false,          {{"Software", "abbe " + versionNumber()}, {"Layer", options.layer}}};
    writePng(options.output, png);
    common.console.line(fmt::format("image {}", options.output));
    return ExitCode::done;
}

} // namespace

ExitCode run(const ConvertOptions& options, const CommonOptions& common) {
    if (!isPngName(options.output)) return noSuchFormat(options, common);
    if (!options.layer.empty()) return showLayer(options, common);
    if (std::filesystem::path(options.input).extension() == ".exr")
        if (const ExrInfo info = readExrInfo(options.input); info.deep)
            return showColours(readFlat(options.input, info), options, common);
    return showColours(readImage(options.input), options, common);
}

} // namespace abbe
