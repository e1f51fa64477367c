#include "geometry/few_shapes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <immintrin.h>
#include <limits>
#include <type_traits>

namespace abbe {

namespace {

constexpr std::size_t kWidth = VisibleLanes::kWidth;

} // namespace

// Of eight polygons: barycentric weights of the corners after the first one and before it, linear in the point.
struct alignas(32) FewPolygons::Weights {
    std::array<float, kWidth> ux, uy, uz, u0, vx, vy, vz, v0;

    void set(std::size_t k, Vec3d u, Vec3d v, Vec3d first) {
        const auto single = [](double x) { return static_cast<float>(x); };
        ux[k] = single(u.x), uy[k] = single(u.y), uz[k] = single(u.z), u0[k] = single(-dot(u, first));
        vx[k] = single(v.x), vy[k] = single(v.y), vz[k] = single(v.z), v0[k] = single(-dot(v, first));
    }
};

// Of eight triangles: planes n · p = d of unit normals, weights, and by how much these may be below 0.
struct alignas(32) FewPolygons::Lanes {
    std::array<double, kWidth> nx, ny, nz, d;
    Weights from; // the first corner
    std::array<float, kWidth> slack;
    VisibleLanes visible;
};

// Of eight quads: weights from either end of the diagonal that does not divide them.
struct FewPolygons::QuadLanes : Lanes {
    Weights opposite; // from the third corner
};

// One ray in all lanes.
struct FewPolygons::Rays {
    __m256 ox, oy, oz, dx, dy, dz, tMax;
    __m256d wideOx, wideOy, wideOz, wideDx, wideDy, wideDz;
    std::size_t row; // VisibleLanes::row() of its kind

    explicit Rays(const Ray& r)
        : ox(_mm256_set1_ps(r.origin.x)), oy(_mm256_set1_ps(r.origin.y)), oz(_mm256_set1_ps(r.origin.z)),
          dx(_mm256_set1_ps(r.direction.x)), dy(_mm256_set1_ps(r.direction.y)), dz(_mm256_set1_ps(r.direction.z)),
          tMax(_mm256_set1_ps(r.tMax)), wideOx(wide(r.origin.x)), wideOy(wide(r.origin.y)), wideOz(wide(r.origin.z)),
          wideDx(wide(r.direction.x)), wideDy(wide(r.direction.y)), wideDz(wide(r.direction.z)),
          row(VisibleLanes::row(r.kind)) {}

