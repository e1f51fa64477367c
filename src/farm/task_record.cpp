#include "farm/task_record.h"

#include "io/file.h"

#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace abbe {

namespace {

using Event = nlohmann::ordered_json; // the only kind that the program instantiates

double numberIn(const Event& event, const char* name) {
    const auto found = event.find(name);
    return found != event.end() && found->is_number() ? found->get<double>() : 0;
}

std::string textIn(const Event& event, const char* name) {
    const auto found = event.find(name);
    return found != event.end() && found->is_string() ? found->get<std::string>() : std::string();
}

void note(const Event& event, TaskRecord& record) {
    const std::string kind = textIn(event, "event");
    if (kind == "start") ++record.starts;
    if (kind == "progress" || kind == "done") {
        record.coreSeconds = numberIn(event, kind == "done" ? "core_seconds" : "core_s");
        if (const double noise = numberIn(event, "noise"); noise > 0) record.noise = noise;
    }
    if (kind == "progress") record.fraction = numberIn(event, "done");
    if (kind == "error") record.fault = fmt::format("{}: {}", textIn(event, "code"), textIn(event, "message"));
}

std::string contentsOf(const std::string& path) {
    RegularFile file(path);
    return file.good() ? file.readAll() : std::string();
}

} // namespace

TaskRecord readTaskRecord(const FarmPlan& plan, const FarmFolder& folder, const FarmTask& task) {
    TaskRecord record;
    const std::string events = contentsOf(folder.eventsFile(plan, task));
    // The last line may be half written, and one of a killed process may be torn.
    for (std::size_t at = 0; at < events.size();) {
        const std::size_t end = std::min(events.find('\n', at), events.size());
        const Event event = Event::parse(events.begin() + static_cast<std::ptrdiff_t>(at),
                                         events.begin() + static_cast<std::ptrdiff_t>(end), nullptr, false);
        if (event.is_object()) note(event, record);
        at = end + 1;
    }
    const Event result = Event::parse(contentsOf(folder.resultFile(plan, task)), nullptr, false);
    if (result.is_object() && result.contains("exit")) record.exit = static_cast<int>(numberIn(result, "exit"));
    std::error_code error;
    record.outputThere = std::filesystem::exists(folder.outputOf(plan, task), error);
    if (record.done()) {
        record.fraction = 1;
        record.fault.clear();
    }
    return record;
}

const TaskRecord& TaskRecords::of(const FarmPlan& plan, const FarmTask& task) {
    const auto [known, isNew] = known_.try_emplace(folder_.nameOf(plan, task));
    if (isNew) known->second = {readTaskRecord(plan, folder_, task), folder_.outputOf(plan, task)};
    return known->second.record;
}

void TaskRecords::forgetUndone() {
    std::error_code error;
    std::erase_if(known_, [&](const auto& known) {
        return !known.second.record.done() || !std::filesystem::exists(known.second.output, error);
    });
}

void writeTaskResult(const FarmPlan& plan, const FarmFolder& folder, const FarmTask& task, int exit) {
    writeAtomically(folder.resultFile(plan, task), fmt::format("{{\"exit\": {}}}\n", exit));
}

} // namespace abbe
