#include "rendering/shared_tile.h"

#include "base/check.h"
#include "caustics/shared/shared_work.h"

#include <vector>

namespace abbe {

namespace {

// Keeps what is added for later.
class HoldingFilm final : public FilmDecorator {
  public:
    explicit HoldingFilm(const Film& like) : FilmDecorator(like) {}
    void add(int x, int y, int replicate, const ExactXyz& sum, std::uint32_t samples) noexcept override {
        held_.push_back({x, y, replicate, samples, sum});
    }
    void addTo(Film& film) const {
        for (const Held& h : held_) film.add(h.x, h.y, h.replicate, h.sum, h.samples);
    }

  private:
    struct Held {
        int x, y, replicate;
        std::uint32_t samples;
        ExactXyz sum;
    };
    std::vector<Held> held_;
};

struct Row {
    HoldingFilm film;
    TileResult result;
};

// Where in a row a portion goes on that goes on there in the tile; the row is one of so many units.
PortionPlace within(const PortionPlace& tile, std::uint32_t before, std::uint32_t units) {
    if (tile.unit < before) return {};
    if (tile.unit >= before + units) return {units, 0};
    return {tile.unit - before, tile.done};
}

} // namespace

TileResult renderShared(TileFunction render, const PathContext& context, Film& film, const TileJob& job) {
    ABBE_DCHECK(!film.makeRecorder());
    const auto unitsOfRow = static_cast<std::uint32_t>(job.pixels.width() * film.replicates());
    std::vector<Row> rows(static_cast<std::size_t>(job.pixels.height()), Row{HoldingFilm(film), {}});
    SharedWork shared;
    shared.run(rows.size(), [&](std::size_t i) {
        TileJob row = job;
        row.pixels.y0 = job.pixels.y0 + static_cast<int>(i);
        row.pixels.y1 = row.pixels.y0 + 1;
        row.from = within(job.from, static_cast<std::uint32_t>(i) * unitsOfRow, unitsOfRow);
        if (row.from.unit < unitsOfRow) rows[i].result = render(context, rows[i].film, row);
    });
    TileResult all;
    for (std::size_t i = 0; i < rows.size() && !all.rest; ++i) {
        rows[i].film.addTo(film);
        all.add(rows[i].result);
        if (all.rest) all.rest->unit += static_cast<std::uint32_t>(i) * unitsOfRow;
    }
    all.secondsElsewhere = shared.secondsElsewhere();
    return all;
}

} // namespace abbe
