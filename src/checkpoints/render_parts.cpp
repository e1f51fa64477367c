#include "checkpoints/render_parts.h"

#include "base/check.h"
#include "base/parallel.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <numeric>
#include <system_error>

namespace abbe {

namespace {

bool isSame(PixelBounds a, PixelBounds b) { return a.x0 == b.x0 && a.y0 == b.y0 && a.x1 == b.x1 && a.y1 == b.y1; }

std::string rectangleText(PixelBounds b) { return fmt::format("{},{} to {},{}", b.x0, b.y0, b.x1, b.y1); }

CheckpointFault misfit(const std::string& message, std::string help) { return {"E0664", message, std::move(help)}; }

} // namespace

std::string partPath(const std::string& imagePath, Vec2i part) {
    return std::filesystem::path(imagePath).replace_extension(fmt::format(".part{}.abbe", part.x)).string();
}

RenderParts::RenderParts(const std::vector<std::string>& paths, PartsWanted wanted) : wanted_(wanted) {
    std::vector<CheckpointReader> opened;
    for (const std::string& path : paths) opened.emplace_back(path);
    std::vector<std::size_t> order(opened.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return opened[i].header().first; });
    for (const std::size_t i : order) readers_.push_back(std::move(opened[i]));
}

std::uint32_t RenderParts::whole() const {
    std::uint32_t whole = 0;
    for (const CheckpointReader& reader : readers_) whole = std::max(whole, reader.header().whole);
    return whole;
}

void RenderParts::check(const std::vector<Fact>& identity) const {
    checkFacts(identity);
    checkDisjoint();
    if (wanted_ == PartsWanted::whole) checkComplete();
    if (wanted_ == PartsWanted::range) checkRange();
}

void RenderParts::checkFacts(const std::vector<Fact>& identity) const {
    // Which samples a plan of noise takes depends on how many there are; all others are what they are.
    const bool planned = std::ranges::find(identity, Fact{"adaptive", "on"}) != identity.end();
    for (const CheckpointReader& reader : readers_) {
        const CheckpointHeader& first = readers_[0].header();
        const CheckpointHeader& header = reader.header();
        std::vector<std::string> lines = differences(header.identity, identity, "the part", "the scene as it is");
        if (planned && header.whole != first.whole)
            lines.push_back(fmt::format("samples per replicate: {} in the part, {} in `{}`", header.whole, first.whole,
                                        readers_[0].path()));
        if (header.planes != first.planes)
            lines.push_back(fmt::format("layers: {} in the part, {} in `{}`", fmt::join(header.planes, " "),
                                        fmt::join(first.planes, " "), readers_[0].path()));
        if (header.lightBlocks != first.lightBlocks)
            lines.push_back(fmt::format("blocks of light paths: {} in the part, {} in `{}`", header.lightBlocks,
                                        first.lightBlocks, readers_[0].path()));
        if (header.pilot != first.pilot)
            lines.push_back(
                fmt::format("pilot: {} in the part, {} in `{}`", header.pilot, first.pilot, readers_[0].path()));
        if (!lines.empty())
            throw CheckpointFault("E0663",
                                  fmt::format("`{}` is of another render: {}", reader.path(), fmt::join(lines, "; ")),
                                  "parts are put together when all was the same but `--part` and `--crop`");
    }
}

void RenderParts::checkRange() const {
    for (std::size_t i = 1; i < readers_.size(); ++i) {
        const CheckpointHeader &before = readers_[i - 1].header(), &here = readers_[i].header();
        if (here.first != before.last)
            throw misfit(fmt::format("samples {} to {} are missing between `{}` and `{}`", before.last, here.first,
                                     readers_[i - 1].path(), readers_[i].path()),
                         "a part (`-o FILE.abbe`) holds samples that follow each other; an image is made of any");
        if (!isSame(here.bounds, before.bounds))
            throw misfit(fmt::format("`{}` has the pixels {}, `{}` has {}", readers_[i - 1].path(),
                                     rectangleText(before.bounds), readers_[i].path(), rectangleText(here.bounds)),
                         "a part (`-o FILE.abbe`) holds one rectangle; an image is made of any");
    }
}

