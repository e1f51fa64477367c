// Collisions of one ray with all media along it, by tracking against bounds on their density [Miller2019; Novak2018].
#pragma once

#include "base/parallel.h"
#include "math/hash.h"
#include "render/effect_counts.h"
#include "render/integrator.h"
#include "transport/surroundings.h"

#include <span>
#include <vector>

namespace abbe {

// Weights of a path along a ray, per lane. Both share the factors by which densities at other wavelengths differ from
// the hero's, so they may be scaled together at will.
struct TrackedWeights {
    Spectrum* beta;    // throughput over the hero's density
    Spectrum* density; // density over the hero's [Wilkie2014, eq. 5]; null while no extinction varies with wavelength
};

struct MediumCollision {
    const Medium* medium = nullptr; // null: the ray came through
    float t = 0;
};

// Receives what emits along a ray: estimates whose sum over the ray is the light that its media add to it.
class EmissionListener {
  public:
    // Whether to tell it what media absorb, too:
    bool minds = false;
    // Of the weight of the path this share, in the mean over its wavelengths, is absorbed at `t`.
    virtual void absorbs(float /*t*/, float /*share*/) {}
    // `amount`: radiance given off around the distance `t`, not yet weighed; the weights are those of the path at `t`.
    virtual void emits(const MediumEmission&, float t, const Spectrum& amount, const Spectrum& beta,
                       const Spectrum& density) = 0;

  protected:
    ~EmissionListener() = default;
};

// What scatters at a place on a ray.
struct InScattering {
    const Medium* medium = nullptr;
    Spectrum coefficient; // 1/m
};

// What a ray has come across so far.
struct MediumCounters {
    std::uint64_t collisions = 0;                     // tentative ones
    std::uint64_t lookups = 0;                        // of density, for transmittance
    std::uint64_t exceeded = 0;                       // densities above their bound, by more than rounding
    std::uint64_t signedWeights = 0;                  // all densities above their bound: weights there may be below 0
    float mostExceeded = 0;                           // the greatest of them over its bound
    std::uint64_t faults = 0;                         // densities that are negative or not finite
    float fault = 0;                                  // the last of them
    const Medium* faulty = nullptr;                   // where it was found
    bool left = false;                                // a ray was left before its end, since it was told to stop
    std::array<VolumeCounts, kVolumeWorks> volumes{}; // collisions and lookups alone

    DensityExcess excess() const { return {collisions + lookups, exceeded, mostExceeded}; }
};

// Of a ray, the first step in each medium: the optical length up to where it may collide.
struct FirstStep {
    float stretch = 1; // times as long as what the medium has
    // Added to the bits of the random number that it is made of. Ways whose turns divide 2^64 evenly start with
    // stratified steps if their random numbers are the same.
    std::uint64_t turn = 0;
};

// One per thread; keeps its memory. Media collide independently of each other, which adds them up.
class MediumTracker {
  public:
    // `open`: the media that no shape bounds. Told to stop, it leaves a ray where it is, and says so in its
    // counters.
    explicit MediumTracker(std::span<const Medium* const> open, const StopFlag& stop = kNeverStop);

    // Follows a ray to tMax or to where it is scattered, whichever comes first. Absorption is never an event: it is a
    // weight, so that a path that loses a tenth of its light does not end in one of ten cases. Emission is collected on
    // the way, at one place in every segment that emits.
    MediumCollision follow(const Ray&, float tMax, const MediumStack& inside, const Wavelengths&, RandomStream&,
                           TrackedWeights, EmissionListener* = nullptr, FirstStep = {});
    // Where follow() with these random numbers will find the ray scattered if nothing is in its way, where that can be
    // told without following it: in a single medium of constant density that does not emit. Elsewhere infinite.
    float reach(const Ray&, const MediumStack& inside, const Wavelengths&, RandomStream, float stretch = 1);
    // Whether that is so: one medium of constant density that does not emit.
    bool even(const MediumStack& inside) const {
        return inside.size() == 1 && open_.empty() && !inside[0]->emission() && inside[0]->homogeneous();
    }
    // An unbiased estimate of the transmittance to tMax, exact where density is constant: residual ratio tracking
    // [Novak2014] with the mean density of each segment as control. Where it falls below `least` roulette ends it or
    // takes it back there, segment by segment: for whom less is not worth its lookups.
    Spectrum transmittance(const Ray&, float tMax, const MediumStack& inside, const Wavelengths&, RandomStream&,
                           float least = 0);

