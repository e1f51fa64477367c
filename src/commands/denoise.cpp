#include "denoise/denoise.h"

#include "app/json.h"
#include "base/stopwatch.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "io/exr_reader.h"
#include "io/exr_writer.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

const char* const kDenoiseHelp = R"(Adds a denoised layer to an image; the picture itself stays as it is.

Examples:
  abbe denoise room.exr                        adds denoised.R .G .B and denoised.error to the file
  abbe denoise room.exr -o clean.exr           leaves room.exr alone
  abbe denoise room.exr --preview              rough, in a fraction of the time

The scene asks for what it needs: film { layers { denoise } })";

void addArguments(Arguments& a, DenoiseOptions& o) {
    a.argument("image", &o.input, "EXR of a render with `layers { denoise }`").require();
    a.value("-o,--output", "FILE", &o.output, "EXR to write; without it the image itself gets the layer");
    a.flag(
        "--preview", [&o] { o.method = DenoiseMethod::preview; }, "Wavelets instead of regressions: fast");
    addThreads(a);
    addJson(a);
}

namespace {

using Names = std::array<const char*, 3>;

constexpr Names kRgb{"R", "G", "B"}, kXyz{"X", "Y", "Z"};
constexpr const char* kLayers =
    "add `layers { denoise }` to the film of the scene and render again: the halves and the "
    "features of its surfaces are then in the image";

// The channels of a layer, without `mean` if not all are there, and of its first half.
std::array<DenoiseChannel, 3> layer(const ExrPlanes& planes, const std::string& prefix, const Names& names,
                                    const Names& halfNames) {
    std::array<DenoiseChannel, 3> channels;
    const auto complete = [&](const std::string& before, const Names& all) {
        return std::all_of(all.begin(), all.end(), [&](const char* n) { return planes.find(before + n); });
    };
    const bool mean = complete(prefix, names), half = complete("half." + prefix, halfNames);
    for (std::size_t c = 0; mean && c < 3; ++c) {
        channels[c].mean = *planes.find(prefix + names[c]);
        if (half) channels[c].half = *planes.find("half." + prefix + halfNames[c]);
    }
    return channels;
}

bool isWanted(std::string_view name) {
    if (name.starts_with("half.")) name.remove_prefix(5);
    if (name.size() == 1) return true;
    return name.starts_with("albedo.") || name.starts_with("normal.") || name == "depth.Z";
}

// One picture from its channels to the layer in the file.
class DenoiseRun {
  public:
    DenoiseRun(const DenoiseOptions& options, const CommonOptions& common) : options_(options), common_(common) {}

    ExitCode run() {
        const ExrPlanes planes = readExrChannels(options_.input, isWanted);
        const DenoiseInput input = collect(planes);
        if (!diagnostics_.hasErrors()) {
            Stopwatch watch;
            result_ = denoise(input, options_.method);
            seconds_ = watch.lap();
            if (result_.repaired > 0)
                diagnostics_.warning("W0446", {},
                                     fmt::format("{} pixels of `{}` are not finite; their neighbours stand in for them",
                                                 result_.repaired, options_.input));
        }
        common_.console.report(diagnostics_, SourceMap());
        if (diagnostics_.hasErrors()) return ExitCode::faulty;
        write();
        report(input.width, input.height);
        return ExitCode::done;
    }

  private:
    DenoiseInput collect(const ExrPlanes& planes);
    void checkHalves(const DenoiseInput& input);
    void warnOfMissing(const DenoiseFeatures& features);
    void write() const;
    void report(int width, int height) const;

    const std::string& output() const { return options_.output.empty() ? options_.input : options_.output; }
    std::string label() const { return fmt::format("{} {}", name(options_.method), version(options_.method)); }

