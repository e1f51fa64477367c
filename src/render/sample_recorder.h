// What a film keeps of samples beyond their XYZ.
#pragma once

#include "render/path_observer.h"
#include "render/ray.h"
#include "spectrum/sensor.h"

namespace abbe {

// Of one thread at a time. For every sample: start(), the events of its path, and then keep() or drop().
class SampleRecorder : public PathObserver {
  public:
    // A pixel within the film's bounds; all samples up to the next pixel belong to it and to one replicate.
    virtual void pixel(int x, int y, int replicate) noexcept = 0;
    // `lambda`: as the path starts with them.
    virtual void start(const Ray& fromEye, const Wavelengths& lambda) noexcept = 0;
    // The sample counts, with this radiance, as the sensor sees it, and this factor of the camera and the pixel filter.
    virtual void keep(const Spectrum& radiance, const Sensor&, double factor) noexcept = 0;
    // It was not sound.
    virtual void drop() noexcept = 0;
    // All samples of the pixel and replicate are done, after `seconds` of one core.
    virtual void pixelDone(double seconds) noexcept = 0;
};

} // namespace abbe
