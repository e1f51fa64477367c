// The sums of a film, piece by piece as bytes: for files, and for adding one film to another.
#pragma once

#include "render/film.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace abbe {

static_assert(std::endian::native == std::endian::little, "bytes of files are those of memory");

// One kind of sum of all pixels. What was added to two films can be put together by adding the bytes of one to the
// other, in any order. Refers to its film.
class FilmPlane {
  public:
    virtual ~FilmPlane() = default;
    // Whether light paths add to it, which they do to any pixel at any time; else only samples of the pixels
    // themselves.
    virtual bool ofLightPaths() const { return false; }
    // Whether layers alone are made of it: neither the picture nor its error. A merge, which reads parts as often as it
    // likes, has these of some rows at a time.
    virtual bool ofLayers() const { return false; }
    // With the layout of a pixel: films understand each other's bytes if the names are the same.
    virtual std::string name() const = 0;
    // Appends what was added to the pixels. Requires a rectangle within the film's bounds; nobody may be adding to
    // them.
    virtual void store(PixelBounds, std::vector<std::byte>&) const = 0;
    // Adds what store() wrote for the pixels `of`, as far as they are in `within`, which lies within the film's bounds.
    // False, and nothing was added, if it is no such thing.
    virtual bool addWithin(PixelBounds within, PixelBounds of, std::span<const std::byte>) = 0;
    bool add(PixelBounds of, std::span<const std::byte> bytes) { return addWithin(of, of, bytes); }
};
using FilmPlanes = std::vector<std::unique_ptr<FilmPlane>>;

inline PixelBounds common(PixelBounds a, PixelBounds b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}
inline bool isEmpty(PixelBounds b) { return b.x0 >= b.x1 || b.y0 >= b.y1; }

// What FilmPlane::ofLightPaths() and ofLayers() say.
struct PlaneUse {
    bool ofLightPaths = false, ofLayers = false;
};

// Some numbers for each pixel, row by row, that add up by +=: of whole numbers the order does not matter.
template <typename Number> class DensePlane final : public FilmPlane {
  public:
    // `numbers`: `perPixel` of them for each pixel of the bounds.
    DensePlane(const std::string& name, PixelBounds bounds, std::size_t perPixel, std::span<Number> numbers,
               PlaneUse use = {})
        : name_(name + "/" + std::to_string(perPixel) + "x" + std::to_string(8 * sizeof(Number))), bounds_(bounds),
          perPixel_(perPixel), numbers_(numbers), use_(use) {}

    bool ofLightPaths() const override { return use_.ofLightPaths; }
    bool ofLayers() const override { return use_.ofLayers; }

    std::string name() const override { return name_; }

    void store(PixelBounds b, std::vector<std::byte>& out) const override {
        for (int y = b.y0; y < b.y1; ++y) {
            const auto bytes = std::as_bytes(row(b, y));
            out.insert(out.end(), bytes.begin(), bytes.end());
        }
    }

    bool addWithin(PixelBounds within, PixelBounds of, std::span<const std::byte> bytes) override {
        const std::size_t pixel = perPixel_ * sizeof(Number);
        if (bytes.size() != static_cast<std::size_t>(of.area()) * pixel) return false;
        const PixelBounds b = common(within, of);
        if (isEmpty(b)) return true;
        for (int y = b.y0; y < b.y1; ++y) {
            const auto before = static_cast<std::size_t>(y - of.y0) * static_cast<std::size_t>(of.width()) +
                                static_cast<std::size_t>(b.x0 - of.x0);
            const std::byte* next = bytes.data() + before * pixel;
            for (Number& number : row(b, y)) {
                Number term;
                std::memcpy(&term, next, sizeof term); // bytes of files are not aligned
                number += term;
                next += sizeof term;
            }
        }
        return true;
    }

  private:
    std::span<Number> row(PixelBounds b, int y) const {
        const auto first = static_cast<std::size_t>(y - bounds_.y0) * static_cast<std::size_t>(bounds_.width()) +
                           static_cast<std::size_t>(b.x0 - bounds_.x0);
        return numbers_.subspan(first * perPixel_, static_cast<std::size_t>(b.width()) * perPixel_);
    }

    std::string name_;
    PixelBounds bounds_;
    std::size_t perPixel_;
    std::span<Number> numbers_;
    PlaneUse use_;
};

} // namespace abbe
