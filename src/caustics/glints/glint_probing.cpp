#include "caustics/glints/glint_probing.h"

#include "base/parallel.h"
#include "base/work.h"
#include "caustics/glints/glint_plan.h"
#include "caustics/glints/glint_search.h"
#include "caustics/shared/light_path_verdict.h"
#include "caustics/shared/pilot.h"
#include "math/frame.h"
#include "math/hash.h"
#include "render/scene.h"
#include "transport/roulette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

namespace abbe {

namespace {

constexpr std::uint64_t kKey = 0x676c696e74; // "glint"
constexpr std::size_t kMostLights = 8;
constexpr int kStep = 4, kWalks = 36; // pixels between places from which so many walks start
constexpr double kMostSeeds = 16384;  // such places; larger frames and smaller pilots have wider steps
constexpr float kNear = 1.2f;         // of the light's direction: from where Newton's method starts
constexpr std::uint32_t kMostCandidates = 16384, kLeastCandidates = 64; // of which Newton's method starts
constexpr int kIterations = 32;
constexpr float kDifference = 0.05f, kFinestStep = 0.002f, kLongestPixelStep = 6; // pixels
constexpr float kMargin = 1.3f;                                                   // of boxes
constexpr double kLargestBox = 256;                                               // pixels: what is larger is no glint
constexpr double kRelevantSamples = 1024; // of a picture in which noise starts to matter less than specks
constexpr double kLeastError = 0.003;     // of a tile, that is worth probes
constexpr double kTile = 64;              // pixels
constexpr double kMostRays = 1.5;         // for a sample of every pixel, in the mean over pixels
constexpr std::array kHeroes{0.01f, 0.25f, 0.5f, 0.75f, 0.99f}; // of chains that disperse each has an image of its own

// A place from which Newton's method starts.
struct Candidate {
    ChainSignature chain;
    std::size_t light = 0;
    Vec2 film;
    float miss = 0;
};

// Where the film shows the middle of a light, at one wavelength.
struct Image {
    Vec2 film, half;        // of its extent along the film's axes, pixels
    double area = 0;        // pixels
    double luminance = 0;   // as the film's Y
    double probability = 0; // that a camera path there takes this chain
};

struct Found {
    Glint glint;
    double error = 0; // of a tile, relative, by camera paths alone
    double rays = 0;  // of all probes for a sample of every pixel
};

class GlintPlanner {
  public:
    GlintPlanner(const PathContext& context, const Film& film, const LightPathKernel& kernel,
                 const RouletteReference& roulette, const std::function<bool()>& stop)
        : context_(context), film_(film), kernel_(kernel), roulette_(roulette), stop_(stop),
          frame_(context.scene.frame), lights_(glintLights(context.scene, kMostLights)) {}

    PlannedGlints run() {
        PlannedGlints result;
        if (lights_.empty() || !mayBeProbed()) return result;
        result.findings.measured = true;
        addWorkFlag(WorkFlag::pilot);
        std::vector<Found> list = measured(candidates());
        removeWorkFlag(WorkFlag::pilot);
        result.findings.pilotRays = rays_;
        if (stop_()) return result;
        std::unordered_set<const Light*> lights;
        for (const GlintLight& light : lights_) lights.insert(light.source);
        result.plan = worthwhile(std::move(list), std::move(lights), result.findings);
        return result;
    }

  private:
    // Probes divide by what the filter gives to samples: it must not be negative.
    bool mayBeProbed() const {
        const float reach = film_.filterRadius();
        for (int i = 0; i <= 64; ++i)
            if (film_.filterWeight(reach * static_cast<float>(i) / 64) < 0) return false;
        return true;
    }

    void send(std::span<const GlintQuery> queries, std::uint64_t& rays, const GlintCallback& report) const {
        PathCounters counters;
        kernel_.glints(context_, queries, counters, report);
        rays += counters.vertices;
    }

    // How far off a light a segment goes, across two axes. Stereographic: it grows all the way to the opposite
    // direction, or Newton's method would not find the way back.
    static Vec2 missOf(const GlintView& view, const GlintLight& light, const Frame& about) {
        const Vec3 towards = light.from(view.p);
        const float cosine = dot(view.direction, towards), scale = 2 / (1 + std::max(cosine, -1 + 1e-4f));
        const Vec3 off = (view.direction - towards * cosine) * scale;
        return {dot(off, about.x), dot(off, about.y)};
    }

