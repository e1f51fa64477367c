#include "view/view_pictures.h"

#include "base/parallel.h"
#include "film/film_planes.h"
#include "film/layer_planes.h"
#include "io/exr_reader.h"
#include "io/file.h"
#include "pictures/film_picture.h"
#include "pictures/layer_view.h"
#include "schema/suggest.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <limits>

namespace abbe {

namespace {

constexpr std::size_t kMostMade = 4; // pictures beside the one that is shown
constexpr double kMostStops = 60;
constexpr double kInterest = 5; // s after a layer was asked for last, in which it is made of each picture

Matrix3 toSpace(const FilmSettings& settings) { return rgbSpace(settings.space).fromXyz() * settings.whiteBalance; }

// A copy of the picture in which the film's pixels are what `of(x, y)` says, three floats each.
template <typename Of>
std::shared_ptr<LivePicture> painted(const LivePicture& under, const LiveFilm& f, bool keep, const Of& of) {
    auto picture = std::make_shared<LivePicture>(under);
    if (!keep) std::ranges::fill(picture->rgb, 0.f);
    const PixelBounds b = f.film.bounds();
    const int step = under.cell == f.cell ? 1 : f.cell; // of pixels of the data: a film's cells may be finer or coarser
    if (under.cell != f.cell && under.cell != 1) return nullptr; // another film has just begun
    parallelFor(static_cast<std::size_t>(picture->height), [&](std::size_t row) {
        const int y = static_cast<int>(row) / step;
        if (y < b.y0 || y >= b.y1) return;
        for (int x = 0; x < picture->width; ++x)
            if (const int u = x / step; u >= b.x0 && u < b.x1 && f.film.samples(u, y) > 0) {
                const auto rgb = of(u, y);
                std::copy_n(
                    rgb.data(), 3,
                    &picture->rgb[3 * (row * static_cast<std::size_t>(picture->width) + static_cast<std::size_t>(x))]);
            }
    });
    return picture;
}

// The sum of a film's light groups, each with its weight.
class WeighedGroups {
  public:
    WeighedGroups(const RestingFilm& resting, const GroupWeights& weights)
        : film_(resting.film.film), layers_(*film_.layers()), first_(layers_.plan().offsets().groups),
          matrix_(toSpace(resting.shot.film)), scale_(resting.shot.built.exposure) {
        for (const std::string& name : layers_.groupNames()) {
            const auto found = weights.find(name);
            weights_.push_back(found == weights.end() ? 1 : found->second);
        }
        for (std::size_t k = 0; k < kSplatKinds; ++k)
            splats_[k] = static_cast<double>(film_.splatCount(static_cast<SplatKind>(k), 0, film_.replicates()));
    }

    std::array<float, 3> operator()(int x, int y) const {
        const std::size_t pixel = layers_.pixelIndex(x, y);
        const double each = 1 / static_cast<double>(film_.samples(x, y));
        Xyz sum;
        for (std::size_t g = 0; g < weights_.size(); ++g) {
            if (weights_[g] == 0) continue;
            const int at = first_ + 3 * static_cast<int>(g);
            sum += Xyz{part(pixel, at, each), part(pixel, at + 1, each), part(pixel, at + 2, each)} * weights_[g];
        }
        const auto rgb = matrix_.apply<Vec3d>(sum * scale_);
        return {static_cast<float>(rgb.x), static_cast<float>(rgb.y), static_cast<float>(rgb.z)};
    }

  private:
    double part(std::size_t pixel, int offset, double each) const {
        ExactSum total;
        for (int h = 0; h < layers_.halves(); ++h) total += layers_.sums(pixel, h)[static_cast<std::size_t>(offset)];
        double value = total.value() * each;
        for (std::size_t k = 0; k < kSplatKinds; ++k)
            if (splats_[k] > 0) value += layers_.splatted(static_cast<SplatKind>(k), pixel, offset) / splats_[k];
        return value;
    }

