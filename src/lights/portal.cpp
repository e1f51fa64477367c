#include "lights/portal.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// No direction through the opening is left out, whatever the table has missed.
constexpr double kFloor = 0.01; // of the mean
constexpr int kPointsPerCell = 3;

double toUnit(double tangent) { return std::atan(tangent) / kPiD + 0.5; }
double toTangent(double unit) { return std::tan(kPiD * (unit - 0.5)); }

// dω over the two angles, each measured in units of π.
double jacobian(double x, double y) {
    const double xx = 1 + x * x, yy = 1 + y * y, r = xx + y * y;
    return kPiD * kPiD * xx * yy / (r * std::sqrt(r));
}

} // namespace

bool Portal::isRectangle(const std::array<Vec3d, 4>& p) {
    constexpr double tolerance = 1e-4;
    const Vec3d x = p[1] - p[0], y = p[3] - p[0];
    const double width = length(x), height = length(y);
    return width > 0 && height > 0 && std::isfinite(width * height) &&
           std::abs(dot(x, y)) <= tolerance * width * height &&
           length(p[2] - (p[0] + x + y)) <= tolerance * std::min(width, height);
}

Portal::Portal(const std::array<Vec3d, 4>& p, const std::function<double(Vec3)>& luminance, const Portal* alike)
    : halfWidth_(length(p[1] - p[0]) / 2), halfHeight_(length(p[3] - p[0]) / 2) {
    ABBE_CHECK(isRectangle(p));
    const Vec3d x = normalize(p[1] - p[0]), inwards = normalize(cross(x, p[3] - p[0]));
    frame_ = {Vec3(x), Vec3(cross(x, inwards)), Vec3(-inwards)};
    centre_ = Vec3((p[0] + p[2]) * 0.5);
    const auto same = [](Vec3 a, Vec3 b) { return length(a - b) < 1e-4f; }; // a twentieth of a cell
    const bool shared = alike && same(frame_.x, alike->frame_.x) && same(frame_.z, alike->frame_.z);
    table_ = shared ? alike->table_ : std::make_shared<const Table>(tabulate(luminance));
}

Portal::Table Portal::tabulate(const std::function<double(Vec3)>& luminance) const {
    std::vector<double> cells(static_cast<std::size_t>(kSize * kSize));
    double mean = 0;
    constexpr double step = 1.0 / (kSize * kPointsPerCell);
    for (int i = 0; i < kSize * kPointsPerCell; ++i)
        for (int j = 0; j < kSize * kPointsPerCell; ++j) {
            const double a = toTangent((i + 0.5) * step), b = toTangent((j + 0.5) * step);
            const Vec3 w = frame_.toWorld(Vec3(normalize(Vec3d{a, b, 1})));
            const double part = luminance(w) * jacobian(a, b) * square(step);
            cells[static_cast<std::size_t>(i / kPointsPerCell * kSize + j / kPointsPerCell)] += part;
            mean += part / (kSize * kSize);
        }
    if (!(mean > 0)) mean = 1;
    Table table(static_cast<std::size_t>(kSize + 1) * (kSize + 1));
    for (std::size_t i = 0; i < kSize; ++i)
        for (std::size_t j = 0; j < kSize; ++j) {
            const auto entry = [&](std::size_t k, std::size_t l) -> double& { return table[k * (kSize + 1) + l]; };
            entry(i + 1, j + 1) =
                cells[i * kSize + j] + kFloor * mean + entry(i, j + 1) + entry(i + 1, j) - entry(i, j);
        }
    return table;
}

// On an edge between rows of cells.
double Portal::sumBelow(std::size_t row, double b) const noexcept {
    const double y = b * kSize;
    const auto j = std::min(static_cast<std::size_t>(y), static_cast<std::size_t>(kSize - 1));
    return lerp(at(row, j), at(row, j + 1), y - static_cast<double>(j));
}

// Exact for cells of even density: bilinear between the corners.
double Portal::sum(double a, double b) const noexcept {
    const double x = a * kSize;
    const auto i = std::min(static_cast<std::size_t>(x), static_cast<std::size_t>(kSize - 1));
    return lerp(sumBelow(i, b), sumBelow(i + 1, b), x - static_cast<double>(i));
}

double Portal::weight(double a0, double a1, double b0, double b1) const noexcept {
    return sum(a1, b1) - sum(a0, b1) - sum(a1, b0) + sum(a0, b0);
}

