#include "app/command_line.h"

#include "app/argument_values.h"
#include "app/command_line_certify.h"
#include "app/command_line_check.h"
#include "app/command_line_compare.h"
#include "app/command_line_convert.h"
#include "app/command_line_denoise.h"
#include "app/command_line_doctor.h"
#include "app/command_line_help.h"
#include "app/command_line_png.h"
#include "app/command_line_reference.h"
#include "app/command_line_replay.h"
#include "app/command_line_study.h"
#include "app/command_line_tree.h"
#include "app/command_line_verify.h"
#include "app/command_line_volume.h"
#include "app/version.h"
#include "schema/scene_tree.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

using Words = std::vector<std::string>;

constexpr const char* kCommands[] = {"render", "merge",     "convert", "denoise", "check", "explain",
                                     "info",   "compare",   "certify", "verify",  "study", "replay",
                                     "volume", "reference", "doctor",  "help"};

// Headings of the list of commands.
constexpr const char* kPictures = "Pictures";
constexpr const char* kScenes = "Scenes";
constexpr const char* kTrust = "How right a picture is, and what it costs";
constexpr const char* kOther = "Besides";

// One reader per command line: holds the library's parser and what it writes into.
class Reader {
  public:
    Reader() {
        app_.name("abbe");
        app_.set_version_flag("-V,--version", versionText(), "Print the version and what it was built with");
        app_.set_help_flag("-h,--help", "Print this help");
        app_.require_subcommand(1);
        app_.get_formatter()->column_width(28);
        addPictureCommands();
        addSceneCommands();
        addTrustCommands();
        addOtherCommands();
    }

    CommandInfo describe() const { return describeCommands(app_); }

    std::variant<Command, EarlyEnd> read(const Words& words) {
        try {
            app_.parse(libraryWords(words));
        } catch (const CLI::CallForHelp&) {
            const CLI::App& chosen = chosenCommand(app_);
            return EarlyEnd{ExitCode::done, &chosen == &app_ ? commandListText(describe()) : helpText(chosen)};
        } catch (const CLI::CallForVersion&) {
            return EarlyEnd{ExitCode::done, versionText() + "\n"};
        } catch (const CLI::ParseError& e) {
            return EarlyEnd{ExitCode::usage, errorText(app_, e)};
        }
        if (app_.got_subcommand("help"))
            if (auto text = commandHelp()) return EarlyEnd{ExitCode::done, std::move(*text)};
        return command(words);
    }

  private:
    using Texts = std::vector<std::string>;

    CLI::App* add(const char* name, const char* help, const char* group) {
        CLI::App* command = app_.add_subcommand(name, help);
        command->group(group);
        command->set_help_flag("-h,--help", "Print this help");
        command->add_option("--color", color_, "When to use colours")
            ->check(CLI::IsMember({"auto", "always", "never"}).description(""))
            ->type_name("auto|always|never");
        command->get_formatter()->column_width(28);
        return command;
    }
    void addJson(CLI::App* c) { c->add_flag("--json", common_.json, "JSON on stdout"); }
    void addDefines(CLI::App* c, Texts& defines) {
        c->add_option("-D", defines, "Set a parameter of the scene; may be repeated")
            ->allow_extra_args(false)
            ->type_name("NAME=VALUE");
    }
    void addView(CLI::App* c, ViewOptions& view) {
        c->add_option("--display", view.display, "OCIO display of the PNG")->type_name("NAME");
        c->add_option("--view", view.view, "OCIO view of the PNG")->type_name("NAME");
        c->add_option("--ocio", view.config, "OCIO configuration; without it $OCIO, else the built-in one")
            ->type_name("FILE");
        c->add_option("--exposure", view.exposure, "Brighten the PNG by so many stops")->type_name("STOPS");
    }
    // An option whose text is read by one of our own functions.
    template <typename Value, typename Function>
    void addRead(CLI::App* c, const char* name, std::optional<Value>& place, const char* type, const char* help,
                 const char* expected, Function readValue) {
        const auto store = [&place, expected, readValue, name](const std::string& text) {
            if (!(place = readValue(text)))
                throw CLI::ValidationError(name, fmt::format("`{}` is not {}", text, expected));
        };
        c->add_option_function<std::string>(name, store, help)->type_name(type);
    }
    void addFrame(CLI::App* c, BuildOptions& b);
    void addGoals(CLI::App* c);
    void addSaving();
    void addPictureCommands();
    void addSceneCommands();
    void addTrustCommands();
    void addOtherCommands();
    void addRender();
    void addMerge();
    void addCheck();
    void addExplain();
    void addInfo();
    void addConvert();

