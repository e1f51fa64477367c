#include "app/json.h"
#include "app/program_end.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "io/file.h"
#include "volumes/vdb_file.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace abbe {

const char* const kVolumeHelp = R"(Inspects, makes and converts OpenVDB volumes.

Examples:
  abbe volume info cloud.vdb
  abbe volume make cumulus cloud.vdb --resolution 1000
  abbe volume convert bunny.vdb fog.vdb --fog)";

namespace {

constexpr const char* kVolumeInfoHelp =
    R"(Tells what is in an OpenVDB file: grids, bounds, voxels, ranges, and what looks wrong.

Examples:
  abbe volume info cloud.vdb
  abbe volume info --json cloud.vdb)";

constexpr const char* kMakeHelp = R"(Makes a procedural volume and writes it as OpenVDB.

  cumulus   1 km wide: density
  smoke     a plume of 6 m: density, velocity
  fire      2 m high: density, temperature, flame
  candle    a flame of 3 cm: density, temperature, flame

Examples:
  abbe volume make cumulus cloud.vdb --resolution 1000
  abbe volume make smoke plume.vdb --seed 7)";

constexpr const char* kConvertHelp = R"(Rewrites an OpenVDB file: some of its grids, coarser, smaller, as fog, cropped.

Examples:
  abbe volume convert bunny.vdb fog.vdb --fog           a level set becomes fog
  abbe volume convert cloud.vdb small.vdb --resample 2 --half
  abbe volume convert sim.vdb out.vdb --grid density --clean --prune 0.001)";

constexpr CommandEntry kActions[] = {{"info", "", kVolumeInfoHelp, makeCommand<VolumeInfoOptions>},
                                     {"make", "", kMakeHelp, makeCommand<VolumeMakeOptions>},
                                     {"convert", "", kConvertHelp, makeCommand<VolumeConvertOptions>}};

} // namespace

std::span<const CommandEntry> volumeActions() { return kActions; }

void addArguments(Arguments& a, VolumeInfoOptions& o) {
    a.argument("file", &o.input, "OpenVDB or NanoVDB file").require();
    addJson(a);
}

void addArguments(Arguments& a, VolumeMakeOptions& o) {
    const auto word = [](const char* kind) { return Choice<const char*>{kind, kind}; };
    a.choice<const char*>("kind", o.kind, {word("cumulus"), word("smoke"), word("fire"), word("candle")},
                          "What is made")
        .require();
    a.argument("output", &o.output, "OpenVDB file to write").require();
    a.value("--resolution", "N", &o.resolution, "Voxels along the longest side").between(8, 4000);
    a.value("--seed", "N", &o.seed, "Another one of its kind");
    a.flag("--quiet,-q", &o.quiet, "Say nothing but errors");
}

void addArguments(Arguments& a, VolumeConvertOptions& o) {
    a.argument("input", &o.input, "OpenVDB or NanoVDB file").require();
    a.argument("output", &o.output, "OpenVDB file to write").require();
    a.value("--grid", "NAME", &o.grids, "Only this grid; may be repeated");
    a.value("--resample", "FACTOR", &o.resample, "Size of the new voxels in old ones: 2 is an eighth of them")
        .between(0.1, 64);
    a.flag("--fog", &o.fog, "Level sets become fog: 1 inside, 0 outside");
    a.flag("--clean", &o.clean, "Values that are not finite or negative, and the background, become 0");
    a.flag("--half", &o.half, "Store 16 bits a number");
    a.value("--prune", "TOLERANCE", &o.prune, "Merge voxels that differ by no more than this")
        .between(0, std::numeric_limits<double>::infinity());
    a.value("--crop", "X,Y,Z,X,Y,Z", &o.crop, "Keep this box of the file's world: two corners").numbers = 6;
}

