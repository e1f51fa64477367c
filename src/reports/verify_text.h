// What `abbe verify` found, in words and as JSON.
#pragma once

#include "render/scene.h"
#include "verify/verify_run.h"

#include <string>

namespace abbe {

struct VerifyFacts {
    std::string path;             // of the scene file
    const Scene* scene = nullptr; // names of what lies where the two differ
    Vec2i size;                   // of the pictures
};

// "0.12 %".
std::string verifyPercent(double part);
// Lines for people, the verdict last.
std::string verifyText(const VerifyReport&, const VerifyFacts&);
// One line: an object with `verdict` "agree", "differ" or "undecided".
std::string verifyJson(const VerifyReport&, const VerifyFacts&);

} // namespace abbe
