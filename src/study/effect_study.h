// What each effect of a scene costs and shows: renders with and without it, in pairs of one seed.
#pragma once

#include "base/diagnostic.h"
#include "io/image.h"
#include "scene/build.h"
#include "study/cost.h"

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace abbe {

// Of one effect.
struct EffectFinding {
    EffectSwitch effect;
    std::string name; // "dispersion", "volume fog"
    Span asker;       // where the scene asks for it
    // Rendering, in processor seconds of all threads: what else the machine does has no part in it.
    double secondsOn = 0, secondsOff = 0;
    // Share of secondsOn that goes with it (negative: it saves time), with its 95 % interval over pairs.
    double deltaTime = 0, low = 0, high = 0;
    std::optional<double> predicted; // the same share as the cost report tells it, see effect_prediction.h
    double flip = 0;                 // mean HDR-FLIP between the two images
    double relMse = 0;               // of the image without it, its noise and that of the reference cancelled
    RgbImage image;                  // without it; linear Rec.709
    std::string reason;              // why it could not be measured; then there is nothing else. Empty: it was
};

struct EffectStudy {
    std::vector<EffectFinding> findings; // in the order of the scene
    CostReport cost;                     // of all renders with all effects
    RgbImage image;                      // with all effects
    Effects effects;                     // of the scene
    bool stopped = false;
};

struct EffectStudyInput {
    const schema::SceneTree* tree = nullptr;
    const schema::TypeTable* types = nullptr;
    BuildOptions build;                      // with nothing left out
    int pairs = 6;                           // at least 2
    std::uint32_t samples = 0;               // per pixel of each render; 0: as the scene says
    const std::atomic<bool>* stop = nullptr; // set: leave after the portions of tiles in hand; may be null
    std::function<void(const std::string& what, double done)> progress = {}; // done: of all, 0 … 1
};

// Requires a scene that is built without errors. What the diagnostics of builds with effects left out say becomes the
// reason of a finding.
EffectStudy measureEffects(const EffectStudyInput&);

} // namespace abbe