    static __m256d wide(float x) { return _mm256_set1_pd(static_cast<double>(x)); }
};

struct FewPolygons::Found {
    __m256 hit; // all bits or none
    __m256 t, u, v;
};

namespace {

// Of four planes: the way to them along their normals, and how much of it a step along the ray is.
struct ToPlanes {
    __m128 way, step;
};

} // namespace

template <typename OneLanes>
[[gnu::always_inline]] inline FewPolygons::Found FewPolygons::test(const OneLanes& l, const Rays& r) noexcept {
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
    const auto along = [&](const auto& a, const auto& b, const auto& c, const auto& start) {
        return _mm256_fmadd_ps(
            _mm256_load_ps(c.data()), z,
            _mm256_fmadd_ps(_mm256_load_ps(b.data()), y,
                            _mm256_fmadd_ps(_mm256_load_ps(a.data()), x, _mm256_load_ps(start.data()))));
    };
    const __m256 u0 = along(l.from.ux, l.from.uy, l.from.uz, l.from.u0),
                 v0 = along(l.from.vx, l.from.vy, l.from.vz, l.from.v0), slack = _mm256_load_ps(l.slack.data());
    const auto within = [&](__m256 w) { return _mm256_cmp_ps(w, slack, _CMP_GE_OQ); };
    // Along a plane weights are infinite or not numbers. No direction leads away from a quad within all four edges, so
    // that one of them is not within.
    __m256 inside, u = u0, v = v0;
    const __m256 one = _mm256_set1_ps(1), third = _mm256_sub_ps(_mm256_sub_ps(one, u0), v0);
    if constexpr (std::is_same_v<OneLanes, QuadLanes>) {
        const __m256 u1 = along(l.opposite.ux, l.opposite.uy, l.opposite.uz, l.opposite.u0),
                     v1 = along(l.opposite.vx, l.opposite.vy, l.opposite.vz, l.opposite.v0);
        inside = _mm256_and_ps(_mm256_and_ps(within(u0), within(v0)), _mm256_and_ps(within(u1), within(v1)));
        u = _mm256_blendv_ps(u0, _mm256_sub_ps(one, u1), third); // by the sign: beyond the diagonal
        v = _mm256_blendv_ps(v0, _mm256_sub_ps(one, v1), third);
    } else {
        // The third weight is then -infinity or not a number, and so is the least, as the minimum of two is the second
        // where either is none.
        inside = within(_mm256_min_ps(u0, _mm256_min_ps(v0, third)));
    }
    const __m256 ahead =
        _mm256_and_ps(_mm256_cmp_ps(t, _mm256_setzero_ps(), _CMP_GT_OQ), _mm256_cmp_ps(t, r.tMax, _CMP_LE_OQ));
    const __m256 visible = _mm256_load_ps(l.visible.masks(r.row));
    return {_mm256_and_ps(_mm256_and_ps(inside, ahead), visible), t, u, v};
}

std::optional<FewPolygons::Hit> FewPolygons::intersect(const Ray& ray) const noexcept {
    Rays rays(ray); // tMax: the nearest so far
    __m256 u = _mm256_setzero_ps(), v = u;
    __m256i nearest = _mm256_set1_epi32(-1), here = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7); // numbers of lanes
    const auto meet = [&](const auto& all) {
        for (const auto& lanes : all) {
            const Found f = test(lanes, rays);
            rays.tMax = _mm256_blendv_ps(rays.tMax, f.t, f.hit);
            u = _mm256_blendv_ps(u, f.u, f.hit);
            v = _mm256_blendv_ps(v, f.v, f.hit);
            nearest = _mm256_blendv_epi8(nearest, here, _mm256_castps_si256(f.hit));
            here = _mm256_add_epi32(here, _mm256_set1_epi32(kWidth));
        }
    };
    meet(quads_);
    meet(triangles_);
    const __m256 none = _mm256_castsi256_ps(nearest); // by the sign bits
    if (_mm256_movemask_ps(none) == 0xff) return std::nullopt;
    // Lanes without a hit still have the ray's end, which is none of theirs.
    const __m256 t = _mm256_blendv_ps(rays.tMax, _mm256_set1_ps(std::numeric_limits<float>::infinity()), none);
    __m256 least = _mm256_min_ps(t, _mm256_permute2f128_ps(t, t, 1));
    least = _mm256_min_ps(least, _mm256_permute_ps(least, 0b01001110));
    least = _mm256_min_ps(least, _mm256_permute_ps(least, 0b10110001));
    const __m256 found = _mm256_andnot_ps(none, _mm256_cmp_ps(t, least, _CMP_EQ_OQ));
    const auto lane = static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(_mm256_movemask_ps(found))));
    alignas(32) std::array<float, kWidth> us, vs;
    alignas(32) std::array<std::uint32_t, kWidth> numbers;
    _mm256_store_ps(us.data(), u);
    _mm256_store_ps(vs.data(), v);
    _mm256_store_si256(reinterpret_cast<__m256i*>(numbers.data()), nearest);
    const Owner& owner = owners_[numbers[lane]];
    const float side = owner.secondHalf ? 1.f : 0.f;
    const auto fromFirst = [side](float x) { return std::abs(side - std::clamp(x, 0.f, 1.f)); };
    return Hit{_mm_cvtss_f32(_mm256_castps256_ps128(least)), fromFirst(us[lane]), fromFirst(vs[lane]), owner.record,
               owner.primitive};
}

bool FewPolygons::occluded(const Ray& ray) const noexcept {
    const Rays rays(ray);
    __m256 found = _mm256_setzero_ps();
    for (const QuadLanes& lanes : quads_) found = _mm256_or_ps(found, test(lanes, rays).hit);
    for (const Lanes& lanes : triangles_) found = _mm256_or_ps(found, test(lanes, rays).hit);
    return _mm256_movemask_ps(found) != 0;
}

FewPolygons::~FewPolygons() = default;

namespace {

// Barycentric weights of a triangle's second and third corner are dot(u, p - a) and dot(v, p - a).
struct TrianglePlane {
    Vec3d a, normal, u, v;
    double twice2 = 0; // doubled area, squared

