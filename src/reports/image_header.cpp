#include "reports/image_header.h"

#include "app/identity.h"
#include "base/file.h"
#include "io/file.h"
#include "rendering/render_params.h"
#include "reports/render_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
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
    if (loaded.text != FileId::none) hash.addField(loaded.sources.text(loaded.text));
    std::vector<std::string> defines = input.defines;
    std::sort(defines.begin(), defines.end());
    for (const std::string& define : defines) hash.addField(define);
    for (const auto& [file, insert] : loaded.tree.inserts)
        if (insert.written && !insert.source.empty()) {
            hash.addField("include " + insert.prefix);
            hash.addField(loaded.sources.text(file));
        }
    for (const std::string& variant : input.layers.variants) hash.addField("variant " + variant);
    for (const std::string& set : input.layers.sets) hash.addField("set " + set);
    if (input.frame) hash.addField(fmt::format("frame {}", *input.frame));
    return hash.digits();
}

namespace {

// What of the layers was chosen.
void addLayerChoice(const ProvenanceInput& p, std::vector<ImageAttribute>& list) {
    std::string variants, sets;
    for (const schema::VariantName& variant : p.loaded->tree.variants)
        if (variant.chosen) variants += (variants.empty() ? "" : " ") + variant.name;
    for (const std::string& set : p.input->layers.sets) sets += (sets.empty() ? "" : "\n") + set;
    if (!variants.empty()) list.push_back({"abbe.variants", std::move(variants)});
    if (!sets.empty()) list.push_back({"abbe.set", std::move(sets)});
}

} // namespace

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
    addLayerChoice(p, list);
    text("abbe.command", p.commandLine);
    if (p.input->frame) {
        list.push_back({"abbe.frame", *p.input->frame});
        real("abbe.fps", p.built->render.fps);
        real("abbe.time", p.built->shutter.open);
    }
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
    const auto& guide = statistics.caustics.of<GuideFindings>();
    if (found.measured || found.verdict == LightPathVerdict::noPilot || guide.verdict == GuideFindings::Verdict::used)
        whole("abbe.pilot", static_cast<std::uint64_t>(statistics.caustics.pilot));
    if (found.measured) {
        real("abbe.lightPathShare", found.share);
        real("abbe.lightPathGain", found.gain);
    }
    text("abbe.guidingTechnique", std::string(word(technique.guiding)));
    text("abbe.windowTechnique", std::string(word(technique.windows)));
    if (const std::string line = guideLine(guide); !line.empty()) text("abbe.guide", line);
    whole("abbe.wavelengthsPerPath", technique.wavelengths);
    if (settings.maxDepth > 0) whole("abbe.maxDepth", settings.maxDepth); // a biased switch
    text("abbe.effects", effectNames(p.built->scene.effects));
    text("abbe.kernel", statistics.kernel);
    text("abbe.wavelengths", p.built->scene.wavelengths.followsLights() ? "lights" : "sech2");
    real("abbe.noise", p.noise);
    real("abbe.seconds", p.seconds);
    real("abbe.coreSeconds", statistics.coreSeconds + statistics.pilotCoreSeconds);
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

namespace {

constexpr const char* kCertificateFormat = "abbe-certificate 1";
constexpr const char* kNoVerdict = "none: ";
constexpr const char* kCaveat =
    "estimated from the samples: what no sample has hit is not in the image nor in its error";

constexpr const char* kRelative = "abbe.error";
constexpr const char* kDisplay = "abbe.errorDisplay";

std::string text(PixelBounds b) { return fmt::format("{} {} {} {}", b.x0, b.y0, b.x1, b.y1); }

void addFigure(std::vector<ImageAttribute>& list, const std::string& name, const ErrorFigure& f) {
    list.push_back({name, f.value});
    list.push_back({name + "Low", f.low});
    list.push_back({name + "High", f.high});
    list.push_back({name + "Pixels", std::to_string(f.pixels)});
    list.push_back({name + "WorstTile", text(f.worst.pixels)});
    list.push_back({name + "Worst", f.worst.value});
    list.push_back({name + "Tail", f.tail});
    list.push_back({name + "Unseen", f.unseen});
    list.push_back({name + "Tiles", std::to_string(f.tiles)});
    list.push_back({name + "TilesUntrusted", std::to_string(f.untrustedTiles)});
}

// Values of a header by name.
class Header {
  public:
    explicit Header(std::span<const ImageAttribute> attributes) : attributes_(attributes) {}

