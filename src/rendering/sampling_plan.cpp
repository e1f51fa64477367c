#include "rendering/sampling_plan.h"

#include "base/check.h"
#include "caustics/shared/kernel_jobs.h"
#include "math/hash.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe {

namespace {
constexpr std::int64_t kMostPlanCells = 8192;
}

PlanPilot::PlanPilot(PixelBounds frame, std::uint64_t seed) : frame_(frame), seed_(seed) {
    ABBE_CHECK(frame.area() > 0);
    const auto cells = [&](int pixels) { return (pixels + cellSize_ - 1) / cellSize_; };
    while (static_cast<std::int64_t>(cells(frame.width())) * cells(frame.height()) > kMostPlanCells) cellSize_ *= 2;
    columns_ = cells(frame.width());
    rows_ = cells(frame.height());
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (int row = 0; row < rows_; ++row)
        for (int column = 0; column < columns_; ++column)
            cells_[index(column, row)].pixels = static_cast<double>(boundsOf(column, row).area());
}

PixelBounds PlanPilot::boundsOf(int column, int row) const {
    const int x = frame_.x0 + column * cellSize_, y = frame_.y0 + row * cellSize_;
    return {x, y, std::min(x + cellSize_, frame_.x1), std::min(y + cellSize_, frame_.y1)};
}

// One in each quarter of the cell; looks 0 and 3, which are diagonal, are the first half.
PixelBounds PlanPilot::pixelOf(int column, int row, int look) const {
    const PixelBounds b = boundsOf(column, row);
    const std::uint64_t hash = combine64(combine64(seed_, index(column, row)), static_cast<std::uint64_t>(look));
    const auto within = [](std::uint32_t bits, int first, int end, int side) {
        const int middle = (first + end + 1) / 2; // of one pixel both quarters are that
        const int from = side == 0 || middle == end ? first : middle, to = side == 0 ? middle : end;
        return from +
               static_cast<int>((static_cast<std::uint64_t>(bits) * static_cast<std::uint64_t>(to - from)) >> 32);
    };
    const int x = within(static_cast<std::uint32_t>(hash), b.x0, b.x1, look % 2);
    const int y = within(static_cast<std::uint32_t>(hash >> 32), b.y0, b.y1, look / 2);
    return {x, y, x + 1, y + 1};
}

void PlanPilot::add(int column, int row, int look, const Probe& probe, std::uint64_t rays) {
    PlanCell& cell = cells_[index(column, row)];
    const std::size_t half = look == 0 || look == 3 ? 0 : 1;
    cell.variance[half] += probe.variance() / (0.5 * kLooks);
    cell.luminance[half] += probe.luminance() / (0.5 * kLooks);
    cell.rays += static_cast<double>(rays) / (kLooks * kReplicates * kSamples);
}

namespace {

constexpr float kSqrt2 = 1.41421356f;

// The nearest power of two. Neither here nor below is a function of which libraries differ in the last bit: parts of a
// render that come from different machines must have the same plan.
int nearestExponent(float factor) {
    int exponent = 0;
    std::frexp(factor * kSqrt2, &exponent);
    return std::clamp(exponent - 1, SamplingPlan::kLeast, SamplingPlan::kMost);
}

double powerOfTwo(int exponent) { return std::ldexp(1.0, exponent); }

// A grid of numbers, row by row.
struct Grid {
    int columns = 0, rows = 0;
    std::vector<double> values;

    double& at(int column, int row) { return values[index(column, row)]; }
    double at(int column, int row) const { return values[index(column, row)]; }
    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    }
};

// Weights 1 2 1 along rows and columns, as often as told; at the borders what is there.
void smooth(Grid& grid, int times) {
    const auto line = [](int count, const auto& at) {
        double before = at(0);
        for (int i = 0; i < count; ++i) {
            const double here = at(i), after = at(std::min(i + 1, count - 1));
            at(i) = 0.25 * (before + after) + 0.5 * here;
            before = here;
        }
    };
    for (; times > 0; --times) {
        for (int r = 0; r < grid.rows; ++r) line(grid.columns, [&](int c) -> double& { return grid.at(c, r); });
        for (int c = 0; c < grid.columns; ++c) line(grid.rows, [&](int r) -> double& { return grid.at(c, r); });
    }
}

// How the pilot is read: with single looks that differ from all around them or not, averaged so often over neighbours,
// and raised to a power of quarters.
struct Reading {
    bool specks = true;
    int smoothing = 0;
    int quarters = 0;
};

