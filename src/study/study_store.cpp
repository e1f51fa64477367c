#include "study/study_store.h"

#include "base/check.h"

namespace abbe {

// In the order of the seeds, so that a study which was interrupted has the same sums.
void CurveRecord::measure(const ReferencePair& reference, const std::vector<StudyImage>& images) {
    ABBE_CHECK(measured < runs.size() && images.size() == rungs.size());
    SeedRun& run = runs[measured++];
    for (std::size_t k = 0; k < rungs.size(); ++k) {
        const ReferencePair::Error error = reference.measure(images[k]);
        run.rungs[k].relMse = error.relMse;
        run.rungs[k].trimmed = error.trimmed;
        CurveRung& rung = rungs[k];
        if (rung.tiles.empty()) {
            rung.sum = images[k];
            rung.tiles = error.tiles;
            continue;
        }
        for (std::size_t c = 0; c < rung.sum.rgb.size(); ++c) rung.sum.rgb[c] += images[k].rgb[c];
        for (std::size_t t = 0; t < rung.tiles.size(); ++t) rung.tiles[t] += error.tiles[t];
    }
}

} // namespace abbe
