// A scene in a folder of its own, in a view without its server.
#pragma once

#include "unit/io/temporary_folder.h"
#include "view/view_session.h"

#include <chrono>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace abbe {

inline std::filesystem::path homeOf(const TemporaryFolder& folder) {
    return std::filesystem::path(folder / "x").parent_path();
}

inline constexpr const char* kBall = R"(scene 1
film { size 64 48 }
render { samples 8 }
camera { from 0 1 4; look-at 0 1 0; fov 40 deg; exposure 7 stops }
light key quad { points { - -1 3 -1; - 1 3 -1; - 1 3 1; - -1 3 1 }; luminance 2000 nits; two-sided on }
light sky sky { luminance 100 nits }
material red diffuse { reflectance 0.8 }
shape ball sphere { center 0 1 0; radius 0.7; material red }
shape floor plane { material diffuse { reflectance 0.4 } }
)";

// A scene in a folder of its own, and what is shown of it.
class Viewed {
  public:
    explicit Viewed(const std::string& text, std::optional<TevAddress> tev = {}) {
        save(text);
        ViewRequest request;
        request.tev = std::move(tev);
        request.input.path = path().string();
        session = std::make_unique<ViewSession>(request);
    }
    std::filesystem::path path() const { return homeOf(folder) / "ball.scene"; }
    // As editors do.
    void save(const std::string& text) const {
        std::ofstream(homeOf(folder) / "ball.tmp") << text;
        std::filesystem::rename(homeOf(folder) / "ball.tmp", path());
    }
    // Saves and waits until that is what is told of.
    bool shows(const std::string& text) {
        const long before = saves();
        save(text);
        return settles(before);
    }
    bool settles(long before) const {
        for (int i = 0; i < 2000; ++i) {
            if (saves() > before && !has("\"status\":\"loading\"") && !has("\"status\":\"rendering\"")) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        MESSAGE(state());
        return false;
    }
    long saves() const {
        const std::string text = state(), mark = "\"save\":";
        return std::stol(text.substr(text.find(mark) + mark.size()));
    }
    std::string state() const { return session->state().text(); }
    bool has(const std::string& text) const { return state().find(text) != std::string::npos; }
    // Waits some seconds for a text in the state.
    bool comes(const std::string& text) const {
        for (int i = 0; i < 2000; ++i) {
            if (has(text)) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        MESSAGE(state());
        return false;
    }
    // Mean of a component of the picture, 0 to 255.
    double mean(std::size_t component, PictureQuery query = {}) const {
        const auto shown = session->picture(query);
        REQUIRE(shown);
        double sum = 0;
        for (std::size_t i = component; i < shown->rgba.size(); i += 4)
            sum += static_cast<unsigned char>(shown->rgba[i]);
        return sum / (static_cast<double>(shown->rgba.size()) / 4);
    }

    TemporaryFolder folder;
    std::unique_ptr<ViewSession> session;
};

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

} // namespace abbe
