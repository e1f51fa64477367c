// What choosing among many lights is worth: a hall with so many lights, whose power is 20 klm together, at equal time
// for each choice.
//   bench_lights [--size N] [--seconds N] [--reference SAMPLES] [COUNT…]     default: 128, 20, 1024, 1 100 1000 100000
//   relMSE after so many core-seconds, relMSE × samples and efficiency, each of all pixels and without the worst 0.1 %.
#include "base/parallel.h"
#include "render_error.h"
#include "rendering/render_params.h"
#include "support/scene_test.h"
#include "support/statistics.h"

#include <cstdio>
#include <cstring>
#include <fmt/format.h>

using namespace abbe;

namespace {

struct Options {
    int size = 128;
    double seconds = 20;
    std::uint32_t reference = 1024;
    std::vector<int> counts;
};

constexpr const char* kHall = R"(scene 1
film {{ size {0} {0}; filter box 0.5 }}
camera {{ from 0 2 9.5; look-at 0 -1 4; fov 55 deg }}
render {{ max-depth 16; replicates 1 }}
material plaster diffuse {{ reflectance 0.5 }}
shape box {{ size 40 5 40; transform {{ translate 0 2.5 -9 }}; material plaster }}
shape box {{ size 1.5 2.4 1.5; transform {{ rotate y 30 deg; translate -2.5 1.2 2 }}; material plaster }}
shape box {{ size 1 1 1; transform {{ rotate y -20 deg; translate 2 0.5 4 }}; material plaster }}
shape cylinder {{ radius 0.4; height 5; transform {{ translate 3.5 2.5 -1 }}; material plaster }}
shape sphere {{ center 0.3 0.9 3; radius 0.9; material conductor {{ index metal Cu; roughness 0.3 }} }}
)";

// Balls and little squares, of powers over two decades, everywhere under the ceiling. None is in the picture but in the
// copper: what a pixel half of a light costs has nothing to do with the choice.
std::string hall(int count, int size) {
    test::Random random(4);
    const auto u = [&random](double a, double b) { return a + (b - a) * static_cast<double>(random.uniform()); };
    std::vector<double> power;
    double all = 0;
    for (int i = 0; i < count; ++i) all += power.emplace_back(std::pow(10, u(-1, 1)));
    std::string text = fmt::format(kHall, size);
    const double r = 0.2 / std::cbrt(count);
    for (int i = 0; i < count; ++i) {
        const double x = u(-19, 19), y = u(2.2, 4.7), z = u(-28, 8),
                     lumen = 20000 * power[static_cast<std::size_t>(i)] / all;
        if (i % 2)
            text += fmt::format("light sphere {{ center {} {} {}; radius {}; power {} lm }}\n", x, y, z, r, lumen);
        else
            text += fmt::format("light quad {{ size {} {}; power {} lm; transform {{ rotate x {} deg; rotate y {} deg; "
                                "translate {} {} {} }} }}\n",
                                2 * r, 2 * r, lumen, u(40, 140), u(0, 360), x, y, z);
    }
    return text;
}

MeasuredRender render(const BuiltScene& built, Technique::LightChoice choice, std::uint32_t samples,
                      std::uint64_t seed) {
    RenderSettings how = renderSettings(built.render);
    how.technique.lightChoice = choice;
    how.samples = samples;
    how.seed = seed;
    return measuredRender(built, how, 1);
}

void measure(const BuiltScene& built, const MeasuredRender& reference, Technique::LightChoice choice, int count,
             const Options& o) {
    const MeasuredRender trial = render(built, choice, 4, 7);
    const auto samples = static_cast<std::uint32_t>(std::max(1.0, 4 * o.seconds / trial.statistics.coreSeconds));
    const MeasuredRender a = render(built, choice, samples, 1), b = render(built, choice, samples, 2);
    const double seconds = 0.5 * (a.statistics.coreSeconds + b.statistics.coreSeconds);
    const RelativeError e = relativeError(a, b, reference);
    // At 512×512 a sample of every pixel takes longer by the number of pixels.
    const double pixels = square(512.0 / o.size);
    std::printf("%7d  %-7s  %7u  %5.3f  %8.4f %8.4f  %8.2f %8.2f  %7.3f %7.3f\n", count, word(choice).data(), samples,
                static_cast<double>(a.statistics.paths) * 1e-6 / a.statistics.coreSeconds, e.all * seconds / o.seconds,
                e.trimmed * seconds / o.seconds, e.all * samples, e.trimmed * samples, 1 / (e.all * seconds * pixels),
                1 / (e.trimmed * seconds * pixels));
    std::fflush(stdout);
}

void run(const Options& o) {
    std::printf(
        "                              M paths  relMSE at %-4.0f s    relMSE×samples     efficiency at 512×512\n"
        " lights  choice   samples  /core-s       all   w/o 0.1%%    all   w/o 0.1%%     all   w/o 0.1%%\n",
        o.seconds);
    for (const int count : o.counts) {
        const auto scene = test::TestScene::parse(hall(count, o.size));
        if (scene.diagnostics().hasErrors()) throw std::runtime_error(scene.report());
        const MeasuredRender reference = render(scene.built(), Technique::LightChoice::tree, o.reference, 1000);
        for (const auto choice :
             {Technique::LightChoice::tree, Technique::LightChoice::power, Technique::LightChoice::uniform}) {
            measure(scene.built(), reference, choice, count, o);
            if (count == 1) break; // no choice
        }
    }
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const auto number = [&] { return ++i < argc ? std::atoi(argv[i]) : 0; };
        if (!std::strcmp(argv[i], "--size"))
            options.size = number();
        else if (!std::strcmp(argv[i], "--seconds"))
            options.seconds = number();
        else if (!std::strcmp(argv[i], "--reference"))
            options.reference = static_cast<std::uint32_t>(number());
        else
            options.counts.push_back(std::atoi(argv[i]));
    }
    if (options.counts.empty()) options.counts = {1, 100, 1000, 100000};
    setThreadCount(1);
    try {
        run(options);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
