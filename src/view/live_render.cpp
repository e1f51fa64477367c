#include "view/live_render.h"

#include "base/memory_limit.h"
#include "base/parallel.h"
#include "cameras/altered_camera.h"
#include "film/film_planes.h"
#include "film/layer_planes.h"
#include "pictures/film_picture.h"
#include "pictures/picture_figures.h"
#include "reports/render_warnings.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace abbe {

namespace {

constexpr int kFirstCell = 8, kRoughestCell = 32; // pixels of the frame
constexpr double kFirstGlance = 0.12;             // s, that the first picture may take
constexpr double kPatience = 0.6;                 // s: what has shown nothing for longer makes way for what comes next
constexpr double kOften = 0.4;                    // s between pictures, at first
constexpr double kShareOfPublishing = 0.05;
constexpr std::size_t kMostCurvePoints = 400;
constexpr std::chrono::seconds kLongestWait{3}; // for a film to rest

PixelBounds roughBounds(const PixelBounds& b, int cell) {
    const auto up = [cell](int v) { return (v + cell - 1) / cell; };
    return {b.x0 / cell, b.y0 / cell, up(b.x1), up(b.y1)};
}

// As an image of the film would name them, but for the parts of a spectrum.
std::vector<std::string> layersOf(const PixelFilm& film) {
    std::vector<std::string> names;
    if (!film.layers()) return names;
    ResolvedImage nothing;
    nothing.bounds = film.bounds();
    nothing.bounds.y1 = nothing.bounds.y0;
    for (const NamedPlane& plane : layerPlanes(film, nothing, {&rgbSpace(OutputSpace::xyz), {}, 1, {}, {}}).planes) {
        const std::string name = plane.name.substr(0, plane.name.rfind('.'));
        const bool known = std::ranges::find(names, name) != names.end();
        if (!known && name != "S0" && !name.starts_with("half")) names.push_back(name);
    }
    return names;
}

} // namespace

LiveRender::LiveRender(LiveScene& scene, std::function<void()> changed) : scene_(scene), changed_(std::move(changed)) {}

LiveRender::~LiveRender() { end(); }

void LiveRender::end() {
    if (!thread_.joinable()) return;
    order([](Orders& o) { o.end = true; }, true);
    thread_.join();
}

// `atOnce`: the render in hand ends; else it may show its first picture before it makes way.
void LiveRender::order(const std::function<void(Orders&)>& change, bool atOnce) {
    {
        const std::lock_guard lock(mutex_);
        change(orders_);
        const bool more = orders_.restart || orders_.goal;
        if (more && report_.status == LiveStatus::done) report_.status = LiveStatus::rendering;
        if (rendering_ && (atOnce || shown_)) stop_ = true;
    }
    awake_.notify_all();
    changed_();
}

void LiveRender::start() {
    thread_ = std::thread([this] { run(); });
}

void LiveRender::reload() {
    order([](Orders& o) { o.reload = true; }, false);
}

void LiveRender::moveTo(const CameraPose& pose) {
    order(
        [&](Orders& o) {
            pose_ = pose;
            report_.pose = pose;
            report_.moved = true;
            o.restart = true;
        },
        false);
}

void LiveRender::resetCamera() {
    order(
        [&](Orders& o) {
            if (shot_) report_.pose = shot_->built.cameraPose;
            report_.moved = false;
            o.restart |= pose_.has_value();
            pose_.reset();
        },
        false);
}

void LiveRender::setRegion(std::optional<PixelBounds> region) {
    order(
        [&](Orders& o) {
            region_ = report_.region = region;
            o.restart = true;
        },
        true);
}

void LiveRender::pause(bool paused) {
    order(
        [&](Orders&) {
            paused_ = paused;
            if (report_.status == LiveStatus::rendering || report_.status == LiveStatus::paused)
                report_.status = paused ? LiveStatus::paused : LiveStatus::rendering;
        },
        paused);
}

void LiveRender::restart() {
    order([](Orders& o) { o.restart = true; }, true);
}

void LiveRender::setGoal(std::uint32_t samples) {
    order(
        [&](Orders& o) {
            goal_ = samples;
            report_.goal = samples;
            o.goal = true;
        },
        true);
}

void LiveRender::keepPicture() {
    {
        const std::lock_guard lock(mutex_);
        if (picture_) saved_ = picture_;
    }
    changed_();
}

LiveReport LiveRender::report() const {
    const std::lock_guard lock(mutex_);
    LiveReport report = report_;
    report.diagnostics.insert(report.diagnostics.end(), found_.begin(), found_.end());
    const bool failed = std::ranges::any_of(report.diagnostics, [](const auto& d) { return d.severity == "error"; });
    if (failed && report.status != LiveStatus::loading) report.status = LiveStatus::error;
    report.stale = failed && picture_ != nullptr;
    return report;
}

