// What is suspicious about a render: before it begins, and about the finished image. Nothing that went wrong stays
// unsaid.
#pragma once

#include "base/diagnostic.h"
#include "film/error_figure.h"
#include "film/pixel_film.h"
#include "pictures/picture_figures.h"
#include "render/integrator.h"
#include "reports/sample_report.h"
#include "scene/build.h"

namespace abbe {

// Samples left out because they were not finite or negative. `faults`: what was found of the examples, if it was looked
// for; `command`: what repeats a sample that is named behind it.
void warnOfDroppedSamples(const RenderStatistics&, std::span<const FoundFault> faults, const std::string& command,
                          Diagnostics&);
// That bounds of procedural density are too low to be of use.
void warnOfDensities(const DensityExcess&, Diagnostics&);
// Of pixels that show the first look: the time was too short for a sample of them, or what they had was dropped.
struct MissingSamples {
    std::size_t pixels = 0;
    PixelBounds image;
    bool allBegun = false; // a sample of every pixel was taken
    std::uint64_t dropped = 0;
};
void warnOfMissingSamples(const MissingSamples&, Diagnostics&);
// That what only light paths or merging bring is missing, because the render was ended before their first.
void warnOfMissingLight(const RenderStatistics&, Diagnostics&);
// Of an image whose error is mostly carried by samples that are too rare.
void warnOfHeavyTail(const ErrorFigure&, Diagnostics&);
void warnOfBlackImage(const ResolvedImage&, Diagnostics&);
// That a display shows next to nothing of the picture, though other stops would.
struct ShownStops {
    double camera = 0, view = 0;
    std::string image; // path
};
void warnOfDisplay(const PictureFigures&, const ShownStops&, Span camera, Diagnostics&);

// Before the first sample: between which shapes paths go round that lose no light there. `samples` of each pixel are
// wanted; 0: as many as there is time for.
void warnOfEndlessPaths(const FramePreview&, const BuiltScene&, double samples, Diagnostics&);
// Of those that met the safety cap on vertices, with the shapes and media where they did.
void warnOfCappedPaths(const RenderStatistics&, const BuiltScene&, Diagnostics&);

} // namespace abbe
