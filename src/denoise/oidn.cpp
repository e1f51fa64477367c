// Open Image Denoise between planes: colours there and back, negative light, small pictures, features of their own.
#include "base/memory_limit.h"
#include "base/parallel.h"
#include "denoise/methods.h"
#include "denoise/oidn_library.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// A network that sees less than this makes something else even of a constant picture, so small ones are extended.
constexpr int kSmall = 64, kMargin = 32;
static_assert(kMargin <= Plane::kBorder);
// A negative component that is no more than this of the largest one is rounding.
constexpr float kRounding = 1e-6f;

constexpr double kMostForFilters = 2048, kLeastForFilters = 64; // MB; the bits of the result do not depend on it
constexpr double kBytesPerPixel = 200;                          // of all images here at once

struct Margins {
    int x = 0, y = 0;

    explicit Margins(const Plane& like)
        : x(like.width() < kSmall ? kMargin : 0), y(like.height() < kSmall ? kMargin : 0) {}
};

struct Matrix {
    float m[3][3];

    explicit Matrix(const Matrix3& from) {
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) m[i][j] = static_cast<float>(from.m[i][j]);
    }
    std::array<float, 3> operator()(float a, float b, float c) const {
        std::array<float, 3> v{};
        for (std::size_t i = 0; i < 3; ++i) v[i] = m[i][0] * a + m[i][1] * b + m[i][2] * c;
        return v;
    }
};

const Matrix3 kUnchanged;

// Interleaved, with the margins, in Rec. 709.
OidnImage imageOf(const std::vector<Plane>& planes, const Matrix3& colours) {
    const Margins margin(planes[0]);
    const Matrix matrix(colours);
    OidnImage image(planes[0].width() + 2 * margin.x, planes[0].height() + 2 * margin.y);
    parallelFor(static_cast<std::size_t>(image.height), [&](std::size_t row) {
        float* to = image.values.data() + 3 * row * static_cast<std::size_t>(image.width);
        const int y = static_cast<int>(row) - margin.y;
        for (int x = -margin.x; x < image.width - margin.x; ++x, to += 3)
            std::ranges::copy(matrix(planes[0].row(y)[x], planes[1].row(y)[x], planes[2].row(y)[x]), to);
    });
    return image;
}

ColourPlanes planesOf(const OidnImage& image, const Matrix3& colours, const Plane& like) {
    const Margins margin(like);
    const Matrix matrix(colours);
    ColourPlanes planes;
    planes.fill(Plane(like.width(), like.height()));
    parallelFor(static_cast<std::size_t>(like.height()), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        const float* from =
            image.values.data() +
            3 * static_cast<std::ptrdiff_t>((y + margin.y) * static_cast<std::ptrdiff_t>(image.width) + margin.x);
        for (int x = 0; x < like.width(); ++x, from += 3) {
            const auto colour = matrix(from[0], from[1], from[2]);
            for (std::size_t c = 0; c < 3; ++c) planes[c].row(y)[x] = colour[c];
        }
    });
    for (Plane& plane : planes) plane.extend();
    return planes;
}

enum class Taken : std::size_t { first, second, both };

std::vector<Plane> planesOf(const HalfBuffers& halves, Taken taken) {
    if (taken != Taken::both) return halves.halves[static_cast<std::size_t>(taken)];
    std::vector<Plane> mean = halves.halves[0];
    for (std::size_t c = 0; c < mean.size(); ++c) {
        for (int y = 0; y < mean[c].height(); ++y)
            for (int x = 0; x < mean[c].width(); ++x)
                mean[c].row(y)[x] = (mean[c].row(y)[x] + halves.halves[1][c].row(y)[x]) / 2;
        mean[c].extend();
    }
    return mean;
}

// Light that is below zero, from `image` to the result, where it is positive. Empty if there is none.
OidnImage takeNegative(OidnImage& image) {
    OidnImage negative(image.width, image.height);
    bool any = false;
    for (std::size_t i = 0; i < image.values.size(); i += 3) {
        float* const c = &image.values[i];
        const float rounding = kRounding * std::max({c[0], c[1], c[2], 0.f});
        for (std::size_t k = 0; k < 3; ++k) {
            if (c[k] >= 0) continue;
            if (c[k] < -rounding) {
                negative.values[i + k] = -c[k];
                any = true;
            }
            c[k] = 0;
        }
    }
    return any ? negative : OidnImage();
}

