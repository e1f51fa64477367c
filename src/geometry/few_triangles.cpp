#include "geometry/few_triangles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <immintrin.h>
#include <limits>

namespace abbe {

namespace {

constexpr std::size_t kWidth = 8;
constexpr std::size_t kKinds = 3; // of rays

} // namespace

// Of eight triangles: planes n · p = d of unit normals; barycentric weights of the second corner and of the third,
// linear in the point; by how much these may be below 0; which rays see them, all bits or none.
struct alignas(32) FewTriangles::Lanes {
    std::array<double, kWidth> nx, ny, nz, d;
    std::array<float, kWidth> ux, uy, uz, u0, vx, vy, vz, v0, slack;
    std::array<std::array<std::uint32_t, kWidth>, kKinds> visible;
};

// One ray in all lanes.
struct FewTriangles::Rays {
    __m256 ox, oy, oz, dx, dy, dz, tMax;
    __m256d wideOx, wideOy, wideOz, wideDx, wideDy, wideDz;
    std::size_t kind;

    explicit Rays(const Ray& r)
        : ox(_mm256_set1_ps(r.origin.x)), oy(_mm256_set1_ps(r.origin.y)), oz(_mm256_set1_ps(r.origin.z)),
          dx(_mm256_set1_ps(r.direction.x)), dy(_mm256_set1_ps(r.direction.y)), dz(_mm256_set1_ps(r.direction.z)),
          tMax(_mm256_set1_ps(r.tMax)), wideOx(wide(r.origin.x)), wideOy(wide(r.origin.y)), wideOz(wide(r.origin.z)),
          wideDx(wide(r.direction.x)), wideDy(wide(r.direction.y)), wideDz(wide(r.direction.z)),
          kind(static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(r.kind)))) {}

    static __m256d wide(float x) { return _mm256_set1_pd(static_cast<double>(x)); }
};

struct FewTriangles::Found {
    __m256 hit; // all bits or none
    __m256 t, u, v;
};

namespace {

// Of four planes: the way to them along their normals, and how much of it a step along the ray is.
struct ToPlanes {
    __m128 way, step;
};

} // namespace

[[gnu::always_inline]] inline FewTriangles::Found FewTriangles::test(const Lanes& l, const Rays& r) noexcept {
    const auto planes = [&](std::size_t first) {
        const __m256d x = _mm256_load_pd(&l.nx[first]), y = _mm256_load_pd(&l.ny[first]),
                      z = _mm256_load_pd(&l.nz[first]);
        const __m256d way = _mm256_fnmadd_pd(
            z, r.wideOz, _mm256_fnmadd_pd(y, r.wideOy, _mm256_fnmadd_pd(x, r.wideOx, _mm256_load_pd(&l.d[first]))));
        const __m256d step = _mm256_fmadd_pd(z, r.wideDz, _mm256_fmadd_pd(y, r.wideDy, _mm256_mul_pd(x, r.wideDx)));
        return ToPlanes{_mm256_cvtpd_ps(way), _mm256_cvtpd_ps(step)};
    };
    const ToPlanes low = planes(0), high = planes(4);
    const __m256 t = _mm256_div_ps(_mm256_set_m128(high.way, low.way), _mm256_set_m128(high.step, low.step));
    const __m256 x = _mm256_fmadd_ps(t, r.dx, r.ox), y = _mm256_fmadd_ps(t, r.dy, r.oy),
                 z = _mm256_fmadd_ps(t, r.dz, r.oz);
    const auto weight = [&](const auto& a, const auto& b, const auto& c, const auto& start) {
        return _mm256_fmadd_ps(
            _mm256_load_ps(c.data()), z,
            _mm256_fmadd_ps(_mm256_load_ps(b.data()), y,
                            _mm256_fmadd_ps(_mm256_load_ps(a.data()), x, _mm256_load_ps(start.data()))));
    };
    const __m256 u = weight(l.ux, l.uy, l.uz, l.u0), v = weight(l.vx, l.vy, l.vz, l.v0);
    const __m256 w = _mm256_sub_ps(_mm256_sub_ps(_mm256_set1_ps(1), u), v);
    // Along a plane the weights are infinite or not numbers: w is then -infinity or not a number, and so is the least,
    // as the minimum of two is the second where either is none.
    const __m256 least = _mm256_min_ps(u, _mm256_min_ps(v, w));
    const __m256 inside = _mm256_cmp_ps(least, _mm256_load_ps(l.slack.data()), _CMP_GE_OQ);
    const __m256 ahead =
        _mm256_and_ps(_mm256_cmp_ps(t, _mm256_setzero_ps(), _CMP_GT_OQ), _mm256_cmp_ps(t, r.tMax, _CMP_LE_OQ));
    const __m256 visible = _mm256_load_ps(reinterpret_cast<const float*>(l.visible[r.kind].data()));
    return {_mm256_and_ps(_mm256_and_ps(inside, ahead), visible), t, u, v};
}

