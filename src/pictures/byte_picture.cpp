#include "pictures/byte_picture.h"

#include "io/exr_reader.h"
#include "io/file.h"
#include "pictures/image_output.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace abbe {

namespace {

// By how much the pixels [first, …) of a row count for one of another length.
struct CoveredPixels {
    int first = 0;
    std::vector<double> weights; // sum 1
};

std::vector<CoveredPixels> coveredPixels(int from, int to) {
    std::vector<CoveredPixels> all;
    const double step = static_cast<double>(from) / to;
    for (int i = 0; i < to; ++i) {
        const double begin = i * step, end = (i + 1) * step;
        CoveredPixels c;
        c.first = std::min(static_cast<int>(begin), from - 1);
        for (int k = c.first; k < from && k < end; ++k) {
            const double part = std::min(end, k + 1.0) - std::max(begin, static_cast<double>(k));
            if (part > 1e-9 || c.weights.empty()) c.weights.push_back(part / step);
        }
        all.push_back(std::move(c));
    }
    return all;
}

unsigned char displayByte(float v) {
    const float clamped = v > 0 ? std::min(v, 1.f) : 0.f; // also of what is no number
    return static_cast<unsigned char>(std::lround(255 * clamped));
}

} // namespace

BytePicture ExrViewer::read(const std::string& path) {
    RgbImage image = readExr(path);
    if (!image.chromaticities) throw IoError("`" + path + "` does not say what its colours are");
    DisplayPicture picture;
    picture.space = makeViewable(image);
    picture.width = image.width();
    picture.height = image.height();
    picture.rgb = std::move(image.rgb);
    cutOut(picture, image.window, image.display);
    if (!view_ || space_ != picture.space) view_ = std::make_unique<const DisplayView>(picture.space, options_);
    space_ = picture.space;
    view_->apply(picture.rgb);
    BytePicture bytes{picture.width, picture.height, {}};
    bytes.rgb.reserve(picture.rgb.size());
    for (const float v : picture.rgb) bytes.rgb.push_back(displayByte(v));
    return bytes;
}

BytePicture resized(const BytePicture& from, int width, int height) {
    if (from.width == width && from.height == height) return from;
    BytePicture to{width, height, {}};
    to.rgb.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const auto columns = coveredPixels(from.width, width), rows = coveredPixels(from.height, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            double sum[3] = {};
            const CoveredPixels &h = columns[static_cast<std::size_t>(x)], &v = rows[static_cast<std::size_t>(y)];
            for (std::size_t j = 0; j < v.weights.size(); ++j)
                for (std::size_t i = 0; i < h.weights.size(); ++i) {
                    const unsigned char* const of =
                        from.at(h.first + static_cast<int>(i), v.first + static_cast<int>(j));
                    for (int c = 0; c < 3; ++c) sum[c] += v.weights[j] * h.weights[i] * of[c];
                }
            for (int c = 0; c < 3; ++c)
                to.at(x, y)[c] = static_cast<unsigned char>(std::clamp(std::lround(sum[c]), 0L, 255L));
        }
    return to;
}

FittedSize fitInto(int width, int height, int mostWidth, int mostHeight) {
    const double scale = std::min(static_cast<double>(mostWidth) / width, static_cast<double>(mostHeight) / height);
    return {std::clamp(static_cast<int>(std::lround(width * scale)), 1, mostWidth),
            std::clamp(static_cast<int>(std::lround(height * scale)), 1, mostHeight)};
}

BytePicture fitted(const BytePicture& from, int width, int height) {
    if (from.width == width && from.height == height) return from;
    const FittedSize size = fitInto(from.width, from.height, width, height);
    const BytePicture small = resized(from, size.width, size.height);
    BytePicture to{width, height, {}};
    to.rgb.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const int left = (width - small.width) / 2, top = (height - small.height) / 2;
    for (int y = 0; y < small.height; ++y) std::copy_n(small.at(0, y), 3 * small.width, to.at(left, top + y));
    return to;
}

} // namespace abbe