    // What `abbe help …` prints; nothing if its words are no command: they are words of the language.
    std::optional<std::string> commandHelp() const;
    Command command(const Words& words);

    CLI::App app_{kAbout};
    std::string color_ = "auto", format_ = "human", kernel_ = "auto", png_, checkpoint_;
    CommonOptions common_;
    RenderOptions render_;
    MergeOptions merge_;
    CheckOptions check_;
    ExplainOptions explain_;
    InfoOptions info_;
    ConvertOptions convert_;
    CompareOptions compare_;
    VolumeOptions volume_;
    DenoiseOptions denoise_;
    ReplayOptions replay_;
    CertifyOptions certify_;
    StudyOptions study_;
    VerifyOptions verify_;
    DoctorOptions doctor_;
    ReferenceOptions reference_;
    Words helpTopic_;
};

void Reader::addPictureCommands() {
    addRender();
    addMerge();
    addConvert();
    addDenoiseArguments(*add("denoise", kDenoiseHelp, kPictures), denoise_, common_);
}

void Reader::addSceneCommands() {
    addCheck();
    addExplain();
    addInfo();
}

void Reader::addTrustCommands() {
    addCompareArguments(*add("compare", kCompareHelp, kTrust), compare_, common_.json);
    CLI::App* certify = add("certify", kCertifyHelp, kTrust);
    addCertifyArguments(*certify, certify_, common_.json);
    addView(certify, certify_.view);
    CLI::App* verify = add("verify", kVerifyHelp, kTrust);
    addVerifyArguments(*verify, verify_, common_);
    addDefines(verify, verify_.input.defines);
    CLI::App* study = add("study", kStudyHelp, kTrust);
    addStudyArguments(*study, study_, common_);
    addDefines(study, study_.input.defines);
    addReplayArguments(*add("replay", kReplayHelp, kTrust), replay_, common_);
}

void Reader::addOtherCommands() {
    addVolumeActions(*add("volume", kVolumeHelp, kOther), volume_, common_.json);
    addReferenceArguments(*add("reference", kReferenceHelp, kOther), reference_);
    addDoctorArguments(*add("doctor", kDoctorHelp, kOther), doctor_, common_);
    add("help", kHelpHelp, kOther)
        ->add_option("topic", helpTopic_, "A command, or words of the scene language")
        ->type_name("");
}

std::optional<bool> readSwitch(const std::string& text) {
    return text == "on" || text == "off" ? std::optional(text == "on") : std::nullopt;
}

// What of the command line a render's picture and plans hang on, beside the scene.
void Reader::addFrame(CLI::App* c, BuildOptions& b) {
    c->add_option("--camera", b.camera, "Camera to render; without it the first one")->type_name("NAME");
    addRead(c, "--size", b.size, "WxH", "Size of the image in pixels", "a size such as 640x480", readSize);
    c->add_option("--seed", b.seed, "Choose other random numbers")
        ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 53).description(""))
        ->type_name("N");
    c->add_option("--pilot", b.pilot, "Size of the pilots that plan for caustics, 0 (none) to 4; else by the work")
        ->check(CLI::Range(0, RenderSettings::kFullPilot).description(""))
        ->type_name("N");
}

void Reader::addGoals(CLI::App* c) {
    BuildOptions& b = render_.build;
    c->add_option("--samples", b.samples, "Samples per pixel")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{4294967295}).description(""))
        ->type_name("N");
    addRead(c, "--noise", b.noise, "ERROR", "Stop at this relative error: 0.5%", "a relative error such as 0.5%",
            [](const std::string& text) -> std::optional<double> {
                const auto value = readQuantity(text, schema::Dimension::fraction);
                return value && *value >= 0 && *value <= 1 ? value : std::nullopt;
            });
    addRead(c, "--texture-cache", b.textureCache, "SIZE", "Most memory for tiles of image textures: 512MiB, 4GiB",
            "an amount of memory such as 512MiB, 16MiB or more", readMebibytes);
    addRead(c, "--memory", render_.memory, "SIZE", "Most memory to take: 4GiB; without it all there is",
            "an amount of memory such as 4GiB, 16MiB or more", readMebibytes);
    addRead(c, "--time", b.timeLimit, "TIME", "Stop after this time: 90, 45min, 2h", "a time such as 45min",
            [](const std::string& text) -> std::optional<double> {
                const auto value = readQuantity(text, schema::Dimension::time);
                return value && *value >= 0 && *value <= 1e9 ? value : std::nullopt;
            });
    addRead(c, "--adaptive", b.adaptive, "on|off", "More samples where there is more noise, at the same cost",
            "on or off", readSwitch);
}