    // Pixels between places from which walks start. Of candidates that are alike and this near one is taken.
    int step() const {
        const double effort = PilotSize(context_.settings).effort();
        const double scale = std::sqrt(static_cast<double>(frame_.area()) / (kMostSeeds * effort));
        const int most = std::max(kStep, std::min(frame_.width(), frame_.height()));
        return std::min(static_cast<int>(std::ceil(std::max(kStep / std::sqrt(effort), scale))), most);
    }

    std::vector<GlintQuery> seeds() const {
        const int step = this->step();
        std::vector<GlintQuery> queries;
        for (int y = frame_.y0; y < frame_.y1; y += step)
            for (int x = frame_.x0; x < frame_.x1; x += step)
                for (int k = 0; k < kWalks; ++k) {
                    GlintQuery query;
                    query.seed = combine64(combine64(context_.settings.seed, kKey), queries.size());
                    RandomStream random(combine64(query.seed, kKey));
                    query.film = {static_cast<float>(x) + random.uniform() * static_cast<float>(step),
                                  static_cast<float>(y) + random.uniform() * static_cast<float>(step)};
                    query.wavelength = random.uniform();
                    queries.push_back(query);
                }
        return queries;
    }

    // Walks that go near a light; of those that are alike the nearest.
    std::vector<Candidate> candidates() {
        const std::vector<GlintQuery> queries = seeds();
        constexpr std::size_t kPart = 256;
        std::vector<std::vector<Candidate>> parts(queries.size() / kPart + 1);
        std::vector<std::uint64_t> rays(parts.size());
        const std::uint32_t most = context_.settings.maxDepth; // camera paths see no light beyond it
        parallelFor(parts.size(), [&](std::size_t i) {
            if (stop_()) return;
            const auto part = std::span(queries).subspan(i * kPart, std::min(kPart, queries.size() - i * kPart));
            send(part, rays[i], [&](std::size_t k, const GlintView& view, const Wavelengths&) {
                if (most > 0 && static_cast<std::uint32_t>(view.chain.length()) > most) return;
                for (std::size_t l = 0; l < lights_.size(); ++l) {
                    const float miss = length(view.direction - lights_[l].from(view.p));
                    if (miss < kNear) parts[i].push_back({view.chain, l, part[k].film, miss});
                }
            });
        });
        for (const std::uint64_t r : rays) rays_ += r;
        const int block = step();
        std::map<std::tuple<ChainSignature, std::size_t, int, int>, Candidate> nearest;
        for (const auto& part : parts)
            for (const Candidate& c : part) {
                const auto place = nearest.try_emplace(
                    {c.chain, c.light, static_cast<int>(c.film.x) / block, static_cast<int>(c.film.y) / block}, c);
                if (c.miss < place.first->second.miss) place.first->second = c;
            }
        std::vector<Candidate> list;
        for (const auto& [key, c] : nearest) list.push_back(c);
        std::ranges::stable_sort(list, {}, &Candidate::miss);
        const std::size_t number = PilotSize(context_.settings).count(kMostCandidates, kLeastCandidates);
        if (list.size() > number) list.resize(number);
        return list;
    }

    // One segment of a chain at a place, and before and behind it along both axes of the film: how far off the light it
    // goes, and how that changes.
    struct Look {
        std::array<bool, 5> seen{};
        std::array<Vec2, 5> miss;
        bool known() const { return std::ranges::all_of(seen, std::identity()); }
        Vec3 p;
        bool hitsLight = false;
        double luminance = 0, probability = 0;
    };
    Look look(const Candidate& c, float hero, float difference, std::uint64_t& rays) const {
        const GlintLight& light = lights_[c.light];
        std::array<GlintQuery, 5> queries;
        for (GlintQuery& q : queries) q = {c.film, hero, c.chain, kKey};
        queries[1].film.x -= 0.5f * difference;
        queries[2].film.x += 0.5f * difference;
        queries[3].film.y -= 0.5f * difference;
        queries[4].film.y += 0.5f * difference;
        Look look;
        Frame about;
        send(queries, rays, [&](std::size_t k, const GlintView& view, const Wavelengths& lambda) {
            if (k == 0) {
                about = Frame::fromNormal(light.from(view.p));
                look.p = view.p;
                const Spectrum emitted = view.emitted(*light.source, lambda);
                look.hitsLight = anyNonZero(emitted);
                look.luminance =
                    context_.scene.sensor(view.throughput * emitted, context_.scene.wavelengths.sample(hero)).y;
                look.probability = view.probability;
            }
            look.seen[k] = true;
            look.miss[k] = missOf(view, light, about);
        });
        return look;
    }

