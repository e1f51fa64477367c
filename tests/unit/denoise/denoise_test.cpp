#include "base/parallel.h"
#include "denoise/denoise.h"
#include "synthetic_picture.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <limits>
#include <utility>

using namespace abbe;

namespace {

constexpr DenoiseMethod kMethods[] = {DenoiseMethod::nfor, DenoiseMethod::preview};

std::array<std::vector<float>, 3> constantPlanes(std::size_t size, float value) {
    const std::vector<float> plane(size, value);
    return {plane, plane, plane};
}

DenoiseInput inputOf(int width, int height, const std::array<std::vector<float>, 3>& mean,
                     const std::array<std::vector<float>, 3>& half) {
    DenoiseInput in;
    in.width = width;
    in.height = height;
    for (std::size_t c = 0; c < 3; ++c) in.colour[c] = {mean[c], half[c]};
    return in;
}

bool finite(const DenoiseResult& r) {
    const auto good = [](const std::vector<float>& v) {
        return std::all_of(v.begin(), v.end(), [](float x) { return std::isfinite(x); });
    };
    return good(r.colour[0]) && good(r.colour[1]) && good(r.colour[2]) && good(r.error) &&
           std::isfinite(r.relMseBefore) && std::isfinite(r.relMseAfter);
}

} // namespace

TEST_CASE("a picture without noise is left alone: constant, black, of one pixel, of one row") {
    for (const DenoiseMethod method : kMethods)
        for (const auto& [width, height] : {std::pair{50, 41}, {1, 1}, {2, 3}, {70, 1}, {1, 70}})
            for (const float value : {0.f, 0.7f, 3e7f}) {
                const auto planes = constantPlanes(static_cast<std::size_t>(width * height), value);
                const DenoiseResult r = denoise(inputOf(width, height, planes, planes), method);
                REQUIRE(finite(r));
                float largest = 0;
                for (const auto& plane : r.colour)
                    for (const float v : plane) largest = std::max(largest, std::abs(v - value));
                CHECK(largest <= 1e-5f * value);
                CHECK(*std::max_element(r.error.begin(), r.error.end()) <= 1e-3f * value);
                CHECK(r.relMseAfter < 1e-8);
            }
}

TEST_CASE("noise goes, the picture stays") {
    const SyntheticPicture picture(96, 80, 0.3f);
    const double before = picture.relMse(picture.mean);
    for (const DenoiseMethod method : kMethods)
        for (const bool features : {true, false}) {
            CAPTURE(features);
            CAPTURE(name(method));
            const DenoiseResult r = denoise(picture.input(features), method);
            const double after = picture.relMse(r.colour);
            MESSAGE(name(method) << " features " << features << ": relMSE " << before << " -> " << after);
            CHECK(after < before / (method == DenoiseMethod::preview ? 4 : features ? 16 : 10));
            CHECK(r.repaired == 0);
        }
}

TEST_CASE("the result has the same bits for any number of threads and in every run") {
    const SyntheticPicture picture(100, 70, 0.4f);
    for (const DenoiseMethod method : kMethods) {
        setThreadCount(1);
        const DenoiseResult one = denoise(picture.input(), method);
        for (const int threads : {2, 5}) {
            setThreadCount(threads);
            const DenoiseResult other = denoise(picture.input(), method);
            CHECK(other.colour == one.colour);
            CHECK(other.error == one.error);
            CHECK(other.relMseAfter == one.relMseAfter);
        }
    }
    setThreadCount(0);
}

TEST_CASE("a brighter picture gives a brighter result and the same relative error") {
    const SyntheticPicture picture(64, 48, 0.3f);
    SyntheticPicture bright = picture;
    constexpr float kFactor = 4096; // a power of two, so that scaling rounds nothing
    for (auto* planes : {&bright.mean, &bright.half})
        for (auto& plane : *planes)
            for (float& v : plane) v *= kFactor;
    const DenoiseResult a = denoise(picture.input(), DenoiseMethod::nfor);
    const DenoiseResult b = denoise(bright.input(), DenoiseMethod::nfor);
    float largest = 0;
    for (std::size_t i = 0; i < picture.size(); ++i)
        largest = std::max(largest, std::abs(b.colour[0][i] / kFactor / a.colour[0][i] - 1));
    CHECK(largest < 1e-4f);
    CHECK(b.relMseAfter == doctest::Approx(a.relMseAfter));
}

