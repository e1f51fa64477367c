#include "film/error_certificate.h"

#include "base/parallel.h"
#include "film/error_figure.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

namespace abbe {

namespace {

constexpr int kRadiusTile = 8;
constexpr double kFactor = 1 / (1 - 1 / std::numbers::sqrt2);

struct Tile {
    double luminance = 0, merged = 0;
    double a = 0, b = 0; // the bias, by two halves of the replicates
};

Tile tileOf(const PixelFilm& film, PixelBounds pixels) {
    const int all = film.replicates(), half = all / 2;
    const auto bias = [&](int x, int y, int first, int last) {
        const double wide = film.splatMean(SplatKind::merged, x, y, first, last).y;
        return kFactor * (wide - film.closerMean(x, y, first, last));
    };
    Tile tile;
    for (int y = pixels.y0; y < pixels.y1; ++y)
        for (int x = pixels.x0; x < pixels.x1; ++x) {
            tile.luminance += film.mean(x, y).y;
            tile.merged += film.splatMean(SplatKind::merged, x, y, 0, all).y;
            tile.a += bias(x, y, 0, half > 0 ? half : all);
            tile.b += bias(x, y, half, all);
        }
    return tile;
}

} // namespace

std::optional<MergedLight> MergedLight::of(const PixelFilm& film) {
    MergedLight result;
    result.rounds = film.splatCount(SplatKind::merged, 0, film.replicates());
    if (result.rounds == 0) return std::nullopt;
    const PixelBounds all = film.bounds();
    std::vector<Tile> tiles;
    for (int y = all.y0; y < all.y1; y += kRadiusTile)
        for (int x = all.x0; x < all.x1; x += kRadiusTile)
            tiles.push_back(tileOf(film, {x, y, std::min(x + kRadiusTile, all.x1), std::min(y + kRadiusTile, all.y1)}));
    double luminance = 0, merged = 0, bias = 0, sum = 0, squares = 0;
    for (const Tile& t : tiles) {
        luminance += t.luminance;
        merged += t.merged;
        bias += (t.a + t.b) / 2;
    }
    if (!(luminance > 0)) return result;
    const double least = 0.1 * luminance / static_cast<double>(tiles.size());
    for (const Tile& t : tiles) {
        const double product = t.a * t.b / square(std::max(t.luminance, least));
        sum += product;
        squares += square(product);
    }
    const auto count = static_cast<double>(tiles.size());
    result.share = merged / luminance;
    result.bias = bias / luminance;
    result.biasOfTiles = std::sqrt(std::max(0.0, sum / count) + 2 * std::sqrt(squares) / count);
    return result;
}

namespace {

constexpr int kTile = 16;

// A measure in both cases: the samples are distributed evenly about their mean, or few of them carry it all.
class Sums {
  public:
    void beginTile(PixelBounds tile) {
        judgeTile();
        even_.beginTile(tile);
        skewed_.beginTile(tile);
    }
    // Squared differences of the pixel from its darker and its brighter half.
    void add(double dark, double bright) {
        const double mean = (dark + bright) / 2;
        even_.add(mean);
        skewed_.add(dark);
        sizes_.push_back(static_cast<float>(std::sqrt(mean)));
    }
    void append(Sums next) {
        judgeTile();
        next.judgeTile();
        even_.append(next.even_);
        skewed_.append(next.skewed_);
        sizes_.insert(sizes_.end(), next.sizes_.begin(), next.sizes_.end());
        judged_ = sizes_.size();
        tiles_ += next.tiles_;
        untrusted_ += next.untrusted_;
    }
    // Between both cases; the interval has room for either, and for what is too rare to have been met.
    ErrorFigure figure() const {
        const ErrorFigure a = even_.figure(), b = skewed_.figure();
        ErrorFigure figure = a;
        figure.value = std::sqrt(a.value * b.value);
        figure.low = std::min(a.low, b.low);
        figure.high = std::max(a.high, b.high);
        figure.tiles = tiles_;
        figure.untrustedTiles = untrusted_;
        std::vector<float> sizes = sizes_;
        if (const auto tail = TailEstimate::of(sizes)) {
            figure.tail = tail->shape;
            figure.unseen = tail->unseen;
            figure.high = std::sqrt(square(figure.high) + square(figure.value) * tail->unseen);
        }
        return figure;
    }

