// What light paths brought to a film, or rounds of merging.
#pragma once

#include "film/film_planes.h"
#include "math/exact_sum.h"
#include "render/film.h"
#include "spectrum/xyz.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace abbe {

// XYZ of every pixel and replicate, and how many light paths (rounds) there were: 48 bytes per pixel and replicate. Any
// thread adds to any pixel at any time; to read is for when nobody does.
class SplatSums {
  public:
    // Throws std::bad_alloc.
    SplatSums(SplatKind, PixelBounds, int replicates);
    static std::uint64_t memoryBytes(PixelBounds, int replicates);

    // `cell`: the pixel, row by row, times the replicates, plus the replicate.
    void add(std::size_t cell, const Xyz& value) noexcept {
        Cell& c = cells_[cell];
        c.x.add(ExactSum(value.x));
        c.y.add(ExactSum(value.y));
        c.z.add(ExactSum(value.z));
    }
    void count(int replicate, std::uint64_t paths) noexcept;
    SplatKind kind() const { return kind_; }

    // Over the cells [first, last).
    Xyz sum(std::size_t first, std::size_t last) const noexcept;
    double luminance(std::size_t cell) const noexcept { return cells_[cell].y.value(); }
    // Of the replicates [first, last).
    std::uint64_t paths(int first, int last) const noexcept;
    std::uint64_t paths(std::size_t replicate) const noexcept { return paths_[replicate]; }

    void appendPlanes(FilmPlanes&);

  private:
    struct Cell {
        SharedSum x, y, z;

        Cell& operator+=(const Cell& b) noexcept {
            x += b.x;
            y += b.y;
            z += b.z;
            return *this;
        }
    };
    class PathsPlane;

    SplatKind kind_;
    PixelBounds bounds_;
    std::vector<Cell> cells_;          // [pixel][replicate]
    std::vector<std::uint64_t> paths_; // [replicate]
};

} // namespace abbe