    template <typename Value> std::optional<Value> get(const std::string& name) const {
        for (const ImageAttribute& a : attributes_)
            if (a.name == name)
                if (const auto* value = std::get_if<Value>(&a.value)) return *value;
        return std::nullopt;
    }
    std::uint64_t whole(const std::string& name) const {
        std::uint64_t value = 0;
        const std::string digits = get<std::string>(name).value_or("");
        std::from_chars(digits.data(), digits.data() + digits.size(), value);
        return value;
    }
    std::optional<ErrorFigure> figure(const std::string& name) const {
        const auto value = get<double>(name), low = get<double>(name + "Low"), high = get<double>(name + "High");
        if (!value || !low || !high) return std::nullopt;
        ErrorFigure f{*value, *low, *high, static_cast<std::int64_t>(whole(name + "Pixels")), {}};
        f.worst.value = get<double>(name + "Worst").value_or(0);
        const std::string tile = get<std::string>(name + "WorstTile").value_or("");
        const char *next = tile.data(), *end = next + tile.size();
        for (int* edge : {&f.worst.pixels.x0, &f.worst.pixels.y0, &f.worst.pixels.x1, &f.worst.pixels.y1}) {
            while (next != end && *next == ' ') ++next;
            next = std::from_chars(next, end, *edge).ptr;
        }
        f.tail = get<double>(name + "Tail").value_or(0);
        f.unseen = get<double>(name + "Unseen").value_or(0);
        f.tiles = static_cast<std::int64_t>(whole(name + "Tiles"));
        f.untrustedTiles = static_cast<std::int64_t>(whole(name + "TilesUntrusted"));
        return f;
    }

  private:
    std::span<const ImageAttribute> attributes_;
};

Json json(const ErrorFigure& f) {
    const PixelBounds& b = f.worst.pixels;
    return Json::object(
        {{"value", f.value},
         {"low", f.low},
         {"high", f.high},
         {"pixels", f.pixels},
         {"pareto_k", f.tail},
         {"unseen", f.unseen},
         {"tiles", f.tiles},
         {"tiles_untrusted", f.untrustedTiles},
         {"worst_tile",
          Json::object({{"x0", b.x0}, {"y0", b.y0}, {"x1", b.x1}, {"y1", b.y1}, {"value", f.worst.value}})}});
}

Json samplesJson(const ErrorCertificate& c, const RenderStatistics& s) {
    Json object =
        Json::object({{"per_pixel", Json::object({{"fewest", c.fewest}, {"mean", c.samples}, {"most", c.most}})},
                      {"replicates", c.replicates}});
    Json dropped = Json::object();
    for (const auto& counter : countersOf(s)) {
        if (isReported(counter, s)) object.set(counter.name, *counter.place);
        if (counter.reported == Reported::asDropped) dropped.set(counter.name, *counter.place);
    }
    return object.set("dropped", dropped);
}

// "abbe.lightPaths" for "light_paths".
std::string attributeName(std::string_view name) {
    std::string attribute = "abbe.";
    for (std::size_t i = 0; i < name.size(); ++i) {
        const bool word = name[i] == '_' && i + 1 < name.size();
        attribute += word ? static_cast<char>(std::toupper(static_cast<unsigned char>(name[++i]))) : name[i];
    }
    return attribute;
}

} // namespace

std::vector<ImageAttribute> certificateAttributes(const ErrorCertificate& c, const RenderStatistics& s) {
    std::vector<ImageAttribute> list{
        {"abbe.certificate", c.reason.empty() ? kCertificateFormat : kNoVerdict + c.reason}};
    if (c.reason.empty()) {
        addFigure(list, kRelative, c.relative);
        if (c.display) addFigure(list, kDisplay, *c.display);
        list.push_back(
            {c.display ? "abbe.errorDisplayView" : "abbe.errorDisplayReason", c.display ? c.view : c.displayReason});
    }
    list.push_back({"abbe.samplesFewest", std::to_string(c.fewest)});
    list.push_back({"abbe.samplesMean", c.samples});
    list.push_back({"abbe.samplesMost", std::to_string(c.most)});
    for (const auto& counter : countersOf(s))
        if (counter.reported != Reported::withRounds && isReported(counter, s)) // those are reported with the bias
            list.push_back({attributeName(counter.name), std::to_string(*counter.place)});
    if (c.merged) {
        list.push_back({"abbe.estimator", "consistent"}); // and not unbiased
        list.push_back({"abbe.mergedRounds", std::to_string(c.merged->rounds)});
        list.push_back({"abbe.mergedShare", c.merged->share});
        list.push_back({"abbe.mergedBias", c.merged->bias});
        list.push_back({"abbe.mergedBiasOfTiles", c.merged->biasOfTiles});
    }
    return list;
}