class OidnRun {
  public:
    OidnRun(const OidnDevice& device, const NoisyInput& input, const Matrix3& toRec709, bool clean)
        : device_(device), input_(input), to_(toRec709), back_(toRec709.inverse()), clean_(clean) {}

    // The pixels of the last one that were outside.
    std::uint64_t outside() const { return outside_; }

    ColourPlanes denoise(Taken taken) {
        const OidnImage albedo = feature(input_.albedo, taken, to_, 0);
        // It takes normals beside an albedo alone.
        const OidnImage normal = input_.albedo ? feature(input_.normal, taken, kUnchanged, -1) : OidnImage();
        OidnImage colour = imageOf(planesOf(input_.colour, taken), to_);
        const OidnImage negative = takeNegative(colour);
        const auto filtered = [&](const OidnImage& light) {
            return device_.filter({&light, present(albedo), present(normal), clean_});
        };
        OidnImage result = filtered(colour);
        outside_ = 0;
        if (!negative.values.empty()) {
            const OidnImage less = filtered(negative);
            for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] -= less.values[i];
            outside_ = countOutside(negative);
        }
        return planesOf(result, back_, input_.colour.halves[0][0]);
    }

  private:
    static const OidnImage* present(const OidnImage& image) { return image.values.empty() ? nullptr : &image; }

    // Without its noise, in the range that the network knows, which ends at 1.
    OidnImage feature(const std::optional<HalfBuffers>& feature, Taken taken, const Matrix3& colours,
                      float least) const {
        if (!feature) return {};
        OidnImage image = imageOf(planesOf(*feature, taken), colours);
        for (float& v : image.values) v = std::clamp(v, least, 1.f);
        if (!clean_) return image;
        OidnImages only;
        (least < 0 ? only.normal : only.albedo) = &image;
        return device_.filter(only);
    }

    // Without the margins.
    std::uint64_t countOutside(const OidnImage& negative) const {
        const Plane& like = input_.colour.halves[0][0];
        const Margins margin(like);
        std::uint64_t count = 0;
        for (int y = 0; y < like.height(); ++y)
            for (int x = 0; x < like.width(); ++x) {
                const std::size_t i =
                    3 * (static_cast<std::size_t>(y + margin.y) * static_cast<std::size_t>(negative.width) +
                         static_cast<std::size_t>(x + margin.x));
                count += negative.values[i] + negative.values[i + 1] + negative.values[i + 2] > 0 ? 1 : 0;
            }
        return count;
    }

    const OidnDevice& device_;
    const NoisyInput& input_;
    Matrix3 to_, back_;
    bool clean_;
    std::uint64_t outside_ = 0;
};

// MB for the filters, beside the images.
int memoryForFilters(const Plane& like) {
    const double images = kBytesPerPixel * static_cast<double>(like.width() + 2 * kMargin) *
                          static_cast<double>(like.height() + 2 * kMargin);
    requireMemory(images + kLeastForFilters * 1e6);
    return static_cast<int>(std::min(kMostForFilters, std::max(kLeastForFilters, 0.8e-6 * (memoryLeft() - images))));
}

} // namespace

OidnResult denoiseByOidn(const OidnLibrary& library, const NoisyInput& input, const Matrix3& toRec709,
                         DenoiseEffort effort) {
    const bool look = effort == DenoiseEffort::look;
    const OidnDevice device(library, threadCount(), memoryForFilters(input.colour.halves[0][0]), look);
    OidnRun run(device, input, toRec709, !look);
    OidnResult result;
    DenoisedHalves whole;
    whole[0] = whole[1] = run.denoise(Taken::both);
    result.outside = run.outside();
    if (look) {
        result.mixture.picture = std::move(whole);
        return result;
    }
    const DenoisedHalves halves{run.denoise(Taken::first), run.denoise(Taken::second)};
    result.mixture = mixWithUntouched(input.colour, halves, whole);
    return result;
}

} // namespace abbe
