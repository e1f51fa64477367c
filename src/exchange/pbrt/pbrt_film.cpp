// The film and how it is sampled: of PbrtView.
#include "exchange/pbrt/pbrt_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

struct PbrtSensorName {
    std::string_view pbrt, ours;
};
constexpr std::array<PbrtSensorName, 3> kPbrtSensors{
    {{"canon_eos_5d_mkiv", "canon-5d-mark-iv"}, {"nikon_d850", "nikon-d850"}, {"sony_ilce_7m4", "sony-a7-iv"}}};

// The chromaticity of daylight has no formula that a scene could state, but for these.
std::string_view pbrtDaylight(double kelvin) {
    constexpr std::array<std::pair<double, std::string_view>, 5> kNamed{
        {{5000, "D50"}, {5500, "D55"}, {6000, "D60"}, {6500, "D65"}, {7500, "D75"}}};
    for (const auto& [temperature, name] : kNamed)
        if (std::abs(kelvin - temperature) <= 10) return name;
    return {};
}

} // namespace

void PbrtView::crop(SceneNode& node) {
    const auto pixels = film.params.numbers("pixelbounds"), window = film.params.numbers("cropwindow");
    std::array<double, 4> box{0, static_cast<double>(width_), 0, static_cast<double>(height_)}; // x0 x1 y0 y1
    if (window.size() == 4) { // shares of the frame; the first pixel is the one behind the edge
        for (std::size_t i = 0; i < 4; ++i)
            box[i] = std::ceil(std::clamp(window[i], 0.0, 1.0) * (i < 2 ? width_ : height_));
        if (box[0] > box[1]) std::swap(box[0], box[1]);
        if (box[2] > box[3]) std::swap(box[2], box[3]);
    } else if (pixels.size() == 4) {
        for (std::size_t i = 0; i < 4; ++i) box[i] = std::clamp(std::floor(pixels[i]), 0.0, i < 2 ? box[1] : box[3]);
    } else if (film.params.has("pixelbounds") || film.params.has("cropwindow")) {
        shared_.faults().error("E0802", film.params.directive, "`cropwindow` and `pixelbounds` take four numbers");
        return;
    } else {
        return;
    }
    if (box[0] >= box[1] || box[2] >= box[3])
        return void(shared_.faults().error("E0802", film.params.directive, "nothing is left of the film"));
    node.child("crop").number(box[0]).number(box[2]).number(box[1]).number(box[3]);
}

void PbrtView::sensor(SceneNode& node) {
    Diagnostics& faults = shared_.faults();
    const std::string name = film.params.text("sensor", "cie1931", faults);
    double kelvin = film.params.number("whitebalance", 0, faults);
    if (name != "cie1931") {
        const auto found = std::ranges::find(kPbrtSensors, name, &PbrtSensorName::pbrt);
        if (found != kPbrtSensors.end())
            node.child("sensor").word(found->ours);
        else
            shared_.out.approximated(&node, film.params.spanOf("sensor"), fmt::format("the sensor `{}`", name),
                                     "its sensitivities are not known here; colours are those of the CIE observer");
        if (kelvin == 0) kelvin = 6500; // as pbrt takes it for cameras
        if (found == kPbrtSensors.end() && kelvin == 6500) return;
    }
    if (kelvin <= 0) return;
    SceneNode& balance = node.child("white-balance");
    if (const auto daylight = pbrtDaylight(kelvin); !daylight.empty())
        return void(balance.word("illuminant").word(daylight));
    balance.word("blackbody").number(std::clamp(kelvin, 100.0, 1e6)).word("K");
    shared_.out.approximated(&node, film.params.spanOf("whitebalance"), "the white balance",
                             "it is for a black body of that temperature, in pbrt for daylight");
}

void PbrtView::filterNode(SceneNode& node) {
    Diagnostics& faults = shared_.faults();
    const std::string& type = filter.type;
    const double absent = type == "box" ? 0.5 : type == "gaussian" ? 1.5 : type == "sinc" ? 4 : 2;
    const double x = filter.params.number("xradius", absent, faults),
                 y = filter.params.number("yradius", absent, faults);
    double radius = std::clamp(x, 0.0, 16.0);
    std::string_view ours = type;
    const auto nearly = [&](std::string_view what, std::string_view how) {
        shared_.out.approximated(&node, filter.params.directive, what, how);
    };
    if (x != y) nearly("a filter of two radii", "that of x counts");
    if (type == "gaussian") {
        const double sigma = filter.params.number("sigma", 0.5, faults);
        if (std::abs(3 * sigma - radius) > 1e-3) {
            radius = std::clamp(3 * sigma, 0.01, 16.0);
            nearly("a gaussian filter", "its radius is three times `sigma`");
        }
    } else if (type == "mitchell") {
        const double b = filter.params.number("B", 1 / 3., faults), c = filter.params.number("C", 1 / 3., faults);
        if (std::abs(b - 1 / 3.) > 1e-3 || std::abs(c - 1 / 3.) > 1e-3)
            nearly("a filter of Mitchell", "B and C are one third");
    } else if (type == "sinc") {
        filter.params.find("tau");
        ours = "mitchell";
        radius = 2;
        nearly("the filter `sinc`", "`mitchell` is the nearest with a negative part");
    } else if (type != "box" && type != "triangle") {
        faults.error("E0802", filter.params.directive, fmt::format("there is no filter `{}`", type));
        return;
    }
    node.child("filter").word(ours).number(radius);
    filter.params.reportUnused(fmt::format("the filter `{}`", type), faults);
}

