// How many samples a denoised picture stands for:  bench_denoising [--picture FILE.png] REFERENCE NOISY LATER…
// All are OpenEXR files of `film { layers { denoise } }` of one scene: the reference of another seed and many samples,
// the picture that is denoised, and the same scene with more samples, in rising order (bench/denoising.sh makes them).
// Prints FLIP and relMSE of all, and where the denoised ones lie on the line through the noisy ones (logarithms of
// error and samples; beyond the last one it goes on straight).
//   bench_denoising --methods [--picture FILE.png] REFERENCE NOISY…
// prints of each picture its samples and FLIP, and of each method FLIP, relMSE over that of the noisy picture, the
// estimated over the true relMSE, and seconds per megapixel, with tabs between; the sheet has the last picture by all.
#include "denoise/denoise.h"
#include "io/exr_reader.h"
#include "io/file.h"
#include "io/flip.h"
#include "io/image_compare.h"
#include "io/png_writer.h"
#include "spectrum/color_space.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <fmt/format.h>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace abbe;

// A render with its halves and features.
struct Render {
    RgbImage image;
    ExrPlanes planes;
    double samples = 0;

    explicit Render(const std::string& path) : image(readImage(path)), planes(readExrChannels(path)) {
        for (const ImageAttribute& a : planes.info.attributes)
            if (a.name == "abbe.samples") samples = std::visit([](const auto& v) { return number(v); }, a.value);
    }
    std::array<DenoiseChannel, 3> layer(const std::string& name, const std::array<const char*, 3>& channels) const {
        std::array<DenoiseChannel, 3> result;
        for (std::size_t c = 0; c < 3; ++c) result[c] = channel(name + channels[c]);
        return result;
    }
    DenoiseChannel channel(const std::string& name) const {
        const auto *mean = planes.find(name), *half = planes.find("half." + name);
        if (!mean || !half) throw IoError("no " + name);
        return {*mean, *half};
    }
    DenoiseInput input() const {
        DenoiseInput in;
        in.width = image.width();
        in.height = image.height();
        in.colour = layer("", {"R", "G", "B"});
        in.features = {layer("albedo.", {"R", "G", "B"}), layer("normal.", {"X", "Y", "Z"}), channel("depth.Z")};
        if (image.chromaticities) in.toRec709 = rgb::rec709.fromXyz() * image.chromaticities->space().toXyz();
        return in;
    }

  private:
    static double number(double v) { return v; }
    static double number(const std::string& text) { return std::strtod(text.c_str(), nullptr); }
};

RgbImage imageOf(const RgbImage& like, const DenoiseResult& result) {
    RgbImage image = like;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = result.colour[i % 3][i / 3];
    return image;
}

struct Figures {
    std::vector<float> map; // FLIP of each pixel
    double flip = 0, relMse = 0;
};

// The halves of the reference are two references: relMSE is free of their noise, FLIP is not.
class Truth {
  public:
    explicit Truth(const Render& reference) : mean_(reference.image), first_(mean_), second_(mean_) {
        const auto colour = reference.input().colour;
        for (std::size_t i = 0; i < mean_.rgb.size(); ++i) {
            first_.rgb[i] = colour[i % 3].half[i / 3];
            second_.rgb[i] = 2 * mean_.rgb[i] - first_.rgb[i];
        }
    }
    const RgbImage& mean() const { return mean_; }
    Figures measure(const RgbImage& image) const {
        HdrFlip flip = hdrFlip(image, mean_);
        return {std::move(flip.map), flip.mean, unbiasedRelMse(image, first_, second_)};
    }
    // Of an estimated error what relMSE is of the real one.
    double relative(const std::vector<float>& error) const {
        double sum = 0, mean = 0;
        for (const float v : mean_.rgb) mean += v;
        const double scale = 0.25 * static_cast<double>(mean_.rgb.size()) / mean;
        for (std::size_t i = 0; i < mean_.rgb.size(); ++i)
            sum += std::pow(scale * error[i / 3], 2) / (std::pow(scale * mean_.rgb[i], 2) + 0.01);
        return sum / static_cast<double>(mean_.rgb.size());
    }

  private:
    RgbImage mean_, first_, second_;
};

// The samples at which the line through (samples, error) reaches `error`, all in logarithms.
double samplesFor(double error, const std::vector<std::pair<double, double>>& curve) {
    std::size_t i = 1;
    while (i + 1 < curve.size() && curve[i].second > error) ++i;
    const auto [n0, e0] = curve[i - 1];
    const auto [n1, e1] = curve[i];
    return n0 * std::pow(n1 / n0, std::log(error / e0) / std::log(e1 / e0));
}

