#include "study/study_run.h"

#include "base/check.h"
#include "study/seed_runs.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace abbe {

namespace {

constexpr std::size_t kFewestRungs = 2;
constexpr std::uint32_t kFirstReference = 16, kLastReference = 256; // samples of a half, over those of the last rung
constexpr double kReferenceMargin = 1.3;                            // the best rung is known from one seed
constexpr double kReferenceShare = 0.5;                             // of the time that is left

} // namespace

StudyRun::StudyRun(const StudySubject& subject, const StudyPlan& plan, const StudyStore& store,
                   const StudyControl& control)
    : subject_(subject), plan_(plan), store_(store), control_(control),
      ladder_(StudyPlan::ladder(plan.samples, subject.replicates)) {
    ABBE_CHECK(ladder_.size() >= kFewestRungs && !plan.chosen.variants.empty());
    referenceSamples_ = kFirstReference * ladder_.back();
}

StudyEnd StudyRun::run() {
    for (const StudyVariant& v : plan_.chosen.variants)
        if (!renderFirst(v)) return StudyEnd::stopped;
    if (!makeReference()) return StudyEnd::stopped;
    const auto stored = store_.loadReference();
    const ReferencePair reference(stored->a, stored->b);
    for (const StudyVariant& v : plan_.chosen.variants) measureFirst(v, reference);
    for (int replicate = 2; replicate <= plan_.seeds; ++replicate)
        for (const StudyVariant& v : plan_.chosen.variants) {
            if (done_[v.id] >= replicate) continue;
            if (outOfTime(secondsOf(v))) return StudyEnd::outOfTime;
            if (!renderNext(v, replicate, reference)) return StudyEnd::stopped;
        }
    return StudyEnd::done;
}

bool StudyRun::outOfTime(double next) const { return plan_.timeLimit > 0 && elapsed() + next > plan_.timeLimit; }

bool StudyRun::renderFirst(const StudyVariant& v) {
    const std::string main = plan_.chosen.variants[0].id;
    if (const auto known = store_.loadCurve(v.id)) {
        seconds_[v.id] = known->runs[0].rungs.back().seconds;
        done_[v.id] = static_cast<int>(known->runs.size());
        return true;
    }
    current_ = secondsOf(v);
    const auto begin = Clock::now();
    LadderRender render(subject_, v, plan_.seedOf(1), control_.stop);
    CurveRecord record{v.id, {}, {{plan_.seedOf(1), {}}}, 0};
    const double mainSeconds = v.id == main ? std::numeric_limits<double>::infinity() : seconds_.at(main);
    for (std::size_t k = 0; k < ladder_.size(); ++k) {
        const double before = k == 0 ? 0 : std::exp2(static_cast<double>(k) - static_cast<double>(ladder_.size()));
        const double after = std::exp2(static_cast<double>(k + 1) - static_cast<double>(ladder_.size()));
        auto rung = render.advance(perReplicate(ladder_[k]), [&](double f) {
            tell(fmt::format("{}, seed 1 of {}", v.label, plan_.seeds), std::lerp(before, after, f));
        });
        if (!rung) return false;
        record.rungs.push_back({rung->samples, std::move(rung->image), {}, {}});
        record.runs[0].rungs.push_back(rung->cost);
        if (!worthAnotherRung(record.runs[0].rungs, mainSeconds)) break;
    }
    store_.saveCurve(record);
    dropped_ += render.dropped();
    seconds_[v.id] = v.id == main ? record.runs[0].rungs.back().seconds
                                  : std::chrono::duration<double>(Clock::now() - begin).count();
    done_[v.id] = 1;
    return true;
}

// The least relMSE of a last rung, as far as this reference can tell.
double StudyRun::bestRung(const ReferencePair& reference) const {
    double best = std::numeric_limits<double>::infinity();
    for (const StudyVariant& v : plan_.chosen.variants)
        best = std::min(best, reference.measure(store_.loadCurve(v.id)->rungs.back().first).relMse);
    return best;
}

