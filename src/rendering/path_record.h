// What happens in single samples, for Integrator::repeat(), and where one that is no radiance went wrong.
#pragma once

#include "render/film.h"
#include "render/integrator.h"
#include "render/path_observer.h"
#include "spectrum/xyz.h"

#include <optional>
#include <string>
#include <vector>

namespace abbe {

// What happened; which members mean something follows from `kind`. Pointers are those of the scene.
struct PathEvent {
    enum class Kind : std::uint8_t {
        surface,  // arrived at `hit` with `beta`
        sampled,  // next-event estimation, which `light` answers: `radiance` of it, scattered by `value`
        hitLight, // found a light by chance, which gives `radiance`
        gathers,  // `light` of it reaches the eye
        scatters, // in direction `next`, if there is one
        collides, // in a medium, at hit.p with `beta`
        fault,    // `source`, whose `what` is `pdf`
        leaves    // the scene, towards `direction`
    };
    Kind kind = Kind::surface;
    int vertex = 0; // from 1, the first that the camera ray hits
    SurfaceHit hit;
    Spectrum beta{0.f};           // throughput
    const void* source = nullptr; // a Light or a MediumEmission
    const char* what = "";
    Spectrum radiance{0.f};
    BsdfEval value;      // of the material towards the light, and its density
    float pdf = 0;       // of the light, with that of its choice
    Spectrum light{0.f}; // part of the sample's radiance
    Vec3 direction;
    std::optional<BsdfSample> next;
};

// Of one replicate's sample. Spectra are lanes of `lambda`.
class PathRecord {
  public:
    explicit PathRecord(int replicate) : replicate_(replicate) {}

    int replicate() const { return replicate_; }
    void begin(Vec3 eye, const Wavelengths& lambda) { *this = {replicate_, eye, lambda}; }
    void add(const PathEvent& event) {
        events_.push_back(event);
        if (event.kind == PathEvent::Kind::gathers) radiance_ += event.light;
    }
    void end(const ExactXyz& sum, bool kept) {
        xyz_ = sum.value();
        kept_ = kept;
    }

    const std::vector<PathEvent>& events() const { return events_; }
    Vec3 eye() const { return eye_; }
    const Wavelengths& lambda() const { return lambda_; }
    // Of all the light that it gathered, at the eye.
    const Spectrum& radiance() const { return radiance_; }
    // As the film would add it, before exposure; 0 if it is not kept.
    Xyz xyz() const { return xyz_; }
    bool kept() const { return kept_; }

  private:
    PathRecord(int replicate, Vec3 eye, const Wavelengths& lambda)
        : replicate_(replicate), eye_(eye), lambda_(lambda) {}

    int replicate_;
    Vec3 eye_;
    Wavelengths lambda_;
    std::vector<PathEvent> events_;
    Spectrum radiance_{0.f};
    Xyz xyz_{};
    bool kept_ = false;
};

// Writes the samples of the record's replicate into it, each over the one before.
class PathRecorder final : public SampleRecorder {
  public:
    explicit PathRecorder(PathRecord& record) : record_(record) {}

    void pixel(int, int, int replicate) noexcept override { listens_ = replicate == record_.replicate(); }
    void start(const Ray& fromEye, const Wavelengths&) noexcept override;
    void arrives(const SurfaceHit&, const Spectrum& beta) noexcept override;
    void gathers(const Spectrum& radiance, const void* source, bool passing) noexcept override;
    void scatters(const SurfaceHit&, Lobes, const Spectrum& beta, const BsdfSample*) noexcept override;
    void collides(Vec3 p, const Spectrum& beta) noexcept override;
    void samples(const void* source, const LightSample&, const BsdfEval&, float pdf) noexcept override;
    void hits(const void* source, const Spectrum& emitted, float pdf) noexcept override;
    void findsFault(const void* who, const char* what, float number) noexcept override;
    void leaves(Vec3 direction) noexcept override;
    void keep(const Spectrum&, const Sensor&, double) noexcept override {}
    void drop() noexcept override {}
    void pixelDone(double) noexcept override {}

  private:
    PathEvent event(PathEvent::Kind kind) const;
    void add(const PathEvent&) noexcept;

    PathRecord& record_;
    SurfaceHit at_; // of the present vertex
    int vertex_ = 0;
    bool listens_ = false;
};

// A film that keeps nothing and shows what happens in samples. Refers to the film that it stands for, which stays as it
// is. Give repeat() the same samples in the same order.
class WatchedFilm final : public FilmDecorator {
  public:
    WatchedFilm(const Film& film, std::vector<SampleId> samples) : FilmDecorator(film), samples_(std::move(samples)) {}

    const std::vector<SampleId>& samples() const { return samples_; }
    // Of each sample, in order.
    const std::vector<PathRecord>& records() const { return records_; }

    void add(int, int, int replicate, const ExactXyz& sum, std::uint32_t samples) noexcept override {
        if (replicate == present_.replicate()) present_.end(sum, samples > 0);
        if (replicate == replicates() - 1) records_.push_back(present_);
    }
    std::unique_ptr<SampleRecorder> makeRecorder() override {
        present_ = PathRecord(samples_.at(records_.size()).replicate);
        return std::make_unique<PathRecorder>(present_);
    }

  private:
    std::vector<SampleId> samples_;
    std::vector<PathRecord> records_;
    PathRecord present_{0};
};

// Where a sample that is no radiance went wrong. The first number of the path that is negative or not finite.
struct SampleFault {
    // Who gave it.
    enum class Culprit : std::uint8_t { camera, material, light, medium };

    Culprit culprit = Culprit::camera;
    const void* who = nullptr; // its Material, Light, MediumEmission or Medium, as far as known
    const char* what = "ray";  // of the culprit: "value", "density", …
    DropCause cause = DropCause::nan;
    std::uint32_t lanes = 0xff; // in which it is; all for what is no spectrum
    float number = 0;           // itself; of the first lane
    PathEvent event;            // at the vertex where it came up
};

// Of a sample that was dropped.
SampleFault findFault(const PathRecord&);

} // namespace abbe
