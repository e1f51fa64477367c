#include "app/command_line_verify.h"

#include "app/argument_values.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <fmt/format.h>

namespace abbe {

namespace {

// "0.1" or "0.1%": per cent.
double readPercent(const char* option, const std::string& text) {
    double percent = 0;
    const char* last = text.data() + text.size();
    const auto [end, fault] = std::from_chars(text.data(), last, percent);
    const std::string_view rest(end, static_cast<std::size_t>(last - end));
    if (fault != std::errc() || !(rest.empty() || rest == "%" || rest == " %") || !(percent > 0 && percent <= 100))
        throw CLI::ValidationError(option, fmt::format("`{}` is not a part in per cent such as 0.1", text));
    return percent / 100;
}

} // namespace

const char* const kVerifyHelp = R"(Renders a scene by two independent estimators and tests whether they agree.

Examples:
  abbe verify room.scene                     seconds to minutes; exit code 4 if they differ
  abbe verify room.scene --resolution 0.02   know the difference to 0.02 % of the picture
  abbe verify room.scene --size 320x180 --time 20min
  abbe verify room.scene --samples 1024 --seed 7 --json)";

void addVerifyArguments(CLI::App& command, VerifyOptions& o, CommonOptions& common) {
    command.add_option("scene", o.input.path, "Scene file")->required()->type_name("");
    command.add_option("--camera", o.build.camera, "Camera to render; without it the first one")->type_name("NAME");
    const auto read = [&command](const char* name, const char* type, const char* help, auto store) {
        command.add_option_function<std::string>(name, store, help)->type_name(type);
    };
    read("--size", "WxH", "Size of the pictures; without it that of the scene, at most 96 pixels a side",
         [&o](const std::string& text) {
             if (!(o.build.size = readSize(text)))
                 throw CLI::ValidationError("--size", fmt::format("`{}` is not a size such as 160x90", text));
         });
    read("--resolution", "PERCENT", "Standard error of the difference to render to; 0.1 when absent",
         [&o](const std::string& text) { o.resolution = readPercent("--resolution", text); });
    read("--time", "TIME", "Most time for it: 90, 20min, 2h; 5min when absent", [&o](const std::string& text) {
        const auto value = readQuantity(text, schema::Dimension::time);
        if (!value || !(*value > 0 && *value <= 1e9))
            throw CLI::ValidationError("--time", fmt::format("`{}` is not a time such as 20min", text));
        o.timeLimit = *value;
    });
    command.add_option("--samples", o.samples, "Samples per pixel of either, in place of resolution and time")
        ->check(CLI::Range(std::int64_t{32}, std::int64_t{1} << 24).description(""))
        ->type_name("N");
    read("--level", "PERCENT", "Probability of a false alarm; 0.1 when absent",
         [&o](const std::string& text) { o.level = readPercent("--level", text); });
    command.add_option("--seed", o.build.seed, "Choose other random numbers")
        ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 52).description(""))
        ->type_name("N");
    command.add_option("-t,--threads", common.threads, "Threads; without it one per core")
        ->check(CLI::Range(1, 4096).description(""))
        ->type_name("N");
    command.add_flag("--strict", o.strict, "Warnings end with exit code 4, too");
    command.add_flag("--json", common.json, "JSON lines on stdout");
    command.add_flag("--quiet,-q", o.quiet, "Say nothing but the result");
}

} // namespace abbe