    // How the miss changes over the film, 1/pixel.
    struct Slope {
        Vec2 dx, dy;
        float determinant = 0;

        Slope(const Look& at, float difference)
            : dx((at.miss[2] - at.miss[1]) * (1 / difference)), dy((at.miss[4] - at.miss[3]) * (1 / difference)),
              determinant(dx.x * dy.y - dx.y * dy.x) {}
        // To where there would be none, and no farther than is trusted.
        Vec2 step(Vec2 miss) const {
            const Vec2 all = Vec2{dy.x * miss.y - dy.y * miss.x, dx.y * miss.x - dx.x * miss.y} * (1 / determinant);
            const float way = size(all);
            return way > kLongestPixelStep ? all * (kLongestPixelStep / way) : all;
        }
        Image image(Vec2 film, float radius, const Look& at) const {
            const float each = radius / std::abs(determinant);
            return {film, Vec2{size(dy), size(dx)} * each, kPiD * static_cast<double>(radius * each), at.luminance,
                    at.probability};
        }
    };
    static float size(Vec2 v) { return std::sqrt(v.x * v.x + v.y * v.y); }

    // Newton's method on the film. A step that leads nowhere, or farther off, is halved; where that does not help, as
    // along the rim of a ball, the slope was taken over too wide a difference.
    std::optional<Image> imageOf(Candidate& c, float hero, std::uint64_t& rays) const {
        Vec2 before = c.film, step;
        float least = kInfinity, nearest = kInfinity, difference = kDifference;
        for (int i = 0; i < kIterations; ++i) {
            const Look at = look(c, hero, difference, rays);
            const float off = at.known() ? size(at.miss[0]) : kInfinity;
            if (i == kIterations / 4 && !(nearest < 0.5f * c.miss)) return std::nullopt; // most of these end nowhere
            nearest = std::min(nearest, off);
            if (!(off < least)) {
                if (i == 0) return std::nullopt;
                if (size(step) > 2 * difference) {
                    step = step * 0.5f;
                    c.film = before + step;
                } else {
                    difference *= 0.25f;
                    if (difference < kFinestStep) return std::nullopt;
                    least = kInfinity;
                    c.film = before;
                }
                continue;
            }
            const Slope slope(at, difference);
            if (!(std::abs(slope.determinant) > 0)) return std::nullopt;
            const float radius = lights_[c.light].sine(at.p);
            before = c.film;
            if (at.hitsLight && off < 0.5f * radius) {
                const Image image = slope.image(c.film, radius, at);
                const float own = std::clamp(std::min(image.half.x, image.half.y), kFinestStep, kDifference);
                if (!(own < 0.5f * difference)) return image;
                difference = own; // over the image itself
                least = kInfinity;
                step = {};
                continue;
            }
            least = off;
            step = slope.step(at.miss[0]);
            c.film = before + step;
            if (!isNear(c.film)) return std::nullopt;
        }
        return std::nullopt;
    }
    bool isNear(Vec2 film) const {
        constexpr float kEdge = 8; // pixels
        return film.x > static_cast<float>(frame_.x0) - kEdge && film.x < static_cast<float>(frame_.x1) + kEdge &&
               film.y > static_cast<float>(frame_.y0) - kEdge && film.y < static_cast<float>(frame_.y1) + kEdge;
    }

    std::vector<Found> measured(std::vector<Candidate> list) {
        std::vector<std::optional<Image>> images(list.size());
        std::vector<std::uint64_t> rays(list.size());
        parallelFor(list.size(), [&](std::size_t i) {
            if (!stop_()) images[i] = imageOf(list[i], 0.5f, rays[i]);
        });
        std::vector<std::size_t> single; // several lead to the same
        for (std::size_t i = 0; i < list.size(); ++i) {
            if (!images[i]) continue;
            const auto same = [&](std::size_t k) {
                const Vec2 off = images[k]->film - images[i]->film, half = images[k]->half;
                return list[k].chain == list[i].chain && list[k].light == list[i].light && std::abs(off.x) < half.x &&
                       std::abs(off.y) < half.y;
            };
            if (std::ranges::none_of(single, same)) single.push_back(i);
        }
        std::vector<std::optional<Found>> found(single.size());
        parallelFor(single.size(), [&](std::size_t i) {
            if (!stop_()) found[i] = whole(list[single[i]], rays[single[i]]);
        });
        for (const std::uint64_t r : rays) rays_ += r;
        std::vector<Found> result;
        for (const auto& f : found)
            if (f) result.push_back(*f);
        return result;
    }

