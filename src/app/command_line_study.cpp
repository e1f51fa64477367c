#include "app/command_line_study.h"

#include "app/argument_values.h"
#include "schema/scene_tree.h"
#include "study/study_variant.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <fmt/format.h>

namespace abbe {

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

void readVariants(const std::string& text, StudyOptions& options) {
    options.variants.clear();
    options.listVariants = text == "list";
    if (text == "all")
        for (const std::string_view id : allIds()) options.variants.emplace_back(id);
    if (text == "all" || text == "none" || text == "list") return;
    const auto known = allIds();
    for (const std::string& id : splitAtCommas(text)) {
        if (std::find(known.begin(), known.end(), id) == known.end()) {
            const std::string_view near = schema::nearest(id, known);
            throw CLI::ValidationError("--variants",
                                       fmt::format("no variant is named `{}`{}; `--variants list` lists them", id,
                                                   near.empty() ? "" : fmt::format(" (did you mean `{}`?)", near)));
        }
        options.variants.push_back(id);
    }
}

// "1,0.3,0.1" or "1%,0.3%": per cent.
void readErrors(const std::string& text, StudyOptions& options) {
    options.errors.clear();
    for (std::string part : splitAtCommas(text)) {
        std::erase_if(part, [](char c) { return c == '%' || c == ' '; });
        double percent = 0;
        const char* last = part.data() + part.size();
        const auto [end, fault] = std::from_chars(part.data(), last, percent);
        if (fault != std::errc() || end != last || !(percent > 0 && percent <= 100))
            throw CLI::ValidationError("--error",
                                       fmt::format("`{}` is no list of errors in per cent such as 1,0.3,0.1", text));
        options.errors.push_back(percent / 100);
    }
    std::sort(options.errors.rbegin(), options.errors.rend());
}

} // namespace

const char* const kStudyHelp = R"(Measures what accuracy costs in time on a scene, and what each technique is worth.

Examples:
  abbe study room.scene                        room-study.html, .csv and .json: minutes
  abbe study room.scene --size 640x360 --samples 1024 --seeds 16
  abbe study room.scene --variants no-nee,random,denoised
  abbe study room.scene --variants list        what can be changed
  abbe study room.scene --effects              what each effect of the scene is worth
  abbe study room.scene --time 20min           as much as that allows
  abbe study room.scene --resume               goes on where it was interrupted)";

void addStudyArguments(CLI::App& command, StudyOptions& o, CommonOptions& common) {
    command.add_option("scene", o.input.path, "Scene file")->required()->type_name("");
    command.add_option("-o,--output", o.output, "DIR/NAME of NAME.html, NAME.csv and NAME.json")->type_name("NAME");
    command.add_option("--camera", o.build.camera, "Camera to render; without it the first one")->type_name("NAME");
    const auto read = [&command](const char* name, const char* type, const char* help, auto store) {
        command.add_option_function<std::string>(name, store, help)->type_name(type);
    };
    read("--size", "WxH", "Size of the pictures; without it that of the scene, at most 160 pixels a side",
         [&o](const std::string& text) {
             if (!(o.build.size = readSize(text)))
                 throw CLI::ValidationError("--size", fmt::format("`{}` is not a size such as 160x90", text));
         });
    command.add_option("--samples", o.samples, "Samples per pixel of the last rung; 64, or what --time allows")
        ->check(CLI::Range(std::int64_t{8}, std::int64_t{1} << 24).description(""))
        ->type_name("N");
    command.add_option("--seeds", o.seeds, "Replicates of each curve; 8 when absent")
        ->check(CLI::Range(2, 1000).description(""))
        ->type_name("N");
    command.add_option("--seed", o.build.seed, "Choose other random numbers")
        ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 52).description(""))
        ->type_name("N");
    read("--variants", "LIST", "What is changed: ids with commas, all, none; list: print them",
         [&o](const std::string& text) { readVariants(text, o); });
    read("--error", "LIST", "Errors in per cent to tell the time to: 1,0.3,0.1",
         [&o](const std::string& text) { readErrors(text, o); });
    read("--time", "TIME", "For the whole study: 90, 20min, 2h", [&o](const std::string& text) {
        const auto value = readQuantity(text, schema::Dimension::time);
        if (!value || !(*value > 0 && *value <= 1e9))
            throw CLI::ValidationError("--time", fmt::format("`{}` is not a time such as 20min", text));
        o.timeLimit = value;
    });
    command.add_flag("--effects", o.effects, "Measure what each effect costs and shows, in place of curves");
    command.add_flag("--resume", o.resume, "Go on from what an interrupted study has saved");
    command.add_option("-t,--threads", common.threads, "Threads; without it one per core")
        ->check(CLI::Range(1, 4096).description(""))
        ->type_name("N");
    command.add_flag("--json", common.json, "Progress as JSON lines on stdout");
    command.add_flag("--quiet,-q", o.quiet, "Say nothing but warnings and errors");
    readVariants("all", o);
}

} // namespace abbe