void RenderParts::checkDisjoint() const {
    for (std::size_t i = 0; i < readers_.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const CheckpointHeader &a = readers_[j].header(), &b = readers_[i].header();
            const PixelBounds both = common(a.bounds, b.bounds);
            const std::uint32_t first = std::max(a.first, b.first), last = std::min(a.last, b.last);
            if (isEmpty(both) || first >= last) continue;
            throw misfit(fmt::format("samples {} to {} of the pixels {} are in `{}` and in `{}`", first, last,
                                     rectangleText(both), readers_[j].path(), readers_[i].path()),
                         "give each part once");
        }
}

PixelBounds RenderParts::bounds() const {
    PixelBounds all = readers_[0].header().bounds;
    for (const CheckpointReader& reader : readers_) {
        const PixelBounds& b = reader.header().bounds;
        all = {std::min(all.x0, b.x0), std::min(all.y0, b.y0), std::max(all.x1, b.x1), std::max(all.y1, b.y1)};
    }
    return all;
}

// No two overlap, so nothing is missing where they add up; else the first place is looked for at the corners of parts,
// because what is covered changes there only.
void RenderParts::checkComplete() const {
    const PixelBounds all = bounds();
    const std::uint32_t whole = this->whole();
    std::vector<int> xs{all.x0}, ys{all.y0};
    std::vector<std::uint32_t> starts{0};
    for (const CheckpointReader& reader : readers_) {
        const CheckpointHeader& h = reader.header();
        xs.insert(xs.end(), {h.bounds.x0, h.bounds.x1});
        ys.insert(ys.end(), {h.bounds.y0, h.bounds.y1});
        starts.insert(starts.end(), {h.first, h.last});
    }
    const auto covered = [&](int x, int y, std::uint32_t sample) {
        return std::any_of(readers_.begin(), readers_.end(), [&](const CheckpointReader& reader) {
            const CheckpointHeader& h = reader.header();
            return !isEmpty(common(h.bounds, {x, y, x + 1, y + 1})) && h.first <= sample && sample < h.last;
        });
    };
    std::sort(starts.begin(), starts.end());
    for (const int y : ys)
        for (const int x : xs)
            for (const std::uint32_t s : starts) {
                if (x >= all.x1 || y >= all.y1 || s >= whole || covered(x, y, s)) continue;
                const auto end = std::upper_bound(starts.begin(), starts.end(), s);
                throw misfit(fmt::format("samples {} to {} of {} are missing at pixel {},{}", s,
                                         end == starts.end() ? whole : *end, whole, x, y),
                             "give all parts, of `--part 1/N` to `--part N/N`, and crops that fill a rectangle");
            }
}

namespace {

constexpr std::size_t kExpectedAtOnce = 16; // parts

// Adds what another range of samples of the same tiles did.
void addTiles(RenderState& total, const RenderState& state) {
    for (std::size_t i = 0; i < total.tileCount(); ++i) {
        TileState& to = total.tile(i);
        const TileState& from = state.tile(i);
        to.reached = from.reached;
        to.tally.add(from.tally);
        for (const DroppedSample& s : from.examples)
            if (to.examples.size() < TileState::kExamples) to.examples.push_back(s);
    }
}

} // namespace

// What is read first lies in small blocks between the large ones of layers. A disk that is asked for one after the
// other is waited for most of the time, so it is asked for those of many parts at once; not of all, since there may be
// more than the system has memory for.
std::vector<std::jthread> RenderParts::expectPictures(std::size_t first) const {
    std::vector<std::jthread> threads;
    try {
        for (std::size_t i = first; i < std::min(first + kExpectedAtOnce, readers_.size()); ++i)
            threads.emplace_back([this, i](const std::stop_token& stop) { readers_[i].expectPicture(stop); });
    } catch (const std::system_error&) { // no more threads: the rest is waited for
    }
    return threads;
}

