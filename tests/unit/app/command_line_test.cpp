#include "command_line/command_tree.h"
#include "command_line/parser.h"
#include "commands/command_table.h"
#include "schema/type.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <initializer_list>

using namespace abbe;

namespace {

std::variant<CommandLine, EarlyEnd> read(std::initializer_list<const char*> words) {
    return readCommandLine(commandTable(), {words.begin(), words.size()});
}

template <typename Options> Options optionsOf(std::initializer_list<const char*> words) {
    const auto result = read(words);
    REQUIRE_MESSAGE(std::holds_alternative<CommandLine>(result), std::get<EarlyEnd>(result).text);
    const Options* const options = abbe::optionsOf<Options>(*std::get<CommandLine>(result).command);
    REQUIRE(options);
    return *options;
}

RenderOptions render(std::initializer_list<const char*> words) { return optionsOf<RenderOptions>(words); }

std::string help(const std::vector<std::string>& words) { return commandHelp(commandTable(), words).value_or(""); }

EarlyEnd end(std::initializer_list<const char*> words) {
    const auto result = read(words);
    REQUIRE(std::holds_alternative<EarlyEnd>(result));
    return std::get<EarlyEnd>(result);
}

bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

} // namespace

TEST_CASE("a scene alone is rendered") {
    CHECK(render({"a.scene"}).input.path == "a.scene");
    CHECK(render({"render", "a.scene"}).input.path == "a.scene");
    CHECK(render({"--samples", "4", "a.scene"}).build.samples == 4);
}

TEST_CASE("frames of an animation") {
    CHECK(render({"a.scene"}).frames.empty());
    CHECK(render({"a.scene", "--frames", "1-5x2"}).frames == std::vector<int>{1, 3, 5});
    CHECK(render({"a.scene", "--frames", "-2--1"}).frames == std::vector<int>{-2, -1});
    CHECK(render({"a.scene", "--frames", "7", "--pixel", "1,2"}).pixel);
    CHECK(contains(end({"render", "a.scene", "--frames", "5-1"}).text, "write `1-5`"));
    CHECK(contains(end({"render", "a.scene", "--frames", "1-2", "--pixel", "1,2"}).text, "--frames 1"));
    CHECK(contains(end({"render", "a.scene", "--frames", "1", "-D", "frame=2"}).text, "--frames"));
    CHECK(contains(end({"render", "a.scene", "--frames", "1", "-o", "#.#.exr"}).text, "#._.exr"));
    CHECK(optionsOf<InfoOptions>({"info", "a.scene", "--frame", "-3"}).frame == -3);
    CHECK(optionsOf<VerifyOptions>({"verify", "a.scene", "--frame", "3"}).input.frame == 3);
}

TEST_CASE("options of render") {
    const RenderOptions o = render({"render",   "a.scene",  "-o",    "b.exr",    "--size", "640x480",    "--noise",
                                    "0.5%",     "--time",   "45min", "-D",       "x=1",    "-D",         "y=2 m",
                                    "--seed=7", "--camera", "top",   "--kernel", "all",    "--strategy", "bsdf"});
    CHECK(o.output == "b.exr");
    REQUIRE(o.build.size);
    CHECK(o.build.size->x == 640);
    CHECK(o.build.size->y == 480);
    CHECK(*o.build.noise == doctest::Approx(0.005));
    CHECK(*o.build.timeLimit == doctest::Approx(2700));
    CHECK(o.input.defines == std::vector<std::string>{"x=1", "y=2 m"});
    CHECK(o.build.seed == 7);
    CHECK(o.build.camera == "top");
    CHECK(o.largestKernel);
    CHECK(o.build.strategy == Technique::Strategy::bsdfOnly);
    CHECK_FALSE(o.png.off);
    CHECK_FALSE(o.png.asked);
}

TEST_CASE("a define does not swallow the scene") { CHECK(render({"-D", "x=1", "a.scene"}).input.path == "a.scene"); }

