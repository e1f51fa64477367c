#include "guiding/guide_training.h"

#include "base/parallel.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace abbe {

namespace {

constexpr int kMostHalvings = 9;       // of a hemisphere's side
constexpr double kSquareBright = 12;   // squares with fewer that brought most of their light are not divided,
constexpr double kSquareShare = 0.005; // nor those that have less of a region's light
constexpr float kSmooth = 0.03f;       // of what a square has, evenly to its quarters: chance left some of them dark
constexpr std::array kGuidedShares = {0.f, 0.25f, 0.5f, 0.75f, 0.87f, 0.95f};
constexpr std::array kDistances = {0.7f, 1.f, 1.4f, 2.f}; // nearness over that of what is seen, in the mean
constexpr float kSamePlace = 0.05f;                       // sizes of regions over distances: less is no parallax
constexpr double kWorthwhile = 0.9;                       // of the second moment without guiding
// Next-event estimation takes about a sixteenth of what a path still takes; it is made at one vertex of ten at least.
constexpr double kRestOverLights = 16, kLeastLights = 0.1;

// A direction and what it brought.
struct GuideRecord {
    Vec3 p, w;
    float nearness = 0; // 1 over the distance of what is seen there
    float radiance = 0, scatter = 0;
    float pdf = 0; // with which it was drawn and followed
    float ownPdf = 0;
    float litSquared = 0; // of light that next-event estimation found there

    float brought() const { return radiance * scatter; }
};
using GuideRecords = std::span<const GuideRecord>;

// What one direction brought, or several: sums.
struct Brought {
    double first = 0, squared = 0;    // what it brought / pdf, and the square of that
    double second = 0;                // what it brought, squared and integrated over the square
    double radiance = 0, inverse = 0; // radiance / pdf, and 1 / pdf

    Brought operator+(const Brought& b) const {
        return {first + b.first, squared + b.squared, second + b.second, radiance + b.radiance, inverse + b.inverse};
    }
    Brought operator-(const Brought& b) const {
        return {first - b.first, squared - b.squared, second - b.second, radiance - b.radiance, inverse - b.inverse};
    }
};

// Places on the squares of both hemispheres along a Z-order curve, quarter by quarter of every square; the upper
// hemisphere comes last.
struct PlaceOrder {
    static constexpr int kBits = 2 * kMostHalvings;
    static constexpr std::uint32_t kUpper = 1u << kBits;

    static std::uint32_t of(const SphereSquare& at) {
        constexpr float kSide = 1 << kMostHalvings;
        const auto x = static_cast<std::uint32_t>(at.u.x * kSide), y = static_cast<std::uint32_t>(at.u.y * kSide);
        return (at.upper ? kUpper : 0) | spread(x) | spread(y) << 1;
    }

  private:
    // Every other bit.
    static std::uint32_t spread(std::uint32_t v) {
        v = (v | v << 8) & 0x00ff00ff;
        v = (v | v << 4) & 0x0f0f0f0f;
        v = (v | v << 2) & 0x33333333;
        return (v | v << 1) & 0x55555555;
    }
};

// A region with trees of its own, whose squares are numbered from 0.
struct Learnt {
    PathGuide::Region region;
    std::vector<PathGuide::Square> squares;

    // Density of the direction.
    float guided(const GuideRecord& r) const {
        return region.known ? PathGuide::look(region, squares.data(), region.offset(r.p), r.w).pdf : 0;
    }
};

class RegionLearner {
  public:
    explicit RegionLearner(float frameRadiance) : perFrame_(1 / frameRadiance) {}

    // A region from every so many-th of the records, seen from `frame`.
    Learnt learn(GuideRecords records, const PathGuide::Region& frame, std::size_t first, std::size_t step) {
        order_.clear();
        found_.clear();
        Brought all;
        for (std::size_t i = first; i < records.size(); i += step) {
            const GuideRecord& r = records[i];
            const auto [at, density] = PathGuide::seen(frame.offset(r.p), r.w);
            const auto area = static_cast<double>(density);
            const auto brought = static_cast<double>(r.brought()), pdf = static_cast<double>(r.pdf);
            const double value = brought / pdf;
            order_.push_back({PlaceOrder::of(at), static_cast<std::uint32_t>(found_.size())});
            found_.push_back(
                {value, value * value, value * brought / area, static_cast<double>(r.radiance) / pdf, 1 / pdf});
            all = all + found_.back();
        }
        learnt_ = {};
        learnt_.region = frame;
        if (!(all.first > 0)) return std::move(learnt_);
        least_ = kSquareShare * all.first;
        mean_ = all.radiance / all.inverse;
        addUp();
        const std::size_t upper = firstFrom(0, order_.size(), PlaceOrder::kUpper);
        std::array<double, 2> weights{};
        for (std::size_t side = 0; side < 2; ++side) {
            quads_.clear();
            const Square whole =
                side == 0 ? Square{0, upper, 0, 1} : Square{upper, order_.size(), PlaceOrder::kUpper, 1};
            weights[side] = divide(whole, 1).weight;
            learnt_.region.upperRoot = flatten(0, 1);
        }
        learnt_.region.known = true;
        learnt_.region.upper = static_cast<float>(weights[1] / (weights[0] + weights[1]));
        return std::move(learnt_);
    }

