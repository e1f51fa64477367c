// A shot on many machines: what is rendered, in which pieces, and where they lie. All that is known of a shot is in one
// folder and in the queue of the engine that runs it; docs/farm.md describes both.
#pragma once

#include "app/console.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// What keeps a shot from going on.
struct FarmFault : CodedFault {
    using CodedFault::CodedFault;
};

enum class FarmEngineKind : std::uint8_t { slurm, local };

// How a shot can end.
enum class ShotOutcome : std::uint8_t {
    done,   // all images are there, and as good as they were to be
    limit,  // all images are there; of some the noise goal was not met by the most samples that they may have
    failed, // some tasks cannot be done, or were tried often enough
    cancelled,
};
const char* wordOf(ShotOutcome); // "done", "limit", "failed", "cancelled"
std::optional<ShotOutcome> outcomeNamed(std::string_view word);

// Samples of some frames that are rendered at once: [from, to) per pixel, all replicates together.
struct FarmRound {
    std::uint32_t from = 0, to = 0;
    int parts = 1; // of each frame
    std::vector<int> frames;
    int tries = 0; // how often what was missing in the end was submitted again
};

struct FarmPlan {
    std::string program;            // "abbe 0.1.0", set when it is written first: another one may take other samples
    std::string executable, folder; // the program, and where its words were given
    std::string scene;
    std::vector<std::string> renderWords; // flags of `abbe render` that all tasks have
    std::vector<std::string> mergeWords;  // flags of `abbe merge`: how the picture is shown
    std::string image;                    // pattern of the images' names; absolute
    bool animation = false;               // else a still, whose one frame has no number
    int width = 0, height = 0, replicates = 1;
    std::uint32_t samples = 0; // per pixel; of a noise goal: the most
    double noise = 0;          // goal, relative; 0: none
    double sampleSeconds = 0;  // measured: of a core, of one sample of one pixel
    int cores = 1;             // of a task
    double chunkSeconds = 600; // wall clock that a part should take
    int parts = 0;             // of each frame in each round; 0: as many as take so long
    FarmEngineKind engine = FarmEngineKind::slurm;
    int atOnce = 1;                       // tasks of the local engine
    int mostTries = 2;                    // FarmRound::tries
    std::vector<std::string> sbatchWords; // further options of every job
    bool cancelled = false;             // that is in a file of its own, which whoever holds the plan does not overwrite
    std::optional<ShotOutcome> outcome; // once it is over
    std::string said;                   // a sentence about that
    std::vector<FarmRound> rounds;
    std::vector<std::string> jobs;      // of the engine, in the order in which they were submitted
    std::map<std::string, int> offsets; // of array jobs: what their indices have to be added to
};

// A piece of a round.
struct FarmTask {
    enum class Kind : std::uint8_t { part, gather, merge };
    Kind kind = Kind::part;
    int round = 0; // index
    int frame = 0;
    int piece = 0; // of the frame, from 1: which part, or which group of parts
};
const char* wordOf(FarmTask::Kind); // "part", "gather", "merge"

// More parts of a frame than this are first gathered into groups, so that no merge reads more files than the square
// root.
inline constexpr int kMostMergedParts = 24;
// Parts in one group, and groups of a frame; 0 groups: they are merged at once.
int groupSize(const FarmRound&);
int groupCount(const FarmRound&);

// So many parts of a frame take about FarmPlan::chunkSeconds each; no part is without samples.
int partsOf(const FarmPlan&, std::uint32_t from, std::uint32_t to);

// All of one kind in a round, in the order of their numbers, which begin at 1.
std::vector<FarmTask> tasksOf(const FarmPlan&, int round, FarmTask::Kind);
// The number of one of them.
int numberOf(const FarmPlan&, const FarmTask&);

// The folder of a shot.
class FarmFolder {
  public:
    explicit FarmFolder(std::string path) : path_(std::move(path)) {}

    const std::string& path() const { return path_; }
    std::string planFile() const { return path_ + "/plan.json"; }
    std::string cancelFile() const { return path_ + "/cancelled"; }
    bool isCancelled() const;
    // "r1.0012.p3", "r1.0012.g2", "r1.0012": of a round, a frame and a piece.
    std::string nameOf(const FarmPlan&, const FarmTask&) const;
    // What the task has to say as it goes on, line by line, and how it ended.
    std::string eventsFile(const FarmPlan& plan, const FarmTask& task) const {
        return path_ + "/tasks/" + nameOf(plan, task) + ".jsonl";
    }
    std::string resultFile(const FarmPlan& plan, const FarmTask& task) const {
        return path_ + "/tasks/" + nameOf(plan, task) + ".json";
    }
    std::string logFile(const FarmPlan& plan, const FarmTask& task) const {
        return path_ + "/log/" + nameOf(plan, task) + ".log";
    }
    // The file that the task makes: a part, or the image.
    std::string outputOf(const FarmPlan&, const FarmTask&) const;
    // The same, as far as it is given to `abbe render -o`, which adds the part's number.
    std::string partPattern(const FarmPlan&, const FarmTask&) const;
    // What a gathering or a merge puts together: of this round and, for an image, of all rounds before it.
    std::vector<std::string> inputsOf(const FarmPlan&, const FarmTask&) const;

    // The words of `abbe` that do it.
    std::vector<std::string> commandOf(const FarmPlan&, const FarmTask&) const;

    // Throws FarmFault where there is no shot, or one of another version of the program; IoError.
    FarmPlan readPlan() const;
    void writePlan(const FarmPlan&) const;
    // Throws IoError.
    void setCancelled(bool) const;

  private:
    std::string path_;
};

// What a sample of a scene costs, measured before it is divided into parts.
// Seconds of a core for one sample of one pixel, from a small render of the first frame on this machine: some seconds,
// a thousandth of what a shot of hours takes. Leaves nothing behind. Throws FarmFault if the scene does not render.
double measureSample(const FarmPlan&, const FarmFolder&);

} // namespace abbe
