#include "pictures/tev_rows.h"
#include "render_run/render_preview.h"
#include "render_run/render_run.h"
#include "spectrum/color_space.h"

#include <algorithm>

namespace abbe {

namespace {

constexpr int kRowsAtOnce = 64;
constexpr double kMostForTev = 0.05; // of the time

std::vector<std::string> channelsOf(const TevFilm::How& how, const PixelFilm& film) {
    if (!film.layers()) return {"R", "G", "B"};
    FilmPicture picture(film, how.film, how.exposure, how.origin);
    return tevChannels(picture);
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
    for (int y0 = bounds_.y0; y0 < bounds_.y1; y0 += kRowsAtOnce) {
        auto rows = tevRows(picture, how_.film.space, channels_, y0, std::min(y0 + kRowsAtOnce, bounds_.y1));
        if (!rows) return; // other layers than at first: none that tev knows
        rows->y0 -= bounds_.y0;
        rows->y1 -= bounds_.y0;
        rows->x0 = 0; // the image in tev is what is rendered, not the frame
        rows->x1 = bounds_.width();
        image_.show(std::move(*rows));
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
