// A camera with a lens of real glass: rays are traced from the film through every surface.
#pragma once

#include "cameras/camera_params.h"
#include "cameras/pupils.h"

#include <mutex>

namespace abbe {

struct LensSystemParams : LensCameraParams {
    schema::Choice prescription; // name of a published lens, or
    std::optional<schema::TableRows> surfaces;
    std::optional<double> lens; // focal length to which the prescription is scaled; its own
};

schema::TypeInfo lensSystemType();

// Aberrations, vignetting and chromatic errors are those of the glass. The whole lens moves for focusing. The camera's
// place is the middle of the paraxial entrance pupil, so that it frames like a `perspective` camera with the same lens
// and sensor. The picture is turned upright.
class LensSystemCamera final : public Camera {
  public:
    struct Optics {
        double film = 0;    // z of the film in lens coordinates, behind the last surface
        double pupil = 0;   // z of the middle of the entrance pupil
        double fNumber = 1; // against whose image-space cone π / (4 N²) rays are weighed
        Aperture opening;   // of the stop
    };
    // `width`: of the film in m. Requires: opening not a point.
    LensSystemCamera(const Frame& axes, Vec2i filmSize, double width, LensTrain, const Optics&);

    // The weight is the illuminance at the film per radiance over π / (4 N²): 1 on the axis for a lens that obeys the
    // sine condition and is focused at infinity, less towards the corners and at close range.
    CameraRay ray(const CameraSample&) const noexcept override;
    std::optional<Vec2d> project(Vec3d p, double time, Vec2d near) const noexcept override;
    // The lens numbers draw a point of the entrance pupil, from which light is traced to the film.
    std::optional<LensConnection> connect(const LensQuery&) const noexcept override;
    float pdfFacingArea(const LensQuery&, const CameraRay&) const noexcept override;
    bool sharesLens() const override { return false; }
    bool disperses() const override { return train_.disperses(); }
    const LensTrain& train() const { return train_; }
    const Optics& optics() const { return optics_; }
    const ExitPupil& exitPupil() const { return exitPupil_; }
    // Found when it is first asked for, which takes about 0.1 s.
    const EntrancePupil& entrancePupil() const;

  private:
    // A film point, in lens coordinates, and the box of the exit pupil that belongs to it; turned about the axis so
    // that it lies on +x.
    struct Zone {
        Vec2d turn; // cosine and sine of the film point's azimuth
        const ExitPupil::Box* box;
    };
    Zone zoneOf(Vec2d film) const noexcept;
    Vec3d inLens(Vec3 p) const noexcept; // lens coordinates
    double rayWeight(const ExitPupil::Box&, double cosine) const noexcept;
    double importance(Vec3d p, Vec3d target, const PupilBox&) const noexcept;

    Frame axes_;
    LensTrain train_;
    Optics optics_;
    ExitPupil exitPupil_;
    double pixel_; // m
    Vec2d corner_; // of the upright picture, m
    mutable std::once_flag searched_;
    mutable EntrancePupil entrancePupil_;
    double weight_; // 4 N² / π over the squared distance of the film from the last vertex
};

// Nothing after an error.
std::optional<PlacedCamera> makeLensSystem(const LensSystemParams&, const CameraContext&, Diagnostics&);

} // namespace abbe
