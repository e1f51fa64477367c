// One channel of a picture in memory, with a border, so that windows and lanes may reach beyond its edges; and what it
// is worked on in: eight neighbouring pixels of a row, treated alike, and squares.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <functional>
#include <span>
#include <vector>

namespace abbe {

using Lanes = float __attribute__((vector_size(32)));
inline constexpr int kLanes = 8;

inline Lanes load(const float* from) {
    Lanes v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
inline void store(float* to, Lanes v) { std::memcpy(to, &v, sizeof v); }
inline Lanes splat(float s) { return Lanes{} + s; }
inline Lanes min(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes max(Lanes a, Lanes b) { return a > b ? a : b; }

// exp(−x) as (1 − x/64)⁶⁴, 0 from 64 on: within 0.004 of it and made of multiplications alone.
inline Lanes decay(Lanes x) {
    Lanes e = max(Lanes{}, 1.f - x * (1 / 64.f));
    for (int i = 0; i < 6; ++i) e *= e;
    return e;
}

// Row by row from the top. Columns and rows from −kBorder to size + kBorder − 1 can be addressed; what stands beyond
// the edges is 0 until extend() is called.
class Plane {
  public:
    static constexpr int kBorder = 40;

    Plane() = default;
    // Zeros.
    Plane(int width, int height);
    // Requires values.size() == width · height. Calls extend().
    Plane(int width, int height, std::span<const float> values);

    int width() const { return width_; }
    int height() const { return height_; }
    // The address of column 0.
    float* row(int y) { return values_.data() + offset(y); }
    const float* row(int y) const { return values_.data() + offset(y); }
    // Repeats the pixels of the edges in the border.
    void extend();
    // Without the border.
    std::vector<float> pixels() const;

  private:
    std::size_t offset(int y) const {
        return static_cast<std::size_t>(y + kBorder) * stride_ + static_cast<std::size_t>(kBorder);
    }

    int width_ = 0, height_ = 0;
    std::size_t stride_ = 0;
    std::vector<float> values_;
};

using ColourPlanes = std::array<Plane, 3>;

// The mean over the square of (2·radius + 1)² pixels around each pixel, its border extended. Requires
// radius <= kBorder − 8 and an extended border of `source`.
Plane boxFilter(const Plane& source, int radius);

// Columns x0 … x0 + width − 1; the width is a multiple of kLanes, so that the last columns may lie beyond the edge.
struct Tile {
    static constexpr int kSize = 32;

    int x0 = 0, y0 = 0, width = 0, height = 0;
};

// Calls body for every tile of a picture, from many threads, in four rounds: tiles of one round are at least kSize
// pixels apart, so that a body may add to what lies up to 12 pixels outside its tile. The order of what is added at one
// pixel is that of the rounds; sums have the same bits for any number of threads.
void forEachTile(int width, int height, const std::function<void(const Tile&)>& body);

} // namespace abbe
