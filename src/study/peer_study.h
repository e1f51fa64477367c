// Another renderer's curve in a study: the same scene, rendered by it in a process of its own, with errors against a
// reference of its own. Mitsuba 3 is one, called by way of its module for Python.
#pragma once

#include "study/study_plan.h"
#include "study/study_run.h"
#include "study/study_store.h"

#include <optional>
#include <string>
#include <vector>

namespace abbe {

struct PeerRequest {
    std::string scene;   // file in the peer's own format
    std::string variant; // of Mitsuba: "scalar_spectral"; empty: tryMitsuba() chooses
    int width = 0, height = 0;
    int threads = 1;
    std::vector<std::uint32_t> ladder; // samples per pixel of the rungs
    int seeds = 2;                     // at least 2
    std::uint64_t seed = 0;
    double mainSeconds = 0; // of the main curve's last rung: the ladder ends near that time, as those of variants do
    double timeLimit = 0;   // s; 0: none
};

struct PeerCurve {
    std::string name, version, variant; // "Mitsuba", "3.9.1", "scalar_spectral"
    CurveRecord record;                 // measured against the reference; times without start-up and loading
    StoredReference reference;
    bool complete = true; // false: the time ran out, fewer seeds
};

struct PeerEnd {
    StudyEnd end = StudyEnd::done; // stopped: there is no curve
    std::string fault, help;       // why there is none
    std::optional<PeerCurve> curve;
};

// The Python that has Mitsuba: $ABBE_PEER_PYTHON, that of a `mitsuba` on the PATH, or `python3`. It is not tried.
std::string mitsubaPython();

// Small pictures of the scene, which tell whether the peer is there and can render it, and with which variant: the
// curve that it returns names it. Takes seconds.
PeerEnd tryMitsuba(const PeerRequest&, const StudyControl&);

// Renders the ladder with the first seed, the reference, and the ladder with the other seeds; measures them all.
// Requires a variant. Both throw std::system_error if there is no place for pictures.
PeerEnd runMitsuba(const PeerRequest&, const StudyControl&);

// What runs in Python (peer_script.cpp). Its output, on lines that begin with `abbe-peer`, is what runMitsuba() reads.
extern const char* const kMitsubaScript;

} // namespace abbe