    const PixelFilm& film_;
    const FilmLayers& layers_;
    int first_;
    Matrix3 matrix_;
    double scale_;
    std::vector<double> weights_;
    std::array<double, kSplatKinds> splats_{};
};

// Null where the film is not that of the picture any more, or keeps no groups.
std::shared_ptr<const LivePicture> weighedPictureOf(const RestingFilm& resting, const LivePicture& live,
                                                    const GroupWeights& weights) {
    const FilmLayers* const layers = resting.film.film.layers();
    if (!layers || layers->plan().groupCount() == 0) return nullptr;
    return painted(live, resting.film, true, WeighedGroups(resting, weights));
}

// Whether a layer is light, which a view shows; else its numbers are made visible (pictures/layer_view.h).
bool isColours(std::string_view layer) {
    constexpr std::string_view kNumbers[] = {"normal",  "position", "forward", "uv",     "depth",
                                             "samples", "seconds",  "invalid", "object", "material"};
    return std::ranges::find(kNumbers, layer) == std::end(kNumbers) && !layer.starts_with("Crypto");
}

std::string layerKey(const std::string& name, double exposure) {
    return isColours(name) ? "layer " + name : fmt::format("layer {} {}", name, exposure);
}

// Likewise of a layer.
std::shared_ptr<const LivePicture> layerPictureOf(const RestingFilm& resting, const LivePicture& live,
                                                  const std::string& name, double exposure) {
    const PixelFilm& film = resting.film.film;
    if (!film.layers()) return nullptr;
    ResolvedImage image;
    image.bounds = film.bounds();
    const LayerView view{&rgbSpace(resting.shot.film.space), toSpace(resting.shot.film), resting.shot.built.exposure,
                         resting.shot.built.scene.origin, name};
    ExrPlanes planes;
    for (NamedPlane& plane : layerPlanes(film, image, view).planes) {
        planes.info.channels.push_back({plane.name, "float", 0});
        planes.values.push_back(std::move(plane.values));
    }
    const auto shown = layerPicture(planes, name, static_cast<float>(std::exp2(exposure)));
    if (!shown) return nullptr;
    const PixelBounds b = film.bounds();
    return painted(live, resting.film, false, [&](int x, int y) {
        const float* v = &shown->rgb[3 * (static_cast<std::size_t>(y - b.y0) * static_cast<std::size_t>(b.width()) +
                                          static_cast<std::size_t>(x - b.x0))];
        return std::array<float, 3>{v[0], v[1], v[2]};
    });
}

// Planes of a film's bounds that denoising takes, as they were at one moment.
struct DenoisePlanes {
    PixelBounds bounds;
    std::array<std::vector<float>, 3> colour, half, albedo, normal;
    std::vector<float> depth;
    Matrix3 toRec709;

