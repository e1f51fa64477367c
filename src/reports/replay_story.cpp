#include "reports/replay_story.h"

#include "reports/found_fault.h"

#include <fmt/format.h>

namespace abbe {

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
        return fmt::format("   asks the light `{}`, density {:.6g}; that of the material {:.6g}\n", light, e.pdf,
                           e.value.pdfSolidAngle) +
               line("radiance", e.radiance) + line("value", e.value.fcos);
    case Kind::met:
        return fmt::format("   meets the light `{}`, density of asking for it {:.6g}\n", light, e.pdf) +
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
    case Kind::met:
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

std::string storyText(const ReplayedSample& s, const Scene& scene) {
    std::string all = fmt::format("pixel {}  sample {}\n", pixelText(s.id), sampleText(s.id));
    all += line("wavelengths, nm", s.record.lambda().nm);
    for (const PathEvent& e : s.record.events()) all += eventText(e, scene);
    all += line("radiance", s.record.radiance());
    const Xyz xyz = s.record.xyz() * s.exposure;
    if (s.record.kept()) return all + fmt::format("XYZ {:.9g} {:.9g} {:.9g}\n", xyz.x, xyz.y, xyz.z);
    return all + fmt::format("dropped: {}\n", s.fault ? text(*s.fault) : std::string());
}

Json storyJson(const ReplayedSample& s, const Scene& scene) {
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
