#include "app/command_line.h"

#include <doctest/doctest.h>
#include <initializer_list>

using namespace abbe;

namespace {

std::variant<Command, EarlyEnd> read(std::initializer_list<const char*> words) {
    return readCommandLine({words.begin(), words.size()});
}

RenderOptions render(std::initializer_list<const char*> words) {
    const auto result = read(words);
    REQUIRE_MESSAGE(std::holds_alternative<Command>(result), std::get<EarlyEnd>(result).text);
    return std::get<RenderOptions>(std::get<Command>(result).options);
}

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
    CHECK(o.build.strategy == "bsdf");
    CHECK_FALSE(o.png);
}

TEST_CASE("a define does not swallow the scene") { CHECK(render({"-D", "x=1", "a.scene"}).input.path == "a.scene"); }

TEST_CASE("the PNG has an optional name") {
    CHECK(render({"a.scene", "--png"}).png == "");
    CHECK(render({"--png", "a.scene"}).png == "");
    CHECK(render({"--png", "a.scene"}).input.path == "a.scene");
    CHECK(render({"a.scene", "--png=b.png"}).png == "b.png");
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
    CHECK(std::get<Command>(result).common.commandLine == R"(abbe render 'my scene.scene' -D 'a='\''x'\''')");
}

TEST_CASE("explain takes several words") {
    const auto result = read({"explain", "unit", "nits"});
    CHECK(std::get<ExplainOptions>(std::get<Command>(result).options).topic == "unit nits");
}