std::optional<FewTriangles::Hit> FewTriangles::intersect(const Ray& ray) const noexcept {
    Rays rays(ray); // tMax: the nearest so far
    __m256 u = _mm256_setzero_ps(), v = u, found = u;
    __m256i index = _mm256_setzero_si256(), here = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    for (const Lanes& lanes : lanes_) {
        const Found f = test(lanes, rays);
        rays.tMax = _mm256_blendv_ps(rays.tMax, f.t, f.hit);
        u = _mm256_blendv_ps(u, f.u, f.hit);
        v = _mm256_blendv_ps(v, f.v, f.hit);
        index = _mm256_blendv_epi8(index, here, _mm256_castps_si256(f.hit));
        found = _mm256_or_ps(found, f.hit);
        here = _mm256_add_epi32(here, _mm256_set1_epi32(kWidth));
    }
    if (_mm256_movemask_ps(found) == 0) return std::nullopt;
    // Lanes without a hit still have the ray's end, which is none of theirs.
    const __m256 t = _mm256_blendv_ps(_mm256_set1_ps(std::numeric_limits<float>::infinity()), rays.tMax, found);
    __m256 least = _mm256_min_ps(t, _mm256_permute2f128_ps(t, t, 1));
    least = _mm256_min_ps(least, _mm256_permute_ps(least, 0b01001110));
    least = _mm256_min_ps(least, _mm256_permute_ps(least, 0b10110001));
    const __m256 nearest = _mm256_and_ps(_mm256_cmp_ps(t, least, _CMP_EQ_OQ), found);
    const auto lane = static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(_mm256_movemask_ps(nearest))));
    alignas(32) std::array<float, kWidth> us, vs;
    alignas(32) std::array<std::uint32_t, kWidth> indices;
    _mm256_store_ps(us.data(), u);
    _mm256_store_ps(vs.data(), v);
    _mm256_store_si256(reinterpret_cast<__m256i*>(indices.data()), index);
    const Triangle& triangle = triangles_[indices[lane]];
    const float side = triangle.secondHalf ? 1.f : 0.f;
    const auto weight = [side](float x) { return std::abs(side - std::clamp(x, 0.f, 1.f)); };
    return Hit{_mm_cvtss_f32(_mm256_castps256_ps128(least)), weight(us[lane]), weight(vs[lane]), triangle.record,
               triangle.primitive};
}

bool FewTriangles::occluded(const Ray& ray) const noexcept {
    const Rays rays(ray);
    __m256 found = _mm256_setzero_ps();
    for (const Lanes& lanes : lanes_) found = _mm256_or_ps(found, test(lanes, rays).hit);
    return _mm256_movemask_ps(found) != 0;
}

FewTriangles::~FewTriangles() = default;

