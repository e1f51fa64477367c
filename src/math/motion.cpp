#include "math/motion.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix cofactors(const Matrix& m) {
    Matrix c;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
        }
    return c;
}

double determinant(const Matrix& m, const Matrix& cofactor) {
    return m[0][0] * cofactor[0][0] + m[0][1] * cofactor[0][1] + m[0][2] * cofactor[0][2];
}

double frobenius(const Matrix& m) {
    double sum = 0;
    for (const auto& row : m)
        for (const double x : row) sum += x * x;
    return std::sqrt(sum);
}

// The orthogonal factor of the polar decomposition by Newton's iteration Q ← (γ Q + Q^-T / γ) / 2 with Higham's
// scaling γ [Higham1986]; quadratic convergence, so the loop ends after a dozen steps whatever the scales are.
Matrix orthogonalFactor(Matrix q) {
    for (int step = 0; step < 100; ++step) {
        const Matrix c = cofactors(q);
        const double inverse = 1 / determinant(q, c); // Q^-T = cofactors / det
        const double gamma = std::sqrt(frobenius(c) * std::abs(inverse) / frobenius(q));
        double change = 0;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                const double next = 0.5 * (gamma * q[i][j] + c[i][j] * inverse / gamma);
                change = std::max(change, std::abs(next - q[i][j]));
                q[i][j] = next;
            }
        if (change < 1e-15) break;
    }
    return q;
}

// From a proper rotation, by the largest of the four components, which is never small [Shepperd1978].
Quaternion toQuaternion(const Matrix& r) {
    const double trace = r[0][0] + r[1][1] + r[2][2];
    const std::array<double, 4> squares{trace, r[0][0], r[1][1], r[2][2]};
    const auto largest = static_cast<std::size_t>(std::max_element(squares.begin(), squares.end()) - squares.begin());
    if (largest == 0) {
        const double w = 0.5 * std::sqrt(1 + trace), f = 0.25 / w;
        return {w, {(r[2][1] - r[1][2]) * f, (r[0][2] - r[2][0]) * f, (r[1][0] - r[0][1]) * f}};
    }
    const std::size_t i = largest - 1, j = (i + 1) % 3, k = (i + 2) % 3;
    std::array<double, 3> v;
    v[i] = 0.5 * std::sqrt(std::max(0.0, 1 + r[i][i] - r[j][j] - r[k][k]));
    const double f = 0.25 / v[i];
    v[j] = (r[j][i] + r[i][j]) * f;
    v[k] = (r[k][i] + r[i][k]) * f;
    return {(r[k][j] - r[j][k]) * f, {v[0], v[1], v[2]}};
}

Matrix toMatrix(const Quaternion& q) {
    const double w = q.w, x = q.v.x, y = q.v.y, z = q.v.z;
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

Quaternion mix(const Quaternion& a, const Quaternion& b, double weightA, double weightB) {
    const Quaternion q{a.w * weightA + b.w * weightB, a.v * weightA + b.v * weightB};
    const double l = std::sqrt(q.w * q.w + lengthSquared(q.v));
    return {q.w / l, q.v / l};
}

Quaternion slerp(const Quaternion& a, Quaternion b, double u) {
    double cosine = a.w * b.w + dot(a.v, b.v);
    if (cosine < 0) { // the same rotation, the nearer of its two quaternions
        b = {-b.w, -b.v};
        cosine = -cosine;
    }
    // The angle from its sine: arccos loses half the digits of small ones.
    const Vec3d dv = b.v - a.v;
    const double angle = 2 * std::asin(std::min(1.0, 0.5 * std::sqrt(square(b.w - a.w) + lengthSquared(dv))));
    const double sine = std::sin(angle);
    if (!(sine > 1e-12)) return mix(a, b, 1 - u, u);
    return mix(a, b, std::sin((1 - u) * angle) / sine, std::sin(u * angle) / sine);
}

} // namespace

