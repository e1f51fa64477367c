#include "view/view_tev.h"

#include "pictures/tev_rows.h"

#include <algorithm>
#include <utility>

namespace abbe {

namespace {

constexpr int kTevRowsAtOnce = 64;
constexpr double kMostForLayersOfTev = 0.05; // of the time

// Those that the film of the last stage will have, whatever film is in hand: the image in tev keeps its channels from
// the first rough picture on.
std::vector<std::string> channelsOf(const LiveShot& shot) {
    const Scene& scene = shot.built.scene;
    const int replicates = static_cast<int>(shot.built.render.replicates);
    PixelFilm film({0, 0, 1, 1}, PixelFilter(shot.film.filter, shot.film.filterRadius), replicates);
    LayerPlan layers = shot.layers;
    if (replicates < 2) layers.halves = false;
    film.keepLayers(layers, scene.names, rgbSpace(shot.film.space), {scene.intersector.get(), scene.camera.get()});
    FilmPicture picture(film, shot.film, 1, {});
    return tevChannels(picture);
}

} // namespace

ViewTev::ViewTev(TevAddress address, std::string name) : address_(std::move(address)), name_(std::move(name)) {}

ViewTev::~ViewTev() {
    if (image_) image_->close();
}

std::string ViewTev::absence() const {
    const std::lock_guard lock(mutex_);
    return image_ ? image_->absence() : std::string();
}

void ViewTev::shape(const RestingFilm& resting, const LivePicture& picture) {
    if (std::exchange(load_, resting.shot.number) != resting.shot.number) channels_ = channelsOf(resting.shot);
    if (image_) return image_->reshape(picture.frameWidth, picture.frameHeight, channels_);
    const std::lock_guard lock(mutex_);
    image_ = std::make_unique<TevImage>(address_, name_, picture.frameWidth, picture.frameHeight, channels_);
}

void ViewTev::show(const RestingFilm& resting, const LivePicture& picture, bool last) {
    shape(resting, picture);
    if (!image_->wanted() && !last) return; // a tev that comes up later gets the finished picture
    const bool rough = resting.film.cell > 1;
    if (rough) due_ = 0; // layers of what was there before go as soon as there are others
    // A picture that fills its frame is a part of the film with its layers, else of what was shown before it.
    const bool filmToo = !rough && (last || watch_.seconds() >= due_);
    const bool covers =
        resting.film.film.bounds().area() == PixelBounds{0, 0, picture.frameWidth, picture.frameHeight}.area();
    if (!filmToo || !covers) showPicture(picture);
    if (filmToo) showFilm(resting);
}

void ViewTev::showPicture(const LivePicture& picture) {
    const Matrix3 matrix = tevColours(picture.space);
    const auto width = static_cast<std::size_t>(picture.frameWidth);
    for (int y0 = 0; y0 < picture.frameHeight; y0 += kTevRowsAtOnce) {
        const int y1 = std::min(y0 + kTevRowsAtOnce, picture.frameHeight);
        const std::size_t count = width * static_cast<std::size_t>(y1 - y0);
        TevRows rows{y0, y1, {"R", "G", "B"}, std::vector<float>(3 * count), 0, picture.frameWidth};
        std::size_t i = 0;
        for (int y = y0; y < y1; ++y)
            for (int x = 0; x < picture.frameWidth; ++x, ++i) {
                const float* const of = picture.at(x, y);
                const auto rgb = matrix.apply<Vec3d>(Vec3d{of[0], of[1], of[2]});
                rows.planes[i] = static_cast<float>(rgb.x);
                rows.planes[count + i] = static_cast<float>(rgb.y);
                rows.planes[2 * count + i] = static_cast<float>(rgb.z);
            }
        image_->show(std::move(rows));
    }
}

void ViewTev::showFilm(const RestingFilm& resting) {
    const double before = watch_.seconds();
    const LiveShot& shot = resting.shot;
    FilmPicture picture(resting.film.film, shot.film, shot.built.exposure, shot.built.scene.origin);
    const PixelBounds bounds = picture.image.bounds;
    for (int y0 = bounds.y0; y0 < bounds.y1; y0 += kTevRowsAtOnce) {
        auto rows = tevRows(picture, shot.film.space, channels_, y0, std::min(y0 + kTevRowsAtOnce, bounds.y1));
        if (!rows) break; // other layers than planned: none that tev knows
        image_->show(std::move(*rows));
    }
    const double now = watch_.seconds();
    due_ = now + (now - before) / kMostForLayersOfTev;
}

} // namespace abbe
