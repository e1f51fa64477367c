// What each command was asked to do.
#pragma once

#include "app/console.h"
#include "app/load.h"
#include "app/volume_options.h"
#include "denoise/denoise.h"
#include "io/flip.h"
#include "render/integrator.h"
#include "scene/build.h"

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace abbe {

// Of every command.
struct CommonOptions {
    std::string commandLine;        // as it would be typed in a shell
    std::vector<std::string> words; // of it, after the program's name
    Console console;
    bool json = false;
    int threads = 0; // 0: one per core
};

// A display rendering for PNG files.
struct ViewOptions {
    std::string display, view; // empty: our own defaults
    std::string config;        // OCIO: see image_output.h
    double exposure = 0;       // stops
};

// The picture for people beside an EXR.
struct PngOptions {
    bool off = false;   // none
    bool asked = false; // by `--png` or for a view: what stands in its way is an error, and else a warning
    std::string path;   // empty: named after the EXR
};

// How a render is kept from being lost.
struct CheckpointOptions {
    double interval = 25; // s; 0: only when interrupted or asked to
    bool off = false;     // none at all
    bool keep = false;    // also when it is done
    bool resume = false;  // go on from it
};

struct RenderOptions {
    std::vector<SampleId> replay; // these are taken again, and told
    SceneInput input;
    std::string output; // EXR; empty: from the scene
    PngOptions png;
    ViewOptions view;
    BuildOptions build;
    bool largestKernel = false; // run the instantiation with all effects
    bool quiet = false;
    bool strict = false;
    bool bill = false;            // printed at the end
    std::optional<bool> preview;  // while it goes on; unless off
    std::optional<Vec2i> pixel;   // render this one alone and print it
    std::optional<double> memory; // MiB, the most that may be taken
    CheckpointOptions checkpoint;
    std::optional<PixelBounds> crop;
    std::optional<Vec2i> part;      // x of y equal ranges of the samples; a file for MergeOptions is written
    std::vector<std::string> parts; // nothing is rendered, but these are put together
};

struct CheckOptions {
    std::vector<std::string> paths; // "-": standard input
    std::string standsFor;          // the file that standard input is the text of
    std::vector<std::string> defines;
    bool fix = false;
    bool strict = false;
    bool textures = false; // read to their ends
    bool quiet = false;
};

struct ExplainOptions {
    std::string topic;    // a scene file, or words of the language; empty: the language itself
    bool effects = false; // of the scene; without a topic: those that there are
    BuildOptions build;   // camera, size, seed and pilot of the render that is explained
    std::vector<std::string> defines;
};

struct InfoOptions {
    std::string path;
    std::vector<std::string> defines;
};

struct ConvertOptions {
    std::string input, output;
    std::string layer;     // or a channel; empty: the picture
    bool overscan = false; // the whole data window
    ViewOptions view;
    int bits = 8;
};

// A bound on a figure of a comparison; exceeding it is exit code 4.
struct CompareThreshold {
    std::string figure; // a name that findCompareFigure knows
    double value = 0;
};

struct CompareOptions {
    std::string image;
    std::optional<std::string> other;    // there, or a reference is
    std::vector<std::string> references; // none: `other` is the reference
    std::vector<CompareThreshold> thresholds;
    std::optional<std::string> html;
    double pixelsPerDegree = kFlipPixelsPerDegree;
};

// Samples of a render that are taken again and told vertex by vertex.
struct ReplayOptions {
    RenderOptions render;           // how the samples were taken; its input is a scene or an image
    std::optional<Vec2i> pixel;     // absent, of an image: all that its header lists
    std::optional<SampleId> sample; // its replicate and index
};

struct CertifyOptions {
    std::string image;
    std::vector<std::string> references; // none, one, or two of different seeds
    ViewOptions view;
};

struct DoctorOptions {
    bool numerics = false; // measure hard cases, too
};

// What the program makes of its own tables.
struct ReferenceOptions {
    std::string what;   // "pages", "json", "man", "bash", "zsh", "fish", "share"
    std::string folder; // of "pages" and "share"
};

struct DenoiseOptions {
    std::string input, output; // no output: the input gets the layer
    DenoiseMethod method = DenoiseMethod::nfor;
};

struct StudyOptions {
    SceneInput input;
    std::string output;                  // DIR/NAME of NAME.html, .csv, .json; empty: the scene's name with "-study"
    BuildOptions build;                  // camera and size; without a size at most kStudySide pixels
    std::optional<std::int64_t> samples; // of the last rung; without it kStudySamples, or what the time allows
    int seeds = 8;
    std::optional<double> timeLimit; // s, of the whole study
    std::vector<std::string> variants;
    bool effects = false;                           // these are measured, in place of curves
    bool listVariants = false;                      // print them, and that is all
    std::vector<double> errors{0.01, 0.003, 0.001}; // relative, to tell the time to
    bool resume = false;
    bool quiet = false;
};

struct VerifyOptions {
    SceneInput input;
    BuildOptions build;                  // camera and size; without a size at most kVerifySide pixels
    double resolution = 0.001;           // relative standard error of the difference
    double timeLimit = 300;              // s
    std::optional<std::int64_t> samples; // per pixel of either, in place of the two
    double level = 0.001;                // of the test
    bool strict = false;
    bool quiet = false;
};

struct MergeOptions {
    std::vector<std::string> parts;
    std::string scene;  // empty: where it was when the first part was made
    std::string output; // EXR
    PngOptions png;
    ViewOptions view;
};

using Options = std::variant<RenderOptions, MergeOptions, CheckOptions, ExplainOptions, InfoOptions, ConvertOptions,
                             CompareOptions, VolumeOptions, DenoiseOptions, ReplayOptions, CertifyOptions, StudyOptions,
                             VerifyOptions, DoctorOptions, ReferenceOptions>;

// One function per command, each in its own file. They report what is wrong themselves; exceptions that leave them are
// system errors (IoError, std::bad_alloc) or bugs.
ExitCode run(const RenderOptions&, const CommonOptions&);
ExitCode run(const MergeOptions&, const CommonOptions&);
ExitCode run(const CheckOptions&, const CommonOptions&);
ExitCode run(const ExplainOptions&, const CommonOptions&);
ExitCode run(const InfoOptions&, const CommonOptions&);
ExitCode run(const ConvertOptions&, const CommonOptions&);
ExitCode run(const CompareOptions&, const CommonOptions&);
ExitCode run(const VolumeOptions&, const CommonOptions&);
ExitCode run(const DenoiseOptions&, const CommonOptions&);
ExitCode run(const ReplayOptions&, const CommonOptions&);
ExitCode run(const CertifyOptions&, const CommonOptions&);
ExitCode run(const StudyOptions&, const CommonOptions&);
ExitCode run(const VerifyOptions&, const CommonOptions&);
ExitCode run(const DoctorOptions&, const CommonOptions&);
ExitCode run(const ReferenceOptions&, const CommonOptions&);

} // namespace abbe
