// Makes scenes/hair-ball/hair.ply:
//
//     g++ -std=c++20 -O2 tools/make_hair_ball.cpp -o make_hair_ball && ./make_hair_ball > scenes/hair-ball/hair.ply
//
// 18 000 strands of seven control points on a ball of radius 0.2 m, in whole multiples of 1/60 000 m, so that a point
// takes seven bytes. The strands hang in tufts, curl and taper.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <vector>

namespace {

using Vec = std::array<double, 3>;
Vec operator+(Vec a, Vec b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vec operator*(Vec a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
double dot(Vec a, Vec b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec unit(Vec a) { return a * (1 / std::sqrt(dot(a, a))); }
Vec cross(Vec a, Vec b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }

constexpr int kStrands = 18000, kPoints = 7, kTufts = 900;
constexpr double kUnitsPerMetre = 60000, kBall = 0.2, kRadius = 0.0004;
constexpr double kPi = 3.14159265358979323846;

// Evenly spread over the sphere: a Fibonacci lattice.
Vec latticePoint(int i, int count) {
    const double y = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - y * y), phi = i * kPi * (3 - std::sqrt(5.0));
    return {r * std::cos(phi), y, r * std::sin(phi)};
}

void put(std::vector<char>& out, std::int16_t v) {
    out.push_back(static_cast<char>(v & 0xff));
    out.push_back(static_cast<char>((v >> 8) & 0xff));
}

} // namespace

int main() {
    std::mt19937 engine(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Vec> tufts;
    for (int i = 0; i < kTufts; ++i)
        tufts.push_back(unit(latticePoint(i, kTufts) + Vec{uniform(engine), uniform(engine), uniform(engine)} * 0.05));
    std::vector<char> body;
    for (int i = 0; i < kStrands; ++i) {
        const Vec root =
            unit(latticePoint(i, kStrands) + Vec{uniform(engine), uniform(engine), uniform(engine)} * 0.01);
        Vec tuft = tufts[0];
        for (const Vec& t : tufts)
            if (dot(t, root) > dot(tuft, root)) tuft = t;
        const double length = 0.15 * (1 + 0.25 * uniform(engine)), phase = 2 * kPi * uniform(engine);
        const double curl = 0.006 * (1 + 0.6 * uniform(engine));
        const Vec side = unit(cross(root, Vec{0.3, 1, 0.1})), other = cross(root, side);
        Vec p = root * (kBall - 0.01), d = unit(root + Vec{uniform(engine), uniform(engine), uniform(engine)} * 0.15);
        for (int k = 0; k < kPoints; ++k) {
            const double s = k / (kPoints - 1.0), angle = phase + 5 * s;
            // Towards the middle of the tuft, and down.
            const Vec pull = (tuft * (kBall + length * s) + p * -1.0) * (4 * s);
            const Vec shown = p + (side * std::cos(angle) + other * std::sin(angle)) * (curl * s);
            for (double c : shown) put(body, static_cast<std::int16_t>(std::lround(c * kUnitsPerMetre)));
            body.push_back(static_cast<char>(std::lround(kRadius * (1 - 0.85 * s * s) * kUnitsPerMetre)));
            d = unit(d + pull + Vec{0.15 * s, -0.9 * s, 0} +
                     Vec{uniform(engine), uniform(engine), uniform(engine)} * 0.08);
            p = p + d * (length / (kPoints - 1));
        }
    }
    std::printf("ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty short x\nproperty short y\n"
                "property short z\nproperty uchar radius\nelement strand %d\nproperty uchar count\nend_header\n",
                kStrands * kPoints, kStrands);
    body.insert(body.end(), kStrands, static_cast<char>(kPoints));
    std::fwrite(body.data(), 1, body.size(), stdout);
}
