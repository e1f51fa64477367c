#include "math/keyed_transform.h"

#include "base/check.h"

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

} // namespace abbe