  private:
    // A square in four quarters.
    struct Quad {
        std::array<float, 4> share{}, radiance{};
        std::array<std::uint32_t, 4> child{}; // 0: not divided
    };
    struct Divided {
        double weight; // ∫ √(mean square)
        std::uint32_t number;
    };

    // By PlaceOrder, digit by digit from the last on, each stable.
    void addUp() {
        constexpr int kDigit = (PlaceOrder::kBits + 2) / 2;
        sorted_.resize(order_.size());
        for (int shift = 0; shift <= PlaceOrder::kBits; shift += kDigit) {
            std::array<std::uint32_t, (1u << kDigit) + 1> from{};
            const auto digit = [shift](std::uint32_t place) { return place >> shift & ((1u << kDigit) - 1); };
            for (const auto& entry : order_) ++from[digit(entry.first) + 1];
            for (std::size_t d = 1; d < from.size(); ++d) from[d] += from[d - 1];
            for (const auto& entry : order_) sorted_[from[digit(entry.first)]++] = entry;
            std::swap(order_, sorted_);
        }
        upTo_.resize(order_.size() + 1);
        for (std::size_t i = 0; i < order_.size(); ++i) upTo_[i + 1] = upTo_[i] + found_[order_[i].second];
    }
    // The first of [begin, end) in that order whose place is not below.
    std::size_t firstFrom(std::size_t begin, std::size_t end, std::uint32_t place) const {
        const auto at = std::ranges::lower_bound(order_.begin() + static_cast<std::ptrdiff_t>(begin),
                                                 order_.begin() + static_cast<std::ptrdiff_t>(end), place, {},
                                                 &std::pair<std::uint32_t, std::uint32_t>::first);
        return static_cast<std::size_t>(at - order_.begin());
    }

    // What lies in one, [begin, end) in that order.
    struct Square {
        std::size_t begin, end;
        std::uint32_t place; // of its first corner
        double area;
    };

    // `halvings`: of the square's sides to come to its quarters'.
    Divided divide(const Square& square, int halvings) {
        const auto number = static_cast<std::uint32_t>(quads_.size());
        quads_.emplace_back();
        std::array<double, 4> weights{};
        Quad made;
        const std::uint32_t size = PlaceOrder::kUpper >> 2 * halvings; // places of a quarter
        std::size_t begin = square.begin;
        for (std::uint32_t q = 0; q < 4; ++q) {
            const std::uint32_t place = square.place + q * size;
            const std::size_t end = q < 3 ? firstFrom(begin, square.end, place + size) : square.end;
            weights[q] = quarter({begin, end, place, 0.25 * square.area}, halvings, q, made);
            begin = end;
        }
        const double sum = weights[0] + weights[1] + weights[2] + weights[3];
        for (std::size_t q = 0; q < 4; ++q)
            made.share[q] = sum > 0 ? (1 - kSmooth) * static_cast<float>(weights[q] / sum) + 0.25f * kSmooth : 0.25f;
        quads_[number] = made;
        return {sum, number};
    }

    double quarter(const Square& square, int halvings, std::size_t q, Quad& parent) {
        const Brought all = square.begin < square.end ? upTo_[square.end] - upTo_[square.begin] : Brought();
        // The effective number of records [Kish1965].
        const bool enough = all.first * all.first >= kSquareBright * all.squared;
        if (enough && all.first > least_ && halvings < kMostHalvings) {
            const Divided divided = divide(square, halvings + 1);
            parent.child[q] = divided.number;
            return divided.weight;
        }
        parent.radiance[q] = perFrame_ * static_cast<float>(all.inverse > 0 ? all.radiance / all.inverse : mean_);
        return std::sqrt(square.area * std::max(0.0, all.second)); // below 0 by rounding, where nothing was brought
    }