std::shared_ptr<const LivePicture> LiveRender::picture() const {
    const std::lock_guard lock(mutex_);
    return picture_;
}

std::shared_ptr<const LivePicture> LiveRender::saved() const {
    const std::lock_guard lock(mutex_);
    return saved_;
}

std::shared_ptr<const LiveShot> LiveRender::shot() const {
    const std::lock_guard lock(mutex_);
    return shot_;
}

bool LiveRender::whileResting(const std::function<void(RestingFilm&)>& use) {
    ++waiting_;
    rest_ = true;
    // One after the other, so that the render gets its turn between two of them.
    const std::unique_lock turn(turnstile_, kLongestWait);
    const auto lock = turn ? std::unique_lock(resting_, kLongestWait) : std::unique_lock<std::timed_mutex>();
    --waiting_;
    if (!lock || !film_) return false;
    RestingFilm resting{*shot_, *film_, shownPose_, shownMoved_};
    use(resting);
    return true;
}

// Those who wait for the film, from the thread that renders while no other one is at work.
void LiveRender::letIn() {
    while (waiting_ > 0) {
        resting_.unlock();
        std::this_thread::yield();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        resting_.lock();
    }
}

bool LiveRender::next(Orders& orders) {
    std::unique_lock lock(mutex_);
    rendering_ = false;
    const auto idle = [&] { return !shot_ || finished_ || (paused_ && isLastStage()); };
    const auto asked = [&] { return orders_.end || orders_.reload || orders_.restart || orders_.goal; };
    awake_.wait(lock, [&] { return asked() || !idle(); });
    orders = std::exchange(orders_, Orders{false, false, false, false});
    stop_ = false;
    rendering_ = true;
    return !orders.end;
}

void LiveRender::run() {
    flushDenormals();
    clock_.emplace(threadCount());
    Orders orders;
    while (next(orders)) {
        try {
            follow(orders);
        } catch (const std::bad_alloc& e) {
            fail("E0781", "out of memory for this picture: " + memoryReason(e),
                 "a smaller `--size`, or fewer layers, takes less");
        } catch (const std::exception& e) {
            fail("E0780", e.what(), {});
        }
    }
}

void LiveRender::follow(const Orders& orders) {
    if (orders.reload) load();
    if (!shot()) return;
    if (orders.restart && !orders.reload) {
        begun_.lap();
        begin();
    }
    if (orders.goal) takeGoal();
    if (!finished_) renderStage();
}

// Nothing more is tried until something changes.
void LiveRender::fail(const char* code, std::string message, std::string help) {
    finished_ = true;
    {
        const std::lock_guard lock(mutex_);
        report_.status = LiveStatus::error;
        found_.push_back({"error", code, {}, 0, 0, std::move(message), {}, std::move(help)});
    }
    changed_();
}

void LiveRender::load() {
    {
        const std::lock_guard lock(mutex_);
        report_.status = LiveStatus::loading;
        report_.firstPixels = 0;
        ++report_.saves;
    }
    changed_();
    begun_.lap();
    LoadOutcome outcome = scene_.load();
    if (onLoad) onLoad(outcome);
    adopt(outcome);
    changed_();
}

void LiveRender::adopt(LoadOutcome& outcome) {
    const bool good = outcome.shot != nullptr;
    if (good) {
        outcome.shot->ownCamera = std::move(outcome.shot->built.scene.camera);
        const std::lock_guard atRest(resting_);
        film_.reset();
        metered_ = false;
        const std::lock_guard lock(mutex_);
        if (!shot_ || shot_->cameraWords != outcome.shot->cameraWords) pose_.reset();
        shot_ = outcome.shot;
        if (region_ && (region_->x1 > shot_->film.width || region_->y1 > shot_->film.height)) region_.reset();
    }
    {
        const std::lock_guard lock(mutex_);
        report_.diagnostics = std::move(outcome.diagnostics);
        found_.clear(); // its places may be elsewhere now
        report_.reuse = outcome.reuse;
        report_.readSeconds = outcome.readSeconds;
        report_.buildSeconds = outcome.buildSeconds;
        report_.commitSeconds = outcome.commitSeconds;
        report_.firstPixels = 0;
        report_.status = !shot_      ? LiveStatus::error
                         : paused_   ? LiveStatus::paused
                         : finished_ ? LiveStatus::done
                                     : LiveStatus::rendering;
        if (good && picture_ && picture_->cell == 1) saved_ = picture_;
    }
    if (good) begin();
}

