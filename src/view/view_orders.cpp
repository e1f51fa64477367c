// What a page asks the view to do.
#include "schema/suggest.h"
#include "view/camera_moves.h"
#include "view/live_render.h"
#include "view/view_pictures.h"
#include "view/view_session.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <initializer_list>
#include <nlohmann/json.hpp>

namespace abbe {

namespace {

namespace fs = std::filesystem;
using OrderBody = nlohmann::json;

constexpr double kMostRadians = 100, kMostHeights = 100, kMostShares = 100; // of one move
constexpr double kMostFactor = 1000;
constexpr std::uint32_t kMostGoal = 1u << 30;

OrderBody readBody(const std::string& text) {
    OrderBody body = OrderBody::parse(text.empty() ? "{}" : text, nullptr, false);
    if (!body.is_object()) throw ViewFault("the request is no JSON object");
    return body;
}

void knowsOnly(const OrderBody& body, std::initializer_list<std::string_view> members) {
    const std::vector<std::string_view> names(members);
    for (const auto& [key, value] : body.items())
        if (std::ranges::find(names, key) == names.end())
            throw ViewFault(fmt::format("there is no `{}` here", key),
                            fmt::format("there is {}", schema::quotedList(names)));
}

double numberOf(const OrderBody& value, std::string_view what, double least, double most) {
    const double number = value.is_number() ? value.get<double>() : NAN;
    if (!(number >= least && number <= most))
        throw ViewFault(fmt::format("`{}` is a number from {:g} to {:g}", what, least, most));
    return number;
}

// So many numbers of at most this magnitude.
std::vector<double> numbersOf(const OrderBody& list, std::string_view what, std::size_t count, double most) {
    if (!list.is_array() || list.size() != count)
        throw ViewFault(fmt::format("`{}` is a list of {} numbers", what, count));
    std::vector<double> numbers;
    for (const OrderBody& value : list) numbers.push_back(numberOf(value, what, -most, most));
    return numbers;
}

bool boolOf(const OrderBody& value, std::string_view what) {
    if (!value.is_boolean()) throw ViewFault(fmt::format("`{}` is true or false", what));
    return value.get<bool>();
}

// Of the picture where the camera looks at, m; of a panorama, rad.
double heightOf(const LiveShot& shot, const CameraPose& pose) {
    const double rows = shot.film.height, middle = shot.film.width / 2.0;
    const auto at = [&](double y) {
        CameraSample sample;
        sample.film = {static_cast<float>(middle), static_cast<float>(y)};
        sample.lens = {0.5f, 0.5f};
        return shot.ownCamera->ray(sample).ray;
    };
    const Ray above = at(rows / 2 - 0.5), below = at(rows / 2 + 0.5);
    const double distance = length(pose.lookAt - pose.from);
    const double turn = length(Vec3d(above.direction) - Vec3d(below.direction));
    return rows * (turn * distance + length(Vec3d(above.origin) - Vec3d(below.origin)) * (turn > 0 ? 0 : pose.size));
}

} // namespace

bool ViewSession::isOrder(std::string_view name) {
    static constexpr std::string_view kOrders[] = {"camera", "region", "groups", "control", "other", "snapshot"};
    return std::ranges::find(kOrders, name) != std::end(kOrders);
}

struct ViewSession::Orders {
    ViewSession& session;

    Json camera(const OrderBody& body) {
        knowsOnly(body, {"orbit", "pan", "dolly", "fly", "reset"});
        const auto shot = session.render_.shot();
        if (!shot) throw ViewFault("there is no camera yet");
        if (body.contains("reset") && boolOf(body["reset"], "reset")) session.render_.resetCamera();
        const LiveReport before = session.render_.report();
        CameraPose pose = before.pose;
        bool moves = false;
        const auto move = [&](const char* name, std::size_t count, double most, const auto& apply) {
            if (!body.contains(name)) return;
            pose = apply(numbersOf(body[name], name, count, most));
            moves = true;
        };
        const bool around = shot->cameraType == "spherical";
        move("orbit", 2, kMostRadians, [&](const auto& v) { // what is seen follows the hand
            return around ? lookedAround(pose, {-v[0], v[1]}) : orbited(pose, {-v[0], v[1]});
        });
        move("pan", 2, kMostHeights, [&](const auto& v) {
            const double height = heightOf(*shot, pose);
            return panned(pose, {-v[0], v[1]}, height);
        });
        move("fly", 3, kMostShares, [&](const auto& v) { return flown(pose, {v[0], v[1], v[2]}); });
        if (body.contains("dolly")) {
            pose = dollied(pose, numberOf(body["dolly"], "dolly", 1 / kMostFactor, kMostFactor));
            moves = true;
        }
        if (moves) session.render_.moveTo(pose);
        return session.cameraState(session.render_.report());
    }