    // About the density of the distances that follow() finds: that of collisions if every segment had its mean density
    // throughout, 1/m. A pure function of the ray and t. If asked, also all that scatters at t.
    float expected(const Ray&, float t, const MediumStack& inside, const Wavelengths&,
                   std::vector<InScattering>* there = nullptr);
    // Whether the medium is among those in which such a path runs.
    bool fills(const Medium& medium, const MediumStack& inside) const {
        bool found = false;
        forEach(inside, [&](const Medium& m) { found |= &m == &medium; });
        return found;
    }
    // The part of the ray up to tMax outside of which there are no media.
    RayExtent extent(const Ray&, float tMax, const MediumStack& inside) const;

    MediumCounters counters;

  private:
    struct Active {
        const Medium* medium;
        MediumWalk* walk;
        MediumSegment segment;
        Spectrum extinction; // at density 1
        Spectrum albedo;
        float hero;    // of it
        float next;    // where something happens: a tentative collision or the end of the segment
        float optical; // hero's optical length still to go after `next` when that is the segment's end
        double passed; // integral of the bounding density over the segments before this one
        bool collides; // at `next`
        bool parts;    // tracked as two media, collide()
    };

    // The weight of residual ratio tracking, over the exponential of what its lanes gave up to stay in range.
    struct Residual {
        Spectrum weight{1.f}, givenUp{0.f};

        void keepInRange();
        Spectrum times(const Spectrum& extinction, double control) const;
    };

    struct Glow {
        const MediumEmission* emission;
        EmissionWalk* walk;
        MediumSegment segment;
        float next; // where it is asked
    };

    // Calls `each` for the media that no shape bounds and for those around the path.
    template <typename F> void forEach(const MediumStack& inside, F each) const {
        for (const Medium* medium : open_) each(*medium);
        for (int i = 0; i < inside.size(); ++i) each(*inside[i]);
    }
    // The one whose walk goes on and whose `next` comes first; null after the last.
    template <typename T> static T* earliest(std::vector<T>& all) {
        T* first = nullptr;
        for (T& one : all)
            if (one.walk && (!first || one.next < first->next)) first = &one;
        return first;
    }
    void start(const Ray&, float tMax, const MediumStack& inside, const Wavelengths&);
    void startGlows(const Ray&, float tMax, const MediumStack& inside, RandomStream&);
    bool advance(Glow&, RandomStream&);
    void emit(const Glow&, const Wavelengths&, TrackedWeights, EmissionListener&) const;
    static void schedule(Active&, float from);
    static bool advance(Active&);
    bool collide(Active&, const Wavelengths&, RandomStream&, TrackedWeights, EmissionListener*);
    void keepInRange(TrackedWeights);
    void shareDistance(float t, TrackedWeights) const;
    void note(float density, const MediumSegment& bounds, const Medium&);
    bool toldToLeave();
    Spectrum ratioTracking(Active&, RandomStream&, float least);
    bool ratioTracking(Active&, double control, RandomStream&, Residual&);

    std::span<const Medium* const> open_;
    const StopFlag& stop_;
    std::vector<WalkSpace> spaces_, glowSpaces_;
    std::vector<Active> active_;
    std::vector<Glow> glows_;
    Spectrum givenUp_; // of both weights of the ray in hand, logarithms
};

} // namespace abbe