    DenoiseInput input() const {
        DenoiseInput in;
        in.width = bounds.width();
        in.height = bounds.height();
        for (std::size_t c = 0; c < 3; ++c) {
            in.colour[c] = {colour[c], half[c]};
            in.features.albedo[c] = {albedo[c], {}};
            in.features.normal[c] = {normal[c], {}};
        }
        in.features.depth = {depth, {}};
        in.toRec709 = toRec709;
        return in;
    }
};

DenoisePlanes denoisePlanes(const RestingFilm& resting) {
    const PixelFilm& film = resting.film.film;
    DenoisePlanes planes;
    planes.bounds = film.bounds();
    planes.toRec709 = rgb::rec709.fromXyz() * rgbSpace(resting.shot.film.space).toXyz();
    ResolvedImage image = resolveImage(film, resting.shot.film, resting.shot.built.exposure);
    const Matrix3 matrix = toSpace(resting.shot.film);
    const int end = (film.replicates() + 1) / 2;
    const PixelBounds& b = planes.bounds;
    for (auto& plane : planes.half) plane.reserve(static_cast<std::size_t>(b.area()));
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x) {
            const auto rgb = matrix.apply<Vec3d>(film.mean(x, y, 0, end) * resting.shot.built.exposure);
            planes.half[0].push_back(static_cast<float>(rgb.x));
            planes.half[1].push_back(static_cast<float>(rgb.y));
            planes.half[2].push_back(static_cast<float>(rgb.z));
        }
    LayerView view{&rgbSpace(resting.shot.film.space), matrix, 1, {}, {}};
    const auto take = [&](const char* layer, std::span<std::vector<float>> to) {
        view.only = layer;
        LayerPlanes found = layerPlanes(film, image, view);
        for (std::size_t c = 0; c < to.size() && c < found.planes.size(); ++c)
            to[c] = std::move(found.planes[c].values);
    };
    take("albedo", planes.albedo);
    take("normal", planes.normal);
    take("depth", std::span(&planes.depth, 1));
    planes.colour = {std::move(image.r), std::move(image.g), std::move(image.b)};
    return planes;
}

// Means of squares of `step` pixels.
LivePicture shrunk(const LivePicture& picture, int step) {
    LivePicture small = picture;
    small.width = (picture.width + step - 1) / step;
    small.height = (picture.height + step - 1) / step;
    small.rgb.assign(3 * static_cast<std::size_t>(small.width) * static_cast<std::size_t>(small.height), 0);
    parallelFor(static_cast<std::size_t>(small.height), [&](std::size_t row) {
        for (int x = 0; x < small.width; ++x) {
            const int x1 = std::min((x + 1) * step, picture.width);
            const int y0 = static_cast<int>(row) * step, y1 = std::min(y0 + step, picture.height);
            float* const out =
                &small.rgb[3 * (row * static_cast<std::size_t>(small.width) + static_cast<std::size_t>(x))];
            for (int v = y0; v < y1; ++v)
                for (int u = x * step; u < x1; ++u)
                    for (std::size_t c = 0; c < 3; ++c)
                        out[c] +=
                            picture.rgb[3 * (static_cast<std::size_t>(v) * static_cast<std::size_t>(picture.width) +
                                             static_cast<std::size_t>(u)) +
                                        c];
            for (std::size_t c = 0; c < 3; ++c) out[c] /= static_cast<float>((x1 - x * step) * (y1 - y0));
        }
    });
    return small;
}

char byteOf(float v) {
    const float clamped = v > 0 ? std::min(v, 1.f) : 0.f; // also of what is no number
    return static_cast<char>(static_cast<unsigned char>(std::lround(255 * clamped)));
}

std::vector<char> bytesOf(const LivePicture& picture, const DisplayView* view) {
    const auto width = static_cast<std::size_t>(picture.width);
    std::vector<char> bytes(4 * width * static_cast<std::size_t>(picture.height));
    parallelFor(static_cast<std::size_t>(picture.height), [&](std::size_t row) {
        std::vector<float> rgb(picture.rgb.begin() + static_cast<std::ptrdiff_t>(3 * row * width),
                               picture.rgb.begin() + static_cast<std::ptrdiff_t>(3 * (row + 1) * width));
        if (view) view->apply(rgb);
        char* out = &bytes[4 * row * width];
        for (std::size_t x = 0; x < width; ++x, out += 4) {
            for (std::size_t c = 0; c < 3; ++c) out[c] = byteOf(rgb[3 * x + c]);
            out[3] = static_cast<char>(255);
        }
    });
    return bytes;
}

} // namespace

ViewPictures::ViewPictures(LiveRender& render, ViewOptions view) : render_(render), options_(std::move(view)) {
    render_.onPublish = [this](RestingFilm& resting, const Picture& live) { published(resting, live); };
    const DisplayView first(OutputSpace::aces2065_1, options_);
    defaultView_ = first.view().view();
    const char* variable = std::getenv("OCIO");
    const std::string config = options_.config == OcioView::builtInConfig ? std::string()
                               : !options_.config.empty()                 ? options_.config
                               : variable                                 ? std::string(variable)
                                                                          : std::string();
    for (const DisplayViews& display : OcioView::list(config))
        if (display.display == first.view().display()) views_ = display.views;
}

void ViewPictures::weigh(const GroupWeights& weights) {
    const std::vector<std::string> groups = render_.report().groups;
    for (const auto& [name, weight] : weights) {
        if (std::ranges::find(groups, name) == groups.end()) {
            const std::vector<std::string_view> names(groups.begin(), groups.end());
            throw ViewFault(fmt::format("there is no light group `{}`", name),
                            groups.empty() ? "the picture has one light alone"
                                           : fmt::format("its groups are {}", schema::quotedList(names)));
        }
        if (!std::isfinite(weight) || weight < 0 || weight > 1e6)
            throw ViewFault(fmt::format("{} is no weight of a light group", weight), "from 0 to 1000000");
    }
    const std::lock_guard lock(mutex_);
    for (const auto& [name, weight] : weights)
        if (weight == 1)
            weights_.erase(name);
        else
            weights_[name] = weight;
    ++weighings_;
}

