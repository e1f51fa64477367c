// Speed of the scene parser and of the layout in MB per second of processor time, single thread, on generated texts.
// Run by hand: parse_bench [REPETITIONS], or parse_bench mesh ABBE MEGABYTES for the memory and the time in which the
// program checks a scene with an inline mesh of that size.
#include "base/source.h"
#include "parser/parse.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <random>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

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

// A grid of n × n points and its quadrilaterals, a row each, of about `bytes` in all.
void writeMesh(const std::filesystem::path& path, double bytes) {
    constexpr double perPoint = 76; // bytes of a point and a face
    const int n = std::max(2, static_cast<int>(std::sqrt(bytes / perPoint)));
    std::ofstream out(path);
    out << "scene 1\ncamera { from 0 2 4; look-at 0 0 0 }\nlight sky { luminance 100 nits }\nshape mesh {\n    points "
           "{\n";
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            out << fmt::format("        - {:.6f} {:.6f} {:.6f}\n", 2. * i / n - 1, 0.1 * std::sin(i * 0.01 + j * 0.013),
                               2. * j / n - 1);
    out << "    }\n    faces {\n";
    for (int j = 0; j + 1 < n; ++j)
        for (int i = 0; i + 1 < n; ++i)
            out << fmt::format("        - {} {} {} {}\n", j * n + i, j * n + i + 1, (j + 1) * n + i + 1,
                               (j + 1) * n + i);
    out << "    }\n}\n";
}

int measureMesh(const char* program, double megabytes) {
    const auto path = std::filesystem::temp_directory_path() / fmt::format("abbe-mesh-{}.scene", ::getpid());
    writeMesh(path, megabytes * 1e6);
    const double size = static_cast<double>(std::filesystem::file_size(path));
    const pid_t child = ::fork();
    if (child == 0) {
        ::execl(program, program, "check", "-q", path.c_str(), nullptr);
        std::_Exit(127);
    }
    int status = 0;
    rusage used{};
    ::wait4(child, &status, 0, &used);
    std::filesystem::remove(path);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    const double peak = 1024. * static_cast<double>(used.ru_maxrss);
    const double time = seconds(used.ru_utime) + seconds(used.ru_stime);
    std::printf(
        "inline mesh of %.0f MB: peak memory %.0f MB, %.2f times the text; %.2f s of processor time, %.0f MB/s\n",
        size / 1e6, peak / 1e6, peak / size, time, size / 1e6 / time);
    return status == 0 ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
    if (argc == 4 && std::strcmp(argv[1], "mesh") == 0) return measureMesh(argv[2], std::atof(argv[3]));
    const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 7;
    std::mt19937 random(1);
    measure("1 M small nodes", smallNodes(random), repetitions);
    measure("rows - x y z", rows(random), repetitions);
    measure("2 M numbers on one line", longLine(random), repetitions);
    measure("1 M numbers of 17 digits", fullPrecision(random), repetitions);
}