  private:
    void judgeTile() {
        std::vector<float> own(sizes_.begin() + static_cast<std::ptrdiff_t>(judged_), sizes_.end());
        judged_ = sizes_.size();
        const auto tail = TailEstimate::of(own);
        tiles_ += tail ? 1 : 0;
        untrusted_ += tail && tail->unseen > TailEstimate::kTrusted ? 1 : 0;
    }

    ErrorSum even_, skewed_;
    std::vector<float> sizes_; // of the even estimates, roots
    std::size_t judged_ = 0;   // of them, tile by tile
    std::int64_t tiles_ = 0, untrusted_ = 0;
};

// Mean square of the difference of two colours on the display.
double squaredDistance(const float* a, const float* b) {
    const auto code = [](float v) { return 255 * std::clamp(static_cast<double>(v), 0.0, 1.0); };
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += square(code(a[c]) - code(b[c]));
    return sum / 3;
}

template <typename Visit> void forPixels(PixelBounds b, const Visit& visit) {
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x) visit(x, y);
}

template <typename Visit> void forTiles(PixelBounds rows, const Visit& visit) {
    for (int x = rows.x0; x < rows.x1; x += kTile)
        visit(PixelBounds{x, rows.y0, std::min(x + kTile, rows.x1), rows.y1});
}

// The two halves of a pixel's samples: the darker one is at mean + toDark, the brighter one as far on the other side.
struct Halves {
    Xyz mean, toDark;
};

// Measures are no linear functions of the light, so errors are estimated by them, and not by variances. A pixel x has
// two halves of samples with means x − d and x + d, if they are equally many, and its expectation may be near either.
// The mean of both squared differences is right up to the third order if samples are distributed evenly about their
// mean. The more is carried by few samples, the nearer the expectation is to the darker half, and in the end it is
// there.
class Certifier {
  public:
    Certifier(const PixelFilm& film, const ErrorCertificate::Picture& picture)
        : film_(film), picture_(picture), bounds_(film.bounds()), measure_(meanLuminance()) {}

    void run(ErrorCertificate& certificate) const;

  private:
    Xyz balanced(const Xyz& xyz) const { return picture_.balance.apply<Xyz>(xyz * picture_.scale); }
    double meanLuminance() const;
    std::optional<Halves> halves(int x, int y) const;
    std::vector<Halves> readBand(PixelBounds rows, std::vector<bool>& known) const;
    std::vector<float> show(const std::vector<Halves>&) const;
    void addBand(Sums& relative, Sums& display, PixelBounds rows) const;

