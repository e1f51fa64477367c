// `abbe study --effects`: what each effect of a scene costs and shows.
#pragma once

#include "app/load.h"
#include "commands/command_table.h"
#include "study/effect_study.h"

#include <string>

namespace abbe {

// Renders, and writes NAME.json, NAME.csv and NAME.html. The scene is built without errors by `build`. Throws IoError.
ExitCode studyEffects(const StudyOptions&, const CommonOptions&, const LoadedScene&, const BuildOptions& build,
                      const std::string& name);

// "abbe-study/1" without curves: docs/study.md describes it.
std::string effectsJson(const EffectStudy&, const StudyOptions&, const CommonOptions&, const LoadedScene&);
// A line for each effect.
std::string effectsCsv(const EffectStudy&);
std::string effectsTable(const EffectStudy&);

} // namespace abbe
