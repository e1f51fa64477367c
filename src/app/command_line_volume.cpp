#include "app/command_line_volume.h"

#include <CLI/CLI.hpp>

namespace abbe {

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

CLI::App* addAction(CLI::App& command, const char* name, const char* help, VolumeOptions& options,
                    VolumeOptions::Action action) {
    CLI::App* c = command.add_subcommand(name, help);
    c->set_help_flag("-h,--help", "Print this help");
    c->get_formatter()->column_width(28);
    c->callback([&options, action] { options.action = action; });
    return c;
}

void addConvert(CLI::App& command, VolumeOptions& v) {
    CLI::App* c = addAction(command, "convert", kConvertHelp, v, VolumeOptions::Action::convert);
    c->add_option("input", v.input, "OpenVDB file")->required()->type_name("");
    c->add_option("output", v.output, "OpenVDB file to write")->required()->type_name("");
    c->add_option("--grid", v.grids, "Only this grid; may be repeated")->allow_extra_args(false)->type_name("NAME");
    c->add_option("--resample", v.resample, "Size of the new voxels in old ones: 2 is an eighth of them")
        ->check(CLI::Range(0.1, 64.0).description(""))
        ->type_name("FACTOR");
    c->add_flag("--fog", v.fog, "Level sets become fog: 1 inside, 0 outside");
    c->add_flag("--clean", v.clean, "Values that are not finite or negative, and the background, become 0");
    c->add_flag("--half", v.half, "Store 16 bits a number");
    c->add_option("--prune", v.prune, "Merge voxels that differ by no more than this")
        ->check(CLI::NonNegativeNumber.description(""))
        ->type_name("TOLERANCE");
    c->add_option("--crop", v.crop, "Keep this box of the file's world: two corners")
        ->delimiter(',')
        ->expected(6)
        ->type_name("X,Y,Z,X,Y,Z");
}

} // namespace

void addVolumeActions(CLI::App& command, VolumeOptions& v, bool& json) {
    command.require_subcommand(1);
    CLI::App* info = addAction(command, "info", kVolumeInfoHelp, v, VolumeOptions::Action::info);
    info->add_option("file", v.input, "OpenVDB file")->required()->type_name("");
    info->add_flag("--json", json, "JSON on stdout");
    CLI::App* make = addAction(command, "make", kMakeHelp, v, VolumeOptions::Action::make);
    make->add_option("kind", v.input, "What is made")
        ->required()
        ->check(CLI::IsMember({"cumulus", "smoke", "fire", "candle"}).description(""))
        ->type_name("cumulus|smoke|fire|candle");
    make->add_option("output", v.output, "OpenVDB file to write")->required()->type_name("");
    make->add_option("--resolution", v.resolution, "Voxels along the longest side")
        ->check(CLI::Range(8, 4000).description(""))
        ->type_name("N");
    make->add_option("--seed", v.seed, "Another one of its kind")->type_name("N");
    make->add_flag("--quiet,-q", v.quiet, "Say nothing but errors");
    addConvert(command, v);
}

} // namespace abbe