TEST_CASE("pixels that are not finite are replaced in the result alone, and counted") {
    SyntheticPicture picture(48, 40, 0.2f);
    const DenoiseResult clean = denoise(picture.input(), DenoiseMethod::nfor);
    const float infinity = std::numeric_limits<float>::infinity();
    picture.mean[0][500] = infinity;
    picture.half[1][900] = std::numeric_limits<float>::quiet_NaN();
    picture.half[2][901] = -infinity;
    picture.depth[33] = infinity;
    picture.halfAlbedo[0][34] = infinity;
    for (const DenoiseMethod method : kMethods) {
        const DenoiseResult r = denoise(picture.input(), method);
        CHECK(r.repaired == 3);
        REQUIRE(finite(r));
        if (method == DenoiseMethod::nfor) CHECK(picture.relMse(r.colour) < 2 * picture.relMse(clean.colour));
    }
    const auto bad = constantPlanes(30, infinity);
    const DenoiseResult hopeless = denoise(inputOf(6, 5, bad, bad), DenoiseMethod::nfor);
    CHECK(hopeless.repaired == 30);
    CHECK(finite(hopeless));
}

// Colours are divided by the albedo before they are fitted: a product of texture and light is no affine function of
// them.
TEST_CASE("texture under uneven light: neither is blurred") {
    SyntheticPicture picture(96, 80, 0.3f);
    picture.repaint([](int x, int y) {
        const int hash = (x * 7919 + y * 104729 + x * y * 31) % 97;
        const float albedo = 0.05f + 0.8f * static_cast<float>(hash) / 96;
        const float light =
            0.6f + 0.5f * std::sin(0.08f * static_cast<float>(x)) * std::cos(0.06f * static_cast<float>(y));
        return std::pair(albedo, albedo * light);
    });
    const double before = picture.relMse(picture.mean);
    const double after = picture.relMse(denoise(picture.input(), DenoiseMethod::nfor).colour);
    MESSAGE("relMSE " << before << " -> " << after);
    CHECK(after < before / 10);
}

// As in a mirror whose albedo has a texture that its images do not show: divided by the albedo they would have it.
TEST_CASE("light that the albedo has no part in, on a texture: none of the texture stays in it") {
    SyntheticPicture picture(96, 80, 0.3f);
    picture.repaint([](int x, int y) {
        const int hash = (x * 7919 + y * 104729 + x * y * 31) % 97;
        const float albedo = 0.1f + 0.4f * static_cast<float>(hash) / 96;
        const float light =
            0.6f + 0.5f * std::sin(0.08f * static_cast<float>(x)) * std::cos(0.06f * static_cast<float>(y));
        return std::pair(albedo, light);
    });
    const double before = picture.relMse(picture.mean);
    const double after = picture.relMse(denoise(picture.input(), DenoiseMethod::nfor).colour);
    MESSAGE("relMSE " << before << " -> " << after);
    CHECK(after < before / 6);
}

// Averaged over seeds, what the halves tell is what the truth tells. Both halves take part in the variances that the
// weights are made of, so that the estimate is somewhat too good.
TEST_CASE("the estimated error is the error") {
    for (const DenoiseMethod method : kMethods) {
        double before = 0, estimatedBefore = 0, after = 0, estimatedAfter = 0, pixels = 0;
        for (unsigned seed = 1; seed <= 4; ++seed) {
            const SyntheticPicture picture(112, 96, 0.25f, seed);
            const DenoiseResult r = denoise(picture.input(), method);
            before += picture.relMse(picture.mean);
            estimatedBefore += r.relMseBefore;
            after += picture.relMse(r.colour);
            estimatedAfter += r.relMseAfter;
            pixels += picture.relMse(r.error);
        }
        MESSAGE(name(method) << ": before " << before << " ~ " << estimatedBefore << ", after " << after << " ~ "
                             << estimatedAfter << " ~ " << pixels);
        CHECK(estimatedBefore / before == doctest::Approx(1).epsilon(0.03));
        CHECK(estimatedAfter / after > (method == DenoiseMethod::nfor ? 0.8 : 0.7));
        CHECK(estimatedAfter / after < 1.2);
        CHECK(pixels / estimatedAfter == doctest::Approx(1).epsilon(0.05)); // denoised.error
    }
}
