// Whether two renders are one to the last bit.
#pragma once

#include "render/integrator.h"
#include "support/scene_test_film.h"

namespace abbe::test {

inline bool sameBits(const RecordingFilm& a, const RecordingFilm& b) {
    const PixelBounds bounds = a.bounds();
    for (int y = bounds.y0; y < bounds.y1; ++y)
        for (int x = bounds.x0; x < bounds.x1; ++x)
            for (int r = 0; r < a.replicates(); ++r) {
                const auto [s, n] = a.replicate(x, y, r);
                const auto [t, m] = b.replicate(x, y, r);
                if (s.x != t.x || s.y != t.y || s.z != t.z || n != m) return false;
            }
    return true;
}

// Of what light paths and rounds brought, added to the rest; of two replicates.
inline bool sameLight(const RecordingFilm& a, const RecordingFilm& b) {
    const PixelFilm &s = a.pixelFilm(), &t = b.pixelFilm();
    const PixelBounds bounds = s.bounds();
    for (int y = bounds.y0; y < bounds.y1; ++y)
        for (int x = bounds.x0; x < bounds.x1; ++x)
            if (s.mean(x, y).x != t.mean(x, y).x || s.mean(x, y).y != t.mean(x, y).y) return false;
    return s.lightPaths() == t.lightPaths() &&
           s.splatCount(SplatKind::merged, 0, 2) == t.splatCount(SplatKind::merged, 0, 2);
}

inline bool sameCounts(const RenderStatistics& a, const RenderStatistics& b) {
    return a.paths == b.paths && a.vertices == b.vertices && a.shadowRays == b.shadowRays;
}

} // namespace abbe::test