// What was rendered is forgotten, but for the picture that is shown until there is another one.
void LiveRender::begin() {
    const std::lock_guard atRest(resting_);
    film_.reset();
    finished_ = false;
    earlier_ = 0;
    std::optional<CameraPose> pose;
    {
        const std::lock_guard lock(mutex_);
        pose = pose_;
        shown_ = false;
        found_.clear();
        report_.region = region_;
        report_.width = shot_->film.width;
        report_.height = shot_->film.height;
        report_.curve.clear();
        report_.samples = 0;
        report_.noise = report_.elapsed = 0;
        report_.left = -1;
        report_.goal = goal_.value_or(shot_->settings.samples);
    }
    moveCamera({});
    if (!lendStops(*shot_)) meter(*shot_);
    moveCamera(pose);
    cell_ = firstCell(shot_->film.crop);
    const std::lock_guard lock(mutex_);
    report_.pose = pose_.value_or(shot_->built.cameraPose); // it may have been moved on meanwhile
    report_.moved = pose_.has_value();
    report_.stops = shot_->built.cameraExposure.stops;
    report_.status = paused_ ? LiveStatus::paused : LiveStatus::rendering;
}

// To a place, or to where the scene has it.
void LiveRender::moveCamera(const std::optional<CameraPose>& pose) {
    movedCamera_.reset();
    shownPose_ = shot_->built.cameraPose;
    if (pose) {
        BuildOptions options = scene_.options();
        options.cameraPose = pose;
        Diagnostics ignored; // the scene was built without errors, and a pose is sound
        LoneCamera moved = buildCamera(shot_->loaded->tree, shot_->loaded->types, options, ignored);
        if (moved.camera) {
            movedCamera_ =
                std::make_unique<MovedCamera>(std::move(moved.camera), moved.origin - shot_->built.scene.origin);
            shownPose_ = *pose;
        }
    }
    shownMoved_ = movedCamera_ != nullptr;
    placeCamera(1);
}

// A render goes on to another number of samples, if it was planned already.
void LiveRender::takeGoal() {
    const std::lock_guard atRest(resting_);
    const std::lock_guard lock(mutex_);
    if (!film_ || film_->cell > 1 || !goal_) return;
    film_->settings.samples = *goal_;
    finished_ = false;
}

void LiveRender::placeCamera(int cell) {
    Scene& scene = shot_->built.scene;
    const Camera& camera = movedCamera_ ? *movedCamera_ : *shot_->ownCamera;
    scene.camera = std::make_unique<RoughCamera>(camera, cell);
    scene.frame = roughBounds({0, 0, shot_->film.width, shot_->film.height}, cell);
}

// `exposure auto`, as a render finds it: by the scene's own camera, so that a picture that is looked around in keeps
// its brightness.
void LiveRender::meter(LiveShot& shot) {
    Exposure& exposure = shot.built.cameraExposure;
    if (!exposure.automatic || std::exchange(metered_, true)) return;
    const Scene& scene = shot.built.scene;
    if (const auto stops = meterExposure(scene, *shot.integrator, shot.settings.maxDepth, exposure.sensitivity))
        exposure.stops = *stops;
    shot.built.exposure = exposure.factor();
    lastStops_ = exposure.stops;
}

// The stops of the scene as it was saved before: a first picture need not wait for paths that find those of its own.
bool LiveRender::lendStops(LiveShot& shot) {
    Exposure& exposure = shot.built.cameraExposure;
    if (!exposure.automatic || metered_ || !lastStops_) return false;
    exposure.stops = *lastStops_;
    shot.built.exposure = exposure.factor();
    return true;
}

// After the first picture.
void LiveRender::meterLate() {
    if (metered_ || !shot_->built.cameraExposure.automatic) return;
    const std::optional<CameraPose> pose = shownMoved_ ? std::optional(shownPose_) : std::nullopt;
    moveCamera({});
    meter(*shot_);
    moveCamera(pose);
    const std::lock_guard lock(mutex_);
    report_.stops = shot_->built.cameraExposure.stops;
}

// Throws MemoryLimitExceeded if a film and its pictures do not fit.
void LiveRender::requireRoom(const PixelBounds& bounds, int replicates) const {
    constexpr double kPictures = 4 * 3 * sizeof(float); // bytes of a pixel: shown, saved, in the making, of a page
    requireMemory(static_cast<double>(PixelFilm::memoryBytes(bounds, replicates, true, true)) +
                  static_cast<double>(FilmLayers::memoryBytes(bounds, shot_->layers)) +
                  kPictures * shot_->film.width * shot_->film.height);
}