    // At all wavelengths.
    std::optional<Found> whole(const Candidate& middle, std::uint64_t& rays) const {
        std::vector<Image> images;
        for (const float hero : kHeroes) {
            Candidate c = middle;
            if (const auto image = imageOf(c, hero, rays)) images.push_back(*image);
        }
        if (images.empty()) return std::nullopt;
        Found found;
        found.glint.chain = middle.chain;
        double light = 0, hits = 0, area = 0;
        const auto n = static_cast<double>(images.size());
        for (const Image& image : images) {
            const Vec2 half = image.half * kMargin;
            const FilmBox own{image.film - half, image.film + half};
            found.glint.box = &image == &images.front() ? own : found.glint.box.united(own);
            light += image.luminance * image.area / n;
            hits += image.probability * image.area / n;
            area += image.area / n;
        }
        const FilmBox& box = found.glint.box;
        if (!(static_cast<double>(box.area()) < kLargestBox) || !isSeenByRays(box)) return std::nullopt;
        const Vec2 place = middle.film;
        const double beside = expected(static_cast<int>(std::floor(place.x)), static_cast<int>(std::floor(place.y)));
        const double share = light / (light + kTile * beside);
        found.error = share / std::sqrt(std::max(1e-30, hits * kRelevantSamples));
        const double fill = area / static_cast<double>(box.area());
        found.glint.side = static_cast<std::uint32_t>(std::clamp(std::ceil(std::sqrt(4 / fill)), 2.0, 8.0));
        const double reach = static_cast<double>(film_.filterRadius());
        const double width = static_cast<double>(box.upper.x - box.lower.x) + 2 * reach,
                     height = static_cast<double>(box.upper.y - box.lower.y) + 2 * reach;
        found.rays = width * height * found.glint.side * found.glint.side * (middle.chain.length() + 1);
        return found;
    }

    // Y that the pilot expects there.
    double expected(int x, int y) const {
        const float scale =
            roulette_.scale(std::clamp(x, frame_.x0, frame_.x1 - 1), std::clamp(y, frame_.y0, frame_.y1 - 1));
        return static_cast<double>(roulette_.average() / (RouletteReference::kThreshold * scale));
    }

    // Pixels that see the box have rays all over.
    bool isSeenByRays(const FilmBox& box) const {
        const float reach = 2 * film_.filterRadius();
        const FilmBox wide{box.lower - Vec2{reach, reach}, box.upper + Vec2{reach, reach}};
        constexpr int kSide = 4;
        for (int i = 0; i <= kSide; ++i)
            for (int j = 0; j <= kSide; ++j) {
                const Vec2 place{wide.lower.x + (wide.upper.x - wide.lower.x) * static_cast<float>(i) / kSide,
                                 wide.lower.y + (wide.upper.y - wide.lower.y) * static_cast<float>(j) / kSide};
                if (!(context_.scene.camera->ray({place, {0.5f, 0.5f}, 0.5f}).weight > 0)) return false;
            }
        return true;
    }

    std::unique_ptr<const GlintPlan> worthwhile(std::vector<Found> list, std::unordered_set<const Light*> lights,
                                                GlintFindings& findings) const {
        std::ranges::stable_sort(list, [](const Found& a, const Found& b) { return a.error > b.error; });
        const double most = kMostRays * static_cast<double>(frame_.area());
        std::vector<Glint> glints;
        double rays = 0;
        for (const Found& f : list) {
            if (f.error < kLeastError) break;
            if (rays + f.rays > most) continue;
            rays += f.rays;
            findings.error = std::max(findings.error, f.error);
            glints.push_back(f.glint);
        }
        if (glints.empty()) return nullptr;
        auto plan =
            std::make_unique<const GlintPlan>(frame_, film_.filterRadius(), std::move(glints), std::move(lights));
        findings.found = static_cast<std::uint32_t>(plan->glints().size());
        findings.rays = rays / static_cast<double>(frame_.area());
        return plan;
    }

    const PathContext& context_;
    const Film& film_;
    const LightPathKernel& kernel_;
    const RouletteReference& roulette_;
    const std::function<bool()>& stop_;
    PixelBounds frame_;
    std::vector<GlintLight> lights_;
    std::uint64_t rays_ = 0;
};

} // namespace

void GlintProbing::plan(const PilotInput& in) {
    if (lightPathVerdict(in.context.scene, in.context.settings.technique) != LightPathVerdict::undecided) return;
    planned_ = GlintPlanner(in.context, in.film, in.kernel, in.roulette, in.stop).run();
}

} // namespace abbe
