// One light of every kind, for tests of the paths that start there.
#pragma once

#include "caustics/shared/aimed_emission.h"
#include "render/intersector.h"
#include "support/environment_file.h"
#include "support/scene_test.h"
#include "support/statistics.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace abbe::test {

struct EmissionCase {
    std::string text; // of the light, near the origin, emitting about towards kAhead if it is at a place
    bool distant = false;
    double powerError = 1e-4; // relative, of Light::power() itself: some are sums over grids
    double powerFactor = 1;   // what power() takes for 1: a sun's is its irradiance times the disk, as if from one
                              // direction, which for half an angle a falls short by 2 / (1 + cos a)
    bool keepsPower = true;   // while it moves
    bool sampledWhole = true; // by Light::sample(): not what compensation leaves to scattering, or portals hide
};

inline const Vec3 kAhead = normalize(Vec3{0.2f, 0.1f, 1});

// What the lights read, for as long as the process lives.
class EmissionFiles {
  public:
    EmissionFiles() {
        writeProfile();
        writeEnvironment(sky(), 24, 12, skyColor);
    }
    EmissionFiles(const EmissionFiles&) = delete;
    EmissionFiles& operator=(const EmissionFiles&) = delete;
    ~EmissionFiles() {
        std::error_code ignored;
        for (const std::string& path : {profile(), sky()}) std::filesystem::remove(path, ignored);
    }
    std::string profile() const { return place("ies"); }
    std::string sky() const { return place("exr"); }

  private:
    static std::string place(const char* extension) {
        const auto name = fmt::format("abbe_emission_{}.{}", getpid(), extension);
        return (std::filesystem::temp_directory_path() / name).string();
    }
    // Brighter in one plane, and brightest 20 degrees off its axis.
    void writeProfile() const {
        std::ofstream file(profile());
        file << "IESNA:LM-63-1995\nTILT=NONE\n1 -1 1 19 4 1 2 0 0 0\n1 1 10\n";
        for (int v = 0; v <= 90; v += 5) file << v << ' ';
        file << "\n0 90 270 360\n";
        for (const double bright : {1.0, 2.0, 0.5, 1.0})
            for (int v = 0; v <= 90; v += 5)
                file << bright * 100 * std::max(0.0, std::cos((v - 20) * kPiD / 180) - 0.3) << ' ';
    }
    // With a sun and a dark ground.
    static std::array<float, 3> skyColor(int x, int y) {
        if (x == 5 && y == 3) return {90, 80, 60};
        if (y < 6) return {0.6f, 0.8f, 1.2f + 0.03f * static_cast<float>(x)};
        return {0.1f, 0.1f, 0.05f};
    }
};

