#include "render_run/render_preview.h"
#include "render_run/render_run.h"
#include "spectrum/color_space.h"

#include <algorithm>
#include <array>

namespace abbe {

namespace {

constexpr int kRowsAtOnce = 64;
constexpr double kMostForTev = 0.05; // of the time

// Colours as the film has them, to what tev takes them for.
Matrix3 toTev(const FilmSettings& film) { return rgb::rec709.fromXyz() * rgbSpace(film.space).toXyz(); }

using Triple = std::array<std::span<float>, 3>;

void convert(const Triple& rgb, const Matrix3& matrix) {
    for (std::size_t i = 0; i < rgb[0].size(); ++i) {
        const auto c = matrix.apply<Vec3d>(Vec3d{rgb[0][i], rgb[1][i], rgb[2][i]});
        rgb[0][i] = static_cast<float>(c.x);
        rgb[1][i] = static_cast<float>(c.y);
        rgb[2][i] = static_cast<float>(c.z);
    }
}

// Layers with R, G and B are colours of the film's space; with A beside them they are identifiers of a Cryptomatte.
std::vector<std::size_t> colourLayers(const std::vector<std::string>& channels) {
    std::vector<std::size_t> found;
    const auto has = [&](const std::string& name) { return std::ranges::find(channels, name) != channels.end(); };
    for (std::size_t i = 0; i < channels.size(); ++i)
        if (channels[i].ends_with(".R")) {
            const std::string layer = channels[i].substr(0, channels[i].size() - 1);
            if (has(layer + "G") && has(layer + "B") && !has(layer + "A")) found.push_back(i);
        }
    return found;
}

std::vector<std::string> channelsOf(const TevFilm::How& how, const PixelFilm& film) {
    std::vector<std::string> channels{"R", "G", "B"};
    const PixelBounds all = film.bounds();
    if (!film.layers()) return channels;
    FilmPicture picture(film, how.film, how.exposure, how.origin);
    for (const NamedPlane& plane : picture.rows(all.y0, all.y0).layers.planes) channels.push_back(plane.name);
    return channels;
}

} // namespace

TevFilm::TevFilm(How how, const PixelFilm& film)
    : how_(std::move(how)), bounds_(film.bounds()), channels_(channelsOf(how_, film)),
      image_(how_.address, how_.name, bounds_.width(), bounds_.height(), channels_) {}

void TevFilm::show(const FramePreview& look) {
    if (look.cells.empty() || !image_.wanted()) return;
    const Matrix3 matrix = rgb::rec709.fromXyz() * how_.film.whiteBalance;
    const auto area = static_cast<std::size_t>(bounds_.width()) * static_cast<std::size_t>(bounds_.height());
    TevRows rows{0, bounds_.height(), {"R", "G", "B"}, std::vector<float>(3 * area)};
    std::size_t i = 0;
    for (int y = bounds_.y0; y < bounds_.y1; ++y)
        for (int x = bounds_.x0; x < bounds_.x1; ++x, ++i) {
            const auto rgb = matrix.apply<Vec3d>(look.at(x, y) * how_.exposure);
            rows.planes[i] = static_cast<float>(rgb.x);
            rows.planes[area + i] = static_cast<float>(rgb.y);
            rows.planes[2 * area + i] = static_cast<float>(rgb.z);
        }
    image_.show(std::move(rows));
}

void TevFilm::show(const PixelFilm& film) {
    if (!image_.wanted() || watch_.seconds() < due_) return;
    const WorkScope work(Work::writing);
    const double before = watch_.seconds();
    FilmPicture picture(film, how_.film, how_.exposure, how_.origin);
    send(picture);
    const double now = watch_.seconds();
    due_ = now + (now - before) / kMostForTev;
}

void TevFilm::finish(FilmPicture& picture) {
    if (image_.wanted()) send(picture);
    image_.finish();
}

void TevFilm::send(FilmPicture& picture) {
    const Matrix3 matrix = toTev(how_.film);
    const std::vector<std::size_t> colours = colourLayers(channels_);
    const auto width = static_cast<std::size_t>(bounds_.width());
    for (int y0 = bounds_.y0; y0 < bounds_.y1; y0 += kRowsAtOnce) {
        const int y1 = std::min(y0 + kRowsAtOnce, bounds_.y1);
        TevRows rows{y0 - bounds_.y0, y1 - bounds_.y0, channels_, {}};
        const std::size_t first = static_cast<std::size_t>(rows.y0) * width;
        const std::size_t count = static_cast<std::size_t>(y1 - y0) * width;
        rows.planes.reserve(channels_.size() * count);
        const auto add = [&](std::span<const float> values) {
            rows.planes.insert(rows.planes.end(), values.begin(), values.end());
        };
        const LayerPlanes layers = picture.rows(y0, y1).layers; // first: the picture gets its last bits by it
        for (const std::vector<float>* plane : {&picture.image.r, &picture.image.g, &picture.image.b})
            add(std::span(*plane).subspan(first, count));
        for (const NamedPlane& plane : layers.planes) add(plane.values);
        if (rows.planes.size() != channels_.size() * count) return; // other layers than at first: none that tev knows
        const auto channel = [&](std::size_t i) { return std::span(rows.planes).subspan(i * count, count); };
        const auto triple = [&](std::size_t r) {
            const std::string layer = channels_[r].substr(0, channels_[r].size() - 1);
            const auto find = [&](const char* c) {
                return static_cast<std::size_t>(std::ranges::find(channels_, layer + c) - channels_.begin());
            };
            return Triple{channel(r), channel(find("G")), channel(find("B"))};
        };
        convert(triple(0), matrix);
        for (const std::size_t r : colours) convert(triple(r), matrix);
        image_.show(std::move(rows));
    }
}

void RenderRun::openTev(const PixelFilm& film) {
    if (options_.tev)
        tev_.emplace(TevFilm::How{*options_.tev, summary_.image, film_, built_.exposure, built_.scene.origin}, film);
}

void RenderRun::tellOfTev() {
    if (!tev_) return;
    if (const std::string why = tev_->takeWarning(); !why.empty())
        warn(
            "W0679", why,
            "start tev, where it listens at port 14158, or write `--tev=HOST:PORT`; the render goes on without it, and "
            "shows its picture there as soon as tev answers");
}

} // namespace abbe
