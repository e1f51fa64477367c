#include "checkpoints/render_parts.h"

#include "checkpoints/render_identity.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

PixelBounds common(PixelBounds a, PixelBounds b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}
bool isEmpty(PixelBounds b) { return b.x0 >= b.x1 || b.y0 >= b.y1; }

std::string rectangleText(PixelBounds b) { return fmt::format("{},{} to {},{}", b.x0, b.y0, b.x1, b.y1); }

CheckpointFault misfit(const std::string& message, std::string help) { return {"E0664", message, std::move(help)}; }

} // namespace

std::string partPath(const std::string& imagePath, Vec2i part) {
    return std::filesystem::path(imagePath).replace_extension(fmt::format(".part{}.abbe", part.x)).string();
}

RenderParts::RenderParts(const std::vector<std::string>& paths) {
    for (const std::string& path : paths) readers_.emplace_back(path);
}

void RenderParts::check(const std::vector<Fact>& identity) const {
    for (const CheckpointReader& reader : readers_) {
        const CheckpointHeader& first = readers_[0].header();
        const CheckpointHeader& header = reader.header();
        std::vector<std::string> lines = differences(header.identity, identity, "the part", "the scene as it is");
        if (header.whole != first.whole)
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
    checkDisjoint();
    checkComplete();
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
    const std::uint32_t whole = readers_[0].header().whole;
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

RenderStatistics RenderParts::addTo(const FilmPlanes& planes) {
    RenderStatistics statistics;
    PathTally sum;
    for (CheckpointReader& reader : readers_) {
        const CheckpointHeader& header = reader.header();
        const RenderState state = reader.addTo(planes);
        if (!state.even() || state.reached() != header.last)
            throw misfit(fmt::format("`{}` is not finished: sample {} of {}", reader.path(),
                                     state.reached() - header.first, header.last - header.first),
                         "finish it with the command that made it and `--resume`");
        sum.add(state.tally());
        statistics.seconds += state.seconds;
        work_.add(state.work);
        for (const DroppedSample& s : state.examples())
            if (statistics.examples.size() < TileState::kExamples) statistics.examples.push_back(s);
    }
    statistics.add(sum);
    statistics.samplesPerPixel =
        readers_[0].header().whole * static_cast<std::uint32_t>(readers_[0].header().replicates);
    statistics.kernel = "merged";
    return statistics;
}

} // namespace abbe
