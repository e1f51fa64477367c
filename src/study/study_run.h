// The renders of a study, in their order.
#pragma once

#include "study/ladder_render.h"
#include "study/study_plan.h"
#include "study/study_store.h"

#include <atomic>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace abbe {

// How far a study has come. A render is a variant with one seed.
struct StudyProgress {
    std::string what;                  // "light sampling alone, seed 3 of 8"
    int renders = 0, totalRenders = 0; // done, of all
    double fraction = 0;               // of the time it will take
    double elapsed = 0, left = -1;     // s, of this run; left < 0: unknown yet
};

struct StudyControl {
    const std::atomic<bool>* stop = nullptr; // set: leave after the portions of tiles in hand
    std::function<void(const StudyProgress&)> progress;
};

enum class StudyEnd : std::uint8_t { done, stopped, outOfTime };

// First one seed of every variant, which tells times and how good the reference must be; then the reference; then the
// other seeds, each for all variants in turn, so that what else the machine does meets all of them alike. What the
// store has already is not rendered again.
//
// A variant's ladder ends where the next rung would take it far beyond the time of the main curve: its first seed
// decides, the others follow.
class StudyRun {
  public:
    static constexpr double kReferenceAdvantage = 20; // relMSE of the best rung over that of the reference

    // All of them outlive it.
    StudyRun(const StudySubject&, const StudyPlan&, const StudyStore&, const StudyControl&);

    // Throws what the store throws.
    StudyEnd run();
    // Samples that were dropped in the renders of this run.
    std::uint64_t dropped() const { return dropped_; }

  private:
    using Clock = std::chrono::steady_clock;

    bool renderFirst(const StudyVariant&);
    bool makeReference();
    void measureFirst(const StudyVariant&, const ReferencePair&);
    bool renderNext(const StudyVariant&, int replicate, const ReferencePair&);
    double bestRung(const ReferencePair&) const;
    bool outOfTime(double next) const;
    double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
    std::uint32_t perReplicate(std::uint32_t samples) const {
        return samples / static_cast<std::uint32_t>(subject_.replicates);
    }
    double secondsOf(const StudyVariant&) const; // of one more seed, estimated
    double referenceSeconds() const;             // estimated
    double secondsLeft() const;
    void tell(const std::string& what, double doneOfIt);

    const StudySubject& subject_;
    const StudyPlan& plan_;
    const StudyStore& store_;
    const StudyControl& control_;
    std::vector<std::uint32_t> ladder_;
    std::map<std::string, double> seconds_; // wall clock of a seed of each variant, by id
    std::map<std::string, int> done_;       // seeds of each variant
    bool referenceDone_ = false;
    std::uint32_t referenceSamples_ = 0; // expected or had, of a half
    Clock::time_point start_ = Clock::now();
    std::uint64_t dropped_ = 0;
    double current_ = 0; // s that the step in hand was expected to take
};

} // namespace abbe
