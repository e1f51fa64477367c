#include "pictures/image_output.h"

#include "app/identity.h"
#include "io/exr_deep.h"
#include "io/exr_reader.h"
#include "io/file.h"
#include "io/png_writer.h"
#include "packs/unpacked.h"
#include "spectrum/color_space.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace abbe {

namespace {

// By which PNGs of this program are known.
constexpr const char* kSoftwareKey = "Software";
constexpr const char* kSoftwareName = "abbe ";

void warnOfLosses(const ExrReport& report, const std::string& path, Diagnostics& diagnostics) {
    if (report.halfOverflows > 0)
        diagnostics
            .warning("W0630", {},
                     fmt::format("{} values of `{}` exceed 65504, the largest half float", report.halfOverflows, path))
            .help = "leave out `half` in the film's output, or lower the exposure";
    for (const std::string& channel : report.leftOut)
        if (channel != "variance.Y") // which nobody asked for
            diagnostics.warning("W0631", {},
                                fmt::format("`{}` is an ACES container, which cannot hold `{}`", path, channel));
}

} // namespace

std::string imagePath(const std::string& output, const FilmSettings& film, const std::string& scenePath) {
    if (!output.empty()) return output;
    // A pack comes from elsewhere: its scene names a file, not a folder of this machine.
    if (!film.output.empty() && isPack(scenePath)) return std::filesystem::path(film.output).filename().string();
    if (!film.output.empty()) return film.output;
    return std::filesystem::path(scenePath).filename().replace_extension(".exr").string();
}

std::string pngPath(const PngOptions& png, const std::string& imagePath) {
    if (png.off) return {};
    if (!png.path.empty()) return png.path;
    return std::filesystem::path(imagePath).replace_extension(".png").string();
}

bool isPngName(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return ending == ".png";
}

bool isForeignPng(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return false;
    std::ifstream file(path, std::ios::binary);
    std::string head(4096, '\0'); // texts come before the pixels
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    const std::size_t key = head.find(std::string(kSoftwareKey) + '\0');
    if (key == std::string::npos) return true;
    // Zeros that say that the text is neither compressed nor translated stand between.
    const std::size_t value = head.find_first_not_of('\0', key + std::strlen(kSoftwareKey));
    return value == std::string::npos || !head.substr(value).starts_with(kSoftwareName);
}

std::string writeFault(const std::string& path) {
    try {
        const AtomicFile probe(path);
        return {};
    } catch (const IoError& e) {
        return e.what();
    }
}

std::string deepPath(const std::string& imagePath) {
    return std::filesystem::path(imagePath).replace_extension(".deep.exr").string();
}

bool isForeignDeep(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return false;
    try {
        const ExrInfo info = readExrInfo(path);
        return !info.deep ||
               std::ranges::find(info.attributes, "abbe.version", &ImageAttribute::name) == info.attributes.end();
    } catch (const IoError&) {
        return true;
    }
}

namespace {

PixelWindow windowOf(const PixelBounds& b) { return {b.x0, b.y0, b.x1, b.y1}; }

void warnOfSums(std::size_t unequal, const std::string& path, Diagnostics& diagnostics) {
    if (unequal == 0) return;
    diagnostics.warning(
        "W0656", {},
        fmt::format("{} values of the light groups or components of `{}` do not add up to the picture", unequal, path));
}

DeepPicture headOf(const ExrPicture& flat) {
    DeepPicture head{flat.window,         flat.display,   {}, {}, {}, {}, {}, {}, {}, flat.chromaticities,
                     flat.adoptedNeutral, flat.attributes};
    std::erase_if(head.attributes, [](const ImageAttribute& a) { return a.name.starts_with("cryptomatte/"); });
    return head;
}

DeepPicture pictureOf(DeepImage deep) {
    return {windowOf(deep.bounds),
            windowOf(deep.bounds),
            std::move(deep.counts),
            std::move(deep.front),
            std::move(deep.back),
            std::move(deep.a),
            std::move(deep.r),
            std::move(deep.g),
            std::move(deep.b),
            {},
            {}};
}

constexpr const char* kVariance = "variance.Y";

// R G B alone.
ExrPicture plainPicture(const ResolvedImage& image, const FilmSettings& film) {
    ExrPicture picture;
    picture.window = windowOf(image.bounds);
    picture.display = {0, 0, film.width, film.height};
    picture.r = image.r;
    picture.g = image.g;
    picture.b = image.b;
    picture.chromaticities = Chromaticities::of(rgbSpace(film.space));
    picture.adoptedNeutral = adoptedNeutral(film.space);
    picture.acesContainer = film.acesContainer;
    picture.compression = findExrCompression(film.compression).value_or(ExrCompression::zip);
    picture.half = film.half;
    picture.parts = film.parts;
    return picture;
}

ExrPicture describe(const FilmPicture& shot, const LayerPlanes& channels, const FilmSettings& film,
                    std::vector<ImageAttribute> attributes) {
    ExrPicture picture = plainPicture(shot.image, film);
    if (!shot.image.variance.empty()) picture.more.push_back({kVariance, {}});
    for (const NamedPlane& plane : channels.planes) picture.more.push_back({plane.name, {}});
    for (const auto& [name, value] : channels.header) attributes.push_back({name, value});
    picture.attributes = std::move(attributes);
    picture.attributes.push_back({"abbe.sensor", film.sensor});
    if (film.adoptedWhite)
        picture.attributes.push_back(
            {"abbe.whiteBalance", fmt::format("{:.5f} {:.5f} bradford", film.adoptedWhite->x, film.adoptedWhite->y)});
    picture.attributes.push_back({"colorInteropID", std::string(rgbSpace(film.space).name)});
    return picture;
}

// The rows of both files, which are made together.
class RowSource {
  public:
    explicit RowSource(FilmPicture& shot) : shot_(shot) {}