// As fine as can be seen soon, by what earlier pictures took.
int LiveRender::firstCell(const PixelBounds& bounds) const {
    int cell = kFirstCell;
    while (cell > 1 && (bounds.width() < 4 * cell || bounds.height() < 4 * cell)) cell /= 2;
    const auto seconds = [&] { return secondsOfPixel_ * static_cast<double>(bounds.area()) / (cell * cell); };
    while (cell > 1 && cell < kRoughestCell && seconds() > kFirstGlance) cell *= 2;
    return cell;
}

// The film of the next step.
void LiveRender::beginStage() {
    std::optional<PixelBounds> region;
    std::optional<std::uint32_t> goal;
    bool shown = false;
    {
        const std::lock_guard lock(mutex_);
        region = region_;
        goal = goal_;
        shown = shown_;
    }
    if (shown || cell_ == 1) meterLate();
    const bool rough = cell_ > 1;
    const PixelBounds bounds = roughBounds(region.value_or(shot_->film.crop), cell_);
    RenderSettings settings = shot_->settings;
    if (goal) settings.samples = *goal;
    const int replicates = rough ? 1 : static_cast<int>(shot_->built.render.replicates);
    if (rough) { // camera paths alone, and nothing that has to be planned
        settings.samples = cell_ >= kFirstCell ? 1 : 2;
        settings.noiseTarget = 0;
        settings.adaptive = false;
        settings.pilot = 0;
        settings.technique.guiding = Technique::Guiding::off;
        settings.technique.lightPaths = Technique::LightPaths::off;
        settings.technique.merging = Technique::Merging::off;
    }
    placeCamera(cell_);
    requireRoom(bounds, replicates);
    Scene& scene = shot_->built.scene;
    PixelFilm film(bounds, PixelFilter(shot_->film.filter, shot_->film.filterRadius), replicates);
    film.keepSplatsOf(*shot_->integrator, scene, settings);
    LayerPlan layers = shot_->layers;
    if (replicates < 2) layers.halves = false;
    film.keepLayers(layers, scene.names, rgbSpace(shot_->film.space), {scene.intersector.get(), scene.camera.get()});
    RenderState state(bounds, settings.range(replicates).first, shot_->integrator->lightBlocks(scene, settings));
    const auto names = layersOf(film);
    {
        const std::lock_guard lock(mutex_);
        report_.layers = names;
        report_.groups = film.layers() ? film.layers()->groupNames() : std::vector<std::string>();
    }
    film_ = std::make_unique<LiveFilm>(LiveFilm{cell_, settings, std::move(film), std::move(state)});
    nextPublication_ = now() + kOften;
}

void LiveRender::renderStage() {
    {
        const std::lock_guard lock(mutex_);
        if (paused_ && isLastStage()) return; // a rough picture is there at once, also of a view that pauses
        if (!paused_) report_.status = LiveStatus::rendering;
    }
    resting_.lock();
    run_.lap();
    try {
        if (!film_) beginStage();
        RenderControl control{&stop_, [this](const Progress& p) { progress(p); }, &film_->state, &rest_,
                              [this](const RenderStatistics& s) {
                                  film_->statistics = s;
                                  publish();
                                  letIn();
                              }};
        control.framePreview = [this](const FramePreview& look) {
            if (film_->cell == 1) warnOfPaths(look);
            letIn();
        };
        control.passEnded = [this] { passEnded(); };
        const RenderStatistics statistics =
            shot_->integrator->render(shot_->built.scene, film_->film, film_->settings, control);
        stageEnded(statistics);
    } catch (...) {
        resting_.unlock();
        throw;
    }
    earlier_ = now();
    resting_.unlock();
    changed_();
}

// Before the first sample of the last stage.
void LiveRender::warnOfPaths(const FramePreview& look) {
    Diagnostics found;
    warnOfEndlessPaths(look, shot_->built, film_->settings.samples, found);
    tell(viewDiagnostics(found, shot_->loaded->sources));
}

void LiveRender::stageEnded(const RenderStatistics& statistics) {
    film_->statistics = statistics;
    if (statistics.stopped) {
        if (!film_->state.empty()) publish(); // else a pass has just ended
        return;
    }
    if (film_->cell > 1) {
        const double pixels = static_cast<double>(film_->film.bounds().area()) * film_->settings.samples;
        secondsOfPixel_ = statistics.seconds / std::max(pixels, 1.0);
        cell_ = film_->cell > 2 ? film_->cell / 2 : 1;
        film_.reset();
        return;
    }
    finished_ = true;
    std::vector<ViewDiagnostic> told;
    if (const auto last = picture(); onEnd && last) {
        RestingFilm resting{*shot_, *film_, shownPose_, shownMoved_};
        told = onEnd(resting, last);
    }
    tell(std::move(told));
    const std::lock_guard lock(mutex_);
    report_.status = LiveStatus::done;
    report_.left = 0;
}

