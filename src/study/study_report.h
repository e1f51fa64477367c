// Colours for maps of errors. The findings of a study.
#pragma once

#include "study/curve_statistics.h"
#include "study/peer_study.h"
#include "study/study_plan.h"
#include "study/study_store.h"

#include <array>
#include <span>
#include <string>
#include <vector>

namespace abbe {

// Cubehelix [Green2011]: a turn through the hues on which brightness rises evenly from black to white, so that
// nothing looks larger than it is, on paper and to colour-blind readers neither.
struct ErrorColours {
    static constexpr const char* kName = "cubehelix";
    // Display-encoded (sRGB), 0 … 1; of t clamped to 0 … 1.
    static std::array<float, 3> at(double t);
    // Interleaved, of values from `low` to `high`.
    static std::vector<float> paint(std::span<const float> values, double low, double high);
    // 0.1, 0.2, 0.5, 1, …: the least such number that 99 % of the values do not exceed. Requires some values.
    static double roundScale(std::vector<float> values);
};

struct StudyCurve {
    StudyVariant variant;
    CurveStatistics statistics;
    std::vector<Estimate> bias; // bias² of each rung, over r² + ε
    std::string note = {};      // in place of the variant's

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

// A curve whose errors are against a reference of its own: another renderer's.
struct StudyPeer {
    std::string id, name, version, variant;
    std::uint32_t referenceSamples = 0; // per pixel, of each half
    double referenceSeconds = 0, referenceRelMse = 0, referenceAdvantage = 0;
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

    std::vector<StudyPeer> peers; // of the curves, those of other renderers

    // From all that the store has: variants with a measured seed, the main one among them; a reference. Peers follow.
    // Throws what the store throws.
    static StudyReport make(const StudySubject&, const StudyPlan&, const StudyStore&,
                            std::span<const PeerCurve> peers = {});
};

} // namespace abbe