    // Two levels at a time. `density` of the whole square.
    std::uint16_t flatten(std::uint32_t quad, float density) {
        const auto number = static_cast<std::uint16_t>(learnt_.squares.size());
        learnt_.squares.emplace_back();
        PathGuide::Square made;
        for (std::uint32_t i = 0; i < 16; ++i) {
            const std::uint32_t column = i % 4, row = i / 4;
            const std::uint32_t q = column / 2 + row / 2 * 2, sub = column % 2 + row % 2 * 2;
            const Quad& outer = quads_[quad];
            PathGuide::Square::Part& part = made.parts[i];
            part.density = 4 * density * outer.share[q];
            part.radiance = narrowed(outer.radiance[q]);
            if (const std::uint32_t c = outer.child[q]) {
                part.density *= 4 * quads_[c].share[sub];
                part.radiance = narrowed(quads_[c].radiance[sub]);
                if (quads_[c].child[sub]) part.child = flatten(quads_[c].child[sub], part.density);
            }
        }
        learnt_.squares[number] = made;
        return number;
    }
    static std::uint16_t narrowed(float v) { return static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(v) >> 16); }

    float perFrame_;
    double least_ = 0, mean_ = 0;
    std::vector<Brought> found_;                                 // in the order of the records
    std::vector<std::pair<std::uint32_t, std::uint32_t>> order_; // their places, and which they are
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sorted_;
    std::vector<Brought> upTo_; // sums of all before, in that order; the first is 0
    std::vector<Quad> quads_;
    Learnt learnt_;
};

// Second moments of what directions bring, for each share of guided ones.
using ShareMoments = std::array<double, kGuidedShares.size()>;

// By every so many-th of the records.
void judge(const Learnt& learnt, GuideRecords records, std::size_t first, std::size_t step, ShareMoments& moments) {
    using Lanes = float __attribute__((vector_size(32))); // a share each
    static_assert(kGuidedShares.size() <= 8);
    Lanes shares{};
    for (std::size_t s = 0; s < kGuidedShares.size(); ++s) shares[s] = kGuidedShares[s];
    for (std::size_t i = first; i < records.size(); i += step) {
        const GuideRecord& r = records[i];
        const auto brought = static_cast<double>(r.brought());
        if (!(brought > 0)) continue;
        const Lanes pdf = shares * learnt.guided(r) + (1 - shares) * r.ownPdf, inverse = pdf > 0 ? 1 / pdf : 0;
        const double square = brought * brought / static_cast<double>(r.pdf);
        for (std::size_t s = 0; s < kGuidedShares.size(); ++s) moments[s] += square * static_cast<double>(inverse[s]);
    }
}

struct Judged {
    PathGuide::Region frame;
    ShareMoments moments{};

    double least() const { return std::ranges::min(moments); }
};

// The best distance at which to look, judged by a quarter of the records from another; then what halves of them say of
// each other.
Judged bestFrame(RegionLearner& learner, GuideRecords records) {
    Vec3 lower = records[0].p, upper = lower;
    double sum = 0, nearness = 0;
    for (const GuideRecord& r : records) {
        lower = min(lower, r.p);
        upper = max(upper, r.p);
        const auto value = static_cast<double>(r.brought() / r.pdf);
        sum += value;
        nearness += value * static_cast<double>(r.nearness);
    }
    Judged best;
    best.frame.centre = (lower + upper) * 0.5f;
    const float mean = sum > 0 ? static_cast<float>(nearness / sum) : 0;
    if (length(upper - lower) * mean * kDistances.back() > kSamePlace) {
        judge(learner.learn(records, best.frame, 0, 4), records, 1, 4, best.moments);
        for (const float factor : kDistances) {
            Judged other;
            other.frame = best.frame;
            other.frame.nearness = factor * mean;
            judge(learner.learn(records, other.frame, 0, 4), records, 1, 4, other.moments);
            if (other.least() < best.least()) best = other;
        }
    }
    best.moments = {};
    for (const std::size_t half : {0, 1})
        judge(learner.learn(records, best.frame, half, 2), records, 1 - half, 2, best.moments);
    return best;
}