Decomposition Decomposition::of(const Transform& t) {
    Matrix a;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) a[i][j] = t.a[i][j];
    Matrix q = orthogonalFactor(a);
    if (determinant(q, cofactors(q)) < 0)
        for (auto& row : q)
            for (double& x : row) x = -x;
    Decomposition d{t.t, toQuaternion(q), {}};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            const auto product = [&](std::size_t r, std::size_t c) {
                return q[0][r] * a[0][c] + q[1][r] * a[1][c] + q[2][r] * a[2][c];
            };
            d.stretch[i][j] = 0.5 * (product(i, j) + product(j, i)); // Q^T A, symmetric but for rounding
        }
    return d;
}

Transform Decomposition::compose() const {
    const Matrix r = toMatrix(rotation);
    Transform t;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            t.a[i][j] = r[i][0] * stretch[0][j] + r[i][1] * stretch[1][j] + r[i][2] * stretch[2][j];
    t.t = translation;
    return t;
}

Decomposition interpolate(const Decomposition& a, const Decomposition& b, double u) {
    Decomposition d{a.translation * (1 - u) + b.translation * u, slerp(a.rotation, b.rotation, u), {}};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) d.stretch[i][j] = a.stretch[i][j] * (1 - u) + b.stretch[i][j] * u;
    return d;
}

namespace {

Transform compose(const std::vector<TransformStep>& steps) {
    Transform result;
    for (const TransformStep& step : steps) result = result.then(step.transform());
    return result;
}

bool equal(const Transform& a, const Transform& b) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (a.a[i][j] != b.a[i][j]) return false;
    return a.t == b.t;
}

bool alike(const TransformStep& a, const TransformStep& b) {
    if (a.kind != b.kind) return false;
    if (a.kind == TransformStep::Kind::rotate) return a.vector == b.vector;
    if (a.kind == TransformStep::Kind::matrix) return equal(a.matrix, b.matrix);
    // A scale that changes sign would pass through 0, where nothing is left to see.
    if (a.kind == TransformStep::Kind::scale)
        return a.vector.x * b.vector.x > 0 && a.vector.y * b.vector.y > 0 && a.vector.z * b.vector.z > 0;
    return true;
}

// Requires alike steps.
bool same(const TransformStep& a, const TransformStep& b) {
    return a.angle == b.angle && (a.kind == TransformStep::Kind::rotate || a.vector == b.vector);
}

TransformStep mix(const TransformStep& a, const TransformStep& b, double u) {
    TransformStep step = a;
    if (a.kind != TransformStep::Kind::rotate) step.vector = a.vector * (1 - u) + b.vector * u;
    step.angle = a.angle * (1 - u) + b.angle * u;
    return step;
}

} // namespace

Transform TransformStep::transform() const {
    switch (kind) {
    case Kind::translate:
        return Transform::translate(vector);
    case Kind::rotate:
        return Transform::rotate(vector, angle);
    case Kind::scale:
        return Transform::scale(vector);
    case Kind::matrix:
        return matrix;
    }
    return {};
}

KeyedTransform::KeyedTransform(std::vector<Key> keys) : keys_(std::move(keys)) {
    for (std::size_t i = 0; i + 1 < keys_.size(); ++i) {
        const Key &a = keys_[i], &b = keys_[i + 1];
        ABBE_CHECK(a.time < b.time);
        const bool similar =
            a.steps.size() == b.steps.size() && std::equal(a.steps.begin(), a.steps.end(), b.steps.begin(), alike);
        auto& pair = apart_.emplace_back();
        if (!similar) pair = {Decomposition::of(compose(a.steps)), Decomposition::of(compose(b.steps))};
    }
    for (std::size_t i = 0; i + 1 < keys_.size(); ++i)
        if (changesAfter(i)) return;
    if (keys_.empty()) return;
    keys_.resize(1);
    apart_.clear();
}

bool KeyedTransform::changesAfter(std::size_t key) const {
    const auto &a = keys_[key].steps, &b = keys_[key + 1].steps;
    if (apart_[key]) return !equal(compose(a), compose(b));
    return !std::equal(a.begin(), a.end(), b.begin(), same);
}

bool KeyedTransform::movesDuring(double from, double to) const {
    for (std::size_t i = 0; i + 1 < keys_.size(); ++i)
        if (std::max(keys_[i].time, from) < std::min(keys_[i + 1].time, to) && changesAfter(i)) return true;
    return false;
}

