// What the benchmarks of caustics under a ball of glass are told.
#pragma once

#include "ball_spot.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace abbe {

struct BallSpotOptions {
    struct Way {
        std::string name, properties; // of `render`
    };

    BallSpot::View view;
    double seconds = 20; // of a render
    std::vector<Way> ways;
    std::vector<double> radii; // of the light

    //   [--size N] [--width METRES] [--least SHARE] [--seconds N] [--way 'NAME=PROPERTIES OF RENDER']… [RADIUS…]
    // Throws std::runtime_error. `defaults` has at least one way and one radius.
    static BallSpotOptions read(int argc, char** argv, const BallSpotOptions& defaults) {
        BallSpotOptions o = defaults;
        o.ways.clear();
        o.radii.clear();
        for (int i = 1; i < argc; ++i) {
            const std::string name = argv[i];
            const auto next = [&] { return ++i < argc ? argv[i] : ""; };
            if (name == "--size")
                o.view.size = std::max(1, std::atoi(next()));
            else if (name == "--width")
                o.view.width = std::atof(next());
            else if (name == "--least")
                o.view.least = std::atof(next());
            else if (name == "--seconds")
                o.seconds = std::atof(next());
            else if (name == "--way")
                o.ways.push_back(way(next()));
            else
                o.radii.push_back(std::atof(argv[i]));
        }
        if (o.ways.empty()) o.ways = defaults.ways;
        if (o.radii.empty()) o.radii = defaults.radii;
        return o;
    }

  private:
    static Way way(const std::string& text) {
        const auto at = text.find('=');
        if (at == std::string::npos) throw std::runtime_error("--way 'NAME=PROPERTIES OF RENDER'");
        return {text.substr(0, at), text.substr(at + 1)};
    }
};

} // namespace abbe