// About the picture in hand, each once: a render that goes on to more samples ends again.
void LiveRender::tell(std::vector<ViewDiagnostic> found) {
    const std::lock_guard lock(mutex_);
    for (ViewDiagnostic& d : found)
        if (std::ranges::find(found_, d) == found_.end()) found_.push_back(std::move(d));
}

void LiveRender::passEnded() {
    film_->statistics.samplesPerPixel =
        (film_->state.reached() - film_->state.first()) * static_cast<std::uint32_t>(film_->film.replicates());
    publish();
    letIn();
    if (film_->cell > 1) return;
    const double noise = film_->film.relativeNoise();
    const std::lock_guard lock(mutex_);
    report_.noise = noise;
    if (noise > 0 && report_.curve.size() < kMostCurvePoints)
        report_.curve.push_back({now(), static_cast<double>(film_->statistics.samplesPerPixel), noise});
}

// From any thread of the render.
void LiveRender::progress(const Progress& p) {
    const double seconds = now();
    {
        const std::lock_guard lock(mutex_);
        report_.elapsed = seconds;
        if (film_->cell == 1) {
            report_.samples = p.samplesPerPixel;
            report_.left = p.left;
        }
        // What waits for a first picture does not wait for ever.
        if (!shown_ && begun_.seconds() > kPatience && (orders_.reload || orders_.restart)) stop_ = true;
    }
    if (waiting_ > 0 || seconds > nextPublication_) rest_ = true;
    changed_();
}

// No thread may be at work on the film.
void LiveRender::publish() {
    const Stopwatch watch;
    const auto picture = compose();
    picture->version = ++versions_;
    if (onPublish) {
        RestingFilm resting{*shot_, *film_, shownPose_, shownMoved_};
        onPublish(resting, picture);
    }
    const double seconds = now();
    nextPublication_ = seconds + std::max({kOften, seconds / 20, watch.seconds() / kShareOfPublishing});
    {
        const std::lock_guard lock(mutex_);
        picture_ = picture;
        report_.elapsed = seconds;
        if (!shown_) report_.firstPixels = begun_.seconds();
        shown_ = true;
        if (orders_.reload || orders_.restart) stop_ = true; // it had its glance
    }
    changed_();
}

// The film over what was shown before it, where it has no samples yet.
std::shared_ptr<LivePicture> LiveRender::compose() const {
    const LiveFilm& f = *film_;
    const FilmSettings& settings = shot_->film;
    const ResolvedImage image = resolveImage(f.film, settings, shot_->built.exposure);
    const PixelBounds& b = image.bounds;
    const PixelBounds whole = roughBounds({0, 0, settings.width, settings.height}, f.cell);
    const bool covers = b.area() == whole.area();
    const int cell = covers ? f.cell : 1;
    auto picture = std::make_shared<LivePicture>();
    picture->frameWidth = settings.width;
    picture->frameHeight = settings.height;
    picture->cell = cell;
    picture->space = settings.space;
    picture->samples = f.cell > 1 ? f.settings.samples : f.statistics.samplesPerPixel;
    picture->width = covers ? whole.width() : settings.width;
    picture->height = covers ? whole.height() : settings.height;
    picture->rgb.resize(3 * static_cast<std::size_t>(picture->width) * static_cast<std::size_t>(picture->height));
    const auto& before = picture_;
    const bool under = before && before->frameWidth == settings.width && before->frameHeight == settings.height &&
                       before->space == settings.space;
    const int step = covers ? 1 : f.cell; // of pixels of the data
    parallelFor(static_cast<std::size_t>(picture->height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        float* out = &picture->rgb[3 * row * static_cast<std::size_t>(picture->width)];
        for (int x = 0; x < picture->width; ++x, out += 3) {
            const int u = x / step, v = y / step;
            const bool inside = u >= b.x0 && u < b.x1 && v >= b.y0 && v < b.y1;
            if (inside && f.film.samples(u, v) > 0) {
                const auto i = static_cast<std::size_t>(v - b.y0) * static_cast<std::size_t>(b.width()) +
                               static_cast<std::size_t>(u - b.x0);
                out[0] = image.r[i];
                out[1] = image.g[i];
                out[2] = image.b[i];
            } else if (under) {
                std::copy_n(before->at(x * cell, y * cell), 3, out);
            }
        }
    });
    return picture;
}

} // namespace abbe
