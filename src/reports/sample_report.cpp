#include "reports/sample_report.h"

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

namespace {

using Kind = PathEvent::Kind;

std::string lanes(const Spectrum& s) {
    std::string text;
    for (int i = 0; i < kLanes; ++i) text += fmt::format("{:>11.5g}", s[i]);
    return text;
}

std::string lobeNames(Lobes lobes) {
    constexpr std::pair<Lobe, std::string_view> kNames[] = {
        {Lobe::reflection, "reflected"}, {Lobe::transmission, "transmitted"}, {Lobe::diffuse, "diffuse"},
        {Lobe::glossy, "glossy"},        {Lobe::delta, "mirror-like"},        {Lobe::dispersive, "dispersive"}};
    std::string names;
    for (const auto& [lobe, name] : kNames)
        if (lobes.has(lobe)) names += (names.empty() ? "" : " ") + std::string(name);
    return names;
}

std::string nameIn(const Scene& scene, const void* thing) {
    const auto found = scene.names.find(thing);
    return found == scene.names.end() ? std::string() : found->second;
}

std::string triple(Vec3d v) { return fmt::format("{:.6g} {:.6g} {:.6g}", v.x, v.y, v.z); }

// World space.
Vec3d place(const PathEvent& e, const Scene& scene) { return scene.origin + Vec3d(e.hit.p); }

std::string whose(std::string_view noun, const std::string& name) {
    return name.empty() ? std::string() : fmt::format(", {} `{}`", noun, name);
}

std::string line(std::string_view what, const Spectrum& s) { return fmt::format("     {:<16}{}\n", what, lanes(s)); }

std::string scatteringText(const PathEvent& e) {
    if (!e.next) return "   not scattered: the path ends here\n";
    return fmt::format("   scattered {}, density {:.6g}, towards {}\n", lobeNames(e.next->lobe), e.next->pdfSolidAngle,
                       triple(Vec3d(e.hit.shading.toWorld(e.next->wi)))) +
           line("weight", e.next->weight);
}

std::string eventText(const PathEvent& e, const Scene& scene) {
    const std::string light = nameIn(scene, e.source);
    switch (e.kind) {
    case Kind::surface: {
        const auto instance =
            e.hit.instance == SurfaceHit::kNoInstance ? std::string() : fmt::format(" (instance {})", e.hit.instance);
        return fmt::format("{:<3}surface at {}{}{}{}\n", e.vertex, triple(place(e, scene)),
                           whose("object", nameIn(scene, e.hit.shape)), instance,
                           whose("material", nameIn(scene, e.hit.material))) +
               line("throughput", e.beta);
    }
    case Kind::collides:
        return fmt::format("{:<3}collision in a medium at {}\n", e.vertex, triple(place(e, scene))) +
               line("throughput", e.beta);
    case Kind::sampled:
        return fmt::format(
                   "   samples the light `{}` (next-event estimation), density {:.6g}; that of the material {:.6g}\n",
                   light, e.pdf, e.value.pdfSolidAngle) +
               line("radiance", e.radiance) + line("value", e.value.fcos);
    case Kind::hitLight:
        return fmt::format("   hits the light `{}`, density of next-event estimation {:.6g}\n", light, e.pdf) +
               line("radiance", e.radiance);
    case Kind::gathers:
        return line("gives the eye", e.light);
    case Kind::scatters:
        return scatteringText(e);
    case Kind::fault:
        return fmt::format("   fault: {} of `{}` is {}\n", e.what, light, e.pdf);
    case Kind::leaves:
        return fmt::format("{:<3}leaves the scene towards {}\n", e.vertex + 1, triple(Vec3d(e.direction)));
    }
    return {};
}

Json triad(Vec3d v) {
    Json list = Json::list();
    list.push(v.x).push(v.y).push(v.z);
    return list;
}

constexpr std::string_view kKinds[] = {"surface", "light_asked", "light_met", "contribution",
                                       "scatter", "collision",   "fault",     "escape"}; // by PathEvent::Kind

Json eventJson(const PathEvent& e, const Scene& scene) {
    Json json = Json::object({{"event", kKinds[static_cast<std::size_t>(e.kind)]}, {"vertex", e.vertex}});
    const auto light = [&] { json.set("light", nameOrNull(nameIn(scene, e.source))); };
    switch (e.kind) {
    case Kind::surface:
        json.set("object", nameOrNull(nameIn(scene, e.hit.shape)));
        json.set("material", nameOrNull(nameIn(scene, e.hit.material)));
        if (e.hit.instance != SurfaceHit::kNoInstance) json.set("instance", e.hit.instance);
        [[fallthrough]];
    case Kind::collides:
        json.set("position", triad(place(e, scene))).set("throughput", lanesJson(e.beta));
        break;
    case Kind::sampled:
        light();
        json.set("radiance", lanesJson(e.radiance)).set("value", lanesJson(e.value.fcos));
        json.set("density", static_cast<double>(e.value.pdfSolidAngle))
            .set("light_density", static_cast<double>(e.pdf));
        break;
    case Kind::hitLight:
        light();
        json.set("radiance", lanesJson(e.radiance)).set("light_density", static_cast<double>(e.pdf));
        break;
    case Kind::gathers:
        light();
        json.set("radiance", lanesJson(e.light));
        break;
    case Kind::scatters:
        if (!e.next) break;
        json.set("lobe", lobeNames(e.next->lobe)).set("weight", lanesJson(e.next->weight));
        json.set("density", static_cast<double>(e.next->pdfSolidAngle));
        json.set("direction", triad(Vec3d(e.hit.shading.toWorld(e.next->wi))));
        break;
    case Kind::fault:
        json.set("what", e.what).set("number", static_cast<double>(e.pdf));
        break;
    case Kind::leaves:
        json.set("direction", triad(Vec3d(e.direction)));
        break;
    }
    return json;
}

} // namespace

std::string replayText(const ReplayedSample& s, const Scene& scene) {
    std::string all = fmt::format("pixel {}  sample {}\n", pixelText(s.id), sampleText(s.id));
    all += line("wavelengths, nm", s.record.lambda().nm);
    for (const PathEvent& e : s.record.events()) all += eventText(e, scene);
    all += line("radiance", s.record.radiance());
    const Xyz xyz = s.record.xyz() * s.exposure;
    if (s.record.kept()) return all + fmt::format("XYZ {:.9g} {:.9g} {:.9g}\n", xyz.x, xyz.y, xyz.z);
    return all + fmt::format("dropped: {}\n", s.fault ? text(*s.fault) : std::string());
}

Json replayJson(const ReplayedSample& s, const Scene& scene) {
    Json events = Json::list();
    for (const PathEvent& e : s.record.events()) events.push(eventJson(e, scene));
    const Xyz xyz = s.record.xyz() * s.exposure;
    return Json::object({{"x", s.id.x},
                         {"y", s.id.y},
                         {"replicate", s.id.replicate},
                         {"sample", s.id.index},
                         {"wavelengths_nm", lanesJson(s.record.lambda().nm)},
                         {"events", std::move(events)},
                         {"radiance", lanesJson(s.record.radiance())},
                         {"kept", s.record.kept()},
                         {"xyz", s.record.kept() ? triad({xyz.x, xyz.y, xyz.z}) : Json()},
                         {"fault", s.fault ? faultJson(*s.fault) : Json()}});
}

} // namespace abbe
