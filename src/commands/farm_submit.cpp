// From a scene and the flags of a render to the plan of a shot.
#include "app/frame_list.h"
#include "app/load.h"
#include "base/parallel.h"
#include "base/path_lock.h"
#include "base/process.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "commands/farm.h"
#include "farm/farm_engine.h"
#include "farm/farm_plan.h"
#include "farm/rounds.h"
#include "film/film_params.h"
#include "pictures/image_output.h"
#include "scene/build.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fmt/format.h>
#include <set>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kMostGoalSamples = 65536; // of a noise goal, unless --samples says otherwise
constexpr std::uint32_t kFirstSamples = 32;       // of its first round

// Flags that the plan decides itself, or that have no meaning for a part.
const std::set<std::string_view> kOwnFlags{"-o",        "--output",   "--frames", "--samples", "--noise", "--time",
                                           "--skip",    "--part",     "--resume", "--preview", "--json",  "--quiet",
                                           "-q",        "--threads",  "-t",       "--strict",  "--cost",  "--bill",
                                           "--pixel",   "--progress", "--folder", "--engine",  "--parts", "--chunk",
                                           "--at-once", "--sbatch",   "--tries",  "--print",   "--color", "--format"};
const std::set<std::string_view> kPictureFlags{"--png", "--display", "--view", "--ocio", "--exposure"};

// Which argument a word such as "--size=64x64", "-ofile" names, and how long that name is.
struct NamedFlag {
    const Argument* argument = nullptr;
    std::string name;
    bool valueAttached = false;
    std::string value;
};

NamedFlag flagOf(const std::string& word, const Arguments& all) {
    const bool isLong = word.starts_with("--");
    const std::string name = isLong ? word.substr(0, word.find('=')) : word.substr(0, 2);
    for (const Argument& argument : all.all()) {
        const std::string names = "," + argument.names + ",";
        if (!argument.isFlag() || names.find("," + name + ",") == std::string::npos) continue;
        NamedFlag flag{&argument, name, word.size() > name.size(), {}};
        if (flag.valueAttached) flag.value = word.substr(name.size() + (word[name.size()] == '=' ? 1 : 0));
        return flag;
    }
    return {nullptr, name, false, {}};
}

struct DividedWords {
    std::vector<std::string> render, merge;
};

// The flags of the command line that parts and merges get, each as one word: "--size=64x64". Files in them count from
// where the command was given, as they do for the tasks.
DividedWords divideWords(const FarmSubmitOptions& options, const CommonOptions& common) {
    FarmSubmitOptions scratch = options;
    CommonOptions ignored;
    Arguments all(ignored);
    addArguments(all, scratch);
    DividedWords divided;
    const std::vector<std::string>& words = common.words;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (!words[i].starts_with('-') || words[i] == "--") continue;
        NamedFlag flag = flagOf(words[i], all);
        const bool hasValue = flag.argument && !flag.argument->value.empty();
        if (hasValue && !flag.valueAttached && !flag.argument->valueOptional && i + 1 < words.size())
            flag.value = words[++i];
        if (kOwnFlags.contains(flag.name)) continue;
        std::vector<std::string>& to = kPictureFlags.contains(flag.name) ? divided.merge : divided.render;
        const bool bare = !hasValue || (flag.value.empty() && flag.argument->valueOptional);
        if (bare)
            to.push_back(flag.name);
        else if (flag.name.starts_with("--"))
            to.push_back(flag.name + "=" + flag.value);
        else
            to.insert(to.end(), {flag.name, flag.value});
    }
    return divided;
}

// What a divided render cannot do.
void refuseContradictions(const RenderOptions& render) {
    const auto refuse = [](const char* flag, const char* why, const char* help) {
        throw FarmFault("E0764", fmt::format("{}: {}", flag, why), help);
    };
    if (render.build.timeLimit)
        refuse("--time", "a shot is divided by samples, not by the clock", "give --samples or --noise");
    if (render.part || render.skip > 0) refuse("--part", "the shot divides the render itself", "leave it out");
    for (const auto& [flag, file] : {std::pair("--contact-sheet", render.sheet), std::pair("--clip", render.clip)})
        if (!file.empty())
            refuse(flag, "a shot is made of parts, which make no pictures of frames",
                   "leave it out; it shows frames that `abbe render --frames` makes");
    if (render.pixel) refuse("--pixel", "one pixel is no shot", "`abbe render --pixel` looks at one");
}

std::string defaultFolder(const std::string& image) {
    std::string stem = fs::path(image).stem().string();
    stem.erase(std::remove(stem.begin(), stem.end(), '#'), stem.end());
    while (!stem.empty() && (stem.back() == '.' || stem.back() == '_' || stem.back() == '-')) stem.pop_back();
    return (fs::path(image).parent_path() / (stem.empty() ? "shot" : stem)).string() + ".farm";
}

