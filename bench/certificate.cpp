// What the certificate of an image costs: bench_certificate [WIDTH HEIGHT] prints core-seconds, for each pixel and in
// all.
#include "film/error_certificate.h"
#include "io/ocio_view.h"
#include "measure.h"

#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
    using namespace abbe;
    const int width = argc > 2 ? std::atoi(argv[1]) : 1280, height = argc > 2 ? std::atoi(argv[2]) : 720;
    for (const int replicates : {2, 8}) {
        PixelFilm film({0, 0, width, height}, {FilterShape::box, 0.5}, replicates);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int r = 0; r < replicates; ++r)
                    film.add(x, y, r, Xyz{0.3, 0.3, 0.3} + Xyz{1, 1, 1} * static_cast<double>(uniform()), 32);
        const double start = seconds(CLOCK_PROCESS_CPUTIME_ID);
        const OcioView view(ViewInput::aces2065_1);
        const double ready = seconds(CLOCK_PROCESS_CPUTIME_ID);
        ErrorCertificate::Picture picture{{}, rgb::ap0.fromXyz(), 1, {}};
        ErrorCertificate::of(film, picture);
        const double linear = seconds(CLOCK_PROCESS_CPUTIME_ID);
        picture.display = [&view](std::span<float> rgb) { view.apply(rgb); };
        const auto certificate = ErrorCertificate::of(film, picture);
        const double end = seconds(CLOCK_PROCESS_CPUTIME_ID);
        const double pixels = static_cast<double>(width) * height;
        std::printf("%d replicates: view %.1f ms; %.0f ns a pixel without a display, %.0f ns with one, of which the "
                    "render took at 1 us a path and 64 samples %.2f %% (error %.3g)\n",
                    replicates, 1e3 * (ready - start), 1e9 * (linear - ready) / pixels, 1e9 * (end - linear) / pixels,
                    100 * (end - linear) / pixels / 64e-6, certificate.relative.value);
    }
}
