// All commands of the program. Help, man page, completions and the parser are made of the table in command_table.cpp:
// nothing else lists them. Here is what each command is asked to do, with the three names that every one has; NAME.cpp
// has the rest of it.
#pragma once

#include "app/load.h"
#include "command_line/command.h"
#include "denoise/denoise.h"
#include "io/flip.h"
#include "pictures/display_view.h"
#include "pictures/image_output.h"
#include "render_run/render_options.h"
#include "scene/build.h"
#include "view/view_session.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace abbe {

// `abbe render`: a picture of a scene.
extern const char* const kRenderHelp;
void addArguments(Arguments&, RenderOptions&);
ExitCode run(const RenderOptions&, const CommonOptions&);

// `abbe merge`: parts of a render, put together to the bits of the whole.
struct MergeOptions {
    std::vector<std::string> parts;
    std::string scene;  // empty: where it was when the first part was made
    std::string output; // EXR, or a part (.abbe)
    bool soFar = false; // also where samples are missing
    PngOptions png;
    ViewOptions view;
    std::vector<std::string> search;

    static bool makesFiles() { return true; }
};

extern const char* const kMergeHelp;
// A render of the same scene, with the same settings, that finds all its samples done. Throws CheckpointFault, IoError.
RenderOptions renderOf(const MergeOptions&);
void addArguments(Arguments&, MergeOptions&);
ExitCode run(const MergeOptions&, const CommonOptions&);

// `abbe convert`: a PNG of an image or of one of its layers.
struct ConvertOptions {
    std::string input, output;
    std::string layer;     // or a channel; empty: the picture
    bool overscan = false; // the whole data window
    ViewOptions view;
    int bits = 8;
};

extern const char* const kConvertHelp;
void addArguments(Arguments&, ConvertOptions&);
ExitCode run(const ConvertOptions&, const CommonOptions&);

// `abbe view`: a page that shows a scene while it is being edited.
extern const char* const kViewHelp;
void addArguments(Arguments&, ViewRequest&);
ExitCode run(const ViewRequest&, const CommonOptions&);

// `abbe denoise`: a denoised layer for an image.
struct DenoiseOptions {
    std::string input, output; // no output: the input gets the layer
    std::optional<DenoiseMethod> method;
    bool preview = false; // another word for that method
};

extern const char* const kDenoiseHelp;
void addArguments(Arguments&, DenoiseOptions&);
ExitCode run(const DenoiseOptions&, const CommonOptions&);

// `abbe check`: what is wrong with scenes, without rendering.
struct CheckOptions {
    std::vector<std::string> paths; // "-": standard input
    std::string standsFor;          // the file that standard input is the text of
    std::vector<std::string> defines;
    LayerChoice layers;
    std::optional<int> frame;
    bool fix = false;
    bool strict = false;
    bool textures = false; // read to their ends
    bool quiet = false;
};

extern const char* const kCheckHelp;
void addArguments(Arguments&, CheckOptions&);
ExitCode run(const CheckOptions&, const CommonOptions&);

// `abbe fmt`: scene files in one layout.
struct FmtOptions {
    std::vector<std::string> paths; // "-": standard input
    std::string standsFor;          // what standard input is called
    bool standardInput = false;
    bool check = false; // these two write nothing
    bool diff = false;
    bool upgrade = false; // state the edition
    bool tree = false;    // print the nodes as JSON instead
    bool quiet = false;
};

extern const char* const kFmtHelp;
void addArguments(Arguments&, FmtOptions&);
ExitCode run(const FmtOptions&, const CommonOptions&);

// `abbe import`: a scene file of a scene of another program.
struct ImportOptions {
    std::string path;
    std::string output; // empty: named after the foreign file, in the current folder
    bool force = false; // replaces a file that is there
    std::string camera; // of a stage
    std::optional<int> frame;
    std::vector<std::string> search;

    static bool makesFiles() { return true; }
};

extern const char* const kImportHelp;
void addArguments(Arguments&, ImportOptions&);
ExitCode run(const ImportOptions&, const CommonOptions&);

// `abbe export`: a scene for another program.
enum class ExportTarget : std::uint8_t { mitsuba, pbrt, gltf, usda };
struct ExportOptions {
    std::string path;
    ExportTarget to = ExportTarget::mitsuba;
    std::string output; // empty: named after the scene, in the current folder
    bool force = false; // replaces a file that is there
    std::vector<std::string> defines;
    LayerChoice layers;

    static bool makesFiles() { return true; }
};

extern const char* const kExportHelp;
void addArguments(Arguments&, ExportOptions&);
ExitCode run(const ExportOptions&, const CommonOptions&);

// `abbe pack`: a scene with all that it reads.
struct PackOptions {
    std::string path;
    std::string output; // a pack, or a folder with a slash at its end
    std::vector<std::string> defines;
    LayerChoice layers;

    static bool makesFiles() { return true; }
};

extern const char* const kPackHelp;
void addArguments(Arguments&, PackOptions&);
ExitCode run(const PackOptions&, const CommonOptions&);

// `abbe explain`: a scene, a word of the language, or a diagnostic.
struct ExplainOptions {
    std::string topic;    // a scene file, or words of the language; empty: the language itself
    bool effects = false; // of the scene; without a topic: those that there are
    BuildOptions build;   // camera, size, seed and pilot of the render that is explained
    std::vector<std::string> defines;
    LayerChoice layers;
    std::optional<int> frame;
};

extern const char* const kExplainHelp;
void addArguments(Arguments&, ExplainOptions&);
ExitCode run(const ExplainOptions&, const CommonOptions&);

// `abbe info`: what is in a scene or in an image.
struct InfoOptions {
    std::string path;
    std::vector<std::string> defines;
    LayerChoice layers;
    std::optional<int> frame;
};

