#include "light_sampling/light_sampler.h"

#include "math/hash.h"

#include <algorithm>
#include <bit>

namespace abbe {

namespace {

// Digits below those of a number from a sampler, which has 24 bits: lights less likely than that must not be lost. Any
// function of the place will do that has nothing to do with the lights.
double refined(float u, Vec3 p) {
    std::uint64_t bits =
        mix64(std::uint64_t{std::bit_cast<std::uint32_t>(u)} << 32 | std::bit_cast<std::uint32_t>(p.x));
    bits = mix64(bits ^ (std::uint64_t{std::bit_cast<std::uint32_t>(p.y)} << 32 | std::bit_cast<std::uint32_t>(p.z)));
    return static_cast<double>(u) + static_cast<double>(bits >> 36) * 0x1p-52;
}

bool hasPlace(const LightBounds& b) {
    return !b.box.empty() && isFinite(b.box.lower) && isFinite(b.box.upper) && b.power < kInfinity;
}

// Of a light's power that a part has; all of them alike where parts have no place.
double shareOf(const Light& light, const std::optional<LightBounds>& part) {
    const double whole = light.visiblePower();
    if (part && whole > 0) return static_cast<double>(part->power) / whole;
    return 1.0 / light.parts();
}

// Or dark.
bool isLeftToScattering(const std::unique_ptr<const Light>& light) {
    const LightOutput output = light->output();
    return !(output.power > 0) || (output.even && !light->neverHit());
}

} // namespace

LightSampler::LightSampler(const std::vector<std::unique_ptr<const Light>>& lights, Technique::LightChoice choice,
                           const StopFlag& stop, bool leavesEven) {
    using enum Technique::LightChoice;
    std::vector<LightBounds> near;
    std::vector<Source> far;
    std::vector<double> farAmounts;
    leavesEven = leavesEven && choice == tree && !std::ranges::all_of(lights, isLeftToScattering);
    for (const auto& light : lights) {
        if (light->infinite()) infinite_.push_back(light->asDistant());
        if (leavesEven && isLeftToScattering(light)) continue;
        for (std::uint32_t part = 0; part < light->parts(); ++part) {
            const std::optional<LightBounds> bounds = light->bounds(part);
            const bool isNear = bounds && hasPlace(*bounds);
            placed_ |= isNear;
            const double amount = isNear ? static_cast<double>(bounds->power) : light->irradiance();
            if (isNear && choice == tree && amount > 0) {
                near.push_back(*bounds);
                lights_.push_back({light.get(), part});
            } else if (light->power() > 0 && (!isNear || amount > 0)) {
                far.push_back({light.get(), part});
                farAmounts.push_back(choice == tree    ? amount
                                     : choice == power ? light->power() * shareOf(*light, bounds)
                                                       : 1);
            }
        }
    }
    near_ = static_cast<std::uint32_t>(near.size());
    if (near_ > 0) tree_.emplace(near, stop);
    lights_.insert(lights_.end(), far.begin(), far.end());
    weighFar(farAmounts);
    farInSight_ = choice == tree && !far.empty() && far.size() <= kMostWeighed;
    number(lights);
}

// Half by amount and half evenly: amounts alone would starve a dim light near the camera when a bright sky is outside
// the room.
void LightSampler::weighFar(const std::vector<double>& amounts) {
    double total = 0, sum = 0;
    for (const double a : amounts) total += a;
    farIrradiance_ = static_cast<float>(total);
    const double count = static_cast<double>(amounts.size());
    for (const double a : amounts) {
        const double p = 0.5 * (total > 0 ? a / total : 1 / count) + 0.5 / count;
        sum += p;
        farCumulative_.push_back(sum);
        farProbability_.push_back(static_cast<float>(p));
        farAmount_.push_back(static_cast<float>(a));
    }
}

// Where to find a part of a light again.
void LightSampler::number(const std::vector<std::unique_ptr<const Light>>& lights) {
    std::uint32_t count = 0;
    for (const auto& light : lights) {
        offsets_[light.get()] = {count, light->parts()};
        if (light->emission()) emitters_[light->emission()] = light.get();
        count += light->parts();
    }
    places_.assign(count, kNone);
    for (std::uint32_t i = 0; i < lights_.size(); ++i)
        places_[offsets_.at(lights_[i].light).first + lights_[i].part] = i;
}

std::uint32_t LightSampler::find(const Light* light, std::uint32_t part) const noexcept {
    const auto found = offsets_.find(light);
    if (found == offsets_.end() || !(part < found->second.count)) return kNone;
    return places_[found->second.first + part];
}

bool LightSampler::hasGroups() const {
    const std::size_t far = farInSight_ ? farAmount_.size() : 0;
    return far + (tree_ ? tree_->branches() : 0) > 1;
}

std::optional<std::size_t> LightSampler::groupOf(const Light* light, std::uint32_t part) const noexcept {
    const std::uint32_t i = find(light, part);
    if (i == kNone) return std::nullopt;
    if (i < near_) return tree_->branchOf(i);
    if (!farInSight_) return std::nullopt;
    return LightArrival::kBranches + i - near_;
}

// Of the picks, to lights in the tree.
float LightSampler::nearShare(const Receiver& at, const float* arrives) const noexcept {
    if (near_ == lights_.size()) return 1;
    if (near_ == 0) return 0;
    const float near = tree_->irradiance(at, arrives);
    const float all = near + farIrradiance(at, arrives);
    return all > 0 ? std::clamp(near / all, kLeastShare, 1 - kLeastShare) : 0.5f;
}

// In a room a sky gives what comes in by the windows.
float LightSampler::farIrradiance(const Receiver& at, const float* arrives) const noexcept {
    if (!farInSight_) return farIrradiance_;
    float sum = 0;
    for (std::size_t i = 0; i < farAmount_.size(); ++i) sum += farAmount_[i] * inSight(i, at, arrives);
    return sum;
}

float LightSampler::inSight(std::size_t i, const Receiver& at, const float* arrives) const noexcept {
    const DistantLight* const distant = lights_[near_ + i].light->asDistant();
    return (distant ? distant->inSight(at) : 1) * (arrives ? arrives[LightArrival::kBranches + i] : 1);
}

// A surface that turns its back on the sun need not ask for it, and in a room the sun lies behind walls unless a window
// shows it.
LightSampler::FarShares LightSampler::farShares(const Receiver& at, const float* arrives) const noexcept {
    // So much of the sky in sight is as good as all of it for the half that is shared evenly: what is seen of it may be
    // the brightest part.
    constexpr float kEnough = 0.1f;
    FarShares shares{}, even{};
    float seen = 0, total = 0;
    const std::size_t count = farAmount_.size();
    for (std::size_t i = 0; i < count; ++i) {
        shares[i] = inSight(i, at, arrives);
        even[i] = std::min(shares[i], kEnough);
        seen += even[i];
        total += shares[i] * farAmount_[i];
    }
    for (std::size_t i = 0; i < count; ++i)
        shares[i] = seen > 0
                        ? 0.5f * (even[i] / seen + (total > 0 ? farAmount_[i] * shares[i] / total : even[i] / seen))
                        : farProbability_[i];
    return shares;
}

PickedLight LightSampler::pickFar(double u, float share, const Receiver& at, const float* arrives) const noexcept {
    if (farInSight_ && farAmount_.size() > 1) {
        const FarShares shares = farShares(at, arrives);
        std::uint32_t last = 0;
        for (std::uint32_t i = 0; i < farAmount_.size(); ++i) {
            if (!(shares[i] > 0)) continue;
            last = i;
            if ((u -= static_cast<double>(shares[i])) < 0) break;
        }
        return picked(near_ + last, share * shares[last]);
    }
    const auto found = std::upper_bound(farCumulative_.begin(), farCumulative_.end() - 1, u * farCumulative_.back());
    const auto i = static_cast<std::uint32_t>(found - farCumulative_.begin());
    return picked(near_ + i, share * farProbability_[i]);
}

PickedLight LightSampler::pick(float u, const Receiver& at, const ScatterView& view,
                               const LightArrival* arrival) const noexcept {
    if (lights_.size() == 1) return picked(0, 1);
    const float* const arrives = arrival ? arrival->at(at) : nullptr;
    const float share = nearShare(at, arrives);
    const auto border = static_cast<double>(share);
    const double x = refined(u, at.p);
    if (!(x < border)) return pickFar((x - border) / (1 - border), 1 - share, at, arrives);
    const LightTree::Pick p = tree_->pick(x / border, at, view, arrives);
    return picked(p.light, share * p.probability);
}

float LightSampler::probabilityOf(std::uint32_t i, const Receiver& at, const ScatterView& view,
                                  const float* arrives) const noexcept {
    if (i == kNone) return 0;
    if (lights_.size() == 1) return 1;
    const float share = nearShare(at, arrives);
    if (i < near_) return share * tree_->probability(i, at, view, arrives);
    const bool choosing = farInSight_ && farAmount_.size() > 1;
    return (1 - share) * (choosing ? farShares(at, arrives)[i - near_] : farProbability_[i - near_]);
}

float LightSampler::probability(const Light* light, std::uint32_t part, const Receiver& at, const ScatterView& view,
                                const LightArrival* arrival) const noexcept {
    // The one light of most scenes, without a search.
    if (lights_.size() == 1 && light == lights_[0].light && part == lights_[0].part) return 1;
    return probabilityOf(find(light, part), at, view, arrival ? arrival->at(at) : nullptr);
}

float LightSampler::probability(const MediumEmission* emission, const Receiver& at, const ScatterView& view,
                                const LightArrival* arrival) const noexcept {
    const auto found = emitters_.find(emission);
    return found != emitters_.end() ? probability(found->second, 0, at, view, arrival) : 0;
}

PickedLight LightSampler::pickAlong(float u, const Ray& ray, RayExtent extent) const noexcept {
    if (near_ == 0 || lights_.size() == 1) return pick(u, ray.origin);
    const LightTree::Pick p = tree_->pick(refined(u, ray.direction), ray, extent);
    return picked(p.light, p.probability);
}

float LightSampler::probabilityAlong(const Light* light, std::uint32_t part, const Ray& ray,
                                     RayExtent extent) const noexcept {
    if (near_ == 0 || lights_.size() == 1) return probability(light, part, ray.origin);
    const std::uint32_t i = find(light, part);
    return i < near_ ? tree_->probability(i, ray, extent) : 0;
}

} // namespace abbe
