#include "math/keyed_transform.h"

#include "base/check.h"
#include "math/decomposition.h"

#include <algorithm>

namespace abbe {

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
    for (std::size_t i = 1; i < keys_.size(); ++i) ABBE_CHECK(keys_[i - 1].time < keys_[i].time);
}

Transform KeyedTransform::at(double time) const {
    if (keys_.empty()) return {};
    const auto after = std::find_if(keys_.begin(), keys_.end(), [&](const Key& k) { return k.time > time; });
    if (after == keys_.begin()) return compose(keys_.front().steps);
    if (after == keys_.end()) return compose(keys_.back().steps);
    const Key &a = *(after - 1), &b = *after;
    const double u = (time - a.time) / (b.time - a.time);
    const bool same =
        a.steps.size() == b.steps.size() && std::equal(a.steps.begin(), a.steps.end(), b.steps.begin(),
                                                       [](const auto& x, const auto& y) { return alike(x, y); });
    if (!same)
        return interpolate(Decomposition::of(compose(a.steps)), Decomposition::of(compose(b.steps)), u).compose();
    std::vector<TransformStep> steps(a.steps.size());
    std::transform(a.steps.begin(), a.steps.end(), b.steps.begin(), steps.begin(),
                   [u](const TransformStep& x, const TransformStep& y) { return mix(x, y, u); });
    return compose(steps);
}

} // namespace abbe
