// Dicing of subdivision surfaces: million triangles per second on one thread, and bytes per triangle with the
// acceleration structure; still, then displaced by noise and by an image. `dicing [LEVEL]`
#include "base/parallel.h"
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "geometry/subdivision_surface.h"
#include "textures/noise_texture.h"
#include "textures/spline_image.h"

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fmt/format.h>
#include <fstream>
#include <string>

using namespace abbe;

namespace {

// Processor time of one thread, which other work on the machine does not change.
double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// A torus of quads; of triangles and pentagons too if `irregular`, so that many vertices are extraordinary.
SubdivisionCage torus(std::uint32_t around, std::uint32_t across, bool irregular) {
    SubdivisionCage c;
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const double a = 2 * kPiD * i / around, b = 2 * kPiD * j / across, r = 2 + std::cos(b);
            c.positions.push_back(Vec3(Vec3d(r * std::cos(a), r * std::sin(a), std::sin(b))));
            c.uvs.push_back({static_cast<float>(i), static_cast<float>(j)});
        }
    const auto vertex = [&](std::uint32_t i, std::uint32_t j) { return (i % around) * across + j % across; };
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const std::uint32_t q[4] = {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)};
            if (irregular && (i + 2 * j) % 5 == 0) {
                c.faceSizes.insert(c.faceSizes.end(), {3, 3});
                c.corners.insert(c.corners.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
            } else {
                c.faceSizes.push_back(4);
                c.corners.insert(c.corners.end(), q, q + 4);
            }
        }
    c.uvCorners = c.corners;
    return c;
}

// Resident memory of this process, bytes.
double resident() {
    std::ifstream file("/proc/self/statm");
    double size = 0, pages = 0;
    file >> size >> pages;
    return pages * 4096;
}

void measure(const std::string& name, const SubdivisionCage& cage, double level, const Displacement* d = nullptr) {
    const double before = resident(), start = now();
    const SubdivisionSurface surface(cage);
    const double built = now();
    const DicingPlan plan = surface.plan({Dicing::Mode::level, level, {}, {}}, 1ull << 40, d);
    MeshData mesh = surface.dice(plan, d).mesh;
    const double diced = now();
    const double triangles = static_cast<double>(mesh.triangles.size() + 2 * mesh.quads.size());
    const Mesh shape(std::move(mesh));
    EmbreeSceneBuilder builder;
    builder.addShape(shape, {});
    const auto scene = builder.build();
    const double committed = now();
    fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.0f} | {:.0f} |\n", name, cage.faceSizes.size(),
               triangles * 1e-6, triangles * 1e-6 / (diced - built), committed - diced, (built - start) * 1e3,
               (resident() - before) / triangles);
}

// Every face has the whole image; heights without meaning.
class Heights final : public Texture {
  public:
    explicit Heights(int size) : image_(pixels(size), Wrap::periodic) {}
    int channels() const override { return 1; }
    bool needsUv() const override { return true; }
    TextureJet jet(const TexturePoint& p, int channels) const noexcept override { return image_.jet(p, channels); }

  private:
    static ImagePixels pixels(int size) {
        ImagePixels pixels;
        pixels.width = pixels.height = size;
        pixels.channels = 1;
        for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(size * size); ++i)
            pixels.values.push_back(static_cast<float>(i % 1009 * 7919 % 1009) / 1009.f);
        return pixels;
    }
    SplineImage image_;
};

} // namespace

int main(int argc, char** argv) {
    setThreadCount(1);
    const double level = argc > 1 ? std::atof(argv[1]) : 4;
    fmt::print("| cage | faces | M triangles | M triangles/s | mesh and BVH s | topology ms | bytes/triangle |\n"
               "|---|---|---|---|---|---|---|\n");
    measure("regular torus", torus(64, 32, false), level + 1);
    measure("torus with triangles", torus(64, 32, true), level + 1);
    measure("regular torus, fine cage", torus(256, 128, false), level - 1);
    measure("fine cage with triangles", torus(256, 128, true), level - 1);
    NoiseTextureParams params;
    const NoiseTexture noise(params);
    const Heights pixels(2048);
    const Displacement byNoise{Displacement::Space::normal, 0.05, 0.5, &noise};
    const Displacement byImage{Displacement::Space::normal, 0.02, 0.5, &pixels};
    measure("regular torus, noise of 4 octaves", torus(64, 32, false), level + 1, &byNoise);
    measure("regular torus, image", torus(64, 32, false), level + 1, &byImage);
    measure("torus with triangles, image", torus(64, 32, true), level + 1, &byImage);
    measure("fine cage with triangles, noise", torus(256, 128, true), level - 1, &byNoise);
    measure("fine cage with triangles, image", torus(256, 128, true), level - 1, &byImage);
}