extern const char* const kInfoHelp;
void addArguments(Arguments&, InfoOptions&);
ExitCode run(const InfoOptions&, const CommonOptions&);

// `abbe compare`: how much images differ.

// A bound on a figure of a comparison; exceeding it is exit code 4.
struct CompareThreshold {
    std::string figure; // a name that findCompareFigure knows
    double value = 0;
};
// "relmse=0.01", or a number alone for relMSE; else what is wrong with it.
std::variant<CompareThreshold, std::string> readThreshold(const std::string& text);

struct CompareOptions {
    std::string image;
    std::optional<std::string> other;    // there, or a reference is
    std::vector<std::string> references; // none: `other` is the reference
    std::vector<CompareThreshold> thresholds;
    std::optional<std::string> html;
    double pixelsPerDegree = kFlipPixelsPerDegree;
};

extern const char* const kCompareHelp;
void addArguments(Arguments&, CompareOptions&);
ExitCode run(const CompareOptions&, const CommonOptions&);

// `abbe certify`: how wrong an image is, measured against what it says of itself.
struct CertifyOptions {
    std::string image;
    std::vector<std::string> references; // none, one, or two of different seeds
    ViewOptions view;
};

extern const char* const kCertifyHelp;
void addArguments(Arguments&, CertifyOptions&);
ExitCode run(const CertifyOptions&, const CommonOptions&);

// `abbe verify`: two independent estimators of one scene, and whether they agree.
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

extern const char* const kVerifyHelp;
void addArguments(Arguments&, VerifyOptions&);
ExitCode run(const VerifyOptions&, const CommonOptions&);

// `abbe study`: what accuracy costs in time on a scene.
struct StudyOptions {
    SceneInput input;
    std::string output;                  // DIR/NAME of NAME.html, .csv, .json; empty: the scene's name with "-study"
    BuildOptions build;                  // camera and size; without a size at most kStudySide pixels
    std::optional<std::int64_t> samples; // of the last rung; without it kStudySamples, or what the time allows
    int seeds = 8;
    std::optional<double> timeLimit; // s, of the whole study
    std::vector<std::string> variants;
    bool effects = false;                           // these are measured, in place of curves
    std::string against;                            // another renderer: "mitsuba", perhaps with ":variant"
    bool listVariants = false;                      // print them, and that is all
    std::vector<double> errors{0.01, 0.003, 0.001}; // relative, to tell the time to
    bool resume = false;
    bool quiet = false;

    static bool makesFiles() { return true; }
};

extern const char* const kStudyHelp;
void addArguments(Arguments&, StudyOptions&);
ExitCode run(const StudyOptions&, const CommonOptions&);

// `abbe replay`: samples of a render that are taken again and reported vertex by vertex.
struct ReplayOptions {
    RenderOptions render;           // how the samples were taken; its input is a scene or an image
    std::optional<Vec2i> pixel;     // absent, of an image: all that its header lists
    std::optional<SampleId> sample; // its replicate and index
};

extern const char* const kReplayHelp;
void addArguments(Arguments&, ReplayOptions&);
ExitCode run(const ReplayOptions&, const CommonOptions&);

// `abbe volume`: OpenVDB files, what is in them, procedural ones, and converted ones. Each action is a command.
struct VolumeInfoOptions {
    std::string input;
};

struct VolumeMakeOptions {
    std::string kind; // "cumulus", as the helper knows it
    std::string output;
    int resolution = 200; // voxels along the longest side
    std::uint32_t seed = 0;
    bool quiet = false;
};

struct VolumeConvertOptions {
    std::string input, output;
    std::vector<std::string> grids; // empty: all
    double resample = 1;            // size of the new voxels in old ones
    bool fog = false, clean = false, half = false;
    std::optional<float> prune;
    std::vector<double> crop; // corners of a box in the file's world: empty or six numbers
};

extern const char* const kVolumeHelp;
std::span<const CommandEntry> volumeActions();

void addArguments(Arguments&, VolumeInfoOptions&);
void addArguments(Arguments&, VolumeMakeOptions&);
void addArguments(Arguments&, VolumeConvertOptions&);
ExitCode run(const VolumeInfoOptions&, const CommonOptions&);
ExitCode run(const VolumeMakeOptions&, const CommonOptions&);
ExitCode run(const VolumeConvertOptions&, const CommonOptions&);

// `abbe lsp`: what editors start.
struct LspOptions {
    bool stdio = false;
};

extern const char* const kLspHelp;
void addArguments(Arguments&, LspOptions&);
ExitCode run(const LspOptions&, const CommonOptions&);

// `abbe reference`: what the program makes of its own tables.
struct ReferenceOptions {
    enum class What : std::uint8_t { pages, json, jsonSchema, textmate, man, bash, zsh, fish, share };
    What what = What::pages;
    std::string where; // the folder of pages and share; of man a command, or empty
};

extern const char* const kReferenceHelp;
void addArguments(Arguments&, ReferenceOptions&);
ExitCode run(const ReferenceOptions&, const CommonOptions&);

// `abbe doctor`: whether machine and installation have what renders need.
struct DoctorOptions {
    bool numerics = false; // measure hard cases, too
};

extern const char* const kDoctorHelp;
void addArguments(Arguments&, DoctorOptions&);
ExitCode run(const DoctorOptions&, const CommonOptions&);

// `abbe help`: all commands, one of them, or a word of the scene language.
struct HelpOptions {
    std::vector<std::string> topic; // a command, or words of the language; empty: all commands
};

extern const char* const kHelpHelp;
void addArguments(Arguments&, HelpOptions&);
ExitCode run(const HelpOptions&, const CommonOptions&);

const CommandTable& commandTable();

} // namespace abbe
