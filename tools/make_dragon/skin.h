// The relief of the skin: scales, plates of the belly, wrinkles. A function of space, so that seams cannot show.
#pragma once

#include "cage.h"

#include <unordered_map>

namespace dragon {

class Skin {
  public:
    // `surface` is a fine version of the cage; scales are spread over it.
    explicit Skin(const Cage& surface);

    struct Look {
        double height = 0; // cm, about -0.2 … 0.2
        double depth = 0;  // 0 in the grooves, 1 on top
        double tint = 0;   // one number per scale, 0 … 1
    };
    [[nodiscard]] Look look(Vec p, Vec normal) const;

  private:
    struct Scale {
        Vec at, normal;
        double radius = 0, tint = 0;
    };
    std::array<int, 3> cell(Vec p) const;
    bool free(const Scale& s) const;
    void add(const Scale& s);

    std::vector<Scale> scales_;
    std::map<std::array<int, 3>, std::vector<int>> grid_;
};

// Normals at the points of a cage.
std::vector<Vec> pointNormals(const Cage& cage);

} // namespace dragon
