// Parts with layers, put together some rows at a time: the bits of a film that has all of them at once.
#include "checkpoints/checkpoint_reader.h"
#include "checkpoints/render_parts.h"
#include "film/pixel_film.h"
#include "io/exr_deep.h"
#include "io/exr_reader.h"
#include "pictures/film_picture.h"
#include "pictures/image_output.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <unistd.h>

namespace abbe::test {
namespace {

namespace fs = std::filesystem;

struct BandFolder {
    fs::path path = fs::temp_directory_path() / ("abbe_banded_merge_" + std::to_string(getpid()));
    BandFolder() { fs::create_directories(path); }
    ~BandFolder() { fs::remove_all(path); }
    std::string operator/(const std::string& name) const { return (path / name).string(); }
};

constexpr PixelBounds kAll{-3, 5, 40, 61}; // 56 rows: three and a half tiles
constexpr std::uint32_t kSamples = 6;
const int kThings[3] = {};
const SceneNames kSceneNames{{&kThings[0], "lamp"}, {&kThings[1], "ball"}, {&kThings[2], "unseen"}};

LayerPlan everything() {
    LayerPlan plan;
    plan.albedo = plan.normal = plan.position = plan.depth = plan.uv = true;
    plan.samples = plan.seconds = plan.invalid = plan.components = plan.halves = true;
    plan.objects = plan.materialIds = true;
    plan.groups = {{"key", {"lamp"}}};
    plan.spectral = SpectralBins{400, 700, 50};
    plan.deep = 3;
    return plan;
}

PixelFilm makeBandFilm(PixelBounds bounds, bool splats, std::optional<PixelBounds> rows = {}) {
    PixelFilm film(bounds, PixelFilter(FilterShape::box, 0.5), 2);
    if (splats) film.keepSplats();
    film.keepLayers(everything(), kSceneNames, rgb::ap0, {}, rows);
    return film;
}

// Something in every plane for each pixel and sample, whatever else the film holds.
void addSample(PixelFilm& film, int x, int y, std::uint32_t s) {
    const double v = 1 + 0.37 * x + 0.011 * y + 1.7 * s;
    const int replicate = static_cast<int>(s % 2);
    film.add(x, y, replicate, Xyz{v, 2 * v, 0.5 * v}, 1);
    FilmLayers& layers = *film.layers();
    const std::size_t pixel = layers.pixelIndex(x, y);
    const auto sums = layers.sums(pixel, replicate);
    const auto at = layers.plan().offsets();
    for (int i = 0; i < at.total; ++i)
        if (i < at.groups || i >= at.spectral) sums[static_cast<std::size_t>(i)] += ExactSum(v / (3 + i));
    // Light groups and components add up to the picture.
    const auto set = [&](int offset, double share) {
        const auto i = static_cast<std::size_t>(offset);
        sums[i] += ExactSum(share * v);
        sums[i + 1] += ExactSum(2 * share * v);
        sums[i + 2] += ExactSum(0.5 * share * v);
    };
    set(at.groups, 0.25);
    set(at.groups + 3, 0.75);
    for (int c = 0; c < 3; ++c) set(at.components + 3 * c, c == 0 ? 0.5 : 0.25);
    layers.cover(pixel, FilmLayers::Matte::objects, &kThings[(x + static_cast<int>(s)) % 2 == 0]);
    layers.cover(pixel, FilmLayers::Matte::materials, &kThings[1]);
    layers.addSeconds(pixel, 0.25);
    if (s == 3) layers.addInvalid(pixel);
    const auto depth = static_cast<float>(1 + (x + 64) % 7 + 3 * static_cast<int>(s));
    layers.deep()->add(pixel, DeepSums::Kind::surface, depth, 0.5f, {v, v, v});
    layers.deep()->add(pixel, DeepSums::Kind::medium, depth / 2, 0.25f, {v / 8, v / 8, v / 8});
}

// Light paths of one sample: those of the whole frame, of which a crop gets what falls on it.
void addLight(PixelFilm& film, std::uint32_t s) {
    const int replicate = static_cast<int>(s % 2);
    const Spectrum radiance(0.5f);
    const Wavelengths lambda = Wavelengths::sample(0.3f);
    for (int y = kAll.y0; y < kAll.y1; ++y)
        for (int x = kAll.x0; x < kAll.x1; ++x) {
            if (isEmpty(common(film.bounds(), {x, y, x + 1, y + 1})) || (x + y + static_cast<int>(s)) % 5 != 0)
                continue;
            film.splat(x, y, replicate,
                       {{4.0 + x, 8.0 + y, 2.0},
                        radiance,
                        lambda,
                        0.5,
                        s % 2 ? &kThings[0] : nullptr,
                        static_cast<PathComponent>(s % 3)});
        }
    film.countLightPaths(replicate, 7);
}

void fillSamples(PixelFilm& film, std::uint32_t first, std::uint32_t last) {
    const PixelBounds b = film.bounds();
    for (std::uint32_t s = first; s < last; ++s) {
        for (int y = b.y0; y < b.y1; ++y)
            for (int x = b.x0; x < b.x1; ++x) addSample(film, x, y, s);
        if (film.takesSplats()) addLight(film, s);
    }
}

void writeSamples(const std::string& path, PixelBounds bounds, std::uint32_t first, std::uint32_t last, bool splats) {
    PixelFilm film = makeBandFilm(bounds, splats);
    fillSamples(film, first, last);
    RenderState state(bounds, first, splats ? 2 : 0);
    for (std::size_t i = 0; i < state.tileCount(); ++i) {
        state.tile(i).reached = last;
        state.tile(i).tally.paths = i;
    }
    CheckpointHeader header;
    header.identity = {{"seed", "7"}};
    header.bounds = bounds;
    header.replicates = 2;
    header.lightBlocks = splats ? 2 : 0;
    header.first = first;
    header.last = last;
    header.whole = kSamples;
    const FilmPlanes planes = film.planes();
    for (const auto& plane : planes) header.planes.push_back(plane->name());
    writeCheckpoint(path, header, planes, state);
}

std::vector<std::byte> bandBytesOf(PixelFilm& film) {
    std::vector<std::byte> bytes;
    for (const auto& plane : film.planes()) plane->store(film.bounds(), bytes);
    return bytes;
}

// A picture with all that is beside it, made in portions of some rows.
struct Shown {
    ResolvedImage image;
    LayerPlanes layers;
    DeepImage deep;
};
Shown show(FilmPicture& picture, int step) {
    Shown shown;
    const PixelBounds b = picture.image.bounds;
    const auto heads = picture.rows(b.y0, b.y0);
    shown.layers.header = heads.layers.header;
    for (const NamedPlane& plane : heads.layers.planes) shown.layers.planes.push_back({plane.name, {}});
    for (int y = b.y0; y < b.y1; y += step) {
        const auto rows = picture.rows(y, std::min(y + step, b.y1));
        shown.layers.unequalSums += rows.layers.unequalSums;
        for (std::size_t i = 0; i < rows.layers.planes.size(); ++i) {
            auto& to = shown.layers.planes[i].values;
            to.insert(to.end(), rows.layers.planes[i].values.begin(), rows.layers.planes[i].values.end());
        }
        shown.deep.counts.insert(shown.deep.counts.end(), rows.deep->counts.begin(), rows.deep->counts.end());
        shown.deep.r.insert(shown.deep.r.end(), rows.deep->r.begin(), rows.deep->r.end());
        shown.deep.back.insert(shown.deep.back.end(), rows.deep->back.begin(), rows.deep->back.end());
    }
    shown.image = picture.image;
    return shown;
}

void checkSame(const Shown& a, const Shown& b) {
    CHECK(a.image.r == b.image.r);
    CHECK(a.image.g == b.image.g);
    CHECK(a.image.b == b.image.b);
    CHECK(a.image.variance == b.image.variance);
    CHECK(a.layers.header == b.layers.header);
    CHECK(a.layers.unequalSums == b.layers.unequalSums);
    REQUIRE(a.layers.planes.size() == b.layers.planes.size());
    for (std::size_t i = 0; i < a.layers.planes.size(); ++i) {
        CAPTURE(a.layers.planes[i].name);
        CHECK(a.layers.planes[i].name == b.layers.planes[i].name);
        CHECK(a.layers.planes[i].values == b.layers.planes[i].values);
    }
    CHECK(a.deep.counts == b.deep.counts);
    CHECK(a.deep.r == b.deep.r);
    CHECK(a.deep.back == b.deep.back);
}

struct Merged {
    Shown shown;
    int mostRows = 0; // of layers at once
};
Merged mergeInRows(const BandFolder& folder, std::vector<std::string> names, bool splats, int step) {
    for (std::string& name : names) name = folder / name;
    RenderParts parts(names);
    parts.check({{"seed", "7"}});
    const PixelBounds b = parts.bounds();
    PixelFilm film = makeBandFilm(b, splats, PixelBounds{b.x0, b.y0, b.x1, b.y0});
    parts.addTo(film);
    Merged merged;
    const auto bring = [&](PixelBounds rows) {
        merged.mostRows = std::max(merged.mostRows, rows.height());
        parts.bringLayers(film, rows);
    };
    const FilmSettings settings;
    FilmPicture picture(film, settings, 2, {1, 2, 3}, bring);
    merged.shown = show(picture, step);
    return merged;
}

} // namespace

TEST_CASE("layers of parts brought in rows make the picture of a film that has all of them, to the bit") {
    for (const bool splats : {false, true}) {
        CAPTURE(splats);
        const BandFolder folder;
        // Crops whose tiles are not those of the whole, and samples in any order.
        const PixelBounds left{-3, 5, 10, 61}, top{10, 5, 40, 14}, bottom{10, 14, 40, 61};
        writeSamples(folder / "left1", left, 0, 2, splats);
        writeSamples(folder / "left2", left, 2, 6, splats);
        writeSamples(folder / "top", top, 0, 6, splats);
        writeSamples(folder / "bottom1", bottom, 0, 5, splats);
        writeSamples(folder / "bottom2", bottom, 5, 6, splats);
        writeSamples(folder / "first", kAll, 0, 3, splats);
        writeSamples(folder / "second", kAll, 3, 6, splats);
        PixelFilm film = makeBandFilm(kAll, splats);
        fillSamples(film, 0, kSamples);
        const FilmSettings settings;
        FilmPicture picture(film, settings, 2, {1, 2, 3});
        const Shown whole = show(picture, 100);
        CHECK(whole.layers.unequalSums == 0);
        for (const int step : {16, 32, 100}) {
            CAPTURE(step);
            const Merged samples = mergeInRows(folder, {"second", "first"}, splats, step);
            checkSame(samples.shown, whole);
            CHECK(samples.mostRows == 16); // however high the film is
            const Merged crops = mergeInRows(folder, {"bottom2", "left2", "top", "left1", "bottom1"}, splats, step);
            checkSame(crops.shown, whole);
            CHECK(crops.mostRows == 16);
        }
    }
}

TEST_CASE("an image that is written while its next rows are made has the channels of all of them") {
    const BandFolder folder;
    // Several groups of rows.
    const PixelBounds bounds{0, 0, 320, 160};
    PixelFilm film = makeBandFilm(bounds, false);
    fillSamples(film, 0, 2);
    FilmSettings settings;
    settings.width = bounds.x1;
    settings.height = bounds.y1;
    FilmPicture written(film, settings, 2, {1, 2, 3}), other(film, settings, 2, {1, 2, 3});
    Diagnostics diagnostics;
    writeImage(folder / "x.exr", written, settings, {}, diagnostics);
    CHECK(diagnostics.all().empty());
    const Shown shown = show(other, 100);
    const ExrPlanes planes = readExrChannels(folder / "x.exr");
    REQUIRE(planes.find("R"));
    CHECK(*planes.find("R") == shown.image.r);
    for (const NamedPlane& plane : shown.layers.planes) {
        CAPTURE(plane.name);
        REQUIRE(planes.find(plane.name));
        CHECK(*planes.find(plane.name) == plane.values);
    }
    CHECK(readDeepExr(folder / "x.deep.exr").r == shown.deep.r);
}

TEST_CASE("a part made of parts in rows holds what a render of all of their samples wrote") {
    for (const bool splats : {false, true}) {
        CAPTURE(splats);
        const BandFolder folder;
        writeSamples(folder / "1", kAll, 1, 2, splats);
        writeSamples(folder / "2", kAll, 2, 6, splats);
        writeSamples(folder / "both", kAll, 1, 6, splats);
        RenderParts parts({folder / "2", folder / "1"}, PartsWanted::range);
        parts.check({{"seed", "7"}});
        PixelFilm film = makeBandFilm(kAll, splats, PixelBounds{kAll.x0, kAll.y0, kAll.x1, kAll.y0});
        parts.addTo(film);
        parts.write(folder / "merged", film);
        PixelFilm merged = makeBandFilm(kAll, splats), expected = makeBandFilm(kAll, splats);
        CheckpointReader reader(folder / "merged");
        CHECK(reader.header().first == 1);
        CHECK(reader.header().last == 6);
        const RenderState state = reader.addTo(merged.planes());
        CHECK(state.reached() == 6);
        CheckpointReader(folder / "both").addTo(expected.planes());
        CHECK(bandBytesOf(merged) == bandBytesOf(expected));
        CHECK(merged.layers()->seen(FilmLayers::Matte::objects, 0));
        CHECK_FALSE(merged.layers()->seen(FilmLayers::Matte::objects, 2)); // "unseen"
    }
}

TEST_CASE("damage to layers is found when they are brought" * doctest::test_suite("sweep")) {
    const BandFolder folder;
    const PixelBounds small{0, 0, 17, 1};
    writeSamples(folder / "whole", small, 0, 6, true);
    std::ifstream in(folder / "whole", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const auto codeOf = [&](const std::string& content) -> std::string {
        std::ofstream(folder / "bad", std::ios::binary | std::ios::trunc) << content;
        try {
            RenderParts parts({folder / "bad"});
            parts.check({{"seed", "7"}});
            PixelFilm film = makeBandFilm(small, true, PixelBounds{0, 0, 17, 0});
            parts.addTo(film);
            parts.bringLayers(film, small);
        } catch (const CheckpointFault& fault) {
            return fault.code;
        }
        return {};
    };
    REQUIRE(codeOf(bytes).empty());
    std::size_t unnoticed = 0;
    for (std::size_t i = 0; i < bytes.size(); i += 5) {
        std::string changed = bytes;
        changed[i] = static_cast<char>(changed[i] ^ (1 << (i % 8)));
        const std::string code = codeOf(changed);
        unnoticed += code != "E0661" && code != "E0662";
    }
    for (std::size_t size = 0; size < bytes.size(); size += 11) {
        const std::string code = codeOf(bytes.substr(0, size));
        unnoticed += code != "E0661" && code != "E0662";
    }
    CHECK(unnoticed == 0);
}

} // namespace abbe::test
