#include "reports/provenance.h"

#include "app/hash128.h"
#include "app/version.h"
#include "rendering/render_params.h"
#include "reports/light_path_text.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

int asInt(std::uint64_t v) { return static_cast<int>(std::min<std::uint64_t>(v, 0x7fffffff)); }

} // namespace

std::string effectNames(Effects effects) {
    std::string names;
    for (const EffectInfo& info : kEffectTable)
        if (effects.has(info.effect)) names += (names.empty() ? "" : "+") + std::string(info.word);
    return names.empty() ? "none" : names;
}

std::string sceneHash(const LoadedScene& loaded, const SceneInput& input) {
    Hash128 hash;
    if (loaded.sources.fileCount() > 0) hash.addField(loaded.sources.text(FileId{0}));
    std::vector<std::string> defines = input.defines;
    std::sort(defines.begin(), defines.end());
    for (const std::string& define : defines) hash.addField(define);
    return hash.digits();
}

std::vector<ImageAttribute> provenance(const ProvenanceInput& p) {
    const RenderSettings& settings = *p.settings;
    const RenderStatistics& statistics = *p.statistics;
    std::vector<ImageAttribute> list;
    const auto text = [&](const char* name, std::string value) { list.push_back({name, std::move(value)}); };
    const auto whole = [&](const char* name, std::uint64_t value) { list.push_back({name, asInt(value)}); };
    const auto real = [&](const char* name, double value) { list.push_back({name, value}); };
    text("abbe.version", versionNumber());
    whole("abbe.edition", kLanguageEdition);
    text("abbe.scene", p.input->path);
    text("abbe.sceneHash", sceneHash(*p.loaded, *p.input));
    text("abbe.command", p.commandLine);
    text("abbe.seed", std::to_string(settings.seed));
    whole("abbe.samples", statistics.samplesPerPixel);
    whole("abbe.replicates", static_cast<std::uint64_t>(p.replicates));
    const Technique& technique = settings.technique;
    text("abbe.sampler", std::string(word(technique.numbers)));
    text("abbe.strategy", std::string(word(technique.strategy)));
    text("abbe.misWeights", std::string(word(technique.weights)));
    text("abbe.directions", std::string(word(technique.directions)));
    text("abbe.lightChoice", std::string(word(technique.lightChoice)));
    text("abbe.roulette", std::string(word(technique.roulette)));
    text("abbe.lightPathTechnique", std::string(word(technique.lightPaths)));
    text("abbe.mergingTechnique", std::string(word(technique.merging)));
    const auto& found = statistics.caustics.of<LightPathFindings>();
    if (found.verdict != LightPathVerdict::undecided) text("abbe.lightPathPlan", lightPathLine(found));
    if (found.measured || found.verdict == LightPathVerdict::noPilot)
        whole("abbe.pilot", static_cast<std::uint64_t>(statistics.caustics.pilot));
    if (found.measured) {
        real("abbe.lightPathShare", found.share);
        real("abbe.lightPathGain", found.gain);
    }
    whole("abbe.wavelengthsPerPath", technique.wavelengths);
    if (settings.maxDepth > 0) whole("abbe.maxDepth", settings.maxDepth); // a biased switch
    text("abbe.effects", effectNames(p.built->scene.effects));
    text("abbe.kernel", statistics.kernel);
    text("abbe.wavelengths", p.built->scene.wavelengths.followsLights() ? "lights" : "sech2");
    real("abbe.noise", p.noise);
    real("abbe.seconds", p.seconds);
    real("abbe.coreSeconds", statistics.coreSeconds);
    whole("abbe.droppedNan", statistics.dropped[static_cast<std::size_t>(DropCause::nan)]);
    whole("abbe.droppedInfinite", statistics.dropped[static_cast<std::size_t>(DropCause::infinite)]);
    whole("abbe.droppedNegative", statistics.dropped[static_cast<std::size_t>(DropCause::negative)]);
    if (statistics.excess.above > 0) {
        whole("abbe.densitiesAboveBound", statistics.excess.above);
        real("abbe.mostAboveBound", static_cast<double>(statistics.excess.most));
    }
    whole("abbe.partial", statistics.stopped ? 1 : 0);
    text("abbe.space", p.space);
    text("abbe.sceneRgb", std::string(schema::rgbSpaceId(p.loaded->tree.header.rgb)));
    real("abbe.exposure", p.built->exposure);
    real("abbe.exposureStops", p.built->cameraExposure.stops);
    if (p.built->cameraExposure.automatic) text("abbe.exposureMode", "auto");
    return list;
}

} // namespace abbe