void Reader::addSaving() {
    CLI::App* c = app_.get_subcommand("render");
    CheckpointOptions& checkpoint = render_.checkpoint;
    const auto readCheckpoint = [&checkpoint](const std::string& text) {
        checkpoint.off = text == "off";
        checkpoint.keep = text == "keep";
        if (checkpoint.off || checkpoint.keep) return;
        const auto interval = readQuantity(text, schema::Dimension::time);
        if (!interval || !(*interval > 0 && *interval <= 1e9))
            throw CLI::ValidationError("--checkpoint",
                                       fmt::format("`{}` is not a time such as 5min, off or keep", text));
        checkpoint.interval = *interval;
    };
    c->add_option_function<std::string>("--checkpoint", readCheckpoint,
                                        "Save what was done every so often (25s); off: never; keep: also when done")
        ->type_name("TIME|off|keep");
    c->add_flag("--resume", checkpoint.resume, "Go on from the checkpoint, if there is one");
    addRead(c, "--crop", render_.crop, "X0,Y0,X1,Y1", "Render these pixels only", "a rectangle such as 0,0,640,360",
            readCrop);
    addRead(c, "--part", render_.part, "K/N", "Take the K-th of N ranges of the samples and write a part for `merge`",
            "a part such as 2/4", readPart);
}

void Reader::addRender() {
    CLI::App* c = add("render", kRenderHelp, kPictures);
    RenderOptions& r = render_;
    c->add_option("scene", r.input.path, "Scene file")->required()->type_name("");
    c->add_option("-o,--output", r.output, "Image to write (EXR)")->type_name("FILE");
    addFrame(c, r.build);
    addGoals(c);
    addSaving();
    addDefines(c, r.input.defines);
    c->add_option("-t,--threads", common_.threads, "Threads; without it one per core")
        ->check(CLI::Range(1, 4096).description(""))
        ->type_name("N");
    c->add_flag(kPngFlag, png_, kPngHelp);
    addView(c, r.view);
    addRead(c, "--preview", r.preview, "on|off", "A PNG of what there is so far, until the image is written",
            "on or off", readSwitch);
    c->add_flag("--json", common_.json, "Progress as JSON lines on stdout");
    c->add_flag("--bill", r.bill, "Print what the time was spent on");
    c->add_flag("--quiet,-q", r.quiet, "Say nothing but warnings and errors");
    c->add_flag("--strict", r.strict, "Exit with 4 when there were warnings");
    const std::string studies = "For studies";
    c->add_option("--kernel", kernel_, "all: the path loop with every effect")
        ->check(CLI::IsMember({"auto", "all"}).description(""))
        ->type_name("auto|all")
        ->group(studies);
    c->add_option("--strategy", r.build.strategy, "How light is found")
        ->check(CLI::IsMember({"mis", "lights", "bsdf"}).description(""))
        ->type_name("mis|lights|bsdf")
        ->group(studies);
    c->add_option("--sampler", r.build.sampler, "Where random numbers come from")
        ->check(CLI::IsMember({"sobol", "stratified", "random"}).description(""))
        ->type_name("sobol|stratified|random")
        ->group(studies);
    addRead(c, "--pixel", r.pixel, "X,Y", "Render one pixel and print its value", "a pixel such as 12,34", readPixel);
}

void Reader::addMerge() {
    CLI::App* c = add("merge", kMergeHelp, kPictures);
    c->add_option("parts", merge_.parts, "Parts of one render (.abbe)")->required()->type_name("");
    c->add_option("-o,--output", merge_.output, "Image to write (EXR)")->required()->type_name("FILE");
    c->add_option("--scene", merge_.scene, "Where the scene is now")->type_name("FILE");
    c->add_flag(kPngFlag, png_, kPngHelp);
    addView(c, merge_.view);
    addJson(c);
}

void Reader::addCheck() {
    CLI::App* c = add("check", kCheckHelp, kScenes);
    addCheckArguments(*c, check_, format_);
    addDefines(c, check_.defines);
}

