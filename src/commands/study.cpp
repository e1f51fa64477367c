#include "app/exported_scene.h"
#include "app/json.h"
#include "app/program_end.h"
#include "base/parallel.h"
#include "checkpoints/render_identity.h"
#include "checkpoints/study_state.h"
#include "command_line/arguments.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "commands/measured_scene.h"
#include "commands/study_effects.h"
#include "exchange/exporter/exporter.h"
#include "exchange/importer/importer.h"
#include "io/file.h"
#include "pages/pages.h"
#include "pictures/image_output.h"
#include "reports/findings.h"
#include "reports/image_header.h"
#include "reports/progress.h"
#include "reports/render_report.h"
#include "schema/scene_tree.h"
#include "study/curve_fits.h"
#include "study/peer_study.h"
#include "study/study_plan.h"
#include "study/study_run.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <utility>

namespace abbe {

const char* const kStudyHelp = R"(Measures what accuracy costs in time on a scene, and what each technique is worth.

Examples:
  abbe study room.scene                        room-study.html, .csv and .json: minutes
  abbe study room.scene --size 640x360 --samples 1024 --seeds 16
  abbe study room.scene --variants no-nee,random,denoised
  abbe study room.scene --variants list        what can be changed
  abbe study room.scene --effects              what each effect of the scene is worth
  abbe study room.xml --against mitsuba        beside Mitsuba, on its own scene
  abbe study room.scene --time 20min           as much as that allows
  abbe study room.scene --resume               goes on where it was interrupted)";

namespace {

std::vector<std::string> splitAtCommas(const std::string& text) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

std::vector<std::string_view> allIds() {
    std::vector<std::string_view> ids;
    for (const StudyVariant& v : studyVariants()) ids.emplace_back(v.id);
    return ids;
}

// What is wrong with the list, or nothing; here and below.
std::string readVariants(const std::string& text, StudyOptions& options) {
    options.variants.clear();
    options.listVariants = text == "list";
    if (text == "all")
        for (const std::string_view id : allIds()) options.variants.emplace_back(id);
    if (text == "all" || text == "none" || text == "list") return {};
    const auto known = allIds();
    for (const std::string& id : splitAtCommas(text)) {
        if (std::find(known.begin(), known.end(), id) == known.end()) {
            const std::string_view near = schema::nearest(id, known);
            return fmt::format("no variant is named `{}`{}; `--variants list` lists them", id,
                               near.empty() ? "" : fmt::format(" (did you mean `{}`?)", near));
        }
        options.variants.push_back(id);
    }
    return {};
}

// "1,0.3,0.1" or "1%,0.3%": per cent.
std::string readErrors(const std::string& text, StudyOptions& options) {
    options.errors.clear();
    for (std::string part : splitAtCommas(text)) {
        std::erase_if(part, [](char c) { return c == '%' || c == ' '; });
        double percent = 0;
        const char* last = part.data() + part.size();
        const auto [end, fault] = std::from_chars(part.data(), last, percent);
        if (fault != std::errc() || end != last || !(percent > 0 && percent <= 100))
            return fmt::format("`{}` is no list of errors in per cent such as 1,0.3,0.1", text);
        options.errors.push_back(percent / 100);
    }
    std::sort(options.errors.rbegin(), options.errors.rend());
    return {};
}

std::string readPeer(const std::string& text, StudyOptions& options) {
    const std::string name = text.substr(0, text.find(':'));
    if (name != "mitsuba" || text == "mitsuba:")
        return fmt::format("`{}` is no renderer to compare with: `mitsuba`, or `mitsuba:VARIANT`, is one", text);
    options.against = text;
    return {};
}

} // namespace