// Where lights are rarely seen, of what use shadow rays are: a sum of which one part is found in a share q of the cases
// is best with q² = (second moments of that part over the other) × (costs of the other over that part).
float lightShare(GuideRecords records, double otherMoments) {
    double lit = 0;
    for (const GuideRecord& r : records) lit += static_cast<double>(r.litSquared);
    if (!(otherMoments > 0)) return 1;
    return static_cast<float>(std::clamp(std::sqrt(kRestOverLights * lit / otherMoments), kLeastLights, 1.0));
}

struct JudgedRegion {
    Learnt learnt;
    double gain = 0; // of the second moment of what a direction brings, which is a mean over the region
};

JudgedRegion learnRegion(GuideRecords records, float frameRadiance) {
    if (records.empty()) return {};
    RegionLearner learner(frameRadiance);
    const Judged judged = bestFrame(learner, records);
    JudgedRegion result{learner.learn(records, judged.frame, 0, 1)};
    result.learnt.region.lights = lightShare(records, judged.least());
    const auto share = static_cast<std::size_t>(std::ranges::min_element(judged.moments) - judged.moments.begin());
    if (!(judged.least() < kWorthwhile * judged.moments[0])) return result;
    result.learnt.region.guided = kGuidedShares[share];
    result.gain = (judged.moments[0] - judged.least()) / static_cast<double>(records.size());
    return result;
}

class GuideTrainer {
  public:
    explicit GuideTrainer(std::span<const PilotVertex> vertices) : vertices_(vertices), givenOff_(vertices) {}

    TrainedGuide run(double frameRadiance, std::size_t regionVertices) {
        std::vector<SpaceTree::Place> places;
        places.reserve(vertices_.size());
        for (std::uint32_t i = 0; i < vertices_.size(); ++i) {
            const PilotVertex& v = vertices_[i];
            if (v.pdf > 0 && v.survival > 0 && (v.goesOn || v.beyond > 0)) places.push_back({v.p, v.face, i});
        }
        SpaceTree space(places, regionVertices);
        std::vector<JudgedRegion> learnt(space.leaves());
        parallelFor(learnt.size(), [&](std::size_t i) {
            const std::span<const SpaceTree::Place> members = space.members(places, i);
            learnt[i] = learnRegion(recordsOf(members), static_cast<float>(frameRadiance));
            // In media what looks for lights along rays shares their light with what looks from collisions.
            if (!members.empty() && members[0].face == kInMedium) learnt[i].learnt.region.lights = 1;
        });
        double gain = 0;
        for (std::size_t i = 0; i < learnt.size(); ++i)
            for (const SpaceTree::Place& member : space.members(places, i)) {
                const auto weight = static_cast<double>(vertices_[member.number].weight) / frameRadiance;
                gain += weight * weight * learnt[i].gain;
            }
        const bool media = std::ranges::any_of(vertices_, [](const PilotVertex& v) { return v.face == kInMedium; });
        TrainedGuide trained{together(std::move(space), learnt), gain};
        if (media) trained.guide.guideDistances(std::move(givenOff_).cache());
        return trained;
    }

  private:
    std::vector<GuideRecord> recordsOf(std::span<const SpaceTree::Place> members) const {
        std::vector<GuideRecord> records;
        records.reserve(members.size());
        for (const SpaceTree::Place& member : members) {
            const PilotVertex& v = vertices_[member.number];
            const float distance = v.goesOn ? length(vertices_[member.number + 1].p - v.p) : kInfinity;
            records.push_back({v.p, v.w, distance > 0 ? 1 / distance : 0,
                               std::max(0.f, givenOff_.arriving(member.number)), v.scatter, v.pdf * v.survival,
                               v.ownPdf, v.lightShare * v.lit * v.lit});
        }
        return records;
    }
    static PathGuide together(SpaceTree space, std::span<JudgedRegion> learnt) {
        std::vector<PathGuide::Region> regions;
        std::vector<PathGuide::Square> squares;
        for (JudgedRegion& j : learnt) {
            j.learnt.region.first = static_cast<std::uint32_t>(squares.size());
            squares.insert(squares.end(), j.learnt.squares.begin(), j.learnt.squares.end());
            regions.push_back(j.learnt.region);
        }
        return {std::move(space), std::move(regions), std::move(squares)};
    }

    std::span<const PilotVertex> vertices_;
    GivenOff givenOff_;
};

} // namespace

TrainedGuide trainGuide(std::span<const PilotVertex> vertices, double frameRadiance, std::size_t regionVertices) {
    return GuideTrainer(vertices).run(frameRadiance, regionVertices);
}

} // namespace abbe
