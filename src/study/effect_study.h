// What each effect of a scene costs and shows: renders with and without it, in pairs of one seed; and what a render
// would take without an effect, estimated from its cost report.
#pragma once

#include "base/diagnostic.h"
#include "io/image.h"
#include "scene/build.h"
#include "scene/effect_switches.h"
#include "study/cost.h"

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace abbe {

// Seconds of rendering without it, as CostReport::rendering; nothing where the cost report has nothing to tell it by.
//
// Of a medium: as long as no medium has scattered a path, each of its rays is the path's last one with a probability
// that does not depend on the medium. Paths that the medium would have scattered go on with it, so that there are
// N (U - C) / (N - C) such rays in place of U, for N paths of which it scattered C first. Each takes along what it did;
// following the medium, and all that came after its scattering, is no more. Where it scattered most paths nothing is
// told.
std::optional<double> renderingWithout(const CostReport&, const EffectSwitch&);

// Of one effect.
struct EffectFinding {
    EffectSwitch effect;
    std::string name; // "dispersion", "volume fog"
    Span place;       // where the scene asks for it
    // Rendering, in processor seconds of all threads: what else the machine does has no part in it.
    double secondsOn = 0, secondsOff = 0;
    // Share of secondsOn that goes with it (negative: it saves time), with its 95 % interval over pairs.
    double deltaTime = 0, low = 0, high = 0;
    std::optional<double> predicted; // the same share as the cost report tells it, see renderingWithout()
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
