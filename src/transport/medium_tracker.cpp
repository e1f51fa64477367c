#include "transport/medium_tracker.h"

#include "base/work.h"

#include <limits>
#include <numbers>

namespace abbe {

namespace {

// After so many lookups a transmittance below kSmall goes on in one case of two, at twice the weight.
constexpr int kRouletteEvery = 16;
constexpr float kSmall = 0.02f;
// Least albedo of a medium that is tracked in two parts, collide().
constexpr float kClear = 0.9f;
// A ray may collide without end where bounds are far above densities: it looks up so often.
constexpr std::uint32_t kLookUpEvery = 1024;

// Products of weights along a ray leave the range of float long before the exponential that compensates them is
// applied. Lanes beyond this give it up, which loses no digit, and note its logarithm.
constexpr float kFactor = 0x1p64f, kLogFactor = 64 * std::numbers::ln2_v<float>;

bool any(Int8 lanes) { return _mm256_movemask_ps(reinterpret_cast<__m256>(lanes)) != 0; }

// Optical lengths of rays without an end: large, but 0 times it is 0.
float finite(double length) { return static_cast<float>(std::min(length, 1e30)); }

// The part of the ray within a box that may be infinite.
RayExtent clip(const Bounds3& box, const Ray& ray, float tMax) {
    RayExtent e{0, tMax};
    for (int a = 0; a < 3; ++a) {
        const float o = ray.origin[a], d = ray.direction[a];
        if (d == 0) {
            if (!(o >= box.lower[a] && o <= box.upper[a])) return {};
            continue;
        }
        const float t0 = (box.lower[a] - o) / d, t1 = (box.upper[a] - o) / d;
        e.tNear = std::max(e.tNear, std::min(t0, t1));
        e.tFar = std::min(e.tFar, std::max(t0, t1));
    }
    return e;
}

} // namespace

MediumTracker::MediumTracker(std::span<const Medium* const> open, const StopFlag& stop)
    : open_(open), stop_(stop), spaces_(open.size() + MediumStack::kMax), glowSpaces_(spaces_.size()) {
    active_.reserve(spaces_.size());
    glows_.reserve(spaces_.size());
}

void MediumTracker::start(const Ray& ray, float tMax, const MediumStack& inside, const Wavelengths& lambda) {
    active_.clear();
    forEach(inside, [&](const Medium& medium) {
        setWork(volumeWork(medium.number));
        MediumWalk* walk = medium.walk(ray, tMax, spaces_[active_.size()]);
        MediumSegment segment;
        if (!walk || !walk->next(segment)) return;
        const Spectrum extinction = medium.extinction().at(lambda), albedo = medium.albedo().at(lambda);
        active_.push_back({&medium, walk, segment, extinction, albedo, extinction[0], 0, 0, 0, false,
                           -maxLane(-albedo) > kClear && !medium.albedoVaries()});
    });
}

// Where the optical length that is left runs out, if it does so within the segment.
void MediumTracker::schedule(Active& a, float from) {
    const float rate = a.segment.maximum * a.hero;
    const float length = a.segment.tFar - from;
    // Written so that an infinite segment at rate 0 makes no NaN.
    a.collides = rate > 0 && a.optical < rate * length;
    if (a.collides) {
        a.next = std::min(from + a.optical / rate, a.segment.tFar);
    } else {
        if (rate > 0) a.optical -= rate * length;
        a.next = a.segment.tFar;
    }
}

bool MediumTracker::advance(Active& a) {
    a.passed += static_cast<double>(a.segment.maximum) * static_cast<double>(a.segment.tFar - a.segment.tNear);
    if (!a.walk->next(a.segment)) return false;
    schedule(a, a.segment.tNear);
    return true;
}

MediumCollision MediumTracker::follow(const Ray& ray, float tMax, const MediumStack& inside, const Wavelengths& lambda,
                                      RandomStream& random, TrackedWeights weights, EmissionListener* listener,
                                      FirstStep step) {
    const WorkScope work(Work::surface);
    start(ray, tMax, inside, lambda);
    givenUp_ = Spectrum(0.f);
    glows_.clear();
    if (listener) startGlows(ray, tMax, inside, random);
    for (Active& a : active_) {
        a.optical = RandomStream::exponentialOf(random.bits() + step.turn) * step.stretch;
        schedule(a, a.segment.tNear);
    }
    for (std::uint32_t missed = 1;;) {
        Active* a = earliest(active_);
        if (Glow* glow = earliest(glows_); glow && (!a || glow->next < a->next)) {
            emit(*glow, lambda, weights, *listener);
            if (!advance(*glow, random)) glow->walk = nullptr;
            continue;
        }
        if (!a) break;
        setWork(volumeWork(a->medium->number));
        const float t = a->next;
        if (!a->collides) {
            if (!advance(*a)) a->walk = nullptr;
            continue;
        }
        if (collide(*a, lambda, random, weights, listener)) {
            shareDistance(t, weights);
            return {a->medium, t};
        }
        if (!anyNonZero(*weights.beta)) return {};
        if (missed++ % kLookUpEvery == 0 && toldToLeave()) break;
        a->optical = random.exponential();
        schedule(*a, t);
    }
    shareDistance(tMax, weights);
    return {};
}

float MediumTracker::reach(const Ray& ray, const MediumStack& inside, const Wavelengths& lambda, RandomStream random,
                           float stretch) {
    if (inside.size() != 1 || !open_.empty() || inside[0]->emission()) return kInfinity;
    MediumWalk* const walk = inside[0]->walk(ray, kInfinity, spaces_[0]);
    MediumSegment all;
    if (!walk || !walk->next(all) || all.tNear > 0 || all.tFar < kInfinity || all.minimum < all.maximum)
        return kInfinity;
    const float rate = all.maximum * inside[0]->extinction().at(lambda)[0];
    return rate > 0 ? random.exponential() * stretch / rate : kInfinity;
}

void MediumTracker::startGlows(const Ray& ray, float tMax, const MediumStack& inside, RandomStream& random) {
    forEach(inside, [&](const Medium& medium) {
        const MediumEmission* emission = medium.emission();
        if (!emission) return;
        EmissionWalk* walk = emission->walk(ray, tMax, glowSpaces_[glows_.size()]);
        if (!walk) return;
        Glow& glow = glows_.emplace_back();
        glow.emission = emission;
        glow.walk = walk;
        if (!advance(glow, random)) glows_.pop_back();
    });
}

bool MediumTracker::advance(Glow& glow, RandomStream& random) {
    if (!glow.walk->next(glow.segment)) return false;
    glow.next = glow.segment.tNear + random.uniform() * (glow.segment.tFar - glow.segment.tNear);
    return true;
}

// One place drawn evenly stands for its segment. Whether the path gets there is what its collisions decided.
void MediumTracker::emit(const Glow& glow, const Wavelengths& lambda, TrackedWeights weights,
                         EmissionListener& listener) const {
    const Spectrum amount = glow.walk->emitted(glow.next, lambda) * (glow.segment.tFar - glow.segment.tNear);
    if (!anyNonZero(amount)) return;
    Spectrum beta = *weights.beta, density = weights.density ? *weights.density : Spectrum(1.f);
    shareDistance(glow.next, {&beta, weights.density ? &density : nullptr});
    listener.emits(*glow.emission, glow.next, amount, beta, density);
}

// A tentative collision: real with the mean probability over the lanes, a symmetric function of the wavelengths that
// leaves their densities alone. True if it scatters.
//
// Where nothing is thinner than a least density the medium is two that collide independently, one of that density
// throughout, whose collisions need no lookup, and the rest [Kutz2017; Novak2018, sec. 5.3]. Not where much is
// absorbed, which the first part would do at collisions alone.
bool MediumTracker::collide(Active& a, const Wavelengths& lambda, RandomStream& random, TrackedWeights weights,
                            EmissionListener* listener) {
    ++counters.collisions;
    ++counters.volumes[volumeRow(a.medium->number)].collisions;
    float bound = a.segment.maximum, density = a.segment.minimum;
    const bool parts = a.parts && density > 0 && density < bound;
    if (parts && random.uniform() * bound < density) {
        bound = density;
    } else {
        density = a.walk->density(a.next);
        note(density, a.segment, *a.medium);
        if (parts) {
            density -= a.segment.minimum;
            bound -= a.segment.minimum;
        }
    }
    // Below 0 where the bound is none, as the density is where it is less than the least. The weight then has a sign
    // and the estimate is unbiased all the same, as long as both events are possible: their probabilities are in
    // proportion to magnitudes [Novak2018, sec. 5.2; Kutz2017].
    const float nothing = bound - density;
    const Spectrum albedo = a.medium->albedoVaries() ? a.walk->albedo(a.next, lambda) : a.albedo;
    if (listener && listener->minds) [[unlikely]]
        listener->absorbs(a.next, mean(Spectrum(1.f) - albedo) * density / bound);
    const Spectrum scattering = albedo * density;
    const Spectrum likely = abs(scattering), kept = likely + Spectrum(std::abs(nothing));
    const float scatters = mean(select(kept.v > 0, likely / kept, Spectrum(0.f)));
    const bool real = random.uniform() < scatters;
    Spectrum factor = real ? scattering * (1 / (bound * scatters))
                           : Spectrum(scatters < 1 ? nothing / (bound * (1 - scatters)) : 0.f);
    if (weights.density) {
        const Spectrum rates = a.extinction * (1 / a.hero);
        factor *= rates;
        *weights.density *= rates;
    }
    *weights.beta *= factor;
    if (weights.density) keepInRange(weights);
    return real;
}

// Rates of collisions at wavelengths that collide 38 times as often as the hero overflow after 25 of them, and those at
// wavelengths that seldom do underflow, though shareDistance() brings both back.
void MediumTracker::keepInRange(TrackedWeights weights) {
    const Spectrum& density = *weights.density;
    const Int8 above = density.v > kFactor, below = (density.v < 1 / kFactor) & (density.v > 0);
    if (!any(above | below)) [[likely]]
        return;
    const Spectrum scale = select(above, Spectrum(1 / kFactor), select(below, Spectrum(kFactor), Spectrum(1.f)));
    *weights.beta *= scale;
    *weights.density *= scale;
    givenUp_ += select(above, Spectrum(kLogFactor), select(below, Spectrum(-kLogFactor), Spectrum(0.f)));
}

bool MediumTracker::toldToLeave() {
    if (!stop_.load(std::memory_order_relaxed)) [[likely]]
        return false;
    return counters.left = true;
}

void MediumTracker::note(float density, const MediumSegment& bounds, const Medium& medium) {
    const float bound = bounds.maximum;
    if (density >= bounds.minimum && density <= bound) [[likely]]
        return;
    if (!(density >= 0 && density < kInfinity)) {
        ++counters.faults;
        counters.fault = density;
        counters.faulty = &medium;
        return;
    }
    ++counters.signedWeights;
    if (!(density > bound * 1.001f)) return;
    ++counters.exceeded;
    counters.mostExceeded = std::max(counters.mostExceeded, density / bound);
}

// What surviving the way to `t` weighs at the other wavelengths, all media and exponents together: e^-a / e^-b has no
// digits left where e^-b underflows, e^(b-a) has. Scaled so that no lane overflows.
void MediumTracker::shareDistance(float t, TrackedWeights weights) const {
    if (!weights.density) return;
    Spectrum exponent = givenUp_;
    for (const Active& a : active_) {
        double passed = a.passed;
        if (a.walk && t > a.segment.tNear)
            passed += static_cast<double>(a.segment.maximum) *
                      static_cast<double>(std::min(t, a.segment.tFar) - a.segment.tNear);
        exponent = exponent - (a.extinction - Spectrum(a.hero)) * finite(passed);
    }
    // A lane that cannot collide is out once the path has: it would leave the others no digits.
    const Spectrum in = select(weights.density->v > 0, exponent, Spectrum(-kInfinity));
    const Spectrum common = exp(exponent - Spectrum(maxLane(in)));
    *weights.beta *= common;
    *weights.density *= common;
    const float largest = maxLane(*weights.density);
    if (largest > 0) {
        *weights.beta *= 1 / largest;
        *weights.density *= 1 / largest;
    }
}

Spectrum MediumTracker::transmittance(const Ray& ray, float tMax, const MediumStack& inside, const Wavelengths& lambda,
                                      RandomStream& random, float least) {
    const WorkScope work(Work::lights);
    start(ray, tMax, inside, lambda);
    Spectrum result(1.f);
    for (Active& a : active_) {
        result *= ratioTracking(a, random, least > 0 ? least / maxLane(abs(result)) : 0);
        if (!anyNonZero(result)) break;
    }
    return result;
}

Spectrum MediumTracker::ratioTracking(Active& a, RandomStream& random, float least) {
    setWork(volumeWork(a.medium->number));
    Residual residual;
    double control = 0; // of the mean density
    do {
        if (!ratioTracking(a, control, random, residual)) return Spectrum(0.f);
        control += static_cast<double>(a.segment.mean) * static_cast<double>(a.segment.tFar - a.segment.tNear);
        if (!(least > 0)) continue;
        residual.keepInRange();
        const float soFar = maxLane(abs(residual.times(a.extinction, control)));
        if (!(soFar < least)) continue;
        if (!(random.uniform() * least < soFar)) return Spectrum(0.f);
        residual.weight *= least / soFar;
    } while (a.walk->next(a.segment));
    return residual.times(a.extinction, control);
}

// With the transmittance of the control.
Spectrum MediumTracker::Residual::times(const Spectrum& extinction, double control) const {
    return weight * exp(givenUp - extinction * finite(control));
}

// Where densities are below the mean, weights grow until that transmittance takes them back.
void MediumTracker::Residual::keepInRange() {
    const Int8 above = abs(weight).v > kFactor;
    if (!any(above)) [[likely]]
        return;
    weight *= select(above, Spectrum(1 / kFactor), Spectrum(1.f));
    givenUp += select(above, Spectrum(kLogFactor), Spectrum(0.f));
}

// The residual of one segment. False if roulette ended a transmittance too small to pay for its lookups.
bool MediumTracker::ratioTracking(Active& a, double control, RandomStream& random, Residual& result) {
    const MediumSegment& s = a.segment;
    const float largest = maxLane(a.extinction);
    const float residual = std::max(s.maximum - s.mean, s.mean - s.minimum);
    const double rate = static_cast<double>(residual * largest);
    if (!(rate > 0)) return true;
    const Spectrum share = a.extinction * (1 / (largest * residual));
    const double length = static_cast<double>(s.tFar - s.tNear);
    int count = 0;
    // In double: steps of a dense medium far from the origin would vanish in float.
    const double step = 1 / rate;
    for (double t = static_cast<double>(random.exponential()) * step; t < length;
         t += static_cast<double>(random.exponential()) * step) {
        ++counters.lookups;
        ++counters.volumes[volumeRow(a.medium->number)].lookups;
        const float density = a.walk->density(s.tNear + static_cast<float>(t));
        note(density, s, *a.medium);
        const Spectrum kept = Spectrum(1.f) - share * (density - s.mean);
        // Below the bound only rounding makes it negative.
        if (density <= s.maximum) {
            result.weight *= max(Spectrum(0.f), kept);
        } else {
            result.weight *= kept;
            result.keepInRange(); // of any size
        }
        if (++count % kRouletteEvery != 0) continue;
        if (toldToLeave()) return false;
        result.keepInRange();
        const Spectrum soFar = result.times(a.extinction, control + static_cast<double>(s.mean) * t);
        if (maxLane(abs(soFar)) > kSmall) continue;
        if (random.uniform() < 0.5f) return false;
        result.weight *= 2.f;
    }
    return true;
}

// What can be said of a ray without tracking it.
RayExtent MediumTracker::extent(const Ray& ray, float tMax, const MediumStack& inside) const {
    if (inside.size() > 0) return {0, tMax};
    RayExtent all;
    for (const Medium* medium : open_) {
        const RayExtent e = clip(medium->bounds(), ray, tMax);
        if (e.empty()) continue;
        all = all.empty() ? e : RayExtent{std::min(all.tNear, e.tNear), std::max(all.tFar, e.tFar)};
    }
    return all;
}

float MediumTracker::expected(const Ray& ray, float t, const MediumStack& inside, const Wavelengths& lambda,
                              std::vector<InScattering>* there) {
    if (there) there->clear();
    start(ray, t, inside, lambda);
    double passed = 0, rate = 0;
    for (Active& a : active_) {
        const double extinction = static_cast<double>(mean(a.extinction));
        const MediumSegment& s = a.segment;
        for (bool more = true; more; more = a.walk->next(a.segment)) {
            passed += extinction * static_cast<double>(s.mean) * static_cast<double>(s.tFar - s.tNear);
            if (s.tFar < t) continue;
            rate += extinction * static_cast<double>(s.mean);
            if (!there) continue;
            const Spectrum albedo = a.medium->albedoVaries() ? a.walk->albedo(t, lambda) : a.albedo;
            const float density = a.walk->density(t);
            note(density, {0, 0, 0, 0, std::numeric_limits<float>::max()}, *a.medium); // no bound counts here
            there->push_back({a.medium, a.extinction * albedo * density});
        }
    }
    return static_cast<float>(rate * std::exp(-passed));
}

} // namespace abbe