std::optional<ErrorCertificate> readCertificate(std::span<const ImageAttribute> attributes) {
    const Header header(attributes);
    const auto verdict = header.get<std::string>("abbe.certificate");
    if (!verdict) return std::nullopt;
    ErrorCertificate c;
    c.replicates = header.get<int>("abbe.replicates").value_or(0);
    c.fewest = header.whole("abbe.samplesFewest");
    c.samples = header.get<double>("abbe.samplesMean").value_or(0);
    c.most = header.whole("abbe.samplesMost");
    if (verdict->starts_with(kNoVerdict)) c.reason = verdict->substr(std::string_view(kNoVerdict).size());
    const auto relative = header.figure(kRelative);
    if (relative) c.relative = *relative;
    if (!relative && c.reason.empty()) c.reason = fmt::format("the header lacks `{}`", kRelative);
    if (const auto share = header.get<double>("abbe.mergedShare"))
        c.merged =
            MergedLight{*share, header.get<double>("abbe.mergedBias").value_or(0),
                        header.get<double>("abbe.mergedBiasOfTiles").value_or(0), header.whole("abbe.mergedRounds")};
    c.display = header.figure(kDisplay);
    c.view = header.get<std::string>("abbe.errorDisplayView").value_or("");
    c.displayReason = header.get<std::string>("abbe.errorDisplayReason").value_or("");
    return c;
}

std::string certificateLine(const ErrorCertificate& c) {
    if (!c.reason.empty()) return "no certificate: " + c.reason;
    const ErrorFigure& r = c.relative;
    std::string line =
        fmt::format("error {:.3g} % (95 %: {:.3g} to {:.3g} %)", 100 * r.value, 100 * r.low, 100 * r.high);
    if (c.display)
        line += fmt::format("   display {:.3g} of 255 ({:.3g} to {:.3g})", c.display->value, c.display->low,
                            c.display->high);
    return line;
}

std::string mergedLine(const MergedLight& m) {
    return fmt::format("merged light {:.3g} % of the picture, in {} rounds: consistent, not unbiased; its blur changes "
                       "tiles of 8×8 by at most about {:.2g} %, the whole by {:+.2g} %",
                       100 * m.share, m.rounds, 100 * m.biasOfTiles, 100 * m.bias);
}

std::string tailLine(const ErrorFigure& f) {
    std::string line =
        fmt::format("variance.Y cannot be trusted in {} of {} tiles of 16×16 pixels: few samples carry it",
                    f.untrustedTiles, f.tiles);
    if (f.unseen > 0)
        line += fmt::format("; what is too rare to have been met adds about {:.2g} % to the squared error (Pareto k "
                            "{:.2g})",
                            100 * f.unseen, f.tail);
    return line;
}

Json certificateJson(const ErrorCertificate& c) {
    const bool stated = c.reason.empty();
    Json object = Json::object({{"stated", stated}, {"reason", stated ? Json() : Json(c.reason)}, {"level", 0.95}});
    object.set("relative", stated ? json(c.relative) : Json());
    object.set("display", stated && c.display ? json(*c.display) : Json());
    object.set("view", c.view).set("display_reason", c.displayReason.empty() ? Json() : Json(c.displayReason));
    object.set("merged", !c.merged ? Json()
                                   : Json::object({{"estimator", "consistent"},
                                                   {"share", c.merged->share},
                                                   {"rounds", c.merged->rounds},
                                                   {"bias", c.merged->bias},
                                                   {"bias_of_tiles", c.merged->biasOfTiles}}));
    return object.set("caveat", kCaveat);
}

bool isForeignCertificate(const std::string& path) {
    RegularFile file(path);
    if (!file.good()) return false;
    const std::string known = fmt::format("{{\n  \"format\": \"{}", std::string_view(kCertificateFormat).substr(0, 17));
    std::string head(known.size(), '\0');
    return file.readAt(0, head) < head.size() || head != known;
}

void writeCertificateFile(const std::string& path, const CertificateFacts& facts) {
    const RenderSummary& s = *facts.summary;
    double seconds = 0;
    for (const auto& phase : s.phases) seconds += phase.second;
    Json file = Json::object({{"format", kCertificateFormat},
                              {"image", std::filesystem::path(s.image).filename().string()},
                              {"partial", s.statistics.stopped || s.partial},
                              {"parts", facts.parts},
                              {"error", certificateJson(*s.certificate)},
                              {"samples", samplesJson(*s.certificate, s.statistics)},
                              {"seconds", seconds},
                              {"core_seconds", s.statistics.coreSeconds + s.statistics.pilotCoreSeconds},
                              {"scene_hash", facts.sceneHash},
                              {"seed", facts.seed},
                              {"program", versionNumber()}});
    if (s.statistics.caustics.of<LightPathFindings>().verdict != LightPathVerdict::undecided)
        file.set("light_path_plan", lightPathJson(s.statistics.caustics));
    if (s.statistics.caustics.of<GuideFindings>().verdict != GuideFindings::Verdict::undecided)
        file.set("guiding", guideJson(s.statistics.caustics.of<GuideFindings>()));
    addLook(file, s.statistics.look);
    writeAtomically(path, file.text(true) + "\n");
}

} // namespace abbe
