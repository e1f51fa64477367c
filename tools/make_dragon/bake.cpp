#include "bake.h"

#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <cstdio>
#include <half.h>

namespace dragon {
namespace {

struct Texel {
    Vec at, normal;
    int layer = -1; // 0 on the surface, then steps beyond the seam
};

// Texels whose centres lie in the triangle know their place on the surface.
void fill(std::vector<Texel>& image, int size, const std::array<Vec2, 3>& t, const std::array<Vec, 3>& p,
          const std::array<Vec, 3>& n) {
    const Vec2 a = t[1] + t[0] * -1, b = t[2] + t[0] * -1;
    const double area = a.u * b.v - a.v * b.u;
    if (area <= 0) return;
    const auto range = [&](double x, double y, double z) {
        return std::array{std::max(0, int(std::min({x, y, z}) * size - 1)),
                          std::min(size - 1, int(std::max({x, y, z}) * size + 1))};
    };
    const auto [x0, x1] = range(t[0].u, t[1].u, t[2].u);
    const auto [y0, y1] = range(t[0].v, t[1].v, t[2].v);
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const Vec2 d = Vec2{(x + 0.5) / size, (y + 0.5) / size} + t[0] * -1;
            const double s = (d.u * b.v - d.v * b.u) / area, r = (a.u * d.v - a.v * d.u) / area;
            if (s < -1e-9 || r < -1e-9 || s + r > 1 + 1e-9) continue;
            image[std::size_t(y) * size + x] = {p[0] + (p[1] - p[0]) * s + (p[2] - p[0]) * r,
                                                n[0] + (n[1] - n[0]) * s + (n[2] - n[0]) * r, 0};
        }
}

// Continues places and normals by one texel, straight on from the two inside.
void extend(std::vector<Texel>& image, int size, int layer) {
    for (int y = 2; y + 2 < size; ++y)
        for (int x = 2; x + 2 < size; ++x) {
            Texel& here = image[std::size_t(y) * size + x];
            if (here.layer >= 0) continue;
            Vec at, normal;
            double count = 0;
            for (int i = 0; i < 9; ++i) {
                const std::ptrdiff_t step = std::ptrdiff_t(i / 3 - 1) * size + i % 3 - 1;
                const Texel &one = (&here)[step], &two = (&here)[2 * step];
                if (one.layer < 0 || one.layer >= layer || two.layer < 0 || two.layer >= layer) continue;
                const double w = i % 2 == 1 ? 1 : 0.5;
                at = at + (one.at * 2 - two.at) * w;
                normal = normal + (one.normal * 2 - two.normal) * w;
                count += w;
            }
            if (count > 0) here = {at * (1 / count), normal * (1 / count), layer};
        }
}

} // namespace

std::vector<float> bake(const Cage& fine, const Skin& skin, int size, double range) {
    std::vector<Texel> image(std::size_t(size) * size);
    const std::vector<Vec> normals = pointNormals(fine);
    for (std::size_t f = 0; f < fine.faces.size(); ++f) {
        const Quad& q = fine.faces[f];
        const auto& t = fine.uvs[f];
        for (int i : {1, 2})
            fill(image, size, {t[0], t[i], t[i + 1]}, {fine.points[q[0]], fine.points[q[i]], fine.points[q[i + 1]]},
                 {normals[q[0]], normals[q[i]], normals[q[i + 1]]});
    }
    for (int layer = 1; layer <= 5; ++layer) extend(image, size, layer);
    std::vector<float> out(image.size(), 0.5f);
    double low = 0, high = 0;
    std::size_t used = 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        if (image[i].layer < 0) continue;
        const double h = skin.look(image[i].at, unit(image[i].normal)).height;
        low = std::min(low, h), high = std::max(high, h), ++used;
        // Steps of a thousandth cannot be seen and make the file small.
        out[i] = float(std::round((0.5 + h / range) * 1024) / 1024);
    }
    std::printf("heights from %.3f to %.3f cm, %.0f %% of the texels used\n", low, high,
                100.0 * double(used) / double(image.size()));
    return out;
}

void writeExr(const char* path, const std::vector<float>& values, int size) {
    std::vector<half> pixels(values.size());
    for (int y = 0; y < size; ++y) // the first row of the file is the top
        for (int x = 0; x < size; ++x) pixels[std::size_t(y) * size + x] = values[std::size_t(size - 1 - y) * size + x];
    Imf::Header header(size, size);
    header.compression() = Imf::PIZ_COMPRESSION;
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(pixels.data()), sizeof(half),
                                  sizeof(half) * std::size_t(size)));
    Imf::OutputFile file(path, header);
    file.setFrameBuffer(buffer);
    file.writePixels(size);
}

} // namespace dragon
