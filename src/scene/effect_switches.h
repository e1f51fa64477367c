// Effects that a scene calls for and that are left out all the same, to see what they are worth.
#pragma once

#include "base/source.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

enum class SwitchedEffect : std::uint8_t {
    dispersion,   // indices are constant, at 587.6 nm
    absorption,   // dielectrics are clear
    motion,       // all stands still where it is at the middle of the exposure
    depthOfField, // rays go through the middle of the lens
    bumps,        // no bump and no normal maps
    displacement, // cages are not displaced
    thinFilm,     // no thin films
    medium,       // a volume or what fills a shape, by its name
};
// "depth-of-field"; of media "volume".
std::string_view wordOf(SwitchedEffect);

struct EffectSwitch {
    SwitchedEffect effect = SwitchedEffect::dispersion;
    std::string medium = {}; // its name
    bool operator==(const EffectSwitch&) const = default;
};

// Where a scene asks for what can be left out: the first place of each.
struct EffectUser {
    EffectSwitch effect;
    Span span;
};

class EffectSwitches {
  public:
    void leaveOut(EffectSwitch s) { off_.push_back(std::move(s)); }
    bool leavesOut(SwitchedEffect e) const { return leavesOut(EffectSwitch{e}); }
    bool leavesOutMedium(const std::string& name) const { return leavesOut({SwitchedEffect::medium, name}); }

  private:
    bool leavesOut(const EffectSwitch& s) const { return std::find(off_.begin(), off_.end(), s) != off_.end(); }

    std::vector<EffectSwitch> off_;
};

} // namespace abbe