// Cores of a task without --threads: of Slurm's smallest node, so that a part has one to itself; of this machine.
int usualCores(const FarmSubmitOptions& options) {
    if (options.engine == FarmEngineKind::local) return std::max(1, threadCount() / options.atOnce);
    const ProcessEnd end = runProcess({"sinfo", "--noheader", "--format=%c"});
    int least = 0;
    for (std::size_t at = 0; at < end.out.size(); at = std::min(end.out.find('\n', at), end.out.size() - 1) + 1) {
        int cores = 0;
        std::from_chars(end.out.data() + at, end.out.data() + end.out.size(), cores);
        if (cores > 0) least = least == 0 ? cores : std::min(least, cores);
    }
    return std::max(1, least);
}

// All but the measured cost and the rounds. Throws FarmFault; what is wrong with the scene was reported, and there is
// none.
std::optional<FarmPlan> planOf(const FarmSubmitOptions& options, const CommonOptions& common) {
    refuseContradictions(options.render);
    const auto loaded = loadScene(options.render.input);
    BuildOptions build = options.render.build;
    build.geometry = false;
    BuiltScene built;
    if (loaded->readable) built = buildScene(loaded->tree, loaded->types, build, loaded->diagnostics);
    common.console.report(loaded->diagnostics, loaded->sources);
    if (loaded->exitCode() != ExitCode::done) return std::nullopt;
    const FilmSettings film = filmSettings(built.film);
    FarmPlan plan;
    const DividedWords words = divideWords(options, common);
    plan.executable = fs::read_symlink("/proc/self/exe").string();
    plan.folder = fs::current_path().string();
    plan.scene = fs::absolute(options.render.input.path).string();
    plan.renderWords = words.render;
    plan.mergeWords = words.merge;
    // Goals of the scene are those of the shot, not of its parts.
    plan.renderWords.insert(plan.renderWords.end(), {"--noise=0", "--time=0"});
    // The environment of a machine of the farm may be another one.
    for (const fs::path& folder : foldersOfEnvironment()) plan.renderWords.push_back("--search=" + folder.string());
    plan.image = fs::absolute(imagePath(options.render.output, film, options.render.input.path)).string();
    plan.animation = !options.render.frames.empty();
    plan.width = film.width;
    plan.height = film.height;
    plan.replicates = static_cast<int>(built.render.replicates);
    plan.noise = options.render.build.noise.value_or(built.render.noise);
    plan.samples = static_cast<std::uint32_t>(built.render.samples);
    if (plan.noise > 0 && !options.render.build.samples) plan.samples = kMostGoalSamples;
    if (plan.noise > 0 && built.render.adaptive)
        throw FarmFault("E0764", "`adaptive` plans all samples at once, a noise goal of a shot takes them in rounds",
                        "leave one of them out: `--adaptive off`, or --samples without --noise");
    // Pilots of rounds have to be alike, whatever the number of samples of a round is.
    if (plan.noise > 0 && !options.render.build.pilot)
        plan.renderWords.push_back(fmt::format("--pilot={}", RenderSettings::kMostPilot));
    plan.engine = options.engine;
    plan.atOnce = options.atOnce;
    plan.mostTries = options.tries;
    plan.chunkSeconds = options.chunk;
    plan.parts = options.parts.value_or(0);
    plan.sbatchWords = options.sbatch;
    plan.cores = common.threads > 0 ? common.threads : usualCores(options);
    return plan;
}

// A folder for the shot, in which there is none. Throws FarmFault, std::filesystem::filesystem_error.
void makeFolder(const FarmFolder& folder) {
    for (const char* name : {"/parts", "/tasks", "/log", "/slurm"}) fs::create_directories(folder.path() + name);
}

// What makeFolder() made, as far as nothing is in it.
void removeEmptyFolder(const FarmFolder& folder) {
    std::error_code notEmpty;
    for (const char* name : {"/parts", "/tasks", "/log", "/slurm", ""}) fs::remove(folder.path() + name, notEmpty);
}

// Of one that nobody knows of yet.
void removeShot(const FarmFolder& folder) {
    std::error_code ignored;
    fs::remove(folder.planFile(), ignored);
    for (const auto& entry : fs::directory_iterator(folder.path() + "/slurm", ignored))
        fs::remove(entry.path(), ignored);
    removeEmptyFolder(folder);
}

void refuseOtherShot(const FarmFolder& folder, const PathLock& lock) {
    if (!lock.refused() && !fs::exists(folder.planFile())) return;
    throw FarmFault(
        "E0761",
        lock.refused() ? fmt::format("another process is submitting a shot to `{}`", folder.path())
                       : fmt::format("there is a shot in `{}` already", folder.path()),
        fmt::format("`abbe farm resume {}` goes on with it; `--folder` puts this one elsewhere", folder.path()));
}

