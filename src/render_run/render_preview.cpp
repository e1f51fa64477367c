#include "render_run/render_preview.h"

#include "io/file.h"
#include "math/vec.h"
#include "render_run/render_run.h"
#include "spectrum/color_space.h"

#include <algorithm>
#include <filesystem>

namespace abbe {

namespace {

constexpr int kWidestLook = 512;        // pixels
constexpr double kSoon = 0.3;           // s: who waits no longer than that needs no preview
constexpr double kTracedTime = 3;       // of a sample with light paths, over one without; rough
constexpr double kMostOfTheTime = 0.05; // for writing it again and again

// Row by row from the top.
struct LookColors {
    LookColors(const FilmSettings& film, double scale)
        : matrix(rgbSpace(film.space).fromXyz() * film.whiteBalance), exposure(scale) {}
    std::array<float, 3> operator()(const Xyz& xyz) const {
        const auto rgb = matrix.apply<Vec3d>(xyz * exposure);
        return {static_cast<float>(rgb.x), static_cast<float>(rgb.y), static_cast<float>(rgb.z)};
    }
    Matrix3 matrix;
    double exposure;
};

DisplayPicture pictureOf(const ResolvedImage& image, const FilmSettings& film) {
    DisplayPicture picture{image.bounds.width(), image.bounds.height(), {}, film.space};
    picture.rgb.reserve(3 * image.r.size());
    for (std::size_t i = 0; i < image.r.size(); ++i)
        picture.rgb.insert(picture.rgb.end(), {image.r[i], image.g[i], image.b[i]});
    return picture;
}

} // namespace

DisplayPicture pictureOf(const FramePreview& look, const FilmSettings& film, double exposure, int most) {
    const int side = std::clamp(most / look.columns, 1, look.cellSize);
    DisplayPicture picture{look.columns * side, look.rows * side, {}, film.space};
    const LookColors colors(film, exposure);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const auto rgb = colors(look.cells[static_cast<std::size_t>(y / side * look.columns + x / side)]);
            picture.rgb.insert(picture.rgb.end(), rgb.begin(), rgb.end());
        }
    return picture;
}

std::size_t paintMissing(ResolvedImage& image, const PixelFilm& film, const FramePreview& look,
                         const FilmSettings& settings, double exposure) {
    const LookColors colors(settings, exposure);
    std::size_t i = 0, missing = 0;
    for (int y = image.bounds.y0; y < image.bounds.y1; ++y)
        for (int x = image.bounds.x0; x < image.bounds.x1; ++x, ++i) {
            if (film.samples(x, y) > 0) continue;
            const auto rgb = colors(look.at(x, y));
            image.r[i] = rgb[0];
            image.g[i] = rgb[1];
            image.b[i] = rgb[2];
            ++missing;
        }
    return missing;
}

RenderPreview::RenderPreview(How how)
    : how_(std::move(how)), path_(std::filesystem::path(how_.image).replace_extension(".preview.png").string()) {}

RenderPreview::~RenderPreview() {
    std::error_code ignored;
    if (shown_) std::filesystem::remove(path_, ignored);
}

bool RenderPreview::show(const FramePreview& look) {
    double predicted = look.secondsForSample * how_.samples * (how_.mayTrace ? kTracedTime : 1);
    if (how_.mostSeconds > 0) predicted = std::min(predicted, how_.mostSeconds);
    if (predicted < kSoon || look.cells.empty()) return false;
    return write(abbe::pictureOf(look, how_.film, how_.exposure, kWidestLook));
}

bool RenderPreview::show(const PixelFilm& film) {
    if (!shown_ || watch_.seconds() < due_) return false;
    const double before = watch_.seconds();
    if (!write(pictureOf(resolveImage(film, how_.film, how_.exposure), how_.film))) return false;
    const double now = watch_.seconds();
    due_ = std::max(1.5 * now, now + (now - before) / kMostOfTheTime);
    return true;
}

bool RenderPreview::write(DisplayPicture picture) {
    const WorkScope work(Work::writing);
    if (!shown_ && isForeignPng(path_)) return false; // somebody's picture that is called so
    try {
        writeDisplayPng(path_, std::move(picture), how_.view, 8);
        return shown_ = true;
    } catch (const IoError&) {
        return false;
    }
}

// Not of parts, which are no image.
void RenderRun::openPreview() {
    if (!options_.preview.value_or(!options_.inMemory) || options_.part) return;
    preview_.emplace(RenderPreview::How{summary_.image, film_, built_.exposure, options_.view,
                                        static_cast<double>(settings_.samples), settings_.timeLimit,
                                        integrator_->lightBlocks(built_.scene, settings_) > 0});
}

// Without a black hole where the time, or the patience, was too short for a sample.
FilmPicture RenderRun::pictureOf(const PixelFilm& film) {
    FilmPicture picture(film, film_, built_.exposure, built_.scene.origin, bringLayers_);
    lookedAt_ = look_ && !look_->cells.empty() ? paintMissing(picture.image, film, *look_, film_, built_.exposure) : 0;
    picture.painted = lookedAt_ > 0;
    return picture;
}

} // namespace abbe
