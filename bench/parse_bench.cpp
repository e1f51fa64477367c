// Speed of the scene parser and of the layout in MB per second of processor time, single thread, on generated texts.
// Run by hand: parse_bench [repetitions].
#include "base/source.h"
#include "parser/parse.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fmt/format.h>
#include <random>
#include <string>

namespace {

// A million nodes as scenes have them: a shape with a few properties.
std::string smallNodes(std::mt19937& random) {
    std::uniform_real_distribution<double> place(-100, 100);
    std::string text = "scene 1\n";
    for (int i = 0; i < 200'000; ++i)
        text += fmt::format("shape s{} sphere {{\n    center {:.3f} {:.3f} {:.3f}\n    radius {:.2f} cm\n    material "
                            "paint\n    visible on\n}}\n",
                            i, place(random), place(random), place(random), place(random));
    return text;
}

// A mesh of 700 000 points as child rows.
std::string rows(std::mt19937& random) {
    std::uniform_real_distribution<double> place(-10, 10);
    std::string text = "scene 1\nshape mesh {\n    points {\n";
    for (int i = 0; i < 700'000; ++i)
        text += fmt::format("        - {:.6f} {:.6f} {:.6f}\n", place(random), place(random), place(random));
    return text + "    }\n}\n";
}

// Two million numbers with nine digits on one line.
std::string longLine(std::mt19937& random) {
    std::uniform_real_distribution<double> value(0, 1);
    std::string text = "scene 1\nspectrum s table";
    for (int i = 0; i < 2'000'000; ++i) text += fmt::format(" {:.9g}", value(random));
    return text + "\n";
}

// Numbers with all 17 digits, which take the slow conversion.
std::string fullPrecision(std::mt19937& random) {
    std::uniform_real_distribution<double> value(0, 1);
    std::string text = "scene 1\nspectrum s table";
    for (int i = 0; i < 1'000'000; ++i) text += fmt::format(" {:.17g}", value(random));
    return text + "\n";
}

// The shortest of several runs, in seconds of processor time.
template <typename Work> double secondsOf(int repetitions, Work work) {
    double best = 1e9;
    for (int i = 0; i < repetitions; ++i) {
        const std::clock_t start = std::clock();
        work();
        best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    return best;
}

void measure(const char* name, std::string text, int repetitions) {
    abbe::SourceMap sources;
    const double megabytes = static_cast<double>(text.size()) / 1e6;
    const abbe::FileId file = sources.add(name, std::move(text));
    std::size_t nodes = 0;
    const double parsing = secondsOf(repetitions, [&] {
        abbe::Diagnostics diagnostics;
        nodes = abbe::parse(sources, file, {}, diagnostics)->nodes.size();
        if (diagnostics.hasErrors()) std::exit(1);
    });
    const double layout = secondsOf(repetitions, [&] {
        if (abbe::layOut(sources.text(file)).empty()) std::exit(1);
    });
    std::printf("%-28s %8.1f MB %9zu nodes %8.0f MB/s, layout %6.0f MB/s\n", name, megabytes, nodes,
                megabytes / parsing, megabytes / layout);
}

} // namespace

int main(int argc, char** argv) {
    const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 7;
    std::mt19937 random(1);
    measure("1 M small nodes", smallNodes(random), repetitions);
    measure("rows - x y z", rows(random), repetitions);
    measure("2 M numbers on one line", longLine(random), repetitions);
    measure("1 M numbers of 17 digits", fullPrecision(random), repetitions);
}
