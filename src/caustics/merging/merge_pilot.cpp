#include "caustics/merging/merge_pilot.h"

#include "base/parallel.h"
#include "base/work.h"
#include "caustics/merging/photon_map.h"
#include "caustics/shared/aim_cone.h"
#include "caustics/shared/pilot.h"
#include "light_sampling/light_target.h"
#include "math/hash.h"
#include "render/scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace abbe {

namespace {

constexpr std::uint32_t kRounds = 8;
constexpr std::uint32_t kPhotons = 16384, kLeastPhotons = 256;
constexpr int kRow = 48, kLeastRow = 6; // pixels

} // namespace

class MergePilot::Listener final : public MergeListener {
  public:
    Listener(const MergePilot& pilot, Heard& to) : pilot_(pilot), to_(to) {}

    void starts(const EmittedRay& start) override { to_.starts.push_back(place(start.light, start.target, start.aim)); }
    void begins(int x, int y) override {
        x_ = x;
        y_ = y;
        ++to_.looks;
    }
    void gathers(const Photon& photon, double luminance, double camera) override {
        if (!(luminance > 0)) return;
        const LightStart start = place(photon.light, photon.target, photon.aim);
        Pixel& pixel = pixels_[start.light];
        pixel.sum += luminance;
        pixel.squares += square(luminance);
        pixel.camera += luminance * camera;
        if (!(camera > 0)) pixel.unseen += luminance;
        squares_[{start.light, start.target, start.part}] += square(luminance);
    }
    void ends(std::uint64_t rays) override {
        for (auto& [light, pixel] : pixels_) {
            pixel.light = light;
            pixel.rays = rays;
            pixel.x = x_;
            pixel.y = y_;
            to_.pixels.push_back(pixel);
        }
        for (const auto& [at, squares] : squares_)
            to_.deposits.push_back(
                {{std::get<0>(at), std::get<1>(at), std::get<2>(at)}, false, x_, y_, std::sqrt(squares), 1, 0});
        pixels_.clear();
        squares_.clear();
    }

  private:
    LightStart place(const Light* light, std::uint32_t target, Vec2 aim) const {
        const std::uint32_t number = pilot_.numbers_.at(light);
        if (target == EmittedRay::kNoTarget) return {number, 0, 0};
        return {number, target + 1, static_cast<std::uint32_t>(AimGrid::cell(aim, AimGrid::kFinest))};
    }

    const MergePilot& pilot_;
    Heard& to_;
    int x_ = 0, y_ = 0;
    std::map<std::uint32_t, Pixel> pixels_;                                             // of this pixel, by light
    std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, double> squares_; // likewise, by start
};

std::vector<LightDeposit> MergePilot::Heard::shown() const {
    std::vector<LightDeposit> list;
    for (const Pixel& p : pixels) list.push_back({{}, false, p.x, p.y, p.sum, each, 0});
    return list;
}

MergePilot::MergePilot(const PathContext& context, const LightPathKernel& kernel, const std::function<bool()>& stop)
    : context_(context), kernel_(kernel), stop_(stop),
      photons_(PilotSize(context.settings).count(kPhotons, kLeastPhotons)),
      wider_(std::sqrt(static_cast<float>(kPhotons) / static_cast<float>(photons_))),
      step_(std::max(1, std::max(context.scene.frame.width(), context.scene.frame.height()) /
                            PilotSize(context.settings).side(kRow, kLeastRow))) {
    for (const auto& light : context.scene.lights)
        numbers_.emplace(light.get(), static_cast<std::uint32_t>(numbers_.size()));
}

MergePilot::Heard MergePilot::listen(const MergePlan& plan, std::uint64_t key) const {
    PathContext context = context_;
    context.settings.seed = combine64(context_.settings.seed, key);
    context.merging = &plan;
    std::vector<Heard> parts(kRounds);
    std::vector<std::uint64_t> photonRays(kRounds), photons(kRounds);
    parallelFor(kRounds, [&](std::size_t i) {
        if (stop_()) return;
        Listener listener(*this, parts[i]);
        NullFilm film(context_.scene.frame);
        const auto round = static_cast<std::uint32_t>(i);
        addWorkFlag(WorkFlag::pilot);
        const TileResult r = kernel_.merge(context, film, {round, round + 1, 0, 1, 0, step_, wider_}, &listener);
        removeWorkFlag(WorkFlag::pilot);
        parts[i].rays = r.counters.vertices + r.counters.shadowRays;
        photonRays[i] = r.photonRays;
        photons[i] = r.photons;
    });
    Heard all;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const Heard& part = parts[i];
        all.pixels.insert(all.pixels.end(), part.pixels.begin(), part.pixels.end());
        all.starts.insert(all.starts.end(), part.starts.begin(), part.starts.end());
        all.deposits.insert(all.deposits.end(), part.deposits.begin(), part.deposits.end());
        all.looks += part.looks;
        all.rays += part.rays;
        all.photonRays += static_cast<double>(photonRays[i]) / (kRounds * static_cast<double>(photons_));
        all.photons += static_cast<double>(photons[i]) / (kRounds * static_cast<double>(photons_));
        all.gatherRays += static_cast<double>(part.rays - photonRays[i]);
    }
    all.looks = std::max(all.looks, 1.0);
    all.gatherRays /= all.looks;
    all.each = static_cast<double>(context_.scene.frame.area()) / all.looks;
    return all;
}

} // namespace abbe