    Json region(const OrderBody& body) {
        knowsOnly(body, {"x0", "y0", "x1", "y1"});
        if (body.empty()) {
            session.render_.setRegion({});
            return Json::object();
        }
        const auto shot = session.render_.shot();
        if (!shot) throw ViewFault("there is no picture yet");
        const auto edge = [&](const char* name, int most) {
            if (!body.contains(name)) throw ViewFault("a region has `x0`, `y0`, `x1` and `y1`");
            return static_cast<int>(std::floor(numberOf(body[name], name, 0, most)));
        };
        const PixelBounds b{edge("x0", shot->film.width), edge("y0", shot->film.height), edge("x1", shot->film.width),
                            edge("y1", shot->film.height)};
        if (b.x0 >= b.x1 || b.y0 >= b.y1)
            throw ViewFault("the region is empty", "left and top are inside, right and bottom exclusive");
        session.render_.setRegion(b);
        return Json::object();
    }

    Json groups(const OrderBody& body) {
        knowsOnly(body, {"weights"});
        const OrderBody weights = body.value("weights", OrderBody::object());
        if (!weights.is_object()) throw ViewFault("`weights` has a number for each light group");
        GroupWeights asked;
        for (const auto& [name, value] : weights.items()) asked[name] = numberOf(value, name, 0, 1e6);
        session.pictures_.weigh(asked);
        session.changed();
        return Json::object();
    }

    Json control(const OrderBody& body) {
        knowsOnly(body, {"pause", "restart", "samples", "save"});
        LiveRender& render = session.render_;
        if (body.contains("samples"))
            render.setGoal(static_cast<std::uint32_t>(numberOf(body["samples"], "samples", 1, kMostGoal)));
        if (body.contains("save") && boolOf(body["save"], "save")) render.keepPicture();
        if (body.contains("restart") && boolOf(body["restart"], "restart")) render.restart();
        if (body.contains("pause")) render.pause(boolOf(body["pause"], "pause"));
        return Json::object();
    }

    // Below the scene's folder alone, also behind links.
    Json other(const OrderBody& body) {
        knowsOnly(body, {"path"});
        std::string path;
        if (body.contains("path")) {
            if (!body["path"].is_string()) throw ViewFault("`path` is the name of an image");
            path = body["path"].get<std::string>();
        }
        if (!path.empty()) session.pictures_.setOther(fileBelow(path).string());
        if (path.empty()) session.pictures_.setOther({});
        {
            const std::lock_guard lock(session.mutex_);
            session.other_ = path;
        }
        session.changed();
        return Json::object();
    }

    fs::path fileBelow(const std::string& path) const {
        std::error_code error;
        const fs::path folder = fs::canonical(session.scene_.folder(), error);
        const fs::path file = fs::canonical(folder / path, error);
        const auto refuse = [&] {
            throw ViewFault(fmt::format("there is no image `{}` in the folder of the scene", path),
                            "images are looked for beside the scene file and in folders there");
        };
        if (error || !fs::is_regular_file(file, error)) refuse();
        const fs::path below = file.lexically_relative(folder);
        if (below.empty() || *below.begin() == "..") refuse();
        return file;
    }
};

Json ViewSession::order(std::string_view name, const std::string& text) {
    const OrderBody body = readBody(text);
    Orders orders{*this};
    if (name == "camera") return orders.camera(body);
    if (name == "region") return orders.region(body);
    if (name == "groups") return orders.groups(body);
    if (name == "control") return orders.control(body);
    if (name == "other") return orders.other(body);
    knowsOnly(body, {});
    return snapshot();
}

} // namespace abbe