void PbrtView::filmNode(SceneNode& node) {
    Diagnostics& faults = shared_.faults();
    if (film.type == "image") throw PbrtOldScene{film.params.directive, "`Film \"image\"`"};
    node.child("size").number(width_).number(height_);
    crop(node);
    filterNode(node);
    sensor(node);
    const std::string file = film.params.text("filename", "pbrt.exr", faults);
    SceneNode& output = node.child("output");
    const std::string stem = std::filesystem::path(file).stem().string();
    output.text((stem.empty() ? "pbrt" : stem) + ".exr");
    if (film.colorSpace == "srgb")
        output.key("space", "rec709");
    else if (film.colorSpace == "aces2065-1")
        output.key("space", "aces2065-1");
    else {
        output.key("space", "acescg");
        shared_.out.approximated(&node, film.params.directive,
                                 fmt::format("a film in the colours `{}`", film.colorSpace),
                                 "the picture is in ACEScg, which holds them");
    }
    film.params.find("diagonal"); // of the realistic camera
    film.params.find("iso");
    film.params.flag("savefp16", true, faults);
    if (film.params.has("maxcomponentvalue"))
        shared_.out.leftOut(&node, film.params.spanOf("maxcomponentvalue"), "`maxcomponentvalue`",
                            "nothing is clamped here, so single samples may be brighter");
    if (film.type == "gbuffer") {
        film.params.find("coordinatesystem");
        SceneNode& layers = node.child("layers");
        for (const char* layer : {"albedo", "normal", "position", "depth", "uv"}) layers.child(layer);
    } else if (film.type == "spectral") {
        const double first = film.params.number("lambdamin", 360, faults),
                     last = film.params.number("lambdamax", 830, faults);
        const int buckets = film.params.integer("nbuckets", 16, faults);
        if (buckets > 0 && last > first)
            node.child("layers").child("spectral").number(first).number(last).number((last - first) / buckets);
    } else if (film.type != "rgb") {
        faults.error("E0802", film.params.directive, fmt::format("there is no film `{}`", film.type));
    }
    film.params.reportUnused(fmt::format("the film `{}`", film.type), faults);
}

void PbrtView::renderNode() {
    Diagnostics& faults = shared_.faults();
    SceneNode node("render");
    int samples = sampler.params.integer("pixelsamples", 16, faults);
    if (sampler.type == "stratified") {
        samples = sampler.params.integer("xsamples", 4, faults) * sampler.params.integer("ysamples", 4, faults);
        sampler.params.find("jitter");
        node.child("sampler").word("stratified");
    } else if (sampler.type == "independent") {
        node.child("sampler").word("random");
    } else if (sampler.type == "lowdiscrepancy" || sampler.type == "02sequence" || sampler.type == "random") {
        throw PbrtOldScene{sampler.params.directive, fmt::format("the sampler `{}`", sampler.type)};
    }
    sampler.params.find("randomization");
    const int own = sampler.params.integer("seed", seed, faults);
    node.child("samples").number(std::max(samples, 1));
    if (own != 0) node.child("seed").number(std::abs(static_cast<double>(own)));
    const int depth = integrator.params.integer("maxdepth", 5, faults);
    node.child("max-depth").number(std::clamp(depth, 1, 100000));
    if (depth < 1)
        shared_.out.approximated(&node, integrator.params.spanOf("maxdepth"), "a `maxdepth` of 0",
                                 "0 is no limit here, so there is one bounce");
    const std::string choice = integrator.params.text("lightsampler", "bvh", faults);
    if (choice == "uniform" || choice == "power") node.child("light-choice").word(choice);
    constexpr std::array<std::string_view, 4> kPaths = {"path", "volpath", "simplepath", "simplevolpath"};
    if (std::ranges::find(kPaths, integrator.type) == kPaths.end())
        shared_.out.approximated(&node, integrator.params.directive,
                                 fmt::format("the integrator `{}`", integrator.type),
                                 "paths are traced from the camera, and from lights where a pilot finds that it pays");
    if (integrator.params.flag("regularize", false, faults))
        shared_.out.leftOut(&node, integrator.params.spanOf("regularize"), "`regularize`",
                            "glossy surfaces stay as they are");
    for (const char* ofOthers : {"samplelights", "samplebsdf", "visualizestrategies", "visualizeweights",
                                 "bootstrapsamples", "chains", "mutationsperpixel", "largestepprobability", "sigma",
                                 "photonsperiteration", "radius", "cossample", "maxdistance", "rrthreshold"})
        integrator.params.find(ofOthers);
    sampler.params.reportUnused(fmt::format("the sampler `{}`", sampler.type), faults);
    integrator.params.reportUnused(fmt::format("the integrator `{}`", integrator.type), faults);
    shared_.settings.push_back(std::move(node));
}

} // namespace abbe::exchange
