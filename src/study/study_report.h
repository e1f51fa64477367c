// The findings of a study.
#pragma once

#include "study/curve_statistics.h"
#include "study/study_plan.h"
#include "study/study_store.h"

#include <string>
#include <vector>

namespace abbe {

struct StudyCurve {
    StudyVariant variant;
    CurveStatistics statistics;
    std::vector<Estimate> bias; // bias² of each rung, over r² + ε

    // What the error flattens at: by a law with a floor, and by the bias² of the last rung, which was measured. The law
    // also fits a curve that is only bent, so the floor is above 0 where both say so; and it lies no higher than the
    // bias of the last rung.
    Estimate floor() const;
};

// Pictures that took about the same time.
struct StudyStrip {
    struct Picture {
        std::string curve; // id
        std::uint32_t samples = 0;
        double relMse = 0;
        std::vector<char> png, errorPng; // files
    };
    double seconds = 0;
    std::vector<Picture> pictures;
};

struct StudyReport {
    std::vector<StudyCurve> curves; // the main one first
    std::vector<StudyStrip> strips;
    double errorScale = 1; // relative error that has the brightest colour in maps
    std::vector<char> referencePng;
    double exposure = 0;                // stops that all pictures are brightened by
    std::uint32_t referenceSamples = 0; // per pixel, of each half
    double referenceSeconds = 0, referenceRelMse = 0;
    double referenceAdvantage = 0; // relMSE of the best rung of all curves over that

    // From all that the store has: variants with a measured seed, the main one among them; a reference.
    // Throws what the store throws.
    static StudyReport make(const StudySubject&, const StudyPlan&, const StudyStore&);
};

} // namespace abbe