std::optional<Portal::View> Portal::view(const Receiver& from) const noexcept {
    const Vec3d d(centre_ - from.p);
    const double z = dot(d, Vec3d(frame_.z)), x = dot(d, Vec3d(frame_.x)), y = dot(d, Vec3d(frame_.y));
    if (!(z > 0)) return std::nullopt;
    View v{toUnit((x - halfWidth_) / z), toUnit((x + halfWidth_) / z), toUnit((y - halfHeight_) / z),
           toUnit((y + halfHeight_) / z), 0};
    if (!(v.a1 - v.a0 > 1e-7 && v.b1 - v.b0 > 1e-7)) return std::nullopt;
    v.weight = weight(v.a0, v.a1, v.b0, v.b1);
    if (!(v.weight > 1e-12 * table_->back())) return std::nullopt;
    return v;
}

bool Portal::behind(const Receiver& from) const noexcept {
    if (!from.oneSided()) return false;
    const float reach = static_cast<float>(halfWidth_) * std::abs(dot(frame_.x, from.n)) +
                        static_cast<float>(halfHeight_) * std::abs(dot(frame_.y, from.n));
    return dot(centre_ - from.p, from.n) + reach <= 0;
}

float Portal::share(Vec3 p) const noexcept {
    const Vec3 d = centre_ - p;
    const float z = dot(d, frame_.z), r2 = lengthSquared(d);
    if (!(z > 0)) return 0;
    const float area = static_cast<float>(4 * halfWidth_ * halfHeight_);
    return std::min(area * z / (2 * kPi * r2 * std::sqrt(r2)), 1.f);
}

bool Portal::crosses(Vec3 p, Vec3 w) const noexcept {
    const Vec3 d = frame_.toLocal(centre_ - p), local = frame_.toLocal(w);
    if (!(local.z > 0 && d.z > 0)) return false;
    const float t = d.z / local.z;
    return std::abs(static_cast<double>(local.x * t - d.x)) <= halfWidth_ &&
           std::abs(static_cast<double>(local.y * t - d.y)) <= halfHeight_;
}

namespace {

// Where `part` of the whole lies: between lower and upper, over which a sum rises from 0 to `whole` and is linear in
// each of `cells` cells; below(i) is its value at the edge i.
template <typename Below> double invert(double lower, double upper, int cells, double whole, double part, Below below) {
    double a = lower, b = upper, fa = 0, fb = whole;
    int first = static_cast<int>(lower * cells) + 1, last = static_cast<int>(std::ceil(upper * cells)) - 1;
    while (first <= last) { // edges of cells within
        const int middle = (first + last) / 2;
        const double f = below(static_cast<std::size_t>(middle));
        if (f <= part) {
            a = static_cast<double>(middle) / cells;
            fa = f;
            first = middle + 1;
        } else {
            b = static_cast<double>(middle) / cells;
            fb = f;
            last = middle - 1;
        }
    }
    return fb > fa ? std::clamp(a + (b - a) * (part - fa) / (fb - fa), a, b) : a;
}

} // namespace

Portal::Sample Portal::sample(const View& v, Vec2 u) const noexcept {
    const auto strip = [&](std::size_t row) { return sumBelow(row, v.b1) - sumBelow(row, v.b0); };
    const double left = sum(v.a0, v.b1) - sum(v.a0, v.b0);
    const double a = invert(v.a0, v.a1, kSize, v.weight, static_cast<double>(u.x) * v.weight,
                            [&](std::size_t edge) { return strip(edge) - left; });
    // Within a row of cells the density does not change with a: its whole width stands for the line at a.
    const std::size_t row = cellOf(a);
    const double lower = sumBelow(row + 1, v.b0) - sumBelow(row, v.b0), all = strip(row + 1) - strip(row);
    const double b = invert(v.b0, v.b1, kSize, all, static_cast<double>(u.y) * all,
                            [&](std::size_t edge) { return at(row + 1, edge) - at(row, edge) - lower; });
    const double x = toTangent(a), y = toTangent(b);
    return {frame_.toWorld(Vec3(normalize(Vec3d{x, y, 1}))), static_cast<float>(density(v, a, b) / jacobian(x, y))};
}

double Portal::density(const View& v, double a, double b) const noexcept {
    const std::size_t i = cellOf(a), j = cellOf(b);
    const double cell = at(i + 1, j + 1) - at(i, j + 1) - at(i + 1, j) + at(i, j);
    return cell * kSize * kSize / v.weight;
}

float Portal::pdf(const View& v, Vec3 w) const noexcept {
    const Vec3d local(frame_.toLocal(w));
    if (!(local.z > 0)) return 0;
    const double x = local.x / local.z, y = local.y / local.z, a = toUnit(x), b = toUnit(y);
    if (!(a >= v.a0 && a <= v.a1 && b >= v.b0 && b <= v.b1)) return 0;
    return static_cast<float>(density(v, a, b) / jacobian(x, y));
}

} // namespace abbe
