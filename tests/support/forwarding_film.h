// For films of tests that look on while another is filled.
#pragma once

#include "render/film.h"

namespace abbe::test {

// Hands everything on; derived classes add what they are there for.
class ForwardingFilm : public FilmDecorator {
  public:
    void add(int x, int y, int replicate, const ExactXyz& sum, std::uint32_t samples) noexcept override {
        film_.add(x, y, replicate, sum, samples);
    }
    void splat(int x, int y, int replicate, const Splat& splat) noexcept override {
        film_.splat(x, y, replicate, splat);
    }
    void countLightPaths(int replicate, std::uint64_t paths) noexcept override {
        film_.countLightPaths(replicate, paths);
    }
    void countRounds(int replicate, std::uint64_t rounds) noexcept override { film_.countRounds(replicate, rounds); }
    std::unique_ptr<SampleRecorder> makeRecorder() override { return film_.makeRecorder(); }

  protected:
    explicit ForwardingFilm(Film& film) : FilmDecorator(film), film_(film) {}

  private:
    Film& film_;
};

} // namespace abbe::test
