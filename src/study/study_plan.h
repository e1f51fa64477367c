// What a study is asked for: the scene under study, the ways of rendering it that are compared, and their samples and
// seeds.
#pragma once

#include "film/film_params.h"
#include "render/integrator.h"
#include "scene/build.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

struct StudySubject {
    const BuiltScene* built = nullptr; // outlives the study
    FilmSettings film;                 // of the whole frame
    RenderSettings settings;           // as rendered, but without goals of noise and time
    int replicates = 2;                // of its film
    bool largestKernel = false;        // the instantiation with all effects
};

// Whether the image that more and more samples tend to is the true one: exact in the mean of any number of samples,
// consistent in the limit, biased in neither.
enum class BiasClass : std::uint8_t { exact, consistent, biased };
std::string_view name(BiasClass);

// The scene as it is rendered with one thing changed. Texts are for people, ids are stable.
struct StudyVariant {
    const char* id = "";
    const char* label = "";
    const char* group = "";  // "main", "light sampling", "directions", …
    const char* change = ""; // in a few words
    BiasClass bias = BiasClass::exact;
    const char* note = "";
    void (*apply)(RenderSettings&) = nullptr; // null: no setting changes
    bool denoised = false;                    // each rung goes through the denoiser, whose time counts
    // Why it is no use for a scene; nothing: it is.
    std::optional<std::string> (*needless)(const StudySubject&) = nullptr;

    RenderSettings settings(RenderSettings asRendered) const {
        if (apply) apply(asRendered);
        return asRendered;
    }
};

// All of them; the first, "abbe", is the scene as it is rendered.
const std::vector<StudyVariant>& studyVariants();

struct LeftOutVariant {
    std::string id, label, reason;
};
struct ChosenVariants {
    std::vector<StudyVariant> variants; // the main one first
    std::vector<LeftOutVariant> leftOut;
};
// Those with these ids that make a difference to the scene; the main one always. What the scene does anyway is not
// among those left out if all ids are given. Requires known ids.
ChosenVariants chooseVariants(const StudySubject&, const std::vector<std::string>& ids);

struct StudyPlan {
    ChosenVariants chosen;
    std::uint32_t samples = 64; // per pixel, of the last rung at most
    int seeds = 8;              // replicates of each curve
    std::uint64_t seed = 0;     // those of the curves follow it
    double timeLimit = 0;       // s of this run of the study; 0: none

    // The samples per pixel of the rungs: each is twice the one before, the first has about four.
    // Requires replicates >= 1.
    static std::vector<std::uint32_t> ladder(std::uint32_t samples, int replicates);
    // The first replicate is 1. A picture of a curve is that of `abbe render --seed` with it.
    std::uint64_t seedOf(int replicate) const { return seed + static_cast<std::uint64_t>(replicate); }
    // Far from those of the curves; half 0 or 1.
    std::uint64_t referenceSeed(int half) const;
};

} // namespace abbe
