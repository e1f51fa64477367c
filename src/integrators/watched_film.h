// A film that keeps nothing and shows what happens in samples: for Integrator::repeat().
#pragma once

#include "integrators/path_record.h"
#include "render/integrator.h"
#include "render/stand_in_film.h"

namespace abbe {

// Refers to the film that it stands for, which stays as it is. Give repeat() the same samples in the same order.
class WatchedFilm final : public StandInFilm {
  public:
    WatchedFilm(const Film& film, std::vector<SampleId> samples) : StandInFilm(film), samples_(std::move(samples)) {}

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

} // namespace abbe
