// The ways of rendering a scene that a study compares.
#pragma once

#include "study/study_subject.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

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

} // namespace abbe
