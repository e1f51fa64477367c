#include "reports/found_fault.h"

#include "rendering/path_record.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

using Culprit = SampleFault::Culprit;

constexpr std::string_view kCauses[] = {"nan", "infinite", "negative"}; // by DropCause

std::string nameOf(const void* thing, const Scene& scene) {
    const auto found = scene.names.find(thing);
    return found == scene.names.end() ? std::string() : found->second;
}

constexpr std::string_view nounOf(Culprit culprit) {
    switch (culprit) {
    case Culprit::camera:
        return "camera";
    case Culprit::material:
        return "material";
    case Culprit::light:
        return "light";
    case Culprit::medium:
        return "medium";
    }
    return {};
}

// Things without a name have one that no definition has.
Span declarationOf(const FoundFault& f, Culprit culprit, const schema::SceneTree& tree) {
    const schema::Definition* d = nullptr;
    if (culprit == Culprit::light && !f.light.empty()) d = tree.find(schema::Kind::light, f.light);
    if (culprit == Culprit::material && !f.material.empty()) d = tree.find(schema::Kind::material, f.material);
    if (!d && culprit != Culprit::camera && !f.object.empty()) d = tree.find(schema::Kind::shape, f.object);
    return d ? d->nameSpan : Span{};
}

} // namespace

FoundFault describeFault(const DroppedSample& sample, const PathRecord& record, const Scene& scene,
                         const schema::SceneTree& tree) {
    const SampleFault fault = findFault(record);
    const PathEvent& at = fault.event;
    FoundFault f;
    f.sample = sample;
    f.cause = fault.cause;
    f.number = fault.number;
    f.what = fmt::format("{} of the {}", fault.what, nounOf(fault.culprit));
    if (fault.culprit == Culprit::camera) return f;
    f.vertex = at.vertex;
    f.object = nameOf(at.hit.shape, scene);
    f.material = nameOf(fault.culprit == Culprit::material ? fault.who : at.hit.material, scene);
    if (fault.culprit == Culprit::light) f.light = nameOf(fault.who, scene);
    f.instance = at.hit.instance;
    for (int i = 0; i < kLanes && fault.lanes != 0xff; ++i)
        if ((fault.lanes >> i & 1) != 0) f.wavelengths.push_back(record.lambda().nm[i]);
    f.declared = declarationOf(f, fault.culprit, tree);
    return f;
}

std::string pixelText(const SampleId& s) { return fmt::format("{},{}", s.x, s.y); }
std::string sampleText(const SampleId& s) { return fmt::format("{}:{}", s.replicate, s.index); }
std::string_view causeName(DropCause cause) { return kCauses[static_cast<std::size_t>(cause)]; }

std::vector<FoundFault> findFaults(std::span<const DroppedSample> dropped, const Integrator& integrator,
                                   const Scene& scene, const schema::SceneTree& tree, const Film& film,
                                   const RenderSettings& settings) {
    std::vector<FoundFault> found;
    if (dropped.empty()) return found;
    WatchedFilm watched(film, {dropped.begin(), dropped.end()});
    integrator.repeat(scene, watched, settings, watched.samples());
    for (std::size_t i = 0; i < dropped.size(); ++i)
        found.push_back(describeFault(dropped[i], watched.records()[i], scene, tree));
    return found;
}

std::string text(const FoundFault& f) {
    std::string s = f.vertex == 0 ? std::string("at the camera") : fmt::format("vertex {}", f.vertex);
    const auto add = [&](std::string_view noun, const std::string& name) {
        if (!name.empty()) s += fmt::format(", {} `{}`", noun, name);
    };
    add("object", f.object);
    if (f.instance != SurfaceHit::kNoInstance && !f.object.empty()) s += fmt::format(" (instance {})", f.instance);
    add("material", f.material);
    add("light", f.light);
    constexpr std::string_view kIs[] = {"not a number", "infinite", "negative"};
    s += fmt::format(": the {} is ", f.what);
    if (f.cause == DropCause::infinite && std::isfinite(f.number))
        s += fmt::format("too large ({:.3g}) at ", f.number);
    else
        s += fmt::format("{} at ", kIs[static_cast<std::size_t>(f.cause)]);
    if (f.wavelengths.empty()) return s + "all wavelengths";
    for (std::size_t i = 0; i < f.wavelengths.size(); ++i)
        s += fmt::format("{}{:.1f}", i ? ", " : "", f.wavelengths[i]);
    return s + " nm";
}

std::string listText(std::span<const FoundFault> faults) {
    std::string list;
    for (const FoundFault& f : faults)
        list += fmt::format("{} {} {} {}\n", pixelText(f.sample), sampleText(f.sample), causeName(f.cause), text(f));
    return list;
}

std::vector<DroppedSample> readList(std::string_view list) {
    std::vector<DroppedSample> samples;
    while (!list.empty()) {
        const std::string_view line = list.substr(0, list.find('\n'));
        list.remove_prefix(std::min(list.size(), line.size() + 1));
        const char* at = line.data();
        const char* const end = at + line.size();
        DroppedSample s;
        bool read = true;
        const auto number = [&](auto& v, char after) {
            const auto result = std::from_chars(at, end, v);
            read = read && result.ec == std::errc() && result.ptr < end && *result.ptr == after;
            at = std::min(end, result.ptr + 1);
        };
        number(s.x, ',');
        number(s.y, ' ');
        number(s.replicate, ':');
        number(s.index, ' ');
        if (read) samples.push_back(s);
    }
    return samples;
}

Json nameOrNull(const std::string& name) { return name.empty() ? Json() : Json(name); }

Json lanesJson(const Spectrum& s) {
    Json list = Json::list();
    for (int i = 0; i < kLanes; ++i) list.push(static_cast<double>(s[i]));
    return list;
}

Json faultJson(const FoundFault& f) {
    Json wavelengths = Json::list();
    for (const float nm : f.wavelengths) wavelengths.push(static_cast<double>(nm));
    return Json::object({{"x", f.sample.x},
                         {"y", f.sample.y},
                         {"replicate", f.sample.replicate},
                         {"sample", f.sample.index},
                         {"dropped_as", causeName(f.sample.cause)},
                         {"cause", causeName(f.cause)},
                         {"vertex", f.vertex},
                         {"object", nameOrNull(f.object)},
                         {"material", nameOrNull(f.material)},
                         {"light", nameOrNull(f.light)},
                         {"what", f.what},
                         {"wavelengths_nm", std::move(wavelengths)}});
}

} // namespace abbe
