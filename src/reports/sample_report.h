// A dropped sample with the place where it went wrong, in the words of the scene; for people and for programs. What
// happened in one sample, vertex by vertex.
#pragma once

#include "app/json.h"
#include "base/source.h"
#include "render/scene.h"
#include "rendering/path_record.h"
#include "schema/scene_tree.h"

#include <span>
#include <string>
#include <vector>

namespace abbe {

struct FoundFault {
    DroppedSample sample;
    DropCause cause = DropCause::nan;    // of the first number that was wrong
    int vertex = 0;                      // from 1; 0: at the camera
    std::string object, material, light; // names; empty: none there
    std::uint32_t instance = SurfaceHit::kNoInstance;
    float number = 0;               // itself, in the first lane
    std::string what;               // "density of the light"
    std::vector<float> wavelengths; // nm; empty: all of the sample
    Span declared;                  // where the scene declares the culprit, if it has a name
};

// How people and `--pixel` with `--sample` name it: "31,7" and "1:12".
std::string pixelText(const SampleId&);
std::string sampleText(const SampleId&);
std::string_view causeName(DropCause);

// Of a sample that was dropped, from its record.
FoundFault describeFault(const DroppedSample&, const PathRecord&, const Scene&, const schema::SceneTree&);
// Takes dropped samples again, which the film and the settings tell, and looks where they went wrong.
std::vector<FoundFault> findFaults(std::span<const DroppedSample>, const Integrator&, const Scene&,
                                   const schema::SceneTree&, const Film&, const RenderSettings&);
// "vertex 2, object `teapot`, material `gold`: the weight of the material is not a number at 431.7 nm"
std::string text(const FoundFault&);

// A line for each sample, "31,7 1:12 nan vertex 2, …", as the header of an image holds it; and what of it names
// samples.
std::string listText(std::span<const FoundFault>);
std::vector<DroppedSample> readList(std::string_view);

Json faultJson(const FoundFault&);
Json lanesJson(const Spectrum&);
Json nameOrNull(const std::string& name); // null where it is empty

struct ReplayedSample {
    SampleId id;
    const PathRecord& record;
    const FoundFault* fault = nullptr; // of a sample that was dropped
    double exposure = 1;               // factor of what the film adds
};

// For people: a block of lines.
std::string replayText(const ReplayedSample&, const Scene&);
Json replayJson(const ReplayedSample&, const Scene&);

} // namespace abbe