TEST_CASE("the PNG has an optional name") {
    CHECK(render({"a.scene", "--png"}).png.asked);
    CHECK(render({"a.scene", "--png"}).png.path == "");
    CHECK(render({"--png", "a.scene"}).png.path == "");
    CHECK(render({"--png", "a.scene"}).input.path == "a.scene");
    for (const auto& o : {render({"a.scene", "--png=b.png"}), render({"--png", "b.png", "a.scene"})}) {
        CHECK(o.input.path == "a.scene");
        CHECK(o.png.asked);
        CHECK(o.png.path == "b.png");
    }
}

TEST_CASE("a PNG is written unless it is switched off, and a view asks for it") {
    CHECK_FALSE(render({"a.scene"}).png.off);
    for (const auto& o :
         {render({"a.scene", "--png=off"}), render({"a.scene", "--png", "off"}), render({"--png", "off", "a.scene"})}) {
        CHECK(o.png.off);
        CHECK(o.png.path == "");
        CHECK(o.input.path == "a.scene");
    }
    CHECK(render({"a.scene", "--png", "on"}).png.asked);
    CHECK(render({"a.scene", "--view", "Raw"}).png.asked);
    CHECK(render({"a.scene", "--exposure", "2"}).png.asked);
    CHECK(contains(end({"render", "--help"}).text, "--png[=FILE]"));
}

TEST_CASE("an unknown flag is answered with the nearest one") {
    const EarlyEnd e = end({"render", "a.scene", "--smaples", "4"});
    CHECK(e.code == ExitCode::usage);
    CHECK(contains(e.text, "`--smaples`"));
    CHECK(contains(e.text, "did you mean `--samples`?"));
    CHECK(contains(end({"a.scene", "--smaples=4"}).text, "did you mean `--samples`?"));
    CHECK_FALSE(contains(end({"a.scene", "--zzzzzz"}).text, "did you mean"));
}

TEST_CASE("an unknown command is answered with the nearest one") {
    CHECK(contains(end({"chekc", "a.scene"}).text, "did you mean `check`?"));
    CHECK(end({"chekc", "a.scene"}).code == ExitCode::usage);
}

TEST_CASE("wrong values are refused") {
    CHECK(end({"a.scene", "--size", "640"}).code == ExitCode::usage);
    CHECK(contains(end({"a.scene", "--size", "640"}).text, "640x480"));
    CHECK(end({"a.scene", "--size", "0x4"}).code == ExitCode::usage);
    CHECK(end({"a.scene", "--samples", "0"}).code == ExitCode::usage);
    CHECK(end({"a.scene", "--samples", "4.5"}).code == ExitCode::usage);
    CHECK(end({"a.scene", "--noise", "5 kg"}).code == ExitCode::usage);
    CHECK(end({"a.scene", "--noise", "-1"}).code == ExitCode::usage);
    CHECK(end({"a.scene", "--time", "3 m"}).code == ExitCode::usage); // metres
    CHECK(end({"a.scene", "--strategy", "luck"}).code == ExitCode::usage);
    CHECK(end({"a.scene", "b.scene"}).code == ExitCode::usage);
    CHECK(end({"render"}).code == ExitCode::usage);
    CHECK(end({}).code == ExitCode::usage);
}

TEST_CASE("help begins with examples") {
    const EarlyEnd e = end({"render", "--help"});
    CHECK(e.code == ExitCode::done);
    REQUIRE(contains(e.text, "Examples:"));
    CHECK(e.text.find("Examples:") < e.text.find("--samples"));
    CHECK(end({"--help"}).code == ExitCode::done);
    CHECK(contains(end({"--help"}).text, "Examples:"));
    CHECK(contains(end({"--version"}).text, "edition 1"));
}

TEST_CASE("the command line is kept as a shell would take it") {
    const auto result = read({"render", "my scene.scene", "-D", "a='x'"});
    CHECK(std::get<CommandLine>(result).common.commandLine == R"(abbe render 'my scene.scene' -D 'a='\''x'\''')");
}

TEST_CASE("explain takes several words") {
    CHECK(optionsOf<ExplainOptions>({"explain", "unit", "nits"}).topic == "unit nits");
}

