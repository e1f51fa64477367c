#include "denoise/denoise.h"

#include "app/json.h"
#include "base/stopwatch.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "io/exr_reader.h"
#include "io/exr_writer.h"
#include "spectrum/color_space.h"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace abbe {

const char* const kDenoiseHelp = R"(Adds a denoised layer to an image; the picture itself stays as it is.

Examples:
  abbe denoise room.exr                        adds denoised.R .G .B and denoised.error to the file
  abbe denoise room.exr -o clean.exr           leaves room.exr alone
  abbe denoise room.exr --preview              rough, in a fraction of the time
  abbe denoise room.exr --method oidn          by Open Image Denoise, where it is installed

The scene asks for what it needs: film { layers { denoise } })";

void addArguments(Arguments& a, DenoiseOptions& o) {
    a.argument("image", &o.input, "EXR of a render with `layers { denoise }`").require();
    a.value("-o,--output", "FILE", &o.output, "EXR to write; without it the image itself gets the layer");
    a.choice<DenoiseMethod>(
        "--method", o.method,
        {{"nfor", DenoiseMethod::nfor}, {"preview", DenoiseMethod::preview}, {"oidn", DenoiseMethod::oidn}},
        "Regressions (the default), wavelets, or the network of Open Image Denoise");
    a.flag("--preview", &o.preview, "The same as `--method preview`: fast");
    addThreads(a);
    addJson(a);
    a.afterwards([&o]() -> std::optional<ArgumentFault> {
        if (o.preview && o.method && *o.method != DenoiseMethod::preview)
            return ArgumentFault{
                "--preview",
                fmt::format("it is the method `preview`, and --method asks for `{}`; leave one out", name(*o.method))};
        return {};
    });
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
            try {
                denoiseInput(input);
            } catch (const DenoiserFault& fault) {
                diagnostics_.error(fault.code, {}, fault.what()).help = fault.help;
                common_.console.report(diagnostics_, SourceMap());
                return ExitCode::system;
            }
        }
        common_.console.report(diagnostics_, SourceMap());
        if (diagnostics_.hasErrors()) return ExitCode::faulty;
        write();
        report(input.width, input.height);
        return ExitCode::done;
    }

  private:
    DenoiseInput collect(const ExrPlanes& planes);
    void denoiseInput(const DenoiseInput& input);
    RgbSpace colours(const ExrInfo& info) const;
    void checkHalves(const DenoiseInput& input);
    void warnOfMissing(const DenoiseFeatures& features);
    void write() const;
    void report(int width, int height) const;

    const std::string& output() const { return options_.output.empty() ? options_.input : options_.output; }
    DenoiseMethod method() const {
        return options_.preview ? DenoiseMethod::preview : options_.method.value_or(DenoiseMethod::nfor);
    }

    const DenoiseOptions& options_;
    const CommonOptions& common_;
    Diagnostics diagnostics_;
    Names names_ = kRgb;
    DenoiseResult result_;
    std::string label_; // the denoiser and its version
    double seconds_ = 0;
};

void DenoiseRun::denoiseInput(const DenoiseInput& input) {
    label_ = fmt::format("{} {}", name(method()), version(method()));
    Stopwatch watch;
    result_ = denoise(input, method());
    seconds_ = watch.lap();
    if (result_.repaired > 0)
        diagnostics_.warning("W0446", {},
                             fmt::format("{} pixels of `{}` are not finite; their neighbours stand in for them",
                                         result_.repaired, options_.input));
}

DenoiseInput DenoiseRun::collect(const ExrPlanes& planes) {
    DenoiseInput input;
    input.width = planes.info.window.width();
    input.height = planes.info.window.height();
    input.colour = layer(planes, "", kRgb, kRgb);
    if (input.colour[0].mean.empty()) {
        names_ = kXyz;
        input.colour = layer(planes, "", kXyz, kRgb); // the halves of a picture in XYZ have these names too
    }
    input.toRec709 = rgb::rec709.fromXyz() * colours(planes.info).toXyz();
    checkHalves(input);
    input.features.albedo = layer(planes, "albedo.", kRgb, kRgb);
    input.features.normal = layer(planes, "normal.", kXyz, kXyz);
    if (const auto* depth = planes.find("depth.Z")) input.features.depth.mean = *depth;
    if (const auto* half = planes.find("half.depth.Z")) input.features.depth.half = *half;
    if (!diagnostics_.hasErrors()) warnOfMissing(input.features);
    return input;
}

// As the file states them; a file that states none has the primaries of Rec. 709, by the rules of OpenEXR.
RgbSpace DenoiseRun::colours(const ExrInfo& info) const {
    if (names_ == kXyz) return rgb::xyz;
    return info.chromaticities ? info.chromaticities->space() : rgb::rec709;
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
    if (features.depth.mean.empty() && method() != DenoiseMethod::oidn) missing.emplace_back("depth");
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
    const std::vector<ImageAttribute> attributes{{"abbe.denoiser", label_ + " (biased)"},
                                                 {"abbe.denoisedRelMse", result_.relMseAfter},
                                                 {"abbe.denoisedRelMseBefore", result_.relMseBefore}};
    appendExr(options_.input, output(), channels, attributes);
}

void DenoiseRun::report(int width, int height) const {
    const double megapixels = 1e-6 * width * height;
    if (common_.json) {
        const Json object = Json::object({{"image", output()},
                                          {"denoiser", label_},
                                          {"rel_mse_before", result_.relMseBefore},
                                          {"rel_mse", result_.relMseAfter},
                                          {"repaired", result_.repaired},
                                          {"outside_rec709", result_.outside},
                                          {"seconds", seconds_}});
        common_.console.data(object.text() + "\n");
        return;
    }
    common_.console.line(fmt::format("denoised by {}: {:.3g} Mpx in {:.2f} s, {:.3g} s/Mpx", label_, megapixels,
                                     seconds_, seconds_ / megapixels));
    common_.console.line(
        fmt::format("relMSE {:.3g}, before {:.3g} (estimates)", result_.relMseAfter, result_.relMseBefore));
    if (result_.outside > 0)
        common_.console.line(
            fmt::format("{} pixels have colours outside of Rec. 709, denoised in two parts", result_.outside));
    common_.console.line(fmt::format("image {}, layer denoised", output()));
}

} // namespace

ExitCode run(const DenoiseOptions& options, const CommonOptions& common) { return DenoiseRun(options, common).run(); }

} // namespace abbe
