// What is shown while a render goes on.
#include "render_run/render_preview.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <unistd.h>

namespace abbe::test {
namespace {

namespace fs = std::filesystem;

// 5 × 3 pixels in cells of two, the luminance of which is 1, 2, 3 … 6.
FramePreview countingLook() {
    FramePreview look{{0, 0, 5, 3}, 2, 3, 2, {}, 1};
    for (int i = 1; i <= 6; ++i) look.cells.push_back({1.0 * i, 1.0 * i, 1.0 * i});
    return look;
}

FilmSettings linearFilm() {
    FilmParams params;
    FilmSettings film = filmSettings(params);
    film.width = 5;
    film.height = 3;
    film.crop = film.overscan = {0, 0, 5, 3};
    return film;
}

} // namespace

TEST_CASE("preview: cells of the first look as squares, as wide as there is room for") {
    const DisplayPicture whole = pictureOf(countingLook(), linearFilm(), 1, 100);
    CHECK(whole.width == 6);
    CHECK(whole.height == 4);
    REQUIRE(whole.rgb.size() == 3 * 24);
    const auto red = [&](int x, int y) { return whole.rgb[static_cast<std::size_t>(3 * (y * 6 + x))]; };
    CHECK(red(0, 0) == red(1, 1));
    CHECK(red(2, 0) == doctest::Approx(2 * red(0, 0)));
    CHECK(red(5, 3) == doctest::Approx(6 * red(0, 0)));
    CHECK(pictureOf(countingLook(), linearFilm(), 1, 4).width == 3);
    const DisplayPicture exposed = pictureOf(countingLook(), linearFilm(), 8, 100);
    CHECK(exposed.rgb[0] == doctest::Approx(8 * whole.rgb[0]));
}

TEST_CASE("preview: pixels without a sample are painted as they looked at first, the others stay") {
    const FilmSettings settings = linearFilm();
    PixelFilm film(settings.crop, PixelFilter(FilterShape::box, 0.5), 2);
    film.add(1, 1, 0, Xyz{7, 7, 7}, 1);
    film.add(4, 2, 1, Xyz{6, 6, 6}, 1); // one replicate is enough
    ResolvedImage image = resolveImage(film, settings, 2);
    const float sampled = image.g[6], other = image.g[14];
    CHECK(paintMissing(image, film, countingLook(), settings, 2) == 13);
    CHECK(image.g[6] == sampled);
    CHECK(image.g[14] == other);
    CHECK(image.g[13] == doctest::Approx(other * 5 / 6)); // of the cell to the left
    CHECK(image.g[0] == doctest::Approx(sampled / 7));
    CHECK(image.g[7] == image.g[8]);
}

TEST_CASE("preview: beside the image, for who waits, and gone in the end") {
    const fs::path folder = fs::temp_directory_path() / ("abbe_preview_" + std::to_string(getpid()));
    fs::create_directories(folder);
    const std::string image = (folder / "room.exr").string(), beside = (folder / "room.preview.png").string();
    const PixelFilm film({0, 0, 5, 3}, PixelFilter(FilterShape::box, 0.5), 2);
    RenderPreview::How how{image, linearFilm(), 1, {}, 64, 0, false};
    {
        RenderPreview preview(how);
        CHECK(preview.path() == beside);
        CHECK_FALSE(preview.show(film)); // nothing was shown yet
        CHECK(preview.show(countingLook()));
        CHECK(fs::exists(beside));
        CHECK(preview.show(film));
        CHECK_FALSE(preview.show(film)); // so soon
    }
    CHECK_FALSE(fs::exists(beside));
    how.mostSeconds = 0.1;
    CHECK_FALSE(RenderPreview(how).show(countingLook()));
    how.mostSeconds = 0;
    how.samples = 0.05; // of a second each
    CHECK_FALSE(RenderPreview(how).show(countingLook()));
    how.samples = 64;
    how.image = (folder / "missing" / "room.exr").string();
    CHECK_FALSE(RenderPreview(how).show(countingLook())); // no folder, no preview, no fault
    CHECK_FALSE(fs::exists(beside));
    fs::remove_all(folder);
}

} // namespace abbe::test