void addArguments(Arguments& a, StudyOptions& o) {
    a.argument("scene", &o.input.path, "Scene file").require();
    a.value("-o,--output", "NAME", &o.output, "DIR/NAME of NAME.html, NAME.csv and NAME.json");
    a.value("--camera", "NAME", &o.build.camera, "Camera to render; without it the first one");
    addOwnSize(a, o.build.size, "Size of the pictures; without it that of the scene, at most 160 pixels a side");
    a.value("--samples", "N", &o.samples, "Samples per pixel of the last rung; 64, or what --time allows")
        .between(8, 1 << 24);
    a.value("--seeds", "N", &o.seeds, "Replicates of each curve; 8 when absent").between(2, 1000);
    addOwnSeed(a, o.build.seed);
    a.value(
        "--variants", "LIST", [&o](const std::string& text) { return readVariants(text, o); },
        "What is changed: ids with commas, all, none; list: print them");
    a.value(
        "--error", "LIST", [&o](const std::string& text) { return readErrors(text, o); },
        "Errors in per cent to tell the time to: 1,0.3,0.1");
    a.read("--time", "TIME", o.timeLimit, "a time such as 20min", readTime, "For the whole study: 90, 20min, 2h");
    a.flag("--effects", &o.effects, "Measure what each effect costs and shows, in place of curves");
    a.value(
        "--against", "PEER", [&o](const std::string& text) { return readPeer(text, o); },
        "Another renderer's curve beside: mitsuba, or mitsuba:VARIANT");
    a.flag("--resume", &o.resume, "Go on from what an interrupted study has saved");
    addThreads(a);
    addJson(a, "Progress as JSON lines on stdout");
    a.flag("--quiet,-q", &o.quiet, "Say nothing but warnings and errors");
    addDefines(a, o.input.defines);
    addLayers(a, o.input.layers);
    addMoment(a, o.input.frame);
    readVariants("all", o);
}

namespace {

constexpr int kStudySide = 160; // pixels, of a picture whose size nobody asked for
constexpr std::uint32_t kStudySamples = 64;
constexpr std::uint32_t kProbeSamples = 8;
// Samples of a half of the reference over those of a curve, as they come out more often than not.
constexpr double kUsualReference = 24;
constexpr double kTimeReserve = 0.9; // of the time that is given

// One study from the command line to the files.
class StudyCommand {
  public:
    StudyCommand(const StudyOptions& options, const CommonOptions& common)
        : options_(options), common_(common),
          messages_(common.json ? makeJsonReport(common.console) : makeHumanReport(common.console, true)) {}

    ExitCode run() {
        if (const ExitCode code = load(); code != ExitCode::done) return code;
        choosePlan();
        if (const ExitCode code = checkOutputs(); code != ExitCode::done) return code;
        if (options_.effects && !options_.against.empty())
            return refuse("E0756", "`--effects` does not go with `--against`",
                          "curves are compared with another renderer");
        if (options_.effects) return studyEffects(options_, common_, *loaded_, build_, outputBase());
        InterruptGuard interrupt;
        if (const ExitCode code = findPeer(interrupt); code != ExitCode::done) return code;
        if (!probe(interrupt)) return stopped(interrupt);
        try {
            StudyState state(outputBase() + ".state", identity());
            openState(state);
            tellStart();
            return study(state, interrupt);
        } catch (const CheckpointFault& fault) {
            return refuse(fault.code, fault.what(), fault.help);
        }
    }

  private:
    ExitCode load();
    ExitCode checkOutputs();
    void choosePlan();
    std::string peerScene();
    ExitCode findPeer(InterruptGuard&);
    std::optional<PeerEnd> runPeer(InterruptGuard&, const StudyStore&, StudyProgressLine&);
    bool probe(InterruptGuard&);
    void openState(StudyState&);
    std::vector<Fact> identity() const;
    void tellStart() const;
    ExitCode study(StudyState&, InterruptGuard&);
    ExitCode stopped(const InterruptGuard&) const;
    void write(const StudyReport&, bool complete);

    void say(const std::string& line) const {
        if (!options_.quiet && !common_.json) common_.console.line(line);
    }
    ExitCode refuse(const std::string& code, std::string message, std::string help, ExitCode exit = ExitCode::faulty) {
        Diagnostics diagnostics;
        diagnostics.error(code, {}, std::move(message)).help = std::move(help);
        messages_->diagnostics(diagnostics, loaded_->sources);
        return exit;
    }
    void warn(const char* code, std::string message, std::string help) {
        Diagnostics diagnostics;
        diagnostics.warning(code, {}, std::move(message)).help = std::move(help);
        messages_->diagnostics(diagnostics, loaded_->sources);
    }
    // Path of the files without their extensions.
    std::string outputBase() const {
        if (!options_.output.empty()) return options_.output;
        return std::filesystem::path(options_.input.path).stem().string() + "-study";
    }
    // Of all renders, at the speed of the probe.
    double expectedSeconds(double samples) const {
        const double curves = static_cast<double>(plan_.chosen.variants.size()) * plan_.seeds;
        return time_.fixed * (curves + 2) + time_.perSample * samples * (curves + 2 * kUsualReference);
    }