std::unique_ptr<const FewTriangles> FewTriangles::make(std::span<const Triangle> triangles) {
    // Of weights, in a place that was rounded where it lies, after a way as long as twice the scene.
    constexpr double kRounding = 10 * 0x1p-24, kLargestSlack = 1e-3;
    constexpr double kLeastArea2 = 1e-30, kMostArea2 = 1e30; // doubled, squared: floats still have its normal
    if (triangles.empty() || triangles.size() > kMost) return nullptr;
    double reach = 0;
    for (const Triangle& t : triangles)
        for (const Vec3 p : t.corners) reach = std::max(reach, static_cast<double>(maxComponent(abs(p))));
    auto result = std::make_unique<FewTriangles>();
    result->triangles_.assign(triangles.begin(), triangles.end());
    result->lanes_.resize((triangles.size() + kWidth - 1) / kWidth, Lanes{}); // nobody sees what is not filled
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        Lanes& l = result->lanes_[i / kWidth];
        const std::size_t k = i % kWidth;
        const Vec3d a(triangles[i].corners[0]), e1 = Vec3d(triangles[i].corners[1]) - a,
                                                e2 = Vec3d(triangles[i].corners[2]) - a;
        const Vec3d normal = cross(e1, e2);
        const double twice2 = lengthSquared(normal);
        if (!(twice2 > 0)) continue; // nothing to be hit
        if (!(twice2 > kLeastArea2 && twice2 < kMostArea2)) return nullptr;
        const Vec3d n = normal / std::sqrt(twice2), u = cross(e2, normal) / twice2, v = cross(normal, e1) / twice2;
        const auto size = [](Vec3d w) { return std::abs(w.x) + std::abs(w.y) + std::abs(w.z); };
        const double slack = kRounding * (1 + (size(u) + size(v)) * reach);
        if (!(slack <= kLargestSlack)) return nullptr;
        l.nx[k] = n.x, l.ny[k] = n.y, l.nz[k] = n.z, l.d[k] = dot(n, a);
        const auto single = [](double x) { return static_cast<float>(x); };
        l.ux[k] = single(u.x), l.uy[k] = single(u.y), l.uz[k] = single(u.z), l.u0[k] = single(-dot(u, a));
        l.vx[k] = single(v.x), l.vy[k] = single(v.y), l.vz[k] = single(v.z), l.v0[k] = single(-dot(v, a));
        l.slack[k] = single(-slack);
        for (std::size_t kind = 0; kind < kKinds; ++kind)
            l.visible[kind][k] = triangles[i].visible.bits() >> kind & 1 ? 0xffffffffu : 0;
    }
    return result;
}

bool FewTrianglesSink::add(const Shape& shape, Visibility visible) {
    visible_ = visible;
    if (fits_) shape.commit(*this);
    return fits_;
}

bool FewTrianglesSink::begin(std::size_t steps, std::size_t count) {
    fits_ = fits_ && steps == 1 && count <= FewTriangles::kMost - std::min(triangles_.size(), FewTriangles::kMost);
    return fits_;
}

void FewTrianglesSink::triangles(TimeSteps<Vec3> vertices, Triangles indices) {
    if (!begin(vertices.size(), indices.size())) return;
    const auto p = vertices[0];
    for (std::uint32_t i = 0; i < indices.size(); ++i)
        triangles_.push_back({{p[indices[i][0]], p[indices[i][1]], p[indices[i][2]]}, records_, i, false, visible_});
    ++records_;
}

// Split as Embree splits them.
void FewTrianglesSink::quads(TimeSteps<Vec3> vertices, Quads indices) {
    if (!begin(vertices.size(), 2 * indices.size())) return;
    const auto p = vertices[0];
    for (std::uint32_t i = 0; i < indices.size(); ++i) {
        const auto& [a, b, c, d] = indices[i];
        triangles_.push_back({{p[a], p[b], p[d]}, records_, i, false, visible_});
        triangles_.push_back({{p[c], p[d], p[b]}, records_, i, true, visible_});
    }
    ++records_;
}

} // namespace abbe
