#include "app/identity.h"
#include "app/json.h"
#include "base/memory_limit.h"
#include "base/parallel.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "doctor/numeric_check.h"
#include "io/file.h"
#include "io/ocio_view.h"
#include "textures/image_file.h"
#include "textures/texture_store.h"
#include "volumes/vdb_file.h"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>

namespace abbe {

const char* const kDoctorHelp = R"(Looks whether this machine and this installation have what renders need.

Examples:
  abbe doctor                 processor, memory, parts of the installation, folders
  abbe doctor --numerics      and numerically hard cases, measured here, in a few seconds
  abbe doctor --numerics --json)";

void addArguments(Arguments& a, DoctorOptions& o) {
    a.flag("--numerics", &o.numerics, "Measure numerically hard cases against their tolerances");
    addThreads(a);
    addJson(a);
}

namespace {

struct Finding {
    const char* name;
    bool good = true;
    std::string detail;
};

Finding processor() {
    std::string missing;
    const auto need = [&missing](bool there, const char* name) {
        if (!there) missing += (missing.empty() ? "" : ", ") + std::string(name);
    };
    need(__builtin_cpu_supports("avx2"), "AVX2");
    need(__builtin_cpu_supports("fma"), "FMA");
    need(__builtin_cpu_supports("bmi"), "BMI");
    need(__builtin_cpu_supports("bmi2"), "BMI2");
    need(__builtin_cpu_supports("popcnt"), "POPCNT");
    if (!missing.empty()) return {"processor", false, "lacks " + missing};
    return {"processor", true, fmt::format("has AVX2, FMA, BMI, BMI2 and POPCNT; {} threads are used", threadCount())};
}

Finding memory() {
    constexpr double mib = 1 << 20, least = 512;
    const double available = availableMemory() / mib, whole = physicalMemory() / mib;
    std::string detail = fmt::format("{:.0f} MiB", available);
    if (available < whole)
        detail += fmt::format(" of {:.0f} MiB, the limit of this process or its control group", whole);
    if (available < least) detail += "; below 512 MiB most pictures do not fit";
    return {"memory", available >= least, detail};
}

Finding colours() {
    const char* const named = std::getenv("OCIO");
    const std::string file = named ? named : ""; // none: the built-in one
    try {
        const OcioIdentity config = OcioView::identify(file);
        std::size_t views = 0;
        for (const DisplayViews& display : OcioView::list(file)) views += display.views.size();
        return {"colours", views > 0,
                fmt::format("OpenColorIO `{}`, {} views{}", config.name, views,
                            named && *named ? fmt::format(", from $OCIO = {}", named) : "")};
    } catch (const IoError& e) {
        return {"colours", false, e.what()};
    }
}

Finding pictures() {
    try {
        return {"images", true,
                fmt::format("the module that reads textures is there, version {}", imageModule().version)};
    } catch (const ImageFileError& e) {
        return {"images", false, e.what()};
    }
}

// An empty file is no volume: an answer that says so comes from a helper that works.
Finding volumes() {
    const auto answer = runVdbHelper({"info", "/dev/null"});
    const auto* const fault = std::get_if<VdbFault>(&answer);
    if (fault && fault->kind == VdbFault::Kind::helper) return {"volumes", false, fault->text};
    return {"volumes", true, "the helper `abbe-vdb`, which reads OpenVDB files, answers"};
}

bool writable(const std::filesystem::path& folder) { return ::access(folder.c_str(), W_OK | X_OK) == 0; }

Finding folders() {
    std::error_code error;
    const auto temporary = std::filesystem::temp_directory_path(error), here = std::filesystem::current_path(error);
    auto cache = textureCacheDirectory();
    const auto wanted = cache;
    while (!cache.empty() && !std::filesystem::exists(cache, error)) cache = cache.parent_path(); // made when needed
    std::string closed;
    for (const auto& folder : {here, temporary, cache})
        if (!folder.empty() && !writable(folder)) closed += (closed.empty() ? "" : ", ") + folder.string();
    if (!closed.empty()) return {"folders", false, "cannot write to " + closed};
    return {"folders", true,
            wanted.empty() ? "can write here; no folder for converted textures: HOME and XDG_CACHE_HOME are not set"
                           : fmt::format("can write here; textures are converted into {}", wanted.string())};
}

// Prints one line for each as it is found.
class Report {
  public:
    explicit Report(const CommonOptions& common) : common_(common) {}

    void add(const Finding& f) {
        good_ = good_ && f.good;
        findings_.push(Json::object({{"name", f.name}, {"ok", f.good}, {"detail", f.detail}}));
        say(fmt::format("{:9} {:10} {}", f.good ? "ok" : "FAULT", f.name, f.detail));
    }
    void add(const doctor::NumericCheck& check, double value) {
        const bool good = value <= check.tolerance; // not a number is not
        good_ = good_ && good;
        numerics_.push(Json::object({{"case", check.hardCase},
                                     {"title", check.title},
                                     {"measured", check.measured},
                                     {"value", value},
                                     {"tolerance", check.tolerance},
                                     {"ok", good}}));
        const std::string number = check.hardCase > 0 ? fmt::format("case {}", check.hardCase) : "machine";
        say(fmt::format("{:9} {:10} {}, {}: {:.2g}, at most {:g}", good ? "ok" : "FAULT", number, check.title,
                        check.measured, value, check.tolerance));
    }
    ExitCode finish(bool numerics) const {
        if (common_.json) {
            Json all = Json::object({{"version", versionNumber()}, {"ok", good_}, {"installation", findings_}});
            if (numerics) all.set("numerics", numerics_);
            common_.console.data(all.text(true) + "\n");
        }
        return good_ ? ExitCode::done : ExitCode::threshold;
    }

  private:
    void say(const std::string& line) const {
        if (!common_.json) common_.console.data(line + "\n");
    }

    const CommonOptions& common_;
    Json findings_ = Json::list(), numerics_ = Json::list();
    bool good_ = true;
};

} // namespace

ExitCode run(const DoctorOptions& options, const CommonOptions& common) {
    Report report(common);
    std::string version = versionText();
    if (const auto end = version.find('\n'); end != std::string::npos) version.replace(end, 1, "; ");
    report.add({"version", true, version});
    for (const auto find : {processor, memory, colours, pictures, volumes, folders}) report.add(find());
    if (options.numerics)
        for (const doctor::NumericCheck& check : doctor::numericChecks()) report.add(check, check.measure());
    return report.finish(options.numerics);
}

} // namespace abbe
