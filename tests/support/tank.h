// A tank of water with walls of glass, and the light that a stack of clear layers passes on.
#pragma once

#include "support/ray_estimate.h"

#include <array>
#include <fmt/format.h>
#include <string>

namespace abbe::test {

// A closed box as a mesh, or the hollow of one.
inline std::string box(double half, bool hollow, int first) {
    std::string faces;
    for (const std::array<int, 4>& f :
         {std::array{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}})
        faces += hollow ? fmt::format("- {} {} {} {}; ", f[3] + first, f[2] + first, f[1] + first, f[0] + first)
                        : fmt::format("- {} {} {} {}; ", f[0] + first, f[1] + first, f[2] + first, f[3] + first);
    static_cast<void>(half);
    return faces;
}
inline std::string corners(double h) {
    return fmt::format("- -{0} -{0} -{0}; - {0} -{0} -{0}; - {0} {0} -{0}; - -{0} {0} -{0}; - -{0} -{0} {0}; "
                       "- {0} -{0} {0}; - {0} {0} {0}; - -{0} {0} {0}; ",
                       fmt::format("{:.12f}", h));
}

// A tank of glass, 24 mm wide with walls of 2 mm, and a block of inky water in it whose half width is given.
inline TestScene tank(double water, int glassPriority = 2) {
    return TestScene::parse(fmt::format(
        R"(scene 1
camera {{ from 0 0 0.2; look-at 0 0 0 }}
light sky {{ radiance 1 }}
material glass dielectric {{ ior 1.5; priority {} }}
material water dielectric {{ ior 1.33; absorption 30; priority 1 }}
shape mesh {{ material glass; points {{ {}{} }}; faces {{ {}{} }} }}
shape mesh {{ material water; points {{ {} }}; faces {{ {} }} }}
)",
        glassPriority, corners(0.012), corners(0.01), box(0.012, false, 0), box(0.01, true, 8), corners(water),
        box(water, false, 0)));
}

// Reflected and transmitted share of a stack of layers, seen from one side, all lit with 1 from both sides.
struct Stack {
    double r = 0, t = 1, back = 0;   // back: reflection seen from the far side
    void add(double r2, double t2) { // a symmetric layer
        const double bounces = 1 / (1 - back * r2);
        const double reflected = r + t * t * r2 * bounces, through = t * t2 * bounces;
        back = r2 + t2 * t2 * back * bounces;
        r = reflected;
        t = through;
    }
};
inline double interfaceReflectance(double n1, double n2) { return ((n1 - n2) / (n1 + n2)) * ((n1 - n2) / (n1 + n2)); }

// What is seen along the middle of the tank: walls on either side of the water.
inline double tankBrightness() {
    const double outer = interfaceReflectance(1, 1.5), inner = interfaceReflectance(1.5, 1.33);
    Stack stack;
    stack.add(outer, 1 - outer);
    stack.add(inner, 1 - inner);
    stack.add(0, std::exp(-30 * 0.02));
    stack.add(inner, 1 - inner);
    stack.add(outer, 1 - outer);
    return stack.r + stack.t;
}

// The same with a film of air between the walls and so much water, in metres.
inline double filmedTankBrightness(double water) {
    const double outer = interfaceReflectance(1, 1.5), wet = interfaceReflectance(1, 1.33);
    Stack stack;
    for (const double r : {outer, outer, wet}) stack.add(r, 1 - r);
    stack.add(0, std::exp(-30 * water));
    for (const double r : {wet, outer, outer}) stack.add(r, 1 - r);
    return stack.r + stack.t;
}

} // namespace abbe::test
