// What light from light paths costs on the film: bench_splats [FILE] prints nanoseconds of a thread for a splat, at any
// pixel and where threads meet, and how long light paths wait for a checkpoint of 1920 × 1080, written to FILE.
#include "checkpoints/checkpoint_file.h"
#include "film/pixel_film.h"
#include "measure.h"

#include <chrono>
#include <cstdio>
#include <thread>
#include <vector>

namespace {

using namespace abbe;

constexpr int kSplats = 4'000'000; // of each thread
constexpr PixelBounds kFrame{0, 0, 1920, 1080};

double nanoseconds(PixelFilm& film, int threads, int pixels) {
    double sum = 0;
    std::vector<double> spent(static_cast<std::size_t>(threads));
    std::vector<std::thread> list;
    for (int t = 0; t < threads; ++t)
        list.emplace_back([&, t] {
            std::mt19937 random(static_cast<unsigned>(t));
            const Spectrum radiance(1.f);
            const Wavelengths lambda = Wavelengths::sample(0.3f);
            const Splat splat{{0.3, 0.4, 0.5}, radiance, lambda, 1, nullptr, PathComponent::caustic};
            const double start = seconds(CLOCK_THREAD_CPUTIME_ID);
            for (int i = 0; i < kSplats; ++i) {
                const auto at = static_cast<int>(random() % static_cast<unsigned>(pixels));
                film.splat(at % 1920, at / 1920, i % 2, splat);
            }
            spent[static_cast<std::size_t>(t)] = seconds(CLOCK_THREAD_CPUTIME_ID) - start;
        });
    for (std::thread& t : list) t.join();
    for (const double s : spent) sum += s;
    return 1e9 * sum / threads / kSplats;
}

} // namespace

int main(int argc, char** argv) {
    PixelFilm film(kFrame, {FilterShape::box, 0.5}, 2);
    const double without = nanoseconds(film, 1, 1920 * 1080);
    film.keepSplats();
    nanoseconds(film, 1, 1920 * 1080); // memory is there
    for (const int threads : {1, 2})
        for (const int pixels : {1920 * 1080, 64, 1})
            std::printf("%d threads, %d pixels: %.1f ns a splat\n", threads, pixels,
                        nanoseconds(film, threads, pixels) - without);
    if (argc < 2) return 0;
    RenderState state(kFrame, 0, 1);
    CheckpointHeader header;
    header.bounds = kFrame;
    header.replicates = 2;
    header.lightBlocks = 1;
    const auto clock = [] { return seconds(CLOCK_MONOTONIC); };
    double waited = 0;
    bool done = false;
    const double start = clock();
    std::atomic<bool> begun = false;
    std::thread light([&] { // as a light path does, again and again
        while (!std::atomic_ref(done).load()) {
            const double before = clock();
            const auto pass = state.lightGate().enter();
            begun = true;
            waited = std::max(waited, clock() - before);
        }
    });
    while (!begun) std::this_thread::yield();
    writeCheckpoint(argv[1], header, film.planes(), state);
    std::atomic_ref(done).store(true);
    light.join();
    std::printf("checkpoint: %.2f s, of which light paths waited %.2f s\n", clock() - start, waited);
}