class FactorPlanner {
  public:
    explicit FactorPlanner(const PlanPilot& pilot) : pilot_(pilot) {
        Grid luminance = gridOf([](const PlanCell& c) { return 0.5 * (c.luminance[0] + c.luminance[1]); });
        double mean = 0, pixels = 0;
        each([&](int c, int r, const PlanCell& cell) {
            mean += cell.pixels * luminance.at(c, r);
            pixels += cell.pixels;
        });
        mean /= pixels;
        smooth(luminance, 1);
        for (std::size_t half = 0; half < 2; ++half) {
            noise_[half] = gridOf([&](const PlanCell& c) { return c.variance[half]; });
            for (std::size_t i = 0; i < luminance.values.size(); ++i)
                noise_[half].values[i] *= mean > 0 ? 1 / (square(luminance.values[i]) + 0.01 * square(mean)) : 0;
        }
        errors_ = noise_;
        for (Grid& grid : errors_) {
            std::size_t i = 0;
            each([&](int, int, const PlanCell& cell) { grid.values[i++] *= cell.pixels; });
        }
        limited_ = noise_;
        limitSpecks();
    }

    // The reading whose plan from one half of the looks is best for the other, by more than chance explains; nothing if
    // none is worth it.
    std::vector<float> best() const {
        constexpr double kWorthwhile = 0.97;
        double least = kWorthwhile;
        Reading choice;
        for (const bool specks : {true, false})
            for (const int smoothing : {1, 2, 4, 8})
                for (const int quarters : {2, 3, 4}) {
                    const Reading reading{specks, smoothing, quarters};
                    const Loss a = lossOf(factors(reading, 1, 0), 1), b = lossOf(factors(reading, 0, 1), 0);
                    // Two standard errors, because the best of many is chosen.
                    const double atMost = 0.5 * (a.mean + b.mean) + std::sqrt(a.variance + b.variance);
                    if (atMost < least) {
                        least = atMost;
                        choice = reading;
                    }
                }
        if (choice.quarters == 0) return {};
        return factors(choice, 1, 1);
    }

  private:
    template <typename Value> Grid gridOf(Value value) const {
        Grid grid{pilot_.columns(), pilot_.rows(), {}};
        each([&](int, int, const PlanCell& cell) { grid.values.push_back(value(cell)); });
        return grid;
    }
    template <typename Visit> void each(Visit visit) const {
        for (int row = 0; row < pilot_.rows(); ++row)
            for (int column = 0; column < pilot_.columns(); ++column) visit(column, row, pilot_.cell(column, row));
    }

    // One sample in thousands may have nearly all of the variance of the frame. Where it falls is chance and says
    // nothing about other samples, unless those around it agree: the other half of the cell's looks, and its
    // neighbours.
    void limitSpecks() {
        constexpr double kMostOfOthers = 4; // times the mean of those around
        each([&](int column, int row, const PlanCell&) {
            double sum = 0;
            int count = 0;
            for (int r = std::max(row - 1, 0); r <= std::min(row + 1, pilot_.rows() - 1); ++r)
                for (int c = std::max(column - 1, 0); c <= std::min(column + 1, pilot_.columns() - 1); ++c, ++count)
                    sum += noise_[0].at(c, r) + noise_[1].at(c, r);
            for (std::size_t half = 0; half < 2; ++half) {
                const double others = (sum - noise_[half].at(column, row)) / (2 * count - 1);
                double& noise = limited_[half].at(column, row);
                noise = std::min(noise, kMostOfOthers * others);
            }
        });
    }

    // From the halves of the looks with these weights; their cost is that of even samples.
    std::vector<float> factors(Reading reading, double first, double second) const {
        const std::array<Grid, 2>& seen = reading.specks ? noise_ : limited_;
        Grid noise = seen[0];
        for (std::size_t i = 0; i < noise.values.size(); ++i)
            noise.values[i] = (first * noise.values[i] + second * seen[1].values[i]) / (first + second);
        Grid rays = gridOf([](const PlanCell& c) { return c.rays; });
        smooth(noise, reading.smoothing);
        smooth(rays, 1);
        std::vector<float> list;
        for (std::size_t i = 0; i < noise.values.size(); ++i) {
            const double score = std::sqrt(noise.values[i] / std::max(rays.values[i], 1.0));
            const double root = std::sqrt(score);
            list.push_back(static_cast<float>(reading.quarters == 4   ? score
                                              : reading.quarters == 3 ? root * std::sqrt(root)
                                                                      : root));
        }
        balance(list);
        return list;
    }