    const PixelFilm& film_;
    const ErrorCertificate::Picture& picture_;
    PixelBounds bounds_;
    RelativeError measure_;
};

double Certifier::meanLuminance() const {
    std::vector<double> rows(static_cast<std::size_t>(bounds_.height()));
    parallelFor(rows.size(), [&](std::size_t i) {
        const int y = bounds_.y0 + static_cast<int>(i);
        for (int x = bounds_.x0; x < bounds_.x1; ++x) rows[i] += balanced(film_.mean(x, y)).y;
    });
    return std::accumulate(rows.begin(), rows.end(), 0.0) / static_cast<double>(bounds_.area());
}

// By what the difference of two halves of so many samples is multiplied to deviate as the mean does: the variance of
// the difference is that of the mean times (a + b)²/(a b).
double shareOfDifference(double a, double b) { return std::sqrt(a * b) / (a + b); }

// Samples, light paths and merged light are divided into halves each by itself.
std::optional<Halves> Certifier::halves(int x, int y) const {
    const int half = film_.replicates() / 2, all = film_.replicates();
    const auto a = static_cast<double>(film_.samples(x, y, 0, half));
    const auto b = static_cast<double>(film_.samples(x, y, half, all));
    if (a == 0 || b == 0) return std::nullopt;
    Xyz d = balanced(film_.sampleMean(x, y, 0, half) - film_.sampleMean(x, y, half, all)) * shareOfDifference(a, b);
    for (const SplatKind kind : {SplatKind::lightPath, SplatKind::merged}) {
        if (film_.splatCount(kind, 0, all) == 0) continue;
        const auto p = static_cast<double>(film_.splatCount(kind, 0, half));
        const auto q = static_cast<double>(film_.splatCount(kind, half, all));
        if (p == 0 || q == 0) return std::nullopt;
        d += balanced(film_.splatMean(kind, x, y, 0, half) - film_.splatMean(kind, x, y, half, all)) *
             shareOfDifference(p, q);
    }
    return Halves{balanced(film_.mean(x, y)), d.y > 0 ? d * -1 : d};
}

// Tile by tile, those alone that have two halves.
std::vector<Halves> Certifier::readBand(PixelBounds rows, std::vector<bool>& known) const {
    std::vector<Halves> list;
    forTiles(rows, [&](PixelBounds tile) {
        forPixels(tile, [&](int x, int y) {
            const auto pixel = halves(x, y);
            known.push_back(pixel.has_value());
            if (pixel) list.push_back(*pixel);
        });
    });
    return list;
}

// Nine values to a pixel: itself, its darker and its brighter half on the display.
std::vector<float> Certifier::show(const std::vector<Halves>& pixels) const {
    std::vector<float> rgb;
    rgb.reserve(9 * pixels.size());
    for (const Halves& p : pixels)
        for (const Xyz& color : {p.mean, p.mean + p.toDark, p.mean - p.toDark}) {
            const auto v = picture_.toRgb.apply<Xyz>(color);
            for (const double c : {v.x, v.y, v.z}) rgb.push_back(static_cast<float>(c));
        }
    picture_.display(rgb);
    return rgb;
}

void Certifier::addBand(Sums& relative, Sums& display, PixelBounds rows) const {
    std::vector<bool> known;
    const std::vector<Halves> pixels = readBand(rows, known);
    const std::vector<float> shown = picture_.display ? show(pixels) : std::vector<float>();
    std::size_t place = 0, i = 0;
    forTiles(rows, [&](PixelBounds tile) {
        relative.beginTile(tile);
        display.beginTile(tile);
        forPixels(tile, [&](int, int) {
            if (!known[place++]) return;
            const double mean = pixels[i].mean.y, d = pixels[i].toDark.y;
            relative.add(measure_.squared(mean, mean + d), measure_.squared(mean, mean - d));
            const float* rgb = shown.data() + 9 * i++;
            if (!shown.empty()) display.add(squaredDistance(rgb, rgb + 3), squaredDistance(rgb, rgb + 6));
        });
    });
}

// Rows of tiles are the unit of work: sums do not depend on the number of threads.
void Certifier::run(ErrorCertificate& certificate) const {
    std::vector<std::pair<Sums, Sums>> parts(static_cast<std::size_t>((bounds_.height() + kTile - 1) / kTile));
    parallelFor(parts.size(), [&](std::size_t i) {
        const int top = bounds_.y0 + static_cast<int>(i) * kTile;
        addBand(parts[i].first, parts[i].second, {bounds_.x0, top, bounds_.x1, std::min(top + kTile, bounds_.y1)});
    });
    Sums relative, display;
    for (auto& part : parts) {
        relative.append(std::move(part.first));
        display.append(std::move(part.second));
    }
    certificate.relative = relative.figure();
    if (picture_.display) certificate.display = display.figure();
}

void countSamples(const PixelFilm& film, ErrorCertificate& certificate) {
    const PixelBounds b = film.bounds();
    certificate.fewest = film.samples(b.x0, b.y0);
    std::uint64_t sum = 0;
    forPixels(b, [&](int x, int y) {
        const std::uint64_t n = film.samples(x, y);
        certificate.fewest = std::min(certificate.fewest, n);
        certificate.most = std::max(certificate.most, n);
        sum += n;
    });
    certificate.samples = static_cast<double>(sum) / static_cast<double>(b.area());
}

} // namespace

ErrorCertificate ErrorCertificate::of(const PixelFilm& film, const Picture& picture) {
    ErrorCertificate certificate;
    certificate.replicates = film.replicates();
    certificate.pixels = film.bounds().area();
    countSamples(film, certificate);
    certificate.merged = MergedLight::of(film);
    if (film.replicates() < 2) {
        certificate.reason = "one replicate: a single set of samples does not tell its error";
        return certificate;
    }
    Certifier(film, picture).run(certificate);
    if (certificate.relative.pixels == 0) certificate.reason = "too few samples: no pixel has them in two replicates";
    return certificate;
}

} // namespace abbe