inline std::vector<EmissionCase> emissionCases() {
    static const EmissionFiles files;
    const std::string turn = "transform { at 0 s { rotate y -20 deg; translate -0.3 0 0 }\n"
                             "at 1 s { rotate y 25 deg; translate 0.3 0.2 0 } } ",
                      grow = "transform { at 0 s { scale 0.5 }\nat 1 s { scale 1.5; translate 0.2 0 0 } } ",
                      flame = "color blackbody 2700 K; power 10 W; ",
                      pattern = "texture product { first ramp { over u; stop 0.3 0.01; stop 1 rgb 1 0.5 0.2 }; second "
                                "checker { even 1; odd 0.02; scale 4 } }; power 10 W; ",
                      solid = "texture checker { even rgb 1 0.3 0.1; odd 0.1; scale 9 cm }; power 10 W; ",
                      quad = "light quad { points -0.5 -0.4 0  0.5 -0.4 0  0.5 0.4 0  -0.5 0.4 0; ",
                      tetrahedron = "light mesh { points { - 0 0 0.6; - 0.5 0 0; - 0 0.5 0; - -0.4 -0.4 0 }; "
                                    "faces { - 0 1 2; - 0 2 3; - 0 3 1; - 1 3 2 }; ",
                      place = "position 0.1 0.2 -0.1; ", facing = "toward 0.2 0.1 1; ",
                      shape = "emission 0.5; transform { rotate x 60 deg; scale 0.5 0.5 0.8 } }",
                      environment =
                          fmt::format("light environment \"{}\" {{ transform {{ rotate y 25 deg }}; ", files.sky()),
                      emitter = fmt::format("light ies \"{}\" {{ ", files.profile()) + facing + "turn 30 deg; ";
    return {
        {"light point { " + place + flame + "}"},
        {"light spot { " + place + facing + "angle 80 deg; inner-angle 30 deg; " + flame + "}"},
        {"light spot { " + facing + "angle 60 deg; inner-angle 60 deg; " + flame + "}"},
        {"light spot { " + facing + "angle 300 deg; inner-angle 0 deg; " + flame + "}"},
        {"light beam { " + facing + "radius 0.3; divergence 80 deg; " + flame + "}"},
        {emitter + flame + "}"},
        {quad + flame + "}"},
        {quad + "two-sided on; " + flame + "}"},
        {"light quad { points -0.5 -0.4 0  0.5 -0.4 0.2  0.2 0.6 0  -0.5 0.4 0; " + flame + "}"},
        {"light disk { radius 0.5; normal 1 0 2; " + flame + "}"},
        {"light disk { radius 0.5; transform { scale 0.5 1.2 1 }; " + flame + "}"},
        {"light sphere { radius 0.3; " + flame + "}"},
        {"light sphere { radius 0.3; transform { scale 1 2 0.5; rotate x 30 deg }; " + flame + "}"},
        {tetrahedron + flame + "}"},
        {"light mesh { points { - -0.5 0 0; - 0 -0.5 0.1; - 0.5 0 0; - 0 0.5 0.1; - 0 0 0.5 }; "
         "faces { - 0 1 2 3; - 1 2 4 }; " +
         flame + "}"},
        {"shape cylinder { radius 0.4; height 1; " + shape},
        {"shape cone { radius 0.5; height 0.8; " + shape},
        {"shape torus { major-radius 0.5; minor-radius 0.2; " + shape},
        {quad + pattern + "}", false, 6e-3},
        {"light sphere { radius 0.3; " + pattern + "}", false, 6e-3},
        {"light disk { radius 0.5; transform { scale 0.5 1.2 1 }; " + pattern + "}", false, 6e-3},
        {tetrahedron + solid + "}", false, 6e-3},
        {"light point { " + place + flame + turn + "}"},
        {"light spot { " + facing + "angle 80 deg; " + flame + grow + "}"},
        {emitter + flame + turn + "}"},
        {"light beam { " + facing + "radius 0.4; divergence 70 deg; " + flame + turn + "}"},
        {quad + flame + turn + "}"},
        {"light sphere { radius 0.3; " + flame + grow + "}", false, 1e-4, 1, false},
        {quad + pattern + turn + "}", false, 6e-3},
        {"light sky { radiance 2 }", true},
        {"light sun { toward 0.3 -1 0.2 }", true},
        {"light sun { toward 0.3 -1 0.2; angular-diameter 60 deg }", true, 1e-4, 2 / (1 + std::cos(kPiD / 6))},
        {"light sun { toward 0.3 -1 0.2; angular-diameter 0 deg }", true},
        {"light daylight { elevation 40 deg; sun off }", true, 6e-3},
        {environment + "}", true, 0.04, 1, true, false},
        {environment + "portals { - -1 -1 -1; - 1 -1 -1; - 1 1 -1; - -1 1 -1 } }", true, 0.04, 1, true, false},
        {"light sky { luminance 3000 nits; portals { - -1 -1 -1; - 1 -1 -1; - 1 1 -1; - -1 1 -1 } }", true, 0.04, 1,
         true, false},
        {"light sun { toward 0.3 -1 0.2; angular-diameter 20 deg; transform { at 0 s { rotate z 0 deg }\n"
         "at 1 s { rotate z 60 deg } } }",
         true, 1e-4, 2 / (1 + std::cos(kPiD / 18))},
    };
}

// The light in a box of 3 m, so that the scene has bounds.
inline TestScene emissionScene(const EmissionCase& emitter) {
    return TestScene::parse("scene 1\nfilm { size 16 16 }\ncamera { from 0 0 9; look-at 0 0 0; shutter 1 s }\n"
                            "shape box { size 3 3 3 }\n" +
                            emitter.text + "\n");
}

inline EmissionNumbers emissionNumbers(Random& random) {
    EmissionNumbers u;
    u.light = random.uniformDouble();
    u.part = random.uniformDouble();
    u.aim = random.uniform();
    u.position = {random.uniform(), random.uniform()};
    u.direction = {random.uniform(), random.uniform()};
    return u;
}

// W of what a path carries, from its eight wavelengths.
inline double watts(const Spectrum& perNanometre, const Wavelengths& lambda) {
    return static_cast<double>(mean(perNanometre / lambda.pdf));
}

} // namespace abbe::test
