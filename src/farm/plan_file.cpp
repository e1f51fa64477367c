// The plan of a shot as JSON, which people may read and nobody else writes.
#include "app/identity.h"
#include "farm/farm_plan.h"
#include "io/file.h"

#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace abbe {

namespace {

using PlanJson = nlohmann::ordered_json;

constexpr int kPlanFormat = 1;

std::string thisProgram() { return "abbe " + versionNumber(); }

PlanJson jsonOfRound(const FarmRound& r) {
    return {{"from", r.from}, {"to", r.to}, {"parts", r.parts}, {"frames", r.frames}, {"tries", r.tries}};
}

FarmRound roundOf(const PlanJson& json) {
    FarmRound r;
    r.from = json.at("from").get<std::uint32_t>();
    r.to = json.at("to").get<std::uint32_t>();
    r.parts = json.at("parts").get<int>();
    r.frames = json.at("frames").get<std::vector<int>>();
    r.tries = json.at("tries").get<int>();
    if (r.from >= r.to || r.parts < 1 || r.frames.empty()) throw std::invalid_argument("a round without samples");
    return r;
}

// One list for both directions, so that nothing is written that is not read.
template <typename Field> void planFields(FarmPlan& p, const Field& field) {
    field("program", p.program);
    field("executable", p.executable);
    field("folder", p.folder);
    field("scene", p.scene);
    field("render_words", p.renderWords);
    field("merge_words", p.mergeWords);
    field("image", p.image);
    field("animation", p.animation);
    field("width", p.width);
    field("height", p.height);
    field("replicates", p.replicates);
    field("samples", p.samples);
    field("noise", p.noise);
    field("sample_seconds", p.sampleSeconds);
    field("cores", p.cores);
    field("chunk_seconds", p.chunkSeconds);
    field("parts", p.parts);
    field("at_once", p.atOnce);
    field("most_tries", p.mostTries);
    field("sbatch_words", p.sbatchWords);
    field("said", p.said);
    field("jobs", p.jobs);
    field("offsets", p.offsets);
}

} // namespace

FarmPlan FarmFolder::readPlan() const {
    std::error_code error;
    if (!std::filesystem::exists(planFile(), error))
        throw FarmFault("E0761", fmt::format("`{}` is not the folder of a shot: it has no plan.json", path_),
                        "`abbe farm submit SCENE` makes one, named after the image: `shot.farm`");
    const std::string text = readFileBytes(planFile());
    FarmPlan plan;
    try {
        const PlanJson json = PlanJson::parse(text);
        if (json.at("format").get<int>() != kPlanFormat) throw std::invalid_argument("another format");
        planFields(plan, [&](const char* name, auto& value) { json.at(name).get_to(value); });
        plan.outcome = outcomeNamed(json.at("outcome").get<std::string>());
        plan.engine = json.at("engine") == "slurm" ? FarmEngineKind::slurm : FarmEngineKind::local;
        for (const PlanJson& round : json.at("rounds")) plan.rounds.push_back(roundOf(round));
        if (plan.rounds.empty() || plan.replicates < 1) throw std::invalid_argument("no rounds");
    } catch (const std::exception& e) {
        throw FarmFault("E0762", fmt::format("`{}` is damaged: {}", planFile(), e.what()),
                        "parts in it can still be merged: `abbe merge FOLDER/parts/*.abbe -o FILE.exr`");
    }
    if (plan.program != thisProgram())
        throw FarmFault("E0762",
                        fmt::format("`{}` was planned by another program: `{}`, and this is `{}`", path_, plan.program,
                                    thisProgram()),
                        "samples may differ between versions: go on with that one, or submit the shot anew");
    plan.cancelled = isCancelled();
    return plan;
}

bool FarmFolder::isCancelled() const {
    std::error_code unreadable;
    return std::filesystem::exists(cancelFile(), unreadable);
}

void FarmFolder::setCancelled(bool cancelled) const {
    std::error_code ignored;
    if (cancelled)
        writeAtomically(cancelFile(), std::string_view("`abbe farm resume` goes on\n"));
    else
        std::filesystem::remove(cancelFile(), ignored);
}

void FarmFolder::writePlan(const FarmPlan& plan) const {
    PlanJson json{{"format", kPlanFormat}};
    FarmPlan copy = plan;
    if (copy.program.empty()) copy.program = thisProgram();
    planFields(copy, [&](const char* name, const auto& value) { json[name] = value; });
    json["outcome"] = plan.outcome ? wordOf(*plan.outcome) : "";
    json["engine"] = plan.engine == FarmEngineKind::slurm ? "slurm" : "local";
    json["rounds"] = PlanJson::array();
    for (const FarmRound& round : plan.rounds) json["rounds"].push_back(jsonOfRound(round));
    const std::string text = json.dump(2, ' ', false, PlanJson::error_handler_t::replace) + "\n";
    writeAtomically(planFile(), text);
}

} // namespace abbe
