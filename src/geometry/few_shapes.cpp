#include "geometry/few_shapes.h"

#include <algorithm>
#include <bit>
#include <immintrin.h>

namespace abbe {

std::unique_ptr<const FewShapes> FewShapes::make(std::span<const FewPolygons::Polygon> polygons,
                                                 std::span<const Own> own) {
    if (own.size() > kMostOwn || (polygons.empty() && own.empty())) return nullptr;
    auto result = std::make_unique<FewShapes>();
    if (!polygons.empty() && !(result->polygons_ = FewPolygons::make(polygons))) return nullptr;
    result->own_.assign(own.begin(), own.end());
    for (std::size_t i = 0; i < own.size(); ++i) {
        const Bounds3 b = own[i].shape->bounds();
        // So that no ray runs in a side of the box and starts there: its way to that side is no number.
        constexpr float kWider = 0x1p-20f;
        const Vec3 margin = (abs(b.lower) + abs(b.upper)) * kWider;
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            result->boxes_.lower[a][i] = b.lower[axis] - margin[axis];
            result->boxes_.upper[a][i] = b.upper[axis] + margin[axis];
        }
        result->boxes_.visible.set(i, own[i].visible);
    }
    return result;
}

// Bits of the own shapes whose boxes the ray meets within tMax: the slab test, whose far end is put off by the rounding
// of both [Ize2013]. Where a ray runs along a side's plane, outside of it, one end is at infinity; nothing is compared
// with what is no number, as the minimum of two is the second where either is none.
unsigned FewShapes::meets(const Ray& ray) const noexcept {
    constexpr float kPutOff = 1 + 3 * 0x1p-23f;
    __m256 near = _mm256_setzero_ps(), far = _mm256_set1_ps(ray.tMax);
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const __m256 origin = _mm256_set1_ps(ray.origin[axis]), inverse = _mm256_set1_ps(1 / ray.direction[axis]);
        const __m256 low = _mm256_mul_ps(_mm256_sub_ps(_mm256_load_ps(boxes_.lower[a].data()), origin), inverse);
        const __m256 high = _mm256_mul_ps(_mm256_sub_ps(_mm256_load_ps(boxes_.upper[a].data()), origin), inverse);
        near = _mm256_max_ps(_mm256_min_ps(low, high), near);
        far = _mm256_min_ps(_mm256_mul_ps(_mm256_max_ps(low, high), _mm256_set1_ps(kPutOff)), far);
    }
    const __m256 visible = _mm256_load_ps(boxes_.visible.masks(VisibleLanes::row(ray.kind)));
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_and_ps(_mm256_cmp_ps(near, far, _CMP_LE_OQ), visible)));
}

std::optional<FewShapes::Hit> FewShapes::intersect(const Ray& ray) const noexcept {
    std::optional<Hit> nearest;
    if (polygons_) nearest = polygons_->intersect(ray);
    if (own_.empty()) return nearest;
    Ray rest = ray;
    if (nearest) rest.tMax = nearest->t;
    for (unsigned met = meets(rest); met != 0; met &= met - 1) {
        const Own& own = own_[static_cast<std::size_t>(std::countr_zero(met))];
        if (const auto hit = own.shape->intersect(rest)) {
            nearest = Hit{hit->distance, hit->u, hit->v, own.record, 0};
            rest.tMax = hit->distance;
        }
    }
    return nearest;
}

bool FewShapes::occluded(const Ray& ray) const noexcept {
    if (polygons_ && polygons_->occluded(ray)) return true;
    if (own_.empty()) return false;
    for (unsigned met = meets(ray); met != 0; met &= met - 1)
        if (own_[static_cast<std::size_t>(std::countr_zero(met))].shape->intersect(ray)) return true;
    return false;
}

bool FewShapesSink::add(const Shape& shape, Visibility visible) {
    shape_ = &shape.primitives();
    visible_ = visible;
    if (fits_) shape_->commit(*this);
    return fits_;
}

void FewShapesSink::triangles(TimeSteps<Vec3> vertices, Triangles indices) { addPolygons(vertices, indices); }
void FewShapesSink::quads(TimeSteps<Vec3> vertices, Quads indices) { addPolygons(vertices, indices); }

template <std::size_t corners>
void FewShapesSink::addPolygons(TimeSteps<Vec3> vertices, std::span<const std::array<std::uint32_t, corners>> indices) {
    const std::size_t left = FewPolygons::kMost - std::min(polygons_.size(), FewPolygons::kMost);
    fits_ = fits_ && vertices.size() == 1 && indices.size() <= left;
    if (!fits_) return;
    for (std::uint32_t i = 0; i < indices.size(); ++i) {
        FewPolygons::Polygon polygon{{}, corners == 4, records_, i, visible_};
        for (std::size_t c = 0; c < corners; ++c) polygon.corners[c] = vertices[0][indices[i][c]];
        polygons_.push_back(polygon);
    }
    ++records_;
}

void FewShapesSink::analytic(const Bounds3&) {
    fits_ = fits_ && own_.size() < FewShapes::kMostOwn;
    if (fits_) own_.push_back({shape_, records_++, visible_});
}

} // namespace abbe
