// What a page is told: docs/view.md lists the members.
#include "view/camera_moves.h"
#include "view/live_render.h"
#include "view/live_scene.h"
#include "view/view_session.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <utility>

namespace abbe {

namespace {

namespace fs = std::filesystem;

Json numbers(Vec3d v) {
    Json list = Json::list();
    for (const double c : {v.x, v.y, v.z}) list.push(c);
    return list;
}

Json texts(const std::vector<std::string>& words) {
    Json list = Json::list();
    for (const std::string& word : words) list.push(word);
    return list;
}

const char* nameOf(LiveStatus status) {
    static constexpr std::array kNames{"loading", "rendering", "paused", "done", "error"};
    return kNames[static_cast<std::size_t>(status)];
}

// A place as it is told: without the folder that the scene is in.
std::string shownPath(const std::string& path, const fs::path& folder) {
    std::error_code error;
    if (path.empty() || !fs::exists(path, error)) return path;
    const fs::path below = fs::absolute(path, error).lexically_normal().lexically_relative(folder);
    return below.empty() || *below.begin() == ".." ? path : below.string();
}

Json diagnosticsJson(const std::vector<ViewDiagnostic>& all, const fs::path& folder) {
    Json list = Json::list();
    for (const ViewDiagnostic& d : all)
        list.push(Json::object({{"severity", d.severity},
                                {"code", d.code},
                                {"file", shownPath(d.file, folder)},
                                {"line", d.line > 0 ? Json(d.line) : Json()},
                                {"column", d.column > 0 ? Json(d.column) : Json()},
                                {"message", d.message},
                                {"label", d.label},
                                {"help", d.help}}));
    return list;
}

// Of a film's edge at half its height, as the scene's own camera sees it.
Ray edgeRay(const LiveShot& shot, double x) {
    CameraSample sample;
    sample.film = {static_cast<float>(x), static_cast<float>(shot.film.height) / 2};
    sample.lens = {0.5f, 0.5f};
    return shot.ownCamera->ray(sample).ray;
}

// The camera's lines for the file. What a parallel one shows changes with its distance; one of a glTF file has its
// place there, so that another one has to take its own.
std::string cameraLines(const LiveShot& shot, const CameraPose& pose, double unit, Vec3d upright) {
    std::string lines = poseLines(pose, unit, upright);
    const Ray left = edgeRay(shot, 0), right = edgeRay(shot, shot.film.width);
    if (shot.cameraType == "orthographic" && pose.size != 1) {
        const double width = length(Vec3d(right.origin) - Vec3d(left.origin)) * pose.size / unit;
        const bool byHeight = shot.cameraWords.find("height") != std::string::npos;
        lines += byHeight ? fmt::format("\nheight {:.7g}", width * shot.film.height / shot.film.width)
                          : fmt::format("\nwidth {:.7g}", width);
    }
    if (shot.cameraType != "gltf") return lines;
    const double chord = length(Vec3d(right.direction) - Vec3d(left.direction)); // of the angle between them
    if (!(chord > 0)) return lines;
    return fmt::format("// in place of the camera of the glTF file\ncamera {{\n{}\nfov {:.7g} deg\n}}", lines,
                       2 * std::asin(std::min(1.0, chord / 2)) / kDegree);
}

Json regionJson(const std::optional<PixelBounds>& r) {
    if (!r) return {};
    Json list = Json::list();
    for (const int v : {r->x0, r->y0, r->x1, r->y1}) list.push(v);
    return list;
}

Json known(double value, bool isKnown) { return isKnown ? Json(value) : Json(); }

Json curveJson(const std::vector<CurvePoint>& curve) {
    Json list = Json::list();
    for (const CurvePoint& p : curve) {
        Json point = Json::list();
        for (const double v : {p.seconds, p.samples, p.noise}) point.push(v);
        list.push(point);
    }
    return list;
}

// For people: what the last building took over from the one before it.
std::string keptText(const ReuseCounters& c) {
    std::string text;
    const auto add = [&](const char* what, std::size_t made, std::size_t kept) {
        if (made == 0 && kept > 0) text += (text.empty() ? "" : ", ") + std::string(what);
    };
    add("geometry", c.structuresBuilt, c.structuresKept);
    if (c.structuresBuilt > 0) add("shapes", c.shapesLoaded, c.shapesKept);
    add("textures", c.texturesRead, c.texturesKept);
    add("volumes", c.volumesRead, c.volumesKept);
    add("tables", c.tablesMade, c.tablesKept);
    return text;
}

Json reuseJson(const LiveReport& r) {
    const ReuseCounters& c = r.reuse;
    const char* const structure = c.structuresBuilt > 0 ? "built" : c.structuresKept > 0 ? "kept" : "none";
    return Json::object({{"shapes_kept", std::uint64_t{c.shapesKept}},
                         {"shapes_loaded", std::uint64_t{c.shapesLoaded}},
                         {"shapes_placed", std::uint64_t{c.placesMade}},
                         {"places_kept", std::uint64_t{c.placesKept}},
                         {"structure", structure},
                         {"textures_kept", std::uint64_t{c.texturesKept}},
                         {"textures_read", std::uint64_t{c.texturesRead}},
                         {"volumes_kept", std::uint64_t{c.volumesKept}},
                         {"volumes_read", std::uint64_t{c.volumesRead}},
                         {"seconds", Json::object({{"read", r.readSeconds},
                                                   {"build", r.buildSeconds},
                                                   {"commit", r.commitSeconds},
                                                   {"first_pixels", known(r.firstPixels, r.firstPixels > 0)}})},
                         {"kept", keptText(c)}});
}

// Those that can be used; `missing` says why others cannot.
Json askForDenoisers(std::string& missing) {
    Json list = Json::list();
    missing.clear();
    for (const DenoiseMethod method : kViewDenoisers) {
        try {
            list.push(Json::object({{"name", std::string(name(method))}, {"version", std::string(version(method))}}));
        } catch (const std::runtime_error& e) {
            missing = e.what();
        }
    }
    return list;
}

} // namespace

Json ViewSession::cameraState(const LiveReport& report) const {
    const auto shot = render_.shot();
    if (!shot) return {};
    const schema::Header& header = shot->loaded->tree.header;
    const Vec3d upright = header.zUp ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
    const double unit = header.length;
    return Json::object({{"name", shot->cameraName},
                         {"type", shot->cameraType},
                         {"movable", true},
                         {"from", numbers(report.pose.from / unit)},
                         {"look_at", numbers(report.pose.lookAt / unit)},
                         {"up", numbers(report.pose.up)},
                         {"moved", report.moved},
                         {"lines", cameraLines(*shot, report.pose, unit, upright)}});
}

Json ViewSession::sceneState() const {
    const fs::path path(request_.input.path);
    return Json::object({{"name", path.stem().string()}, {"path", request_.input.path}});
}

Json ViewSession::denoisersState(std::string& missing) const {
    const std::uint64_t saves = render_.report().saves;
    const std::lock_guard lock(denoisersMutex_);
    if (std::exchange(denoisersOf_, saves) != saves) denoisers_ = askForDenoisers(denoiserMissing_);
    missing = denoiserMissing_;
    return denoisers_;
}

// Those of the scene and its render, and what keeps tev from having the picture.
std::vector<ViewDiagnostic> ViewSession::allDiagnostics(const LiveReport& report) const {
    std::vector<ViewDiagnostic> all = report.diagnostics;
    if (std::string why = tevAbsence(); !why.empty())
        all.push_back({"warning", "W0679", {}, 0, 0, std::move(why), {}, std::string(kTevHelp)});
    return all;
}

Json ViewSession::state() const {
    const LiveReport r = render_.report();
    const auto picture = render_.picture();
    const auto shot = render_.shot();
    Json groups = Json::list();
    const GroupWeights weights = pictures_.weights();
    for (const std::string& name : r.groups) {
        const auto found = weights.find(name);
        groups.push(Json::object({{"name", name}, {"weight", found == weights.end() ? 1.0 : found->second}}));
    }
    std::vector<std::string> layers{"beauty"};
    layers.insert(layers.end(), r.layers.begin(), r.layers.end());
    std::string missing;
    const Json denoisers = denoisersState(missing);
    Json other;
    {
        const std::lock_guard lock(mutex_);
        if (!other_.empty()) other = Json::object({{"path", other_}});
    }
    return Json::object(
        {{"scene", sceneState()},
         {"status", nameOf(r.status)},
         {"save", r.saves},
         {"picture", Json::object({{"version", picture ? picture->version : 0},
                                   {"cell", picture ? picture->cell : 1},
                                   {"stale", r.stale}})},
         {"frame", Json::object({{"width", r.width}, {"height", r.height}, {"region", regionJson(r.region)}})},
         {"samples", Json::object({{"done", r.samples}, {"goal", r.goal}})},
         {"noise", known(r.noise, r.noise > 0)},
         {"curve", curveJson(r.curve)},
         {"elapsed", r.elapsed},
         {"left", known(r.left, r.left >= 0)},
         {"camera", cameraState(r)},
         {"layers", texts(layers)},
         {"groups", groups},
         {"views", texts(pictures_.views())},
         {"view", pictures_.defaultView()},
         {"exposure", shot ? Json(r.stops) : Json()},
         {"denoisers", denoisers},
         {"denoiser_missing", missing.empty() ? Json() : Json(missing)},
         {"diagnostics", diagnosticsJson(allDiagnostics(r), scene_.folder())},
         {"reuse", reuseJson(r)},
         {"other", other},
         {"saved", render_.saved() != nullptr}});
}

} // namespace abbe