GroupWeights ViewPictures::weights() const {
    const std::lock_guard lock(mutex_);
    return weights_;
}

bool ViewPictures::hasOther() const {
    const std::lock_guard lock(mutex_);
    return other_ != nullptr;
}

void ViewPictures::setOther(const std::string& path) {
    Picture picture;
    if (!path.empty()) {
        try {
            RgbImage image = readExr(path);
            auto made = std::make_shared<LivePicture>();
            made->space = makeViewable(image);
            made->width = made->frameWidth = image.width();
            made->height = made->frameHeight = image.height();
            made->rgb = std::move(image.rgb);
            made->version = 1;
            picture = made;
        } catch (const IoError& e) {
            throw ViewFault(e.what(), "an OpenEXR image with R, G and B can be shown");
        }
    }
    const std::lock_guard lock(mutex_);
    other_ = picture;
}

std::shared_ptr<const DisplayView> ViewPictures::viewFor(OutputSpace space, const std::string& name) {
    const std::lock_guard lock(mutex_);
    auto& view = displays_[{static_cast<int>(space), name}];
    if (view) return view;
    ViewOptions options = options_;
    options.exposure = 0; // that of each request
    if (!name.empty()) options.view = name;
    try {
        return view = std::make_shared<const DisplayView>(space, options);
    } catch (const IoError& e) {
        displays_.erase({static_cast<int>(space), name});
        throw ViewFault(e.what());
    }
}

// Of one version of the picture at a time. What cannot be made of it, since the film has gone on to other cells, is as
// it was last, or else the picture itself.
template <typename Make>
ViewPictures::Picture ViewPictures::cached(const std::string& key, const Picture& live, const Make& make) {
    {
        const std::lock_guard lock(mutex_);
        takeVersion(live->version);
        if (const auto found = made_.find(key); found != made_.end()) return found->second;
    }
    Picture picture = make();
    const std::lock_guard lock(mutex_);
    if (!picture) {
        const auto older = older_.find(key);
        return older == older_.end() ? live : older->second;
    }
    if (madeOf_ == live->version) store(key, picture);
    return picture;
}

void ViewPictures::takeVersion(std::uint64_t version) {
    if (version <= madeOf_) return; // who asks for an older picture may have a newer one
    for (auto& [key, picture] : made_) older_[key] = std::move(picture);
    while (older_.size() > kMostMade) older_.erase(older_.begin());
    made_.clear();
    madeOf_ = version;
}

void ViewPictures::store(const std::string& key, const Picture& picture) {
    if (made_.size() >= kMostMade) made_.erase(made_.begin());
    made_[key] = picture;
}

// What pages look at is made while the film rests anyway, and is as old as the picture.
void ViewPictures::published(RestingFilm& resting, const Picture& live) {
    std::string name;
    double exposure = 0;
    GroupWeights weights;
    std::uint64_t weighing = 0;
    {
        const std::lock_guard lock(mutex_);
        takeVersion(live->version);
        if (askedFor_.seconds() < kInterest) name = askedLayer_;
        exposure = askedExposure_;
        weights = weights_;
        weighing = weighings_;
    }
    Picture layer, sum;
    if (!name.empty()) layer = layerPictureOf(resting, *live, name, exposure);
    if (name.empty() && !weights.empty()) sum = weighedPictureOf(resting, *live, weights);
    const std::lock_guard lock(mutex_);
    if (layer) store(layerKey(name, exposure), layer);
    if (sum) store(fmt::format("weights {}", weighing), sum);
}

ViewPictures::Picture ViewPictures::weighed(const Picture& live, const GroupWeights& weights) {
    std::uint64_t weighing = 0;
    {
        const std::lock_guard lock(mutex_);
        weighing = weighings_;
    }
    return cached(fmt::format("weights {}", weighing), live, [&] {
        Picture made;
        render_.whileResting([&](RestingFilm& resting) { made = weighedPictureOf(resting, *live, weights); });
        return made;
    });
}

