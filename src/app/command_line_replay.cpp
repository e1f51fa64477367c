#include "app/command_line_replay.h"

#include "app/argument_values.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace abbe {

const char* const kReplayHelp = R"(Takes single samples of a render again and tells what happened, vertex by vertex.

Examples:
  abbe replay room.exr                              all samples that the header lists as dropped
  abbe replay room.scene --pixel 31,7 --sample 1:12      sample 12 of replicate 1, dropped or not
  abbe replay room.exr --pixel 31,7 --sample 1:12 --json

A sample has the bits that it has in the render with the same scene, size, camera, seed and studies.)";

void addReplayArguments(CLI::App& command, ReplayOptions& options, CommonOptions& common) {
    BuildOptions& b = options.render.build;
    const auto read = [&command](const char* name, auto& place, const char* type, const char* help,
                                 const char* expected, auto readValue) {
        const auto store = [&place, expected, readValue, name](const std::string& text) {
            if (!(place = readValue(text)))
                throw CLI::ValidationError(name, fmt::format("`{}` is not {}", text, expected));
        };
        command.add_option_function<std::string>(name, store, help)->type_name(type);
    };
    command.add_option("input", options.render.input.path, "Scene, or an image that was rendered from one")
        ->required()
        ->type_name("");
    read("--pixel", options.pixel, "X,Y", "The pixel", "a pixel such as 12,34", readAnyPixel);
    read("--sample", options.sample, "R:I", "Sample I of replicate R, both from 0", "a sample such as 1:12",
         readSample);
    command.add_option("--camera", b.camera, "Camera of the render")->type_name("NAME");
    read("--size", b.size, "WxH", "Size of the whole image in pixels", "a size such as 640x480", readSize);
    command.add_option("--seed", b.seed, "Seed of the render")
        ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 53).description(""))
        ->type_name("N");
    command.add_option("--pilot", b.pilot, "Size of its pilots, `abbe.pilot` of the image's header; else by the work")
        ->check(CLI::Range(0, RenderSettings::kFullPilot).description(""))
        ->type_name("N");
    command.add_option("-D", options.render.input.defines, "A parameter of the scene; may be repeated")
        ->allow_extra_args(false)
        ->type_name("NAME=VALUE");
    command.add_option("--strategy", b.strategy, "How light was found")
        ->check(CLI::IsMember({"mis", "lights", "bsdf"}).description(""))
        ->type_name("mis|lights|bsdf");
    command.add_option("--sampler", b.sampler, "Where random numbers came from")
        ->check(CLI::IsMember({"sobol", "stratified", "random"}).description(""))
        ->type_name("sobol|stratified|random");
    command.add_option("-t,--threads", common.threads, "Threads; without it one per core")
        ->check(CLI::Range(1, 4096).description(""))
        ->type_name("N");
    command.add_flag("--json", common.json, "JSON on stdout");
}

} // namespace abbe