TEST_CASE("the tree of commands is what the program takes") {
    const CommandInfo tree = commandTree(commandTable());
    CHECK(tree.name == "abbe");
    CHECK(tree.actions.size() == 23);
    for (const CommandInfo& command : tree.actions) {
        CAPTURE(command.name);
        CHECK(isCommand(commandTable(), command.name));
        CHECK(command.summary.ends_with('.'));
        CHECK(command.more.starts_with("Examples:") == !(command.name == "reference"));
        CHECK((command.actions.empty() || command.name == "volume" || command.name == "farm"));
        for (const FlagInfo& flag : command.flags) {
            CAPTURE(flag.doc);
            CHECK(!flag.names.empty());
            CHECK(!flag.doc.empty());
            CHECK(!flag.doc.ends_with('.'));
        }
    }
    const CommandInfo* render = findCommand(tree, {"render"});
    REQUIRE(render);
    CHECK(render->arguments.size() == 1);
    CHECK(render->arguments[0].required);
    const auto sampler =
        std::ranges::find_if(render->flags, [](const FlagInfo& f) { return f.names[0] == "--sampler"; });
    REQUIRE(sampler != render->flags.end());
    CHECK(sampler->choices == std::vector<std::string>{"sobol", "stratified", "random"});
    const auto checkpoint =
        std::ranges::find_if(render->flags, [](const FlagInfo& f) { return f.names[0] == "--checkpoint"; });
    REQUIRE(checkpoint != render->flags.end());
    CHECK(checkpoint->choices == std::vector<std::string>{"off", "keep"});
    CHECK(findCommand(tree, {"volume", "make"})->arguments[0].choices.size() == 4);
    CHECK(findCommand(tree, {"volume", "render"}) == nullptr);
}

TEST_CASE("help of a command, of an action, of a word of the language") {
    CHECK(contains(help({"render"}), end({"render", "--help"}).text));
    CHECK(contains(help({"volume", "make"}), "abbe volume make"));
    CHECK(help({}) == end({"--help"}).text);
    CHECK(help({"camera", "lens"}).empty());
    CHECK(contains(end({}).text, "abbe help"));
}

TEST_CASE("check reads standard input once, and does not repair it") {
    const auto o = optionsOf<CheckOptions>({"check", "-", "--as", "a.scene", "-q"});
    CHECK(o.paths == std::vector<std::string>{"-"});
    CHECK(o.standsFor == "a.scene");
    CHECK(o.quiet);
    CHECK(end({"check", "-", "-"}).code == ExitCode::usage);
    CHECK(end({"check", "--fix", "-"}).code == ExitCode::usage);
    CHECK(end({"check", "--as", "a.scene", "b.scene"}).code == ExitCode::usage);
}

TEST_CASE("pages for shells and man are quoted") {
    CommandInfo tree{"abbe", "", "Renders.", "", {}, {}, {}};
    tree.actions.push_back(
        {"render", "Pictures", "Renders [a] scene: it's.", ".TH is no request\n'nor this", {}, {}, {}});
    tree.actions[0].flags.push_back({{"--x-y"}, "A|b", {"b"}, false, "Bob's [50 %]: so"});
    tree.actions[0].arguments.push_back({"scene", "A scene", {}, true, false});
    const auto pages = manPages(tree, "1.2.3");
    REQUIRE(pages.size() == 2);
    CHECK(pages[0].name == "abbe");
    CHECK(contains(pages[0].text, "\\fBabbe\\-render\\fR(1)\nRenders [a] scene: it's."));
    CHECK(pages[1].name == "abbe-render");
    const std::string man = pages[1].text;
    CHECK(contains(man, ".TH ABBE\\-RENDER 1 "));
    CHECK(contains(man, "\n\\&.TH is no request\n\\&'nor this\n"));
    CHECK(contains(man, "\\fB\\-\\-x\\-y\\fR"));
    CHECK(contains(man, "abbe 1.2.3"));
    CHECK(contains(zshCompletion(tree, {"camera"}), R"('*--x-y=[Bob'\''s \[50 %\]\: so]:A|b:(b)')"));
    CHECK(contains(fishCompletion(tree, {"camera"}), R"(-l x-y -x -a 'b' -d 'Bob\'s [50 %]: so')"));
    CHECK(contains(bashCompletion(tree, {"camera"}), "--x-y) value='b' ;;"));
}