void Reader::addExplain() {
    CLI::App* c = add("explain", kExplainHelp, kScenes);
    c->add_option_function<Texts>(
         "topic", [this](const Texts& words) { explain_.topic = fmt::format("{}", fmt::join(words, " ")); },
         "Scene file, or words of the language; without any: how scenes are written")
        ->type_name("");
    c->add_flag("--effects", explain_.effects, "What a scene needs simulated; without one: all effects");
    addFrame(c, explain_.build);
    addDefines(c, explain_.defines);
    addJson(c);
}

void Reader::addInfo() {
    CLI::App* c = add("info", kInfoHelp, kScenes);
    c->add_option("file", info_.path, "Scene (.scene) or image (.exr)")->required()->type_name("");
    addDefines(c, info_.defines);
    addJson(c);
}

void Reader::addConvert() {
    CLI::App* c = add("convert", kConvertHelp, kPictures);
    addConvertArguments(*c, convert_);
    addView(c, convert_.view);
}

std::optional<std::string> Reader::commandHelp() const {
    if (helpTopic_.empty()) return commandListText(describe());
    const CLI::App* command = &app_;
    for (const std::string& word : helpTopic_) {
        const auto named = command->get_subcommands([&](const CLI::App* c) { return c->get_name() == word; });
        if (named.empty()) return std::nullopt;
        command = named.front();
    }
    const std::string text = helpText(*command);
    if (helpTopic_.size() > 1 || !schema::findKind(helpTopic_[0])) return text;
    return text + fmt::format("\n`{0}` is a word of scenes, too: `abbe explain {0}`\n", helpTopic_[0]);
}

Command Reader::command(const Words& words) {
    const ColorMode color = color_ == "always"  ? ColorMode::always
                            : color_ == "never" ? ColorMode::never
                                                : ColorMode::automatic;
    const MessageFormat format = format_ == "json"    ? MessageFormat::json
                                 : format_ == "short" ? MessageFormat::brief
                                                      : MessageFormat::human;
    common_.console = Console(color, format);
    common_.commandLine = "abbe";
    for (const std::string& word : words) common_.commandLine += " " + shellQuoted(word);
    common_.words = words;
    render_.largestKernel = kernel_ == "all";
    render_.png = pngOptions(png_, render_.view);
    merge_.png = pngOptions(png_, merge_.view);
    if (app_.got_subcommand("volume")) return {volume_, common_};
    const std::string name = chosenCommand(app_).get_name();
    if (name == "render") return {render_, common_};
    if (name == "merge") return {merge_, common_};
    if (name == "check") return {check_, common_};
    if (name == "explain") return {explain_, common_};
    if (name == "info") return {info_, common_};
    if (name == "convert") return {convert_, common_};
    if (name == "denoise") return {denoise_, common_};
    if (name == "replay") return {replay_, common_};
    if (name == "certify") return {certify_, common_};
    if (name == "study") return {study_, common_};
    if (name == "verify") return {verify_, common_};
    if (name == "doctor") return {doctor_, common_};
    if (name == "reference") return {reference_, common_};
    if (name == "help") {
        explain_.topic = fmt::format("{}", fmt::join(helpTopic_, " "));
        return {explain_, common_};
    }
    return {compare_, common_};
}

} // namespace

bool isCommand(std::string_view word) { return std::ranges::find(kCommands, word) != std::end(kCommands); }

std::string commandSuggestion(const std::string& word) {
    std::error_code error;
    if (word.find_first_of("./-") != std::string::npos || std::filesystem::exists(word, error)) return {};
    return std::string(schema::nearest(word, {std::begin(kCommands), std::end(kCommands)}));
}

CommandInfo commandTree() { return Reader().describe(); }

std::variant<Command, EarlyEnd> readCommandLine(std::span<const char* const> arguments) {
    Reader reader;
    Words words(arguments.begin(), arguments.end());
    if (words.empty()) return EarlyEnd{ExitCode::usage, kFirstWords};
    const bool global = words[0] == "-h" || words[0] == "--help" || words[0] == "-V" || words[0] == "--version";
    if (!isCommand(words[0]) && !global) {
        if (const std::string near = commandSuggestion(words[0]); !near.empty())
            return EarlyEnd{ExitCode::usage,
                            fmt::format("abbe: no command is named `{}`; did you mean `{}`?\n", words[0], near)};
        words.insert(words.begin(), "render");
    }
    return reader.read(words);
}

} // namespace abbe
