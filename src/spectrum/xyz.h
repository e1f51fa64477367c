// CIE 1931 tristimulus values; docs/conventions.md states their scale.
#pragma once

namespace abbe {

struct Xyz {
    double x = 0, y = 0, z = 0;

    Xyz operator+(Xyz b) const { return {x + b.x, y + b.y, z + b.z}; }
    Xyz operator-(Xyz b) const { return {x - b.x, y - b.y, z - b.z}; }
    Xyz operator*(double s) const { return {x * s, y * s, z * s}; }
    Xyz& operator+=(Xyz b) { return *this = *this + b; }
};

} // namespace abbe