    void balance(std::vector<float>& list) const {
        double most = 0;
        for (const float f : list) most = std::max(most, static_cast<double>(f));
        if (!(most > 0)) return std::fill(list.begin(), list.end(), 1.f);
        double low = 1e-9 / most, high = 1e9 / most;
        for (int step = 0; step < 24; ++step) {
            const double scale = std::sqrt(low) * std::sqrt(high);
            (costOf(list, scale) > 1 ? high : low) = scale;
        }
        for (float& f : list) f = static_cast<float>(low * static_cast<double>(f));
    }

    // Of so scaled factors, over that of even samples.
    double costOf(const std::vector<float>& list, double scale) const {
        double planned = 0, even = 0;
        std::size_t i = 0;
        each([&](int, int, const PlanCell& cell) {
            const double one = cell.pixels * std::max(cell.rays, 1.0);
            even += one;
            planned += one * powerOfTwo(nearestExponent(static_cast<float>(scale * static_cast<double>(list[i++]))));
        });
        return planned / even;
    }

    // Cost × error of such factors as a half of the looks sees them, over that of even samples; and how sure that is,
    // since cells are independent: the variance of a ratio of sums.
    struct Loss {
        double mean = 1, variance = 0;
    };
    Loss lossOf(const std::vector<float>& list, std::size_t half) const {
        double planned = 0, even = 0;
        for (std::size_t i = 0; i < list.size(); ++i) {
            even += errors_[half].values[i];
            planned += errors_[half].values[i] / powerOfTwo(nearestExponent(list[i]));
        }
        if (!(even > 0)) return {};
        const double ratio = planned / even, cost = costOf(list, 1);
        double variance = 0;
        for (std::size_t i = 0; i < list.size(); ++i)
            variance += square(errors_[half].values[i] / even * (1 / powerOfTwo(nearestExponent(list[i])) - ratio));
        return {ratio * cost, variance * square(cost)};
    }

    const PlanPilot& pilot_;
    std::array<Grid, 2> noise_;   // variance/(Y² + ε) of one sample, by half of the looks
    std::array<Grid, 2> limited_; // without specks
    std::array<Grid, 2> errors_;  // of all pixels of a cell
};

} // namespace

SamplingPlan::SamplingPlan(const PlanPilot& pilot)
    : frame_(pilot.frame()), cellSize_(pilot.cellSize()), columns_(pilot.columns()), rows_(pilot.rows()) {
    factors_ = FactorPlanner(pilot).best();
}

// Linear between the centres of cells.
int SamplingPlan::exponent(int x, int y) const {
    if (factors_.empty()) return 0;
    const auto place = [this](int pixel, int first, int count) {
        const float at = (static_cast<float>(pixel - first) + 0.5f) / static_cast<float>(cellSize_) - 0.5f;
        return std::clamp(at, 0.f, static_cast<float>(count - 1));
    };
    return nearestExponent(factorAt(place(x, frame_.x0, columns_), place(y, frame_.y0, rows_)));
}

float SamplingPlan::factorAt(float u, float v) const {
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    const auto at = [this](int c, int r) {
        return factors_[static_cast<std::size_t>(std::min(r, rows_ - 1)) * static_cast<std::size_t>(columns_) +
                        static_cast<std::size_t>(std::min(c, columns_ - 1))];
    };
    const float s = u - static_cast<float>(column), t = v - static_cast<float>(row);
    const float upper = at(column, row) * (1 - s) + at(column + 1, row) * s;
    const float lower = at(column, row + 1) * (1 - s) + at(column + 1, row + 1) * s;
    return upper * (1 - t) + lower * t;
}

double SamplingPlan::meanFactor(PixelBounds b) const {
    double sum = 0;
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x) sum += powerOfTwo(exponent(x, y));
    return sum / static_cast<double>(b.area());
}

SampleRange SamplingPlan::scaled(SampleRange nominal, int exponent) {
    const auto place = [exponent](std::uint64_t n) {
        const std::uint64_t at = exponent >= 0 ? n << exponent : (n + (1ull << -exponent) - 1) >> -exponent;
        return static_cast<std::uint32_t>(std::min<std::uint64_t>(at, 0xffffffff));
    };
    return {place(nominal.first), place(nominal.last)};
}

SampleRange SamplingPlan::of(int x, int y, SampleRange nominal) const { return scaled(nominal, exponent(x, y)); }

} // namespace abbe