    const StudyOptions& options_;
    const CommonOptions& common_;
    std::unique_ptr<RenderReport> messages_;
    std::unique_ptr<LoadedScene> loaded_;
    BuildOptions build_;
    BuiltScene built_;
    StudySubject subject_;
    StudyPlan plan_;
    TimeModel time_; // of one render
    PeerRequest peer_;
};

ExitCode StudyCommand::load() {
    MeasuredScene scene = loadMeasured(options_.input, options_.build, kStudySide, *messages_);
    loaded_ = std::move(scene.loaded);
    build_ = scene.options;
    built_ = std::move(scene.built);
    if (scene.code != ExitCode::done) return scene.code;
    subject_.built = &built_;
    subject_.film = filmSettings(built_.film);
    subject_.settings = renderSettings(built_.render);
    subject_.settings.noiseTarget = subject_.settings.timeLimit = 0;
    subject_.replicates = static_cast<int>(built_.render.replicates);
    return ExitCode::done;
}

void StudyCommand::choosePlan() {
    plan_.chosen = chooseVariants(subject_, options_.variants);
    plan_.seeds = options_.seeds;
    plan_.seed = subject_.settings.seed;
    plan_.timeLimit = options_.timeLimit.value_or(0);
    plan_.samples = options_.samples ? static_cast<std::uint32_t>(*options_.samples) : kStudySamples;
    // Two rungs at least.
    plan_.samples = std::max(plan_.samples, 8u * static_cast<std::uint32_t>(subject_.replicates));
}

// Hours of rendering must not end in "permission denied".
ExitCode StudyCommand::checkOutputs() {
    for (const char* extension : {".json", ".csv", ".html"})
        if (std::string fault = writeFault(outputBase() + extension); !fault.empty())
            return refuse("E0430", std::move(fault), "`-o DIR/NAME` writes the study elsewhere", ExitCode::system);
    return ExitCode::done;
}

// The scene in the format of the peer: its own file, or an export beside the report.
std::string StudyCommand::peerScene() {
    const auto* format = loaded_->import ? exchange::importFormat(options_.input.path) : nullptr;
    if (format && format->name == "mitsuba") return options_.input.path;
    const std::string target = outputBase() + ".xml";
    const Diagnostics told = std::exchange(loaded_->diagnostics, {});
    writeExport(*exchange::findExportFormat("mitsuba"), *loaded_, target);
    messages_->diagnostics(loaded_->diagnostics, loaded_->sources);
    loaded_->diagnostics = told;
    say(fmt::format("Mitsuba renders {}", target));
    return target;
}

// Before anything is rendered: whether there is a peer, and whether it can render the scene.
ExitCode StudyCommand::findPeer(InterruptGuard& interrupt) {
    if (options_.against.empty()) return ExitCode::done;
    if (!options_.build.camera.empty())
        return refuse("E0756", "`--camera` does not go with `--against`",
                      "Mitsuba renders the first sensor of its scene");
    const std::size_t colon = options_.against.find(':');
    peer_.scene = peerScene();
    peer_.variant = colon == std::string::npos ? std::string() : options_.against.substr(colon + 1);
    peer_.width = subject_.film.width;
    peer_.height = subject_.film.height;
    peer_.threads = threadCount();
    peer_.seeds = plan_.seeds;
    peer_.seed = plan_.seed;
    // Half of the time is the peer's.
    peer_.timeLimit = plan_.timeLimit /= 2;
    const PeerEnd trial = tryMitsuba(peer_, {&interrupt.stop(), {}});
    if (trial.end == StudyEnd::stopped) return stopped(interrupt);
    if (!trial.curve) return refuse("E0757", trial.fault, trial.help, ExitCode::system);
    peer_.variant = trial.curve->variant;
    return ExitCode::done;
}

// Nothing if it was interrupted.
std::optional<PeerEnd> StudyCommand::runPeer(InterruptGuard& interrupt, const StudyStore& store,
                                             StudyProgressLine& line) {
    const auto main = store.loadCurve(plan_.chosen.variants[0].id);
    peer_.ladder = StudyPlan::ladder(plan_.samples, subject_.replicates);
    peer_.mainSeconds = main->runs[0].rungs.back().seconds;
    PeerEnd end = runMitsuba(peer_, {&interrupt.stop(), [&line](const StudyProgress& p) { line.show(p); }});
    line.clear();
    if (end.end == StudyEnd::stopped) return std::nullopt;
    return end;
}

// How fast the scene renders: what the study will take, or what it can do in the time. False if it was interrupted.
bool StudyCommand::probe(InterruptGuard& interrupt) {
    LadderRender render(subject_, plan_.chosen.variants[0], plan_.referenceSeed(2), &interrupt.stop());
    const auto replicates = static_cast<std::uint32_t>(subject_.replicates);
    std::vector<double> samples, seconds;
    for (const std::uint32_t n : {kProbeSamples / 2, kProbeSamples}) {
        const auto rung = render.advance(std::max(n / replicates, samples.empty() ? 1u : 2u));
        if (!rung) return false;
        samples.push_back(rung->samples);
        seconds.push_back(rung->cost.seconds);
    }
    time_ = TimeModel::fit(samples, seconds).value_or(TimeModel{0, seconds.back() / samples.back()});
    if (options_.samples || plan_.timeLimit == 0) return true;
    if (const auto known = options_.resume ? StudyState::fact(outputBase() + ".state", "rungs") : std::nullopt) {
        std::from_chars(known->data() + known->rfind(' ') + 1, known->data() + known->size(), plan_.samples);
        return true;
    }
    for (std::uint32_t n = 2 * plan_.samples; n <= 1u << 16; n *= 2)
        if (expectedSeconds(n) < kTimeReserve * plan_.timeLimit) plan_.samples = n;
    while (plan_.samples >= 16 * replicates && expectedSeconds(plan_.samples) > kTimeReserve * plan_.timeLimit)
        plan_.samples /= 2;
    return true;
}

std::vector<Fact> StudyCommand::identity() const {
    RenderSettings settings = subject_.settings;
    settings.seed = plan_.seed;
    std::vector<Fact> facts = renderIdentity(
        {loaded_.get(), &subject_.film, &settings, subject_.replicates, options_.build.camera, built_.render.fps});
    const auto ladder = StudyPlan::ladder(plan_.samples, subject_.replicates);
    facts.push_back({"rungs", fmt::format("{}", fmt::join(ladder, " "))});
    return facts;
}

void StudyCommand::openState(StudyState& state) {
    if (options_.resume && state.exists()) {
        state.resume();
        return;
    }
    if (options_.resume)
        warn("W0732", fmt::format("there is nothing to go on with in `{}`; the study begins anew", state.folder()), {});
    else if (state.exists())
        warn("W0731",
             fmt::format("`{}` holds an earlier study that was not finished; this one replaces it", state.folder()),
             "`--resume` goes on with it");
    state.begin();
}

void StudyCommand::tellStart() const {
    const auto ladder = StudyPlan::ladder(plan_.samples, subject_.replicates);
    const std::size_t variants = plan_.chosen.variants.size();
    if (common_.json) {
        common_.console.data(Json::object({{"event", "start"},
                                           {"scene", options_.input.path},
                                           {"width", subject_.film.width},
                                           {"height", subject_.film.height},
                                           {"threads", threadCount()},
                                           {"variants", static_cast<std::uint64_t>(variants)},
                                           {"seeds", plan_.seeds},
                                           {"samples", ladder.back()},
                                           {"estimate_s", expectedSeconds(ladder.back())}})
                                 .text() +
                             "\n");
        return;
    }
    say(fmt::format("{}  {}×{}  {} thread{}  {} curve{} of {} to {} samples, {} seeds each: about {}",
                    options_.input.path, subject_.film.width, subject_.film.height, threadCount(),
                    threadCount() == 1 ? "" : "s", variants, variants == 1 ? "" : "s", ladder.front(), ladder.back(),
                    plan_.seeds, clockText(expectedSeconds(ladder.back()))));
    if (!peer_.scene.empty()) say(fmt::format("  beside Mitsuba, {}", peer_.variant));
    for (const LeftOutVariant& v : plan_.chosen.leftOut) say(fmt::format("  without {}: {}", v.label, v.reason));
}

ExitCode StudyCommand::stopped(const InterruptGuard& interrupt) const {
    say(fmt::format("interrupted; `{} --resume` goes on where it was", common_.commandLine));
    return static_cast<ExitCode>(128 + interrupt.signal());
}

ExitCode StudyCommand::study(StudyState& state, InterruptGuard& interrupt) {
    using Form = StudyProgressLine::Form;
    StudyProgressLine line(common_.console, common_.json ? Form::json : options_.quiet ? Form::none : Form::human);
    const StudyStore store = state.store();
    const StudyControl control{&interrupt.stop(), [&line](const StudyProgress& p) { line.show(p); }};
    StudyRun renders(subject_, plan_, store, control);
    const StudyEnd end = renders.run();
    line.clear();
    if (renders.dropped() > 0)
        warn(
            "W0734",
            fmt::format("{} samples of the study's renders were dropped: something in them was not finite, or negative",
                        renders.dropped()),
            "`abbe render` of the scene with its samples tells where");
    if (end == StudyEnd::stopped) return stopped(interrupt);
    std::optional<PeerEnd> peer = PeerEnd();
    if (!options_.against.empty()) peer = runPeer(interrupt, store, line);
    if (!peer) return stopped(interrupt);
    const auto peers = peer->curve ? std::span(&*peer->curve, 1) : std::span<const PeerCurve>();
    const StudyReport report = StudyReport::make(subject_, plan_, store, peers);
    write(report, end == StudyEnd::done && (!peer->curve || peer->curve->complete));
    if (report.referenceAdvantage < StudyRun::kReferenceAdvantage)
        warn("W0733",
             fmt::format("the best image has {:.3g} times the error of the reference; 20 times and more were wanted",
                         report.referenceAdvantage),
             "its noise cancels in the mean, but what is measured varies more; give the study more `--time`");
    if (end == StudyEnd::outOfTime)
        say("the time is used up; the report has the seeds that were done, and `--resume` adds the others");
    else if (peer->fault.empty())
        state.remove();
    // What was rendered here is in the report all the same.
    return peer->fault.empty() ? ExitCode::done : refuse("E0757", peer->fault, peer->help, ExitCode::system);
}

void StudyCommand::write(const StudyReport& report, bool complete) {
    StudyFacts facts;
    facts.command = common_.commandLine;
    facts.scene = options_.input.path;
    facts.name = std::filesystem::path(options_.input.path).stem().string();
    facts.width = subject_.film.width;
    facts.height = subject_.film.height;
    facts.effects = effectNames(built_.scene.effects);
    facts.threads = threadCount();
    facts.seeds = plan_.seeds;
    facts.seed = plan_.seed;
    facts.errors = options_.errors;
    facts.complete = complete;
    facts.leftOut = plan_.chosen.leftOut;
    const std::string json = studyJson(report, facts), base = outputBase();
    writeAtomically(base + ".json", json);
    writeAtomically(base + ".csv", studyCsv(report, facts));
    writeAtomically(base + ".html", studyPage(json));
    if (common_.json) {
        for (const char* extension : {".html", ".csv", ".json"})
            common_.console.data(Json::object({{"event", "file"}, {"path", base + extension}}).text() + "\n");
        common_.console.data(
            Json::object(
                {{"event", "done"}, {"complete", complete}, {"reference_advantage", report.referenceAdvantage}})
                .text() +
            "\n");
        return;
    }
    if (options_.quiet) return;
    common_.console.data(studyTable(report, facts));
    for (const char* extension : {".html", ".csv", ".json"}) say("study " + base + extension);
}

ExitCode listVariants(const Console& console) {
    std::string text;
    for (const StudyVariant& v : studyVariants()) text += fmt::format("{:<23}{:<28}{}\n", v.id, v.label, v.change);
    console.data(text);
    return ExitCode::done;
}

} // namespace

ExitCode run(const StudyOptions& options, const CommonOptions& common) {
    if (options.listVariants) return listVariants(common.console);
    return StudyCommand(options, common).run();
}

} // namespace abbe