    // `deep`: takes those of the deep image; may be empty.
    std::vector<std::span<const float>> operator()(int y0, int y1, const DeepRows& deep) {
        const ResolvedImage& image = shot_.image;
        const auto width = static_cast<std::size_t>(image.bounds.width());
        std::swap(rows_, written_);
        rows_ = shot_.rows(y0, y1);
        unequalSums_ += rows_.layers.unequalSums;
        if (deep) deep(pictureOf(std::move(*rows_.deep)));
        std::vector<std::span<const float>> values;
        if (!image.variance.empty())
            values.push_back(std::span(image.variance)
                                 .subspan(static_cast<std::size_t>(y0 - image.bounds.y0) * width,
                                          static_cast<std::size_t>(y1 - y0) * width));
        for (const NamedPlane& plane : rows_.layers.planes) values.emplace_back(plane.values);
        return values;
    }
    std::size_t unequalSums() const { return unequalSums_; }

  private:
    FilmPicture& shot_;
    FilmPicture::Rows rows_, written_; // the last ones, and those before them
    std::size_t unequalSums_ = 0;
};

} // namespace

void writeImage(const std::string& path, FilmPicture& shot, const FilmSettings& film,
                std::vector<ImageAttribute> attributes, Diagnostics& diagnostics) {
    const int top = shot.image.bounds.y0;
    const ExrPicture picture = describe(shot, shot.rows(top, top).layers, film, std::move(attributes));
    RowSource source(shot);
    ExrReport report;
    const auto write = [&](const DeepRows& deep) {
        report = writeExr(path, picture, [&](int y0, int y1) { return source(y0, y1, deep); });
    };
    if (shot.hasDeep())
        writeDeepExr(deepPath(path), headOf(picture), write);
    else
        write({});
    warnOfLosses(report, path, diagnostics);
    warnOfSums(source.unequalSums(), path, diagnostics);
}

HeldImage holdImage(FilmPicture& shot, const FilmSettings& film, std::vector<ImageAttribute> attributes) {
    const PixelBounds bounds = shot.image.bounds;
    FilmPicture::Rows all = shot.rows(bounds.y0, bounds.y1);
    HeldImage held;
    ExrPicture picture = describe(shot, all.layers, film, std::move(attributes));
    if (all.deep) {
        held.deep = pictureOf(std::move(*all.deep));
        DeepPicture head = headOf(picture);
        held.deep->display = head.display;
        held.deep->chromaticities = head.chromaticities;
        held.deep->adoptedNeutral = head.adoptedNeutral;
        held.deep->attributes = std::move(head.attributes);
    }
    held.unequalSums = all.layers.unequalSums;
    held.attributes = std::move(picture.attributes);
    held.image = shot.image;
    held.layers = std::move(all.layers.planes);
    held.film = film;
    return held;
}

void writeImage(const std::string& path, const HeldImage& held, Diagnostics& diagnostics) {
    ExrPicture picture = plainPicture(held.image, held.film);
    picture.attributes = held.attributes;
    if (!held.image.variance.empty()) picture.more.push_back({kVariance, held.image.variance});
    for (const NamedPlane& plane : held.layers) picture.more.push_back({plane.name, plane.values});
    if (held.deep) writeDeepExr(deepPath(path), *held.deep);
    warnOfLosses(writeExr(path, picture), path, diagnostics);
    warnOfSums(held.unequalSums, path, diagnostics);
}

void cutOut(DisplayPicture& picture, const PixelWindow& window, const PixelWindow& display) {
    const PixelWindow inside{std::max(window.x0, display.x0), std::max(window.y0, display.y0),
                             std::min(window.x1, display.x1), std::min(window.y1, display.y1)};
    if (inside == window || inside.x0 >= inside.x1 || inside.y0 >= inside.y1) return;
    std::vector<float> rgb;
    rgb.reserve(3 * inside.area());
    for (int y = inside.y0; y < inside.y1; ++y) {
        const auto row = static_cast<std::ptrdiff_t>(y - window.y0) * window.width();
        const auto first = picture.rgb.begin() + 3 * (row + (inside.x0 - window.x0));
        rgb.insert(rgb.end(), first, first + 3 * inside.width());
    }
    picture = {inside.width(), inside.height(), std::move(rgb), picture.space};
}

std::vector<std::pair<std::string, std::string>> pngTexts(const DisplayView& display, double exposure) {
    const OcioView& view = display.view();
    return {{kSoftwareKey, kSoftwareName + versionNumber()},
            {"Display", view.display()},
            {"View", view.view()},
            {"OCIO", view.config().name},
            {"OCIO hash", view.config().hash},
            {"Exposure", fmt::format("{:g} stops", exposure)}};
}

void writeDisplayPng(const std::string& path, DisplayPicture picture, const ViewOptions& options, int bits) {
    const DisplayView display(picture.space, options);
    display.apply(picture.rgb);
    const OcioView& view = display.view();
    PngPicture png;
    png.width = picture.width;
    png.height = picture.height;
    png.rgb = picture.rgb;
    png.bits = bits;
    png.srgb = view.isSrgb();
    png.texts = pngTexts(display, options.exposure);
    writePng(path, png);
}

} // namespace abbe