// Noisy, denoised by both methods, reference; below them the maps of FLIP.
class Sheet {
  public:
    Sheet(int width, int height, int columns)
        : width_(width), height_(height), stride_(width * columns),
          rgb_(6U * static_cast<std::size_t>(stride_ * height)) {}
    void add(const RgbImage& image, const Figures& figures, double exposure) {
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                const auto i = static_cast<std::size_t>(y * width_ + x);
                for (std::size_t c = 0; c < 3; ++c) {
                    at(x, y)[c] = static_cast<float>(shown(exposure * image.rgb[3 * i + c]));
                    at(x, y + height_)[c] = std::min(1.f, 2 * figures.map[i]);
                }
            }
        ++column_;
    }
    void write(const std::string& path) const { writePng(path, {stride_, 2 * height_, rgb_}); }

  private:
    static double shown(double v) { return std::pow(std::max(v, 0.) / (1 + std::max(v, 0.)), 1 / 2.2); }
    float* at(int x, int y) { return &rgb_[3U * static_cast<std::size_t>(y * stride_ + column_ * width_ + x)]; }
    int width_, height_, stride_, column_ = 0;
    std::vector<float> rgb_;
};

void run(std::vector<std::string> files, const std::string& picture) {
    const Render reference(files[0]);
    const Truth truth(reference);
    std::vector<std::pair<double, double>> flips, relMses;
    for (std::size_t i = 1; i < files.size(); ++i) {
        const Render render(files[i]);
        const Figures f = truth.measure(render.image);
        flips.emplace_back(render.samples, f.flip);
        relMses.emplace_back(render.samples, f.relMse);
        fmt::print("{:>8} samples  FLIP {:.4f}  relMSE {:.3g}\n", render.samples, f.flip, f.relMse);
    }
    const Render noisy(files[1]);
    Sheet sheet(noisy.image.width(), noisy.image.height(), 4);
    double mean = 0;
    for (const float v : reference.image.rgb) mean += v / static_cast<double>(reference.image.rgb.size());
    sheet.add(noisy.image, truth.measure(noisy.image), 0.5 / mean);
    for (const DenoiseMethod method : {DenoiseMethod::nfor, DenoiseMethod::preview}) {
        const auto start = std::chrono::steady_clock::now();
        const DenoiseResult result = denoise(noisy.input(), method);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        const RgbImage image = imageOf(reference.image, result);
        const Figures f = truth.measure(image);
        fmt::print(
            "{:>8} {:<8} FLIP {:.4f} = x{:.2f}  relMSE {:.3g} = x{:.1f}  estimate/truth {:.2f}, by pixels {:.2f}  "
            "{:.1f} s/Mpx\n",
            noisy.samples, name(method), f.flip, samplesFor(f.flip, flips) / noisy.samples, f.relMse,
            samplesFor(f.relMse, relMses) / noisy.samples, result.relMseAfter / f.relMse,
            truth.relative(result.error) / f.relMse,
            1e6 * seconds.count() / static_cast<double>(noisy.image.window.area()));
        sheet.add(image, f, 0.5 / mean);
    }
    sheet.add(reference.image, truth.measure(reference.image), 0.5 / mean);
    if (!picture.empty()) sheet.write(picture);
}

void compareMethods(const std::vector<std::string>& files, const std::string& picture) {
    constexpr DenoiseMethod kMethods[] = {DenoiseMethod::preview, DenoiseMethod::nfor, DenoiseMethod::oidn};
    const Render reference(files[0]);
    const Truth truth(reference);
    double mean = 0;
    for (const float v : reference.image.rgb) mean += v / static_cast<double>(reference.image.rgb.size());
    Sheet sheet(reference.image.width(), reference.image.height(), 5);
    for (std::size_t i = 1; i < files.size(); ++i) {
        const Render noisy(files[i]);
        const Figures before = truth.measure(noisy.image);
        const bool shown = i + 1 == files.size();
        if (shown) sheet.add(noisy.image, before, 0.5 / mean);
        fmt::print("{}\t{:.4f}", noisy.samples, before.flip);
        for (const DenoiseMethod method : kMethods) {
            const auto start = std::chrono::steady_clock::now();
            const DenoiseResult result = denoise(noisy.input(), method);
            const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
            const RgbImage image = imageOf(reference.image, result);
            const Figures f = truth.measure(image);
            fmt::print("\t{:.4f}\t{:.3f}\t{:.2f}\t{:.1f}", f.flip, f.relMse / before.relMse,
                       result.relMseAfter / f.relMse,
                       1e6 * seconds.count() / static_cast<double>(noisy.image.window.area()));
            if (shown) sheet.add(image, f, 0.5 / mean);
        }
        fmt::print("\n");
    }
    sheet.add(reference.image, truth.measure(reference.image), 0.5 / mean);
    if (!picture.empty()) sheet.write(picture);
}

} // namespace

int main(int argc, char** argv) {
    std::vector<std::string> files(argv + 1, argv + argc);
    std::string picture;
    const bool methods = !files.empty() && files[0] == "--methods";
    if (methods) files.erase(files.begin());
    if (files.size() > 1 && files[0] == "--picture") {
        picture = files[1];
        files.erase(files.begin(), files.begin() + 2);
    }
    if (files.size() < (methods ? 2 : 3)) {
        fmt::print(stderr, "usage: bench_denoising [--methods] [--picture FILE.png] REFERENCE NOISY LATER...\n");
        return 2;
    }
    try {
        methods ? compareMethods(files, picture) : run(files, picture);
    } catch (const std::exception& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
}