namespace {

// --- info

// What a user would want to know before rendering the grid.
std::vector<std::string> doubts(const VdbGridInfo& g) {
    std::vector<std::string> list;
    const auto count = [&](std::uint64_t n, const char* text) {
        if (n > 0) list.push_back(fmt::format("{} {}", n, text));
    };
    if (!g.affine) list.push_back("lies in a frustum: not rendered");
    if (g.singular) list.push_back("its transform has no inverse: not rendered");
    if (g.type == "ptdataidx32" || g.type == "ptidx32") list.push_back("points: not rendered");
    if (g.volumeClass == "level set") list.push_back("a level set: fog only after `abbe volume convert --fog`");
    count(g.notFinite, "values are not finite and count as 0");
    if (g.volumeClass != "level set") count(g.negative, "values are negative and count as 0 in amounts");
    count(g.inactiveValues, "inactive values differ from the background and count as 0");
    if (g.read && g.background != 0 && g.volumeClass != "level set")
        list.push_back(fmt::format("the background is {} and counts as 0", g.background));
    if (g.read && g.activeVoxels == 0) list.push_back("empty");
    return list;
}

struct WorldBox {
    Bounds3d box;
    Vec3d voxel; // edge lengths
};

WorldBox worldBox(const VdbGridInfo& g) {
    WorldBox w;
    for (int corner = 0; corner < 8; ++corner) {
        const auto side = [&](int bit, int low, int high) { return corner >> bit & 1 ? high + 0.5 : low - 0.5; };
        w.box.add(g.indexToWorld.point(
            {side(0, g.lower.x, g.upper.x), side(1, g.lower.y, g.upper.y), side(2, g.lower.z, g.upper.z)}));
    }
    w.voxel = {length(g.indexToWorld.vector({1, 0, 0})), length(g.indexToWorld.vector({0, 1, 0})),
               length(g.indexToWorld.vector({0, 0, 1}))};
    return w;
}

bool placed(const VdbGridInfo& g) { return g.affine && !g.singular && g.activeVoxels > 0; }

template <typename T> Json json(const Vec3T<T>& v) {
    Json list = Json::list();
    list.push(v.x).push(v.y).push(v.z);
    return list;
}

Json json(const std::vector<std::pair<std::string, std::string>>& metadata) {
    Json object = Json::object();
    for (const auto& [name, value] : metadata) object.set(name, value);
    return object;
}

Json json(const VdbGridInfo& g) {
    Json object = Json::object({{"name", g.name},
                                {"type", g.type},
                                {"class", g.volumeClass},
                                {"unit", g.unit},
                                {"half", g.half},
                                {"active_voxels", g.activeVoxels},
                                {"active_tiles", g.activeTiles},
                                {"leaves", g.leaves},
                                {"memory_bytes", g.memoryBytes}});
    if (placed(g)) {
        const WorldBox w = worldBox(g);
        object.set("bounds", Json::object({{"lower", json(w.box.lower)}, {"upper", json(w.box.upper)}}));
        object.set("voxels", Json::object({{"lower", json(g.lower)}, {"upper", json(g.upper)}}));
        object.set("voxel_size", json(w.voxel));
    }
    if (g.read) {
        object.set("minimum", g.minimum).set("maximum", g.maximum).set("background", g.background);
        object.set("not_finite", g.notFinite).set("negative", g.negative).set("inactive_values", g.inactiveValues);
    }
    Json warnings = Json::list();
    for (const std::string& doubt : doubts(g)) warnings.push(doubt);
    return object.set("warnings", std::move(warnings)).set("metadata", json(g.metadata));
}

std::string text(const VdbGridInfo& g) {
    std::string s =
        fmt::format("\ngrid         {}  ({}{}, {})\n", g.name, g.type, g.half ? " stored as half" : "", g.volumeClass);
    if (!g.unit.empty()) s += fmt::format("unit         {}\n", g.unit);
    if (placed(g)) {
        const WorldBox w = worldBox(g);
        const Vec3d a = w.box.lower, b = w.box.upper;
        s += fmt::format("bounds       {:.6g} {:.6g} {:.6g} … {:.6g} {:.6g} {:.6g}\n", a.x, a.y, a.z, b.x, b.y, b.z);
        const Vec3i n = g.upper - g.lower + Vec3i(1, 1, 1);
        s += fmt::format("voxels       {}×{}×{}, of {:.6g}", n.x, n.y, n.z, w.voxel.x);
        const bool cubes = maxComponent(w.voxel) - minComponent(w.voxel) < 1e-6 * w.voxel.x;
        s += cubes ? "\n" : fmt::format("×{:.6g}×{:.6g}\n", w.voxel.y, w.voxel.z);
        const double whole = double(n.x) * double(n.y) * double(n.z);
        s += fmt::format("active       {} ({:.3g} %), {} leaves, {} tiles\n", g.activeVoxels,
                         100 * static_cast<double>(g.activeVoxels) / whole, g.leaves, g.activeTiles);
    }
    if (g.read && g.activeVoxels > 0)
        s += fmt::format("range        {:.6g} … {:.6g}{}\n", g.minimum, g.maximum,
                         g.type.starts_with("vec") ? " (lengths)" : "");
    if (g.memoryBytes > 0) s += fmt::format("memory       {:.1f} MB\n", static_cast<double>(g.memoryBytes) * 1e-6);
    for (const std::string& doubt : doubts(g)) s += fmt::format("warning      {}\n", doubt);
    for (const auto& [name, value] : g.metadata)
        if (!name.starts_with("file_") && name != "name" && name != "class")
            s += fmt::format("  {} = {}\n", name, value);
    return s;
}

ExitCode failed(const VdbFault& fault, const Console& console) {
    console.error(fault.text);
    switch (fault.kind) {
    case VdbFault::Kind::noGrid:
    case VdbFault::Kind::wrongKind:
    case VdbFault::Kind::transform:
    case VdbFault::Kind::extent:
        return ExitCode::faulty;
    case VdbFault::Kind::memory:
        return ExitCode::memory;
    default:
        return ExitCode::system;
    }
}

ExitCode info(const VolumeInfoOptions& options, const CommonOptions& common) {
    const auto result = inspectVdb(options.input);
    if (const auto* fault = std::get_if<VdbFault>(&result)) return failed(*fault, common.console);
    const auto& file = std::get<VdbFileInfo>(result);
    if (common.json) {
        Json grids = Json::list();
        for (const VdbGridInfo& g : file.grids) grids.push(json(g));
        common.console.data(Json::object({{"compression", file.compression},
                                          {"format", file.library},
                                          {"metadata", json(file.metadata)},
                                          {"grids", std::move(grids)}})
                                .text(true) +
                            "\n");
        return ExitCode::done;
    }
    std::string s = fmt::format("format       {}{}\ncompression  {}\ngrids        {}\n",
                                file.library.starts_with("Nano") ? "" : "OpenVDB ", file.library, file.compression,
                                file.grids.size());
    for (const auto& [name, value] : file.metadata) s += fmt::format("  {} = {}\n", name, value);
    for (const VdbGridInfo& g : file.grids) s += text(g);
    common.console.data(s);
    return ExitCode::done;
}

// --- make, convert

class Seconds {
  public:
    double operator()() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

struct Interrupted {};

// A line at every tenth, at most one in two seconds.
class ProgressLines {
  public:
    ProgressLines(const Console& console, bool quiet) : console_(console), quiet_(quiet) {}
    void operator()(double fraction) {
        const int tenth = static_cast<int>(fraction * 10);
        if (quiet_ || tenth <= told_ || seconds_() < next_) return;
        console_.line(fmt::format("{} %", tenth * 10));
        told_ = tenth;
        next_ = seconds_() + 2;
    }