Transform KeyedTransform::at(double time) const {
    if (keys_.empty()) return {};
    const auto after =
        std::upper_bound(keys_.begin(), keys_.end(), time, [](double t, const Key& key) { return t < key.time; });
    if (after == keys_.begin()) return compose(keys_.front().steps);
    if (after == keys_.end()) return compose(keys_.back().steps);
    const Key &a = *(after - 1), &b = *after;
    const double u = (time - a.time) / (b.time - a.time);
    if (const auto& pair = apart_[static_cast<std::size_t>(after - keys_.begin()) - 1])
        return interpolate((*pair)[0], (*pair)[1], u).compose();
    Transform result;
    for (std::size_t i = 0; i < a.steps.size(); ++i) result = result.then(mix(a.steps[i], b.steps[i], u).transform());
    return result;
}

Motion Motion::then(const KeyedTransform& next) const {
    if (!next.moves()) return then(next.at(0));
    Motion result = *this;
    result.links_.push_back({result.outer_, next});
    result.outer_ = {};
    return result;
}

Motion Motion::then(const Transform& next) const {
    Motion result = *this;
    result.outer_ = outer_.then(next);
    return result;
}

Motion Motion::then(const Motion& next) const {
    Motion result = *this;
    for (const Link& link : next.links_) result = result.then(link.before).then(link.keyed);
    return result.then(next.outer_);
}

Transform Motion::at(double time) const {
    Transform result;
    for (const Link& link : links_) result = result.then(link.before).then(link.keyed.at(time));
    return result.then(outer_);
}

namespace {

// Of the distance between two steps: below the resolution of positions in float.
constexpr double kOnGrid = 1e-7;

KeyPosition snapped(KeyPosition p) {
    if (p.fraction < kOnGrid) return {p.key, 0};
    if (p.fraction > 1 - kOnGrid) return {p.key + 1, 0};
    return p;
}

bool onGrid(const std::vector<double>& positions, double parts) {
    return std::ranges::all_of(positions,
                               [&](double x) { return std::abs(x * parts - std::round(x * parts)) < kOnGrid; });
}

} // namespace

KeyPosition keyPosition(std::span<const double> times, double time) {
    ABBE_CHECK(!times.empty());
    if (time <= times.front()) return {0, 0};
    if (time >= times.back()) return {times.size() - 1, 0};
    const auto next = static_cast<std::size_t>(std::ranges::upper_bound(times, time) - times.begin());
    return {next - 1, (time - times[next - 1]) / (times[next] - times[next - 1])};
}

KeyGrid makeKeyGrid(std::span<const double> times, Interval interval, std::size_t maxSteps) {
    ABBE_CHECK(maxSteps >= 2 && interval.duration >= 0);
    KeyGrid grid;
    std::vector<std::size_t> inside;
    std::vector<double> positions; // of these, in the interval
    for (std::size_t i = 0; i < times.size(); ++i) {
        const double x = (times[i] - interval.open) / interval.duration; // not finite for a duration of 0
        if (!(x > 0 && x < 1)) continue;
        inside.push_back(i);
        positions.push_back(x);
    }
    const KeyPosition first = snapped(keyPosition(times, interval.open));
    const KeyPosition last = snapped(keyPosition(times, interval.open + interval.duration));
    if (first == last) { // two states of different keys are never the same
        grid.steps.push_back(first);
        return grid;
    }
    std::size_t parts = 1;
    while (parts < maxSteps - 1 && !onGrid(positions, static_cast<double>(parts))) ++parts;
    const auto n = static_cast<double>(parts);
    for (std::size_t i = 0; i <= parts; ++i)
        grid.steps.push_back(
            snapped(keyPosition(times, interval.open + interval.duration * (static_cast<double>(i) / n))));
    if (onGrid(positions, n)) return grid;
    for (std::size_t i = 0; i < inside.size(); ++i) {
        const double at = positions[i] * n, step = std::min(std::floor(at), n - 1);
        if (std::abs(at - std::round(at)) >= kOnGrid)
            grid.offGrid.push_back({inside[i], static_cast<std::size_t>(step), at - step});
    }
    return grid;
}

} // namespace abbe
