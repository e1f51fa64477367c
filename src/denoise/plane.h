// One channel of a picture in memory, with a border, so that windows and lanes may reach beyond its edges.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace abbe {

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

} // namespace abbe
