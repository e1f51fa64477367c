// CPU seconds for reading a large binary PLY file:  mesh_reading [millions of triangles]
#include "io/mesh_file.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sys/resource.h>

namespace {

struct CpuSeconds {
    double user, system;
};

CpuSeconds cpuSeconds() {
    rusage use{};
    getrusage(RUSAGE_SELF, &use);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return {seconds(use.ru_utime), seconds(use.ru_stime)};
}

// A grid of as many triangles: x, y, z, and lists of three numbers.
void writeGrid(const std::string& path, std::uint32_t side) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (!file) std::abort();
    std::fprintf(file,
                 "ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty float x\nproperty float y\n"
                 "property float z\nelement face %u\nproperty list uchar int vertex_indices\nend_header\n",
                 (side + 1) * (side + 1), 2 * side * side);
    for (std::uint32_t y = 0; y <= side; ++y)
        for (std::uint32_t x = 0; x <= side; ++x) {
            const float point[3] = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(x * y % 7)};
            std::fwrite(point, sizeof point, 1, file);
        }
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x) {
            const std::uint32_t a = y * (side + 1) + x, c = a + side + 1;
            const std::uint32_t faces[6] = {a, a + 1, c, a + 1, c + 1, c};
            for (int i = 0; i < 2; ++i) {
                std::fputc(3, file);
                std::fwrite(faces + 3 * i, 3 * sizeof(std::uint32_t), 1, file);
            }
        }
    if (std::fclose(file) != 0) std::abort();
}

} // namespace

int main(int argc, char** argv) {
    const double millions = argc > 1 ? std::atof(argv[1]) : 10;
    const auto side = static_cast<std::uint32_t>(std::sqrt(millions * 5e5));
    const std::string path = (std::filesystem::temp_directory_path() / "abbe_mesh_reading.ply").string();
    writeGrid(path, side);
    for (int i = 0; i < 3; ++i) {
        const CpuSeconds before = cpuSeconds();
        const abbe::MeshFile file = abbe::readMesh(path);
        const CpuSeconds after = cpuSeconds();
        std::printf("%zu triangles: %.3f s, and %.3f s in the kernel\n", file.mesh.triangles.size(),
                    after.user - before.user, after.system - before.system);
    }
    std::filesystem::remove(path);
}