    TrianglePlane(Vec3 first, Vec3 second, Vec3 third) : a(first) {
        const Vec3d e1 = Vec3d(second) - a, e2 = Vec3d(third) - a, n = cross(e1, e2);
        twice2 = lengthSquared(n);
        if (!(twice2 > 0)) return;
        normal = n / std::sqrt(twice2);
        u = cross(e2, n) / twice2;
        v = cross(n, e1) / twice2;
    }
    // By how much weights may be below 0, in a place that was rounded where it lies after a way as long as twice the
    // scene, which reaches so far from the origin.
    double slack(double reach) const {
        constexpr double kRounding = 10 * 0x1p-24;
        const auto size = [](Vec3d w) { return std::abs(w.x) + std::abs(w.y) + std::abs(w.z); };
        return kRounding * (1 + (size(u) + size(v)) * reach);
    }
};

constexpr double kLargestSlack = 1e-3;
constexpr double kLeastArea2 = 1e-30, kMostArea2 = 1e30; // doubled, squared: floats still have its normal

bool isUsable(const TrianglePlane& plane, double reach) {
    return plane.twice2 > kLeastArea2 && plane.twice2 < kMostArea2 && plane.slack(reach) <= kLargestSlack;
}

} // namespace

// Fills lanes one by one.
class FewPolygons::Maker {
  public:
    // `reach`: of the scene from the origin.
    Maker(FewPolygons& result, double reach) : result_(result), reach_(reach) {}

    // False where rounding would show.
    bool add(const Polygon& p) {
        const auto& [a, b, c, d] = p.corners;
        if (!p.quad) return add(p, TrianglePlane(a, b, c), false);
        const TrianglePlane first(a, b, d), second(c, d, b);
        if (!isFlat(p, first, second)) return add(p, first, false) && add(p, second, true);
        QuadLanes& l = at(result_.quads_, quads_);
        const std::size_t k = quads_++ % kWidth;
        fill(l, k, first, std::max(first.slack(reach_), second.slack(reach_)), p);
        l.opposite.set(k, second.u, second.v, second.a);
        quadOwners_.push_back({p.record, p.primitive, false});
        return true;
    }
    void finish() {
        result_.owners_ = std::move(quadOwners_);
        result_.owners_.resize(kWidth * result_.quads_.size());
        result_.owners_.insert(result_.owners_.end(), triangleOwners_.begin(), triangleOwners_.end());
    }

  private:
    // Whether a quad is one plane, so flat that what this leaves out is no error of a place, and convex: its third
    // corner lies beyond the diagonal of the others.
    bool isFlat(const Polygon& p, const TrianglePlane& first, const TrianglePlane& second) const {
        constexpr double kFlat = 0x1p-30;
        const Vec3d c = Vec3d(p.corners[2]) - first.a;
        const double u = dot(first.u, c), v = dot(first.v, c);
        return isUsable(first, reach_) && isUsable(second, reach_) &&
               std::abs(dot(first.normal, c)) <= kFlat * reach_ && u > 0 && v > 0 && u + v > 1;
    }
    bool add(const Polygon& p, const TrianglePlane& plane, bool secondHalf) {
        if (!(plane.twice2 > 0)) return true; // nothing to be hit
        if (!isUsable(plane, reach_)) return false;
        Lanes& l = at(result_.triangles_, triangles_);
        fill(l, triangles_++ % kWidth, plane, plane.slack(reach_), p);
        triangleOwners_.push_back({p.record, p.primitive, secondHalf});
        return true;
    }
    template <typename OneLanes> static OneLanes& at(std::vector<OneLanes>& lanes, std::size_t number) {
        if (number % kWidth == 0) lanes.push_back(OneLanes{}); // nobody sees what is not filled
        return lanes.back();
    }
    static void fill(Lanes& l, std::size_t k, const TrianglePlane& plane, double slack, const Polygon& p) {
        l.nx[k] = plane.normal.x, l.ny[k] = plane.normal.y, l.nz[k] = plane.normal.z,
        l.d[k] = dot(plane.normal, plane.a);
        l.from.set(k, plane.u, plane.v, plane.a);
        l.slack[k] = static_cast<float>(-slack);
        l.visible.set(k, p.visible);
    }

    FewPolygons& result_;
    double reach_;
    std::size_t triangles_ = 0, quads_ = 0; // so far
    std::vector<Owner> quadOwners_, triangleOwners_;
};

std::unique_ptr<const FewPolygons> FewPolygons::make(std::span<const Polygon> polygons) {
    if (polygons.empty() || polygons.size() > kMost) return nullptr;
    double reach = 0;
    for (const Polygon& p : polygons)
        for (std::size_t i = 0; i < (p.quad ? 4u : 3u); ++i)
            reach = std::max(reach, static_cast<double>(maxComponent(abs(p.corners[i]))));
    auto result = std::make_unique<FewPolygons>();
    Maker maker(*result, reach);
    for (const Polygon& p : polygons)
        if (!maker.add(p)) return nullptr;
    maker.finish();
    return result;
}

} // namespace abbe