RenderStatistics RenderParts::addTo(PixelFilm& film) {
    std::vector<std::jthread> ahead;
    const FilmPlanes planes = film.planes();
    RenderStatistics statistics;
    PathTally sum;
    const CheckpointHeader& first = readers_[0].header();
    if (wanted_ == PartsWanted::range) {
        total_.emplace(first.bounds, first.first, first.lightBlocks);
        total_->setPilot(first.pilot);
    }
    for (std::size_t i = 0; i < readers_.size(); ++i) {
        if (i % kExpectedAtOnce == 0) ahead = expectPictures(i);
        CheckpointReader& reader = readers_[i];
        const CheckpointHeader& header = reader.header();
        const RenderState state = reader.addPicture(planes);
        const bool finished = state.even() && state.reached() == header.last;
        if (!finished && wanted_ != PartsWanted::soFar)
            throw misfit(fmt::format("`{}` is not finished: sample {} of {}", reader.path(),
                                     state.reached() - header.first, header.last - header.first),
                         "finish it with the command that made it and `--resume`");
        sum.add(state.tally());
        statistics.seconds += state.seconds;
        statistics.stopped |= !finished;
        work_.add(state.work);
        if (total_) addTiles(*total_, state);
        for (const DroppedSample& s : state.examples())
            if (statistics.examples.size() < TileState::kExamples) statistics.examples.push_back(s);
    }
    statistics.add(sum);
    statistics.samplesPerPixel = whole() * static_cast<std::uint32_t>(first.replicates);
    statistics.kernel = "merged";
    if (wanted_ == PartsWanted::soFar) statistics.stopped = true;
    if (total_) total_->seconds = statistics.seconds;
    return statistics;
}

// Column by column of tiles and of each part by part: sums of a tile are in the cache of one core until all parts are
// in them. Where parts begin at other pixels than the film does, as crops may, tiles are read for each column and row
// that they reach into. The row below is said to be wanted, so that the disk is at work while this one is added up.
void RenderParts::addLayers(const FilmPlanes& planes, PixelBounds rows, bool ofLightPaths) const {
    const TileGrid grid(rows);
    parallelFor(grid.count(), [&](std::size_t i) {
        CheckpointReader::Scratch scratch;
        const PixelBounds here = grid.pixels(i);
        const PixelBounds below{here.x0, here.y1, here.x1, here.y1 + TileGrid::kSize};
        for (const PixelBounds& wanted : {here, below})
            for (const CheckpointReader& reader : readers_) reader.expectLayers(wanted, ofLightPaths);
        for (const CheckpointReader& reader : readers_) reader.addLayers(planes, here, ofLightPaths, scratch);
    });
}

void RenderParts::bringLayers(PixelFilm& film, PixelBounds rows) const {
    if (!film.layers()) return;
    film.layers()->restart(rows);
    const FilmPlanes planes = film.planes();
    for (const bool ofLightPaths : {false, true}) addLayers(planes, rows, ofLightPaths);
}

void RenderParts::write(const std::string& path, PixelFilm& film) {
    ABBE_CHECK(total_);
    CheckpointHeader header = readers_[0].header();
    header.last = readers_.back().header().last;
    header.whole = whole();
    header.seconds = total_->seconds;
    header.work = work_;
    const auto fetch = [&](PixelBounds rows, bool ofLightPaths) {
        if (film.layers()) film.layers()->restart(rows);
        FilmPlanes planes = film.planes();
        if (film.layers()) addLayers(planes, rows, ofLightPaths);
        return planes;
    };
    writeMerged(path, header, *total_, film.takesSplats(), fetch);
}

} // namespace abbe