  private:
    const Console& console_;
    bool quiet_;
    Seconds seconds_;
    double next_ = 2;
    int told_ = 0;
};

// Lets the helper write beside the output, which appears only when complete.
ExitCode write(std::vector<std::string> arguments, std::size_t outputPlace, bool quiet, const CommonOptions& common) {
    const Seconds seconds;
    const InterruptGuard guard; // the temporary file is removed first
    const std::string output = arguments[outputPlace];
    AtomicFile file(output);
    arguments[outputPlace] = file.temporaryPath();
    ProgressLines lines(common.console, quiet);
    std::variant<std::string, VdbFault> result;
    try {
        result = runVdbHelper(arguments, [&](double fraction) {
            if (guard.stop()) throw Interrupted();
            lines(fraction);
        });
    } catch (const Interrupted&) { // the helper ended with the conversation
    }
    if (guard.signal() != 0) return static_cast<ExitCode>(128 + guard.signal());
    if (const auto* fault = std::get_if<VdbFault>(&result)) return failed(*fault, common.console);
    file.commit();
    if (quiet) return ExitCode::done;
    std::string notes = std::get<std::string>(result);
    while (!notes.empty() && notes.back() == '\n') notes.pop_back();
    if (!notes.empty()) common.console.lines(notes);
    const double megabytes = static_cast<double>(std::filesystem::file_size(output)) * 1e-6;
    common.console.line(fmt::format("volume {}  ({:.1f} MB, {:.1f} s)", output, megabytes, seconds()));
    return ExitCode::done;
}

ExitCode convert(const VolumeConvertOptions& o, const CommonOptions& common) {
    std::vector<std::string> arguments{"convert", o.input, o.output};
    for (const std::string& grid : o.grids) arguments.push_back("grid=" + grid);
    arguments.push_back(fmt::format("resample={}", o.resample));
    if (o.fog) arguments.push_back("fog");
    if (o.clean) arguments.push_back("clean");
    if (o.half) arguments.push_back("half");
    if (o.prune) arguments.push_back(fmt::format("prune={}", *o.prune));
    if (!o.crop.empty()) arguments.push_back(fmt::format("crop={}", fmt::join(o.crop, ",")));
    std::error_code error;
    if (!std::filesystem::is_regular_file(o.input, error)) {
        common.console.error(
            fmt::format("cannot read `{}`: {}", o.input, error ? error.message() : "it is not a regular file"));
        return ExitCode::system;
    }
    return write(std::move(arguments), 2, false, common);
}

} // namespace

ExitCode run(const VolumeInfoOptions& o, const CommonOptions& common) { return info(o, common); }

ExitCode run(const VolumeMakeOptions& o, const CommonOptions& common) {
    return write({"make", o.kind, o.output, fmt::format("{}", o.resolution), fmt::format("{}", o.seed)}, 2, o.quiet,
                 common);
}

ExitCode run(const VolumeConvertOptions& o, const CommonOptions& common) { return convert(o, common); }

} // namespace abbe
