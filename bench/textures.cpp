// What image textures cost:  bench_textures FOLDER [MiB of set] [MiB of cache]
// Makes a set of incompressible 8-bit pictures of 4096×4096 RGB in FOLDER (kept for the next run), converts them with a
// cache in FOLDER/cache, and looks into all of them at random and in order: nanoseconds per lookup, what was read, and
// the memory of the whole process at its peak.
#include "base/parallel.h"
#include "math/hash.h"
#include "textures/image_texture.h"

#include <cstdlib>
#include <ctime>
#include <fmt/format.h>
#include <fstream>
#include <sys/resource.h>

namespace {

using namespace abbe;
namespace fs = std::filesystem;

constexpr int kSize = 4096;

// Of processors, by all threads: other programs do not count.
double processorSeconds(auto&& body) {
    const std::clock_t start = std::clock();
    body();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

double peakMiB() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

std::string pictureFile(const fs::path& folder, int number) {
    const fs::path path = folder / fmt::format("noise{}.ppm", number);
    if (fs::exists(path)) return path.string();
    std::ofstream out(path, std::ios::binary);
    out << fmt::format("P6\n{} {}\n255\n", kSize, kSize);
    std::vector<std::uint64_t> row(kSize * 3 / 8);
    std::uint64_t i = static_cast<std::uint64_t>(number) << 40;
    for (int y = 0; y < kSize; ++y) {
        for (std::uint64_t& x : row) x = mix64(++i);
        out.write(reinterpret_cast<const char*>(row.data()), kSize * 3);
    }
    return path.string();
}

using Textures = std::vector<std::unique_ptr<Texture>>;

TextureQuery query(std::uint64_t i, float halfTexels, float ratio) {
    const std::uint64_t h = mix64(i);
    TextureQuery q(Vec2{unitFloat(static_cast<std::uint32_t>(h)), unitFloat(static_cast<std::uint32_t>(h >> 32))}, {});
    q.du = {halfTexels * ratio / kSize, 0.3f * halfTexels * ratio / kSize};
    q.dv = {-0.3f * halfTexels / kSize, halfTexels / kSize};
    return q;
}

void report(const TextureStore& store, const char* what, double lookups, double time) {
    const AbbeTextureStatistics s = store.statistics();
    fmt::print("| {} | {:.0f} | {:.0f} | {:.0f} | {:.0f} |\n", what, time / lookups * 1e9,
               static_cast<double>(s.bytesRead) / 1048576, static_cast<double>(s.cacheBytes) / 1048576, peakMiB());
}

void measure(const Textures& textures, const TextureStore& store, const Wavelengths& lambda) {
    fmt::print("| lookups | processor ns per lookup | MiB read | MiB of tiles | peak MiB of the process |\n"
               "|---|---|---|---|---|\n");
    std::vector<float> sums(64);
    // Every picture, everywhere: tiles come and go.
    constexpr std::size_t kEverywhere = 400;
    const double all = processorSeconds([&] {
        parallelFor(64, [&](std::size_t task) {
            for (std::size_t t = 0; t < textures.size(); ++t)
                for (std::size_t i = 0; i < kEverywhere; ++i)
                    sums[task] += textures[t]->value(query(task * 1000003 + i * 7919 + t, 0.5f, 1)).x;
        });
    });
    report(store, "everywhere in the set", 64.0 * kEverywhere * static_cast<double>(textures.size()), all);
    // In tiles that are there.
    const auto local = [&](const char* what, float halfTexels, float ratio, bool spectrum) {
        constexpr std::size_t kCount = 500000;
        const auto loop = [&] {
            for (std::size_t i = 0; i < kCount; ++i) {
                TextureQuery q = query(i, halfTexels, ratio);
                q.uv = q.uv * 0.05f;
                sums[0] += spectrum ? textures[0]->spectrum(q, lambda)[0] : textures[0]->value(q).x;
            }
        };
        loop();
        report(store, what, kCount, processorSeconds(loop));
    };
    local("point, between texels", 0, 1, false);
    local("round, one texel", 0.5f, 1, false);
    local("round, ten texels", 5, 1, false);
    local("four times as long as wide", 0.5f, 4, false);
    local("sixteen times as long as wide", 0.5f, 16, false);
    local("round, one texel, spectrum", 0.5f, 1, true);
    fmt::print("(sum {:g})\n", static_cast<double>(sums[0]));
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        fmt::print("bench_textures FOLDER [MiB of set] [MiB of cache]\n");
        return 2;
    }
    const fs::path folder = argv[1];
    const int setMiB = argc > 2 ? std::atoi(argv[2]) : 2048, cacheMiB = argc > 3 ? std::atoi(argv[3]) : 512;
    const int count = std::max(1, (setMiB + 47) / 48); // 48 MiB each
    fs::create_directories(folder);
    std::vector<std::string> files;
    for (int i = 0; i < count; ++i) files.push_back(pictureFile(folder, i));
    TextureStoreSettings settings;
    settings.bytes = std::int64_t{cacheMiB} << 20;
    settings.directory = folder / "cache";
    const auto store = std::make_shared<TextureStore>(settings);
    Diagnostics diagnostics;
    Textures textures;
    const double made = processorSeconds([&] {
        for (const std::string& file : files) {
            ImageTextureParams params;
            params.file.value = file;
            textures.push_back(makeImageTexture(params, store, diagnostics));
            if (!textures.back() || !textures.back()->prepare(TextureUse::reflectance, {}, diagnostics)) std::abort();
        }
    });
    fmt::print("{} pictures, {} MiB, cache of {} MiB, {} threads; ready in {:.1f} processor seconds, {:.1f} Mtexels/s; "
               "peak {:.0f} MiB\n\n",
               count, count * 48, cacheMiB, threadCount(), made, count * 16.8 / made, peakMiB());
    Wavelengths lambda;
    for (int i = 0; i < kLanes; ++i) lambda.nm.v[i] = 400 + 40 * static_cast<float>(i);
    measure(textures, *store, lambda);
    for (const Diagnostic& d : diagnostics.all()) fmt::print("{} {}\n", d.code, d.message);
}