bool StudyRun::makeReference() {
    if (const auto known = store_.loadReference()) {
        referenceSamples_ = known->samples;
        referenceDone_ = true;
        return true;
    }
    StudyVariant plain = plan_.chosen.variants[0];
    plain.apply = [](RenderSettings& s) { s.adaptive = false; };
    LadderRender halves[] = {{subject_, plain, plan_.referenceSeed(0), control_.stop},
                             {subject_, plain, plan_.referenceSeed(1), control_.stop}};
    const double budget = plan_.timeLimit > 0 ? kReferenceShare * (plan_.timeLimit - elapsed()) : 0;
    const std::uint32_t most = kLastReference * ladder_.back();
    std::uint32_t before = 0;
    for (;; before = referenceSamples_, referenceSamples_ = std::min(most, referenceSamples_ / 2 * 3)) {
        current_ = referenceSeconds() * (1 - static_cast<double>(before) / referenceSamples_);
        StoredReference stored;
        for (int half = 0; half < 2; ++half) {
            auto rung = halves[half].advance(perReplicate(referenceSamples_), [&](double f) {
                tell(fmt::format("reference, {} samples, half {} of 2", referenceSamples_, half + 1), (half + f) / 2);
            });
            if (!rung) return false;
            (half == 0 ? stored.a : stored.b) = std::move(rung->image);
            stored.samples = rung->samples;
            stored.seconds += rung->cost.seconds;
        }
        const ReferencePair reference(stored.a, stored.b);
        const bool good = bestRung(reference) >= kReferenceMargin * kReferenceAdvantage * reference.relMse();
        if (good || referenceSamples_ >= most || (budget > 0 && 1.5 * stored.seconds > budget)) {
            store_.saveReference(stored);
            dropped_ += halves[0].dropped() + halves[1].dropped();
            referenceDone_ = true;
            return true;
        }
    }
}

void StudyRun::measureFirst(const StudyVariant& v, const ReferencePair& reference) {
    CurveRecord record = *store_.loadCurve(v.id);
    if (record.measured > 0) return;
    std::vector<StudyImage> images;
    for (const CurveRung& rung : record.rungs) images.push_back(rung.first);
    record.measure(reference, images);
    store_.saveCurve(record);
}

bool StudyRun::renderNext(const StudyVariant& v, int replicate, const ReferencePair& reference) {
    current_ = secondsOf(v);
    const auto begin = Clock::now();
    CurveRecord record = *store_.loadCurve(v.id);
    LadderRender render(subject_, v, plan_.seedOf(replicate), control_.stop);
    SeedRun run{plan_.seedOf(replicate), {}};
    std::vector<StudyImage> images;
    for (const CurveRung& rung : record.rungs) {
        const double last = record.rungs.back().samples;
        const double from = run.rungs.empty() ? 0 : rung.samples / 2 / last;
        auto next = render.advance(perReplicate(rung.samples), [&](double f) {
            tell(fmt::format("{}, seed {} of {}", v.label, replicate, plan_.seeds),
                 std::lerp(from, rung.samples / last, f));
        });
        if (!next) return false;
        run.rungs.push_back(next->cost);
        images.push_back(std::move(next->image));
    }
    record.runs.push_back(std::move(run));
    record.measure(reference, images);
    store_.saveCurve(record);
    dropped_ += render.dropped();
    seconds_[v.id] = std::chrono::duration<double>(Clock::now() - begin).count();
    done_[v.id] = replicate;
    return true;
}

// Until a variant has been seen it counts as the main one does.
double StudyRun::secondsOf(const StudyVariant& v) const {
    for (const std::string& id : {std::string(v.id), std::string(plan_.chosen.variants[0].id)})
        if (const auto known = seconds_.find(id); known != seconds_.end()) return known->second;
    return 0;
}

double StudyRun::referenceSeconds() const {
    return secondsOf(plan_.chosen.variants[0]) * 2 * referenceSamples_ / ladder_.back();
}

double StudyRun::secondsLeft() const {
    double left = referenceDone_ ? 0 : referenceSeconds();
    for (const StudyVariant& v : plan_.chosen.variants) {
        const auto done = done_.find(v.id);
        left += secondsOf(v) * (plan_.seeds - (done == done_.end() ? 0 : done->second));
    }
    return left;
}

void StudyRun::tell(const std::string& what, double doneOfIt) {
    if (!control_.progress) return;
    StudyProgress p;
    p.what = what;
    for (const auto& [id, done] : done_) p.renders += done;
    p.totalRenders = plan_.seeds * static_cast<int>(plan_.chosen.variants.size());
    p.elapsed = elapsed();
    if (!seconds_.empty()) {
        p.left = std::max(0.0, secondsLeft() - current_ * doneOfIt);
        if (plan_.timeLimit > 0) p.left = std::min(p.left, std::max(0.0, plan_.timeLimit - p.elapsed));
        p.fraction = p.elapsed / std::max(p.elapsed + p.left, 1e-9);
    }
    control_.progress(p);
}

} // namespace abbe
