// Cameras that change what another one does: one whose shutter and movement matter, because something moves while it is
// open, one without the effects that it has, one that stands elsewhere, and one with fewer pixels.
#pragma once

#include "cameras/exposure.h"
#include "math/motion.h"
#include "render/camera.h"

#include <memory>

namespace abbe {

// Gives the rays of another camera their time (Ray::time is the position in the shutter interval), and moves them with
// the camera as a rigid body.
class ShutterCamera final : public Camera {
  public:
    // `inner` makes rays in render space for the moment at which the shutter opens. `toRender`: camera space to render
    // space over scene time; only turns and moves.
    ShutterCamera(std::unique_ptr<const Camera> inner, const Motion& toRender, const Shutter& shutter);

    CameraRay ray(const CameraSample&) const noexcept override;
    std::optional<Vec2d> project(Vec3d p, double time, Vec2d near) const noexcept override;
    float rayTime(float u) const noexcept override;
    std::optional<LensConnection> connect(const LensQuery&) const noexcept override;
    float pdfFacingArea(const LensQuery&, const CameraRay&) const noexcept override;
    bool sharesLens() const override { return inner_->sharesLens(); }
    bool usesLens() const override { return inner_->usesLens(); }
    bool disperses() const override { return inner_->disperses(); }

  private:
    // From render space at the opening to there at a position of the shutter interval.
    Transform moved(double position) const { return fromOpening_.then(toRender_.at(shutter_.timeAt(position))); }

    std::unique_ptr<const Camera> inner_;
    Motion toRender_;
    Transform fromOpening_; // render space to camera space at the opening
    Shutter shutter_;
};

// A camera whose rays go through the middle of the lens, or all belong to the middle of the exposure. `still` requires
// a scene in which nothing else moves.
class ReducedCamera final : public Camera {
  public:
    ReducedCamera(std::unique_ptr<const Camera> inner, bool centred, bool still)
        : inner_(std::move(inner)), centred_(centred), still_(still) {}

    CameraRay ray(const CameraSample& sample) const noexcept override {
        CameraSample held = sample;
        if (centred_) held.lens = {0.5f, 0.5f};
        if (still_) held.time = 0.5f;
        CameraRay result = inner_->ray(held);
        if (still_) result.ray.time = 0;
        return result;
    }
    std::optional<Vec2d> project(Vec3d p, double time, Vec2d near) const noexcept override {
        return inner_->project(p, still_ ? 0.5 : time, near);
    }
    float rayTime(float u) const noexcept override { return still_ ? 0 : inner_->rayTime(u); }
    // The middle of a lens whose points ray() finds otherwise than connect() is hit by no connection.
    std::optional<LensConnection> connect(const LensQuery& query) const noexcept override {
        return reachable() ? inner_->connect(held(query)) : std::nullopt;
    }
    float pdfFacingArea(const LensQuery& query, const CameraRay& ray) const noexcept override {
        if (!reachable()) return 0;
        CameraRay inner = ray;
        if (still_) inner.ray.time = inner_->rayTime(0.5f);
        return inner_->pdfFacingArea(held(query), inner);
    }
    bool sharesLens() const override { return inner_->sharesLens(); }
    bool usesLens() const override { return !centred_ && inner_->usesLens(); }
    bool disperses() const override { return inner_->disperses(); }

  private:
    bool reachable() const { return !centred_ || !inner_->usesLens() || inner_->sharesLens(); }
    LensQuery held(LensQuery query) const {
        if (centred_) query.lens = {0.5f, 0.5f};
        if (still_) query.time = inner_->rayTime(0.5f);
        return query;
    }

    std::unique_ptr<const Camera> inner_;
    bool centred_, still_;
};

// A camera made for the origin that stands elsewhere in render space: where the space of an earlier camera is kept.
class MovedCamera final : public Camera {
  public:
    MovedCamera(std::unique_ptr<const Camera> inner, Vec3d place) : inner_(std::move(inner)), place_(place) {}

    CameraRay ray(const CameraSample& sample) const noexcept override {
        CameraRay result = inner_->ray(sample);
        result.ray.origin = Vec3(Vec3d(result.ray.origin) + place_);
        return result;
    }
    std::optional<Vec2d> project(Vec3d p, double time, Vec2d near) const noexcept override {
        return inner_->project(p - place_, time, near);
    }
    float rayTime(float u) const noexcept override { return inner_->rayTime(u); }
    std::optional<LensConnection> connect(const LensQuery& query) const noexcept override {
        auto found = inner_->connect(before(query));
        if (found) found->lens = Vec3(Vec3d(found->lens) + place_);
        return found;
    }
    float pdfFacingArea(const LensQuery& query, const CameraRay& ray) const noexcept override {
        CameraRay inner = ray;
        inner.ray.origin = Vec3(Vec3d(ray.ray.origin) - place_);
        return inner_->pdfFacingArea(before(query), inner);
    }
    bool sharesLens() const override { return inner_->sharesLens(); }
    bool usesLens() const override { return inner_->usesLens(); }
    bool disperses() const override { return inner_->disperses(); }

  private:
    LensQuery before(LensQuery query) const {
        query.p = Vec3(Vec3d(query.p) - place_);
        return query;
    }

    std::unique_ptr<const Camera> inner_;
    Vec3d place_; // m
};

// Another camera on a film of fewer pixels: those of a rough picture, each as wide as `cell` of the inner one's.
class RoughCamera final : public Camera {
  public:
    // `inner` outlives it. Requires: cell >= 1.
    RoughCamera(const Camera& inner, int cell) : inner_(inner), cell_(static_cast<float>(cell)) {}

    CameraRay ray(const CameraSample& sample) const noexcept override {
        CameraSample finer = sample;
        finer.film = sample.film * cell_;
        return inner_.ray(finer);
    }
    std::optional<Vec2d> project(Vec3d p, double time, Vec2d near) const noexcept override {
        const auto cell = static_cast<double>(cell_);
        const auto seen = inner_.project(p, time, near * cell);
        return seen ? std::optional(*seen * (1 / cell)) : std::nullopt;
    }
    float rayTime(float u) const noexcept override { return inner_.rayTime(u); }
    // Densities are of places on the film in pixels, of which there are fewer.
    std::optional<LensConnection> connect(const LensQuery& query) const noexcept override {
        auto result = inner_.connect(finer(query));
        if (!result) return result;
        result->film = result->film * (1 / cell_);
        result->importance /= square(cell_);
        result->pdfFacingArea /= square(cell_);
        return result;
    }
    float pdfFacingArea(const LensQuery& query, const CameraRay& ray) const noexcept override {
        return inner_.pdfFacingArea(finer(query), ray) / square(cell_);
    }
    bool sharesLens() const override { return inner_.sharesLens(); }
    bool usesLens() const override { return inner_.usesLens(); }
    bool disperses() const override { return inner_.disperses(); }

  private:
    LensQuery finer(LensQuery query) const {
        query.filmLower = query.filmLower * cell_;
        query.filmUpper = query.filmUpper * cell_;
        return query;
    }

    const Camera& inner_;
    float cell_;
};

} // namespace abbe