void planFirstRound(FarmPlan& plan, const FarmFolder& folder, const std::vector<int>& frames) {
    const auto replicates = static_cast<std::uint32_t>(plan.replicates);
    plan.samples = (plan.samples + replicates - 1) / replicates * replicates;
    FarmRound first;
    first.to = plan.noise > 0 ? std::min(plan.samples, std::max(replicates, kFirstSamples / replicates * replicates))
                              : plan.samples;
    first.frames = frames.empty() ? std::vector<int>{0} : frames;
    plan.rounds = {first};
    plan.sampleSeconds = measureSample(plan, folder);
    plan.rounds[0].parts = partsOf(plan, 0, first.to);
}

std::string planText(const FarmPlan& plan, const FarmFolder& folder) {
    const FarmRound& r = plan.rounds[0];
    const double seconds = plan.sampleSeconds * plan.width * plan.height * (r.to - r.from) / r.parts / plan.cores;
    return fmt::format("{}: {} of {}x{}, {} samples{} in {} part{} of about {:.3g} s on {} core{}", folder.path(),
                       plan.animation ? fmt::format("{} frames", r.frames.size()) : std::string("one image"),
                       plan.width, plan.height, r.to, plan.noise > 0 ? " to begin with" : "", r.parts,
                       r.parts == 1 ? "" : "s", seconds, plan.cores, plan.cores == 1 ? "" : "s");
}

ExitCode submit(const FarmSubmitOptions& options, const CommonOptions& common) {
    std::optional<FarmPlan> plan = planOf(options, common);
    if (!plan) return ExitCode::faulty;
    const FarmFolder folder(
        fs::absolute(options.folder.empty() ? defaultFolder(plan->image) : options.folder).lexically_normal().string());
    makeFolder(folder);
    const PathLock lock(folder.planFile(), 1);
    refuseOtherShot(folder, lock);
    try {
        planFirstRound(*plan, folder, options.render.frames);
    } catch (const FarmFault&) {
        removeEmptyFolder(folder);
        throw;
    }
    const RoundWork work = workOf(*plan, 0);
    common.console.line(planText(*plan, folder));
    if (options.print) {
        for (const std::string& script : writeSlurmScripts(folder, *plan, work)) common.console.data(script + "\n");
        folder.writePlan(*plan);
        return ExitCode::done;
    }
    folder.writePlan(*plan);
    const auto engine = makeEngine(plan->engine, folder);
    try {
        engine->submit(*plan, work);
    } catch (const FarmFault&) {
        if (plan->jobs.empty()) removeShot(folder); // nothing was submitted
        throw;
    }
    if (engine->signal() != 0) {
        common.console.line(fmt::format("to go on:  abbe farm resume {}", shellQuoted(folder.path())));
        return static_cast<ExitCode>(128 + engine->signal());
    }
    if (!engine->closesItself()) return goOn(*plan, folder, 0, common);
    common.console.line(fmt::format("submitted as jobs {} to {};  abbe farm watch {}", plan->jobs.front(),
                                    plan->jobs.back(), shellQuoted(folder.path())));
    return ExitCode::done;
}

} // namespace

void addArguments(Arguments& a, FarmSubmitOptions& o) {
    constexpr const char* kFarm = "Of the farm";
    addArguments(a, o.render);
    a.value("--folder", "DIR", &o.folder, "Folder of the shot; without it the image's name with .farm").under(kFarm);
    a.choice<FarmEngineKind>("--engine", o.engine, {{"slurm", FarmEngineKind::slurm}, {"local", FarmEngineKind::local}},
                             "local: processes of this machine, until all is done")
        .under(kFarm);
    a.read("--chunk", "TIME", o.chunk, "a time such as 10min", readTime, "How long a part should take, 10min")
        .under(kFarm);
    a.value("--parts", "N", &o.parts, "Parts of each frame, however long they take").between(1, 100000).under(kFarm);
    a.value("--at-once", "N", &o.atOnce, "Tasks of the local engine at a time").between(1, 1024).under(kFarm);
    a.value("--tries", "N", &o.tries, "How often what failed is tried again, 2").between(0, 100).under(kFarm);
    a.value("--sbatch", "OPTION", &o.sbatch, "Option for every Slurm job: --sbatch=--partition=night; may be repeated")
        .under(kFarm);
    a.flag("--print", &o.print, "Write the sbatch scripts, and submit nothing").under(kFarm);
}

ExitCode run(const FarmSubmitOptions& options, const CommonOptions& common) {
    try {
        return reportingFaults(common.console, [&] { return submit(options, common); });
    } catch (const fs::filesystem_error& e) {
        common.console.error(e.what());
        return ExitCode::system;
    }
}

} // namespace abbe