    const DenoiseOptions& options_;
    const CommonOptions& common_;
    Diagnostics diagnostics_;
    Names names_ = kRgb;
    DenoiseResult result_;
    double seconds_ = 0;
};

DenoiseInput DenoiseRun::collect(const ExrPlanes& planes) {
    DenoiseInput input;
    input.width = planes.info.window.width();
    input.height = planes.info.window.height();
    input.colour = layer(planes, "", kRgb, kRgb);
    if (input.colour[0].mean.empty()) {
        names_ = kXyz;
        input.colour = layer(planes, "", kXyz, kRgb); // the halves of a picture in XYZ have these names too
    }
    checkHalves(input);
    input.features.albedo = layer(planes, "albedo.", kRgb, kRgb);
    input.features.normal = layer(planes, "normal.", kXyz, kXyz);
    if (const auto* depth = planes.find("depth.Z")) input.features.depth.mean = *depth;
    if (const auto* half = planes.find("half.depth.Z")) input.features.depth.half = *half;
    if (!diagnostics_.hasErrors()) warnOfMissing(input.features);
    return input;
}

void DenoiseRun::checkHalves(const DenoiseInput& input) {
    const auto& colour = input.colour;
    if (colour[0].mean.empty()) {
        diagnostics_.error("E0445", {}, fmt::format("`{}` has no picture in R G B or X Y Z", options_.input));
    } else if (colour[0].half.empty()) {
        diagnostics_
            .error("E0446", {},
                   fmt::format("`{}` does not hold the halves that tell noise from detail", options_.input))
            .help = kLayers;
    } else if (std::all_of(colour.begin(), colour.end(),
                           [](const DenoiseChannel& c) { return std::ranges::equal(c.mean, c.half); })) {
        diagnostics_
            .error("E0447", {}, fmt::format("both halves of `{}` are the same: they are one replicate", options_.input))
            .help = "render with two replicates or more; `replicates 2` is the default";
    }
}

void DenoiseRun::warnOfMissing(const DenoiseFeatures& features) {
    std::vector<std::string_view> missing;
    if (features.albedo[0].mean.empty()) missing.emplace_back("albedo");
    if (features.normal[0].mean.empty()) missing.emplace_back("normal");
    if (features.depth.mean.empty()) missing.emplace_back("depth");
    if (missing.empty()) return;
    diagnostics_
        .warning("W0445", {},
                 fmt::format("`{}` has no {}; textures and edges will lose detail", options_.input,
                             fmt::join(missing, ", no ")))
        .help = kLayers;
}

void DenoiseRun::write() const {
    std::vector<ExrChannel> channels;
    for (std::size_t c = 0; c < 3; ++c) channels.push_back({fmt::format("denoised.{}", names_[c]), result_.colour[c]});
    channels.push_back({"denoised.error", result_.error});
    const std::vector<ImageAttribute> attributes{{"abbe.denoiser", label() + " (biased)"},
                                                 {"abbe.denoisedRelMse", result_.relMseAfter},
                                                 {"abbe.denoisedRelMseBefore", result_.relMseBefore}};
    appendExr(options_.input, output(), channels, attributes);
}

void DenoiseRun::report(int width, int height) const {
    const double megapixels = 1e-6 * width * height;
    if (common_.json) {
        const Json object = Json::object({{"image", output()},
                                          {"denoiser", label()},
                                          {"rel_mse_before", result_.relMseBefore},
                                          {"rel_mse", result_.relMseAfter},
                                          {"repaired", result_.repaired},
                                          {"seconds", seconds_}});
        common_.console.data(object.text() + "\n");
        return;
    }
    common_.console.line(fmt::format("denoised by {}: {:.3g} Mpx in {:.2f} s, {:.3g} s/Mpx", label(), megapixels,
                                     seconds_, seconds_ / megapixels));
    common_.console.line(
        fmt::format("relMSE {:.3g}, before {:.3g} (estimates)", result_.relMseAfter, result_.relMseBefore));
    common_.console.line(fmt::format("image {}, layer denoised", output()));
}

} // namespace

ExitCode run(const DenoiseOptions& options, const CommonOptions& common) { return DenoiseRun(options, common).run(); }

} // namespace abbe
