#include "skin.h"

#include <cstdint>
#include <random>

namespace dragon {
namespace {

const Form kForm;

double hash(int x, int y, int z) {
    std::uint32_t h = std::uint32_t(x) * 0x8da6b343u ^ std::uint32_t(y) * 0xd8163841u ^ std::uint32_t(z) * 0xcb1ab31fu;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return (h ^ h >> 15) / 4294967296.0;
}

// Smooth noise, -1 … 1.
double noise(Vec p) {
    const Vec f{std::floor(p.x), std::floor(p.y), std::floor(p.z)}, t = p - f;
    const int x = int(f.x), y = int(f.y), z = int(f.z);
    const double u = smoothstep(0, 1, t.x), v = smoothstep(0, 1, t.y), w = smoothstep(0, 1, t.z);
    const auto row = [&](int j, int k) { return mix(hash(x, y + j, z + k), hash(x + 1, y + j, z + k), u); };
    return 2 * mix(mix(row(0, 0), row(1, 0), v), mix(row(0, 1), row(1, 1), v), w) - 1;
}

struct Region {
    double wing, belly, face, foot, lid, gum;
};

Region region(Vec p, Vec n) {
    const auto d = kForm.parts(p);
    Vec q = toHead(p);
    const double side = std::abs(q.x);
    q.x = side;
    Region r{};
    const double head = smoothstep(15.5, 17, p.y + 0.25 * p.z);
    r.wing = smoothstep(-3.2, -4.4, p.z) * smoothstep(2.6, 4.2, std::abs(p.x)) *
             smoothstep(6.0, 7.0, p.y + 0.12 * p.z) * (d[kWing] < 0.2);
    const double chest = smoothstep(2.9, 2.2, std::abs(p.x) * (1 + 0.05 * (p.y - 9))) * smoothstep(0.0, 0.35, n.z) *
                         smoothstep(-0.5, 1.5, p.z);
    r.belly = chest * smoothstep(2.2, 3.2, p.y) * (1 - smoothstep(14.4, 15.4, p.y - 0.3 * (p.z - 3)));
    r.face = head * smoothstep(2.5, 5.5, q.z);
    r.foot = smoothstep(3.2, 1.8, p.y) * smoothstep(3.0, 4.5, p.z) * smoothstep(9.2, 8.6, std::abs(p.x));
    const double eye = length(q - kEye);
    r.lid = smoothstep(3.4, 2.2, eye) * head;
    r.gum = head * smoothstep(0.30, 0.08, std::abs(d[kJaw] - d[kSkin])) * smoothstep(0.5, 2, q.z);
    return r;
}

double scaleRadius(Vec p, Vec n) {
    const Region r = region(p, n);
    double size = 0.50 + 0.10 * noise(p * 0.35);
    size = mix(size, 0.62, smoothstep(-0.2, 0.5, n.y - n.z) * smoothstep(-1.0, -4.0, p.z));
    size = mix(size, 0.34, r.face);
    size = mix(size, 0.36, r.foot);
    size = mix(size, 0.24, r.lid);
    return mix(size, 0.30, r.wing);
}

// The way scales point: from the snout backwards and down, along the tail to its end.
Vec flow(Vec p) {
    const Vec body = unit(Vec{0.12 * p.x, -0.7, -0.8});
    return unit(mix(body, Vec{-0.25, 0, 1}, smoothstep(7.5, 9, p.x) * smoothstep(-7, -3, p.z) * smoothstep(4, 3, p.y)));
}

} // namespace

std::vector<Vec> pointNormals(const Cage& cage) {
    std::vector<Vec> out(cage.points.size());
    for (const Quad& q : cage.faces) {
        const Vec n = cross(cage.points[q[2]] - cage.points[q[0]], cage.points[q[3]] - cage.points[q[1]]);
        for (int p : q) out[p] = out[p] + n;
    }
    for (Vec& n : out) n = unit(n);
    return out;
}

std::array<int, 3> Skin::cell(Vec p) const {
    return {int(std::floor(p.x)), int(std::floor(p.y)), int(std::floor(p.z))};
}

void Skin::add(const Scale& s) {
    grid_[cell(s.at)].push_back(int(scales_.size()));
    scales_.push_back(s);
}

bool Skin::free(const Scale& s) const {
    const auto c = cell(s.at);
    for (int i = 0; i < 27; ++i) {
        const auto found = grid_.find({c[0] + i % 3 - 1, c[1] + i / 3 % 3 - 1, c[2] + i / 9 - 1});
        if (found == grid_.end()) continue;
        for (int k : found->second) {
            const Scale& o = scales_[k];
            const Vec d = o.at - s.at;
            const double reach = 0.5 * (o.radius + s.radius) * 1.25;
            if (dot(o.normal, s.normal) > 0.1 && dot(d, d) < reach * reach) return false;
        }
    }
    return true;
}

Skin::Skin(const Cage& surface) {
    const std::vector<Vec> normals = pointNormals(surface);
    std::mt19937 engine(11);
    std::vector<Scale> darts;
    for (std::size_t f = 0; f < surface.faces.size(); ++f)
        for (int i = 0; i < 2; ++i) {
            const Quad& q = surface.faces[f];
            const double s = engine() / 4294967296.0, t = engine() / 4294967296.0;
            const auto at = [&](const std::vector<Vec>& v) {
                return mix(mix(v[q[0]], v[q[1]], s), mix(v[q[3]], v[q[2]], s), t);
            };
            Scale dart{at(surface.points), unit(at(normals)), 0, engine() / 4294967296.0};
            dart.radius = scaleRadius(dart.at, dart.normal);
            darts.push_back(dart);
        }
    for (std::size_t i = darts.size(); i > 1; --i) std::swap(darts[i - 1], darts[engine() % i]);
    for (const Scale& dart : darts)
        if (free(dart)) add(dart);
}

Skin::Look Skin::look(Vec p, Vec n) const {
    const Vec wobble = Vec{noise(p * 2.1), noise(p * 2.1 + Vec{9, 0, 0}), noise(p * 2.1 + Vec{0, 9, 0})} * 0.05;
    const Vec at = p + wobble;
    double first = 1e9, second = 1e9;
    const Scale* scale = nullptr;
    const auto c = cell(at);
    for (int i = 0; i < 27; ++i) {
        const auto found = grid_.find({c[0] + i % 3 - 1, c[1] + i / 3 % 3 - 1, c[2] + i / 9 - 1});
        if (found == grid_.end()) continue;
        for (int k : found->second) {
            const Scale& s = scales_[k];
            const double d = length(s.at - at) / s.radius * (1 + 1.5 * (1 - dot(n, s.normal)));
            if (d < first)
                second = first, first = d, scale = &s;
            else if (d < second)
                second = d;
        }
    }
    if (!scale) return {};
    const Region r = region(p, n);
    const double top = smoothstep(0.0, 0.5, second - first);
    const double tilt = dot(at - scale->at, flow(p)) / scale->radius;
    Look out;
    out.tint = scale->tint;
    out.depth = top;
    double size = 0.30 * scale->radius * mix(1.0, 0.75, r.face) * (0.8 + 0.4 * scale->tint);
    double scales = size * (top * (0.75 + 0.45 * tilt) - 0.45) + 0.008 * noise(p * 9);
    // Plates across the belly, each over the next one below.
    const double row = (p.y + 0.10 * p.x * p.x * 0.6 + 0.15 * p.z + 0.04 * noise(p * 0.7)) / 0.95,
                 step = row - std::floor(row);
    const double plate = 0.17 * (smoothstep(0, 0.16, step) * (1 - 0.75 * step) - 0.35) + 0.008 * noise(p * 6);
    // The wing is thin leather with fine wrinkles.
    const double leather = 0.05 * (top - 0.5) * 0.6 + 0.02 * noise(p * 3.3);
    Vec q = toHead(p);
    q.x = std::abs(q.x);
    const double folds = 0.07 * std::sin(length(q - kEye) * 13) * r.lid;
    double h = mix(scales, plate, r.belly);
    h = mix(h, leather, r.wing);
    h = mix(h, h * 0.6 + folds, r.lid);
    h -= 0.30 * smoothstep(0.75, 0.2, length(q - Vec{1.35, 18.25, 10.05}));
    out.height = mix(h, -0.06, r.gum);
    out.depth = mix(out.depth, smoothstep(0, 0.2, step), r.belly);
    return out;
}

} // namespace dragon
