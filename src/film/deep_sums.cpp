#include "film/deep_sums.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace abbe {

namespace {

constexpr int kDropped = 17;            // bits of a float behind those of the finest key
constexpr std::uint32_t kMaxLevel = 14; // one bin for all distances

float edge(std::uint32_t key, std::uint32_t level) {
    const std::uint64_t bits = (static_cast<std::uint64_t>(key) << level) << kDropped;
    return std::bit_cast<float>(static_cast<std::uint32_t>(std::min<std::uint64_t>(bits, 0x7f7fffffu)));
}

ExactSum term(double x) { return std::abs(x) < ExactSum::kLargest ? ExactSum(x) : ExactSum(); }

void operator+=(DeepBin& a, const DeepBin& b) {
    a.share += b.share;
    a.x += b.x;
    a.y += b.y;
    a.z += b.z;
    a.depth += b.depth;
}

// Of a bin in a file: its key, and its sums.
constexpr std::size_t kBinBytes = sizeof(std::uint32_t) + 5 * sizeof(ExactSum);

template <typename T> void put(const T& value, std::vector<std::byte>& out) {
    const auto bytes = std::as_bytes(std::span(&value, 1));
    out.insert(out.end(), bytes.begin(), bytes.end());
}

template <typename T> T take(std::span<const std::byte>& bytes) {
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes = bytes.subspan(sizeof value);
    return value;
}

} // namespace

DeepSums::DeepSums(PixelBounds bounds, int most)
    : bounds_(bounds), most_(static_cast<std::size_t>(most)), pixels_(2 * static_cast<std::size_t>(bounds.area())) {}

void DeepSums::restart(PixelBounds bounds) {
    bounds_ = bounds;
    pixels_.resize(2 * static_cast<std::size_t>(bounds.area()));
    for (Bins& bins : pixels_) {
        bins.level = 0;
        bins.list.clear();
    }
}

std::uint64_t DeepSums::mostBytes(PixelBounds bounds, int most, std::uint64_t samples) {
    const auto bins = std::min<std::uint64_t>(static_cast<std::uint64_t>(most), samples);
    // Lists grow by doubling: up to twice of what they hold.
    return 2 * static_cast<std::uint64_t>(bounds.area()) * (sizeof(Bins) + 2 * bins * sizeof(DeepBin));
}

float DeepSums::Bins::front(std::size_t i) const { return edge(list[i].key, level); }
float DeepSums::Bins::back(std::size_t i) const { return edge(list[i].key + 1, level); }

void DeepSums::add(std::size_t pixel, Kind kind, float depth, float share, const Xyz& light) {
    Bins& bins = pixels_[2 * pixel + static_cast<std::size_t>(kind)];
    const auto s = static_cast<double>(share);
    const std::uint32_t key = std::bit_cast<std::uint32_t>(std::abs(depth)) >> kDropped >> bins.level;
    add(bins, {key, term(s), term(light.x), term(light.y), term(light.z), term(s * static_cast<double>(depth))});
}

// A full list is made coarser before it is added to, so that it never takes more memory than it may.
void DeepSums::add(Bins& bins, const DeepBin& bin) const {
    DeepBin added = bin;
    for (;; added.key >>= 1, coarsen(bins)) {
        const auto place = std::ranges::lower_bound(bins.list, added.key, {}, &DeepBin::key);
        if (place != bins.list.end() && place->key == added.key) {
            *place += added;
            return;
        }
        if (bins.list.size() < most_) {
            bins.list.insert(place, added);
            return;
        }
    }
}

void DeepSums::coarsen(Bins& bins) const {
    ++bins.level;
    std::size_t last = 0;
    for (std::size_t i = 0; i < bins.list.size(); ++i) {
        DeepBin bin = bins.list[i];
        bin.key >>= 1;
        if (i > 0 && bins.list[last].key == bin.key)
            bins.list[last] += bin;
        else
            bins.list[i == 0 ? 0 : ++last] = bin;
    }
    bins.list.resize(std::min(bins.list.size(), last + 1));
}

// Of each list its level, its length and its bins.
class DeepSums::Plane final : public FilmPlane {
  public:
    explicit Plane(DeepSums& sums) : sums_(sums) {}

    std::string name() const override { return "deep/" + std::to_string(sums_.most_); }

    void store(PixelBounds b, std::vector<std::byte>& out) const override {
        for (int y = b.y0; y < b.y1; ++y)
            for (const Bins& bins :
                 std::span(sums_.pixels_).subspan(first(b, y), static_cast<std::size_t>(2 * b.width()))) {
                put(bins.level, out);
                put(static_cast<std::uint32_t>(bins.list.size()), out);
                for (const DeepBin& bin : bins.list) {
                    put(bin.key, out);
                    for (const ExactSum& s : {bin.share, bin.x, bin.y, bin.z, bin.depth}) put(s, out);
                }
            }
    }

    bool ofLayers() const override { return true; }

    bool addWithin(PixelBounds within, PixelBounds of, std::span<const std::byte> bytes) override {
        auto check = bytes;
        for (std::int64_t list = 2 * of.area(); list > 0; --list)
            if (!skip(check)) return false;
        if (!check.empty()) return false;
        for (int y = of.y0; y < of.y1; ++y)
            for (int x = of.x0; x < of.x1; ++x) {
                const bool inside = !isEmpty(common(within, {x, y, x + 1, y + 1}));
                const std::size_t at = inside ? first({x, y, x + 1, y + 1}, y) : 0;
                for (std::size_t kind = 0; kind < 2; ++kind)
                    if (inside)
                        addTo(sums_.pixels_[at + kind], bytes);
                    else
                        skip(bytes);
            }
        return true;
    }

  private:
    // The lists of the first pixel of a row.
    std::size_t first(PixelBounds b, int y) const {
        const auto row = static_cast<std::size_t>(y - sums_.bounds_.y0);
        return 2 * (row * static_cast<std::size_t>(sums_.bounds_.width()) +
                    static_cast<std::size_t>(b.x0 - sums_.bounds_.x0));
    }

    bool skip(std::span<const std::byte>& bytes) const {
        if (bytes.size() < 2 * sizeof(std::uint32_t)) return false;
        const auto level = take<std::uint32_t>(bytes);
        const std::size_t count = take<std::uint32_t>(bytes);
        if (level > kMaxLevel || count > sums_.most_ || bytes.size() < count * kBinBytes) return false;
        std::int64_t before = -1;
        for (std::size_t i = 0; i < count; ++i, bytes = bytes.subspan(5 * sizeof(ExactSum))) {
            const std::int64_t key = take<std::uint32_t>(bytes);
            if (key <= before || key >> (kMaxLevel + 1 - level) != 0) return false;
            before = key;
        }
        return true;
    }

    void addTo(Bins& bins, std::span<const std::byte>& bytes) {
        const auto level = take<std::uint32_t>(bytes);
        const auto count = take<std::uint32_t>(bytes);
        while (bins.level < level) sums_.coarsen(bins);
        for (std::uint32_t i = 0; i < count; ++i) {
            DeepBin bin;
            const auto key = take<std::uint32_t>(bytes);
            for (ExactSum* s : {&bin.share, &bin.x, &bin.y, &bin.z, &bin.depth}) *s = take<ExactSum>(bytes);
            bin.key = key >> (bins.level - level); // which adding one may have made coarser
            sums_.add(bins, bin);
        }
    }

    DeepSums& sums_;
};

std::unique_ptr<FilmPlane> DeepSums::plane() { return std::make_unique<Plane>(*this); }

} // namespace abbe