ViewPictures::Shown ViewPictures::layer(const Picture& live, const std::string& name, double exposure) {
    const auto layers = render_.report().layers;
    if (std::ranges::find(layers, name) == layers.end())
        throw ViewFault(fmt::format("there is no layer `{}`", name),
                        "the film of the scene keeps others: `layers { … }`");
    {
        const std::lock_guard lock(mutex_);
        askedLayer_ = name;
        askedExposure_ = exposure;
        askedFor_.lap();
    }
    Picture picture = cached(layerKey(name, exposure), live, [&] {
        Picture made;
        render_.whileResting([&](RestingFilm& resting) { made = layerPictureOf(resting, *live, name, exposure); });
        return made;
    });
    return {picture, isColours(name)};
}

// A rough picture is denoised as it is: it is gone before anybody looks closely.
ViewPictures::Picture ViewPictures::denoised(const Picture& live, DenoiseMethod method) {
    return cached(fmt::format("denoised {}", name(method)), live, [&] {
        const std::lock_guard one(denoising_);
        std::optional<DenoisePlanes> planes;
        render_.whileResting([&](RestingFilm& resting) {
            if (resting.film.cell == 1 && live->cell == 1 && resting.film.film.replicates() > 1)
                planes = denoisePlanes(resting);
        });
        if (!planes) return live;
        DenoiseResult result;
        try {
            result = denoise(planes->input(), method, DenoiseEffort::look);
        } catch (const std::runtime_error& e) { // a denoiser that is not there, or failed
            throw ViewFault(e.what());
        }
        const PixelBounds b = planes->bounds;
        auto made = std::make_shared<LivePicture>(*live);
        for (int y = b.y0; y < std::min(b.y1, made->height); ++y)
            for (int x = b.x0; x < std::min(b.x1, made->width); ++x) {
                const auto from = static_cast<std::size_t>(y - b.y0) * static_cast<std::size_t>(b.width()) +
                                  static_cast<std::size_t>(x - b.x0);
                const auto to =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(made->width) + static_cast<std::size_t>(x);
                for (std::size_t c = 0; c < 3; ++c) made->rgb[3 * to + c] = result.colour[c][from];
            }
        return Picture(made);
    });
}

ViewPictures::Shown ViewPictures::find(const PictureQuery& query) {
    if (query.source == PictureSource::saved) return {render_.saved()};
    if (query.source == PictureSource::other) {
        const std::lock_guard lock(mutex_);
        return {other_};
    }
    const Picture live = render_.picture();
    if (!live) return {};
    if (!query.layer.empty()) return layer(live, query.layer, query.exposure);
    if (query.denoise) return {denoised(live, *query.denoise)};
    if (const GroupWeights w = weights(); !w.empty()) return {weighed(live, w)};
    return {live};
}

std::optional<ShownBytes> ViewPictures::show(const PictureQuery& query) {
    if (!(std::abs(query.exposure) <= kMostStops))
        throw ViewFault(fmt::format("{} stops are no exposure", query.exposure), "from -60 to 60");
    const Shown shown = find(query);
    if (!shown.picture) return std::nullopt;
    const auto view = viewFor(shown.picture->space, query.view);
    const int longest = std::max(shown.picture->width, shown.picture->height);
    const int step = query.most > 0 ? (longest + query.most - 1) / query.most : 1;
    LivePicture picture = step > 1 ? shrunk(*shown.picture, step) : *shown.picture;
    if (const auto gain = static_cast<float>(std::exp2(query.exposure)); shown.colours && gain != 1)
        for (float& v : picture.rgb) v *= gain;
    ShownBytes result;
    result.width = picture.width;
    result.height = picture.height;
    result.rgba = bytesOf(picture, shown.colours ? view.get() : nullptr);
    picture.rgb.clear();
    picture.rgb.shrink_to_fit();
    result.of = std::make_shared<const LivePicture>(std::move(picture));
    return result;
}

} // namespace abbe
