#include "cameras/lens_train.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>

namespace abbe {

LensTrain::LensTrain(const LensPrescription& lens) {
    ABBE_CHECK(!lens.surfaces.empty());
    std::vector<const Curve*> media{nullptr};
    indices_.assign(kCells + 1, 1.0);
    std::uint32_t before = 0;
    double z = 0;
    for (const LensSurface& s : lens.surfaces) {
        auto medium = static_cast<std::uint32_t>(std::ranges::find(media, s.index) - media.begin());
        if (medium == media.size()) {
            media.push_back(s.index);
            for (int i = 0; i <= kCells; ++i) indices_.push_back(s.index->at(static_cast<double>(kMinWavelength) + i));
            disperses_ = disperses_ || !s.index->isConstant();
        }
        if (s.isStop) stop_ = surfaces_.size();
        surfaces_.push_back({z, s.curvature, s.semiAperture, before, medium, s.isStop});
        before = medium;
        z += s.thickness;
    }
}

double LensTrain::index(std::uint32_t medium, double nm) const {
    const double x = std::clamp(nm - static_cast<double>(kMinWavelength), 0.0, static_cast<double>(kCells));
    const int cell = std::min(static_cast<int>(x), kCells - 1);
    const double* n = &indices_[medium * (kCells + 1) + static_cast<std::size_t>(cell)];
    return n[0] + (x - cell) * (n[1] - n[0]);
}

double LensTrain::edge(const Surface& s) {
    const double h2 = s.semiAperture * s.semiAperture, c = s.curvature;
    return s.z + c * h2 / (1 + std::sqrt(std::max(0.0, 1 - c * c * h2)));
}

// One surface, by the intersection nearest to its vertex and Snell's law as a vector [Welford1986, ch. 4]: `ratio` is
// the index in front of the surface over that behind it, along the ray, and `forward` the sign of the ray's dz.
bool LensTrain::cross(const Surface& s, LensRay& ray, double ratio, double forward,
                      const Aperture& opening) const noexcept {
    const double c = s.curvature;
    const Vec3d o{ray.p.x, ray.p.y, ray.p.z - s.z};
    const double f = ray.d.z - c * dot(ray.d, o);
    const double g = c * dot(o, o) - 2 * o.z;
    const double root = f * f - c * g;
    if (!(root >= 0)) return false;
    const double cosine = forward * std::sqrt(root); // of the ray and the normal, which points to +z
    const double t = g / (f + cosine);
    // The stop may lie within the hollow of its neighbour; glass that a ray would have to go back to is beyond a rim.
    if (!(t >= -1e-9 || s.isStop)) return false;
    const Vec3d hit{o.x + t * ray.d.x, o.y + t * ray.d.y, o.z + t * ray.d.z};
    ray.p = {hit.x, hit.y, hit.z + s.z};
    if (s.isStop) return opening.contains({hit.x, hit.y});
    if (!(hit.x * hit.x + hit.y * hit.y <= s.semiAperture * s.semiAperture)) return false;
    if (ratio == 1) return true;
    const double transmitted = 1 - ratio * ratio * (1 - root);
    if (!(transmitted > 0)) return false;
    const double bend = forward * std::sqrt(transmitted) - ratio * cosine;
    const Vec3d normal{-c * hit.x, -c * hit.y, 1 - c * hit.z};
    ray.d = normalize(ray.d * ratio + normal * bend);
    return true;
}

bool LensTrain::toScene(LensRay& ray, double nm, const Aperture& opening) const noexcept {
    if (!(ray.d.z < 0)) return false;
    double n = 1;
    for (std::size_t i = surfaces_.size(); i-- > 0;) {
        const Surface& s = surfaces_[i];
        const double next = s.before == 0 ? 1 : index(s.before, nm);
        if (!cross(s, ray, n / next, -1, opening) || !(ray.d.z < 0)) return false;
        n = next;
    }
    return true;
}

bool LensTrain::toFilm(LensRay& ray, double nm, const Aperture& opening, Vec3d* entry) const noexcept {
    if (!(ray.d.z > 0)) return false;
    double n = 1;
    for (const Surface& s : surfaces_) {
        const double next = s.behind == 0 ? 1 : index(s.behind, nm);
        if (!cross(s, ray, n / next, 1, opening) || !(ray.d.z > 0)) return false;
        if (entry && &s == &surfaces_.front()) *entry = ray.p;
        n = next;
    }
    return true;
}

LensTrain::Matrix LensTrain::matrix(std::size_t count, double nm) const {
    Matrix m;
    for (std::size_t i = 0; i < count; ++i) {
        const Surface& s = surfaces_[i];
        const double way = i > 0 ? s.z - surfaces_[i - 1].z : s.z;
        m.a += way * m.c;
        m.b += way * m.d;
        // n' u' = n u - y c (n' - n)
        const double n = index(s.before, nm), next = index(s.behind, nm), power = s.curvature * (next - n);
        m.c = (n * m.c - power * m.a) / next;
        m.d = (n * m.d - power * m.b) / next;
    }
    return m;
}

CardinalPoints LensTrain::cardinalPoints(double nm) const {
    const Matrix m = matrix(surfaces_.size(), nm);
    const double f = -1 / m.c, last = length();
    CardinalPoints p;
    p.focalLength = f;
    p.rearFocus = last - m.a / m.c;
    p.rearPrincipal = p.rearFocus - f;
    p.frontFocus = m.d / m.c;
    p.frontPrincipal = p.frontFocus + f;
    return p;
}

double LensTrain::entrancePupil(double nm) const {
    const Matrix m = matrix(stop_ + 1, nm);
    return m.b / m.a;
}

double LensTrain::entrancePupilScale(double nm) const { return 1 / std::abs(matrix(stop_ + 1, nm).a); }

} // namespace abbe
