// The render of a live view: begins anew whenever the scene, the camera or the region changes, and shows at once what
// it has: first an eighth of the resolution, then finer pictures, then samples as `abbe render` takes them.
#pragma once

#include "base/stopwatch.h"
#include "base/work_clock.h"
#include "film/pixel_film.h"
#include "render/render_state.h"
#include "view/live_scene.h"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace abbe {

// A picture as it was at one moment: linear RGB of the film's space with the camera's exposure, interleaved, row by
// row. Of a rough one a pixel stands for a square of `cell` pixels of the frame.
struct LivePicture {
    std::uint64_t version = 0;
    int width = 0, height = 0;           // of this data
    int frameWidth = 0, frameHeight = 0; // of the whole frame
    int cell = 1;
    std::uint64_t samples = 0; // per pixel
    OutputSpace space = OutputSpace::aces2065_1;
    std::vector<float> rgb;

    // Of the pixel of the frame, or of the cell that it is in.
    const float* at(int x, int y) const {
        const int column = std::min(x / cell, width - 1), row = std::min(y / cell, height - 1);
        return &rgb[3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                         static_cast<std::size_t>(column))];
    }
};

// What a view renders into: one for each step from rough to fine.
struct LiveFilm {
    int cell;
    RenderSettings settings;
    PixelFilm film;
    RenderState state;
    RenderStatistics statistics = {};
};

// A film with nobody at work on it, and the scene that it shows, for the time of a call.
struct RestingFilm {
    LiveShot& shot;
    LiveFilm& film;
    const CameraPose& pose;
    bool moved; // the camera, away from where the scene has it
};

enum class LiveStatus : std::uint8_t { loading, rendering, paused, done, error };

struct CurvePoint {
    double seconds = 0, samples = 0, noise = 0;
};

// All that a page is told about a render.
struct LiveReport {
    LiveStatus status = LiveStatus::loading; // error: what was saved last cannot be rendered
    std::uint64_t saves = 0;                 // times that the scene was read
    bool stale = false;                      // the picture is of an older save, since this one has errors
    std::vector<ViewDiagnostic> diagnostics; // of the scene, and of its render so far
    int width = 0, height = 0;
    std::optional<PixelBounds> region;
    std::uint64_t samples = 0, goal = 0; // per pixel
    double noise = 0;                    // relative; 0: unknown
    double elapsed = 0, left = -1;       // s; left < 0: unknown
    std::vector<CurvePoint> curve;
    CameraPose pose;
    bool moved = false;
    double stops = 0;                                                             // exposure of the camera
    double readSeconds = 0, buildSeconds = 0, commitSeconds = 0, firstPixels = 0; // s; 0: not yet
    std::vector<std::string> layers; // of the film, as its image names them
    std::vector<std::string> groups; // of lights
    ReuseCounters reuse;             // of the last building
};

class LiveRender {
  public:
    // `changed` is called from any thread, often, without locks of this object.
    LiveRender(LiveScene& scene, std::function<void()> changed);
    ~LiveRender();
    LiveRender(const LiveRender&) = delete;
    LiveRender& operator=(const LiveRender&) = delete;

    // Reads the scene and begins.
    void start();
    // For good. What is asked for from then on is not done.
    void end();

    // From any thread; none waits for the render.
    void reload();
    void moveTo(const CameraPose&);
    void resetCamera();
    void setRegion(std::optional<PixelBounds>); // within the frame; of the present picture, else it is left alone
    void pause(bool);
    void restart();
    void setGoal(std::uint32_t samples); // of this view, whatever the scene says
    void keepPicture();                  // as the one to compare with

    LiveReport report() const;
    std::shared_ptr<const LivePicture> picture() const; // null: none yet
    std::shared_ptr<const LivePicture> saved() const;   // the last one before what was rendered last began
    std::shared_ptr<const LiveShot> shot() const;       // its immutable parts; null: none yet
    // Calls with the film at rest, which takes until the threads are between two portions of work. False if there is
    // none yet, or if it does not come to rest for some seconds, as while pilots are at work.
    bool whileResting(const std::function<void(RestingFilm&)>&);

    // Called with each picture before anybody gets it, by the thread of the view, while its film rests.
    std::function<void(RestingFilm&, const std::shared_ptr<const LivePicture>&)> onPublish;
    // Likewise with the last picture of a render that has come to its end. What it returns is told beside what the
    // scene was told of, until another picture begins.
    std::function<std::vector<ViewDiagnostic>(RestingFilm&, const std::shared_ptr<const LivePicture>&)> onEnd;
    // Called from the thread of the view when a scene was read: the files to be followed from now on.
    std::function<void(const LoadOutcome&)> onLoad;
    // Of all threads so far. Requires a film, which rests.
    WorkReading work() { return clock_->read(); }
    double seconds() const { return whole_.seconds(); }

  private:
    struct Orders {
        bool end = false, reload = true, restart = false, goal = false;
    };
    void run();
    bool next(Orders&); // false: it is to end
    void order(const std::function<void(Orders&)>&, bool atOnce);
    void follow(const Orders&);
    void fail(const char* code, std::string message, std::string help);
    void load();
    void adopt(LoadOutcome&);
    void begin();
    void takeGoal();
    void beginStage();
    void renderStage();
    void stageEnded(const RenderStatistics&);
    void placeCamera(int cell);
    void meter(LiveShot&);
    bool lendStops(LiveShot&);
    void meterLate();
    void requireRoom(const PixelBounds&, int replicates) const;
    void moveCamera(const std::optional<CameraPose>&);
    void publish();
    std::shared_ptr<LivePicture> compose() const;
    void letIn();
    void progress(const Progress&);
    void passEnded();
    void warnOfPaths(const FramePreview&);
    void tell(std::vector<ViewDiagnostic>);
    int firstCell(const PixelBounds&) const;
    bool isLastStage() const { return (film_ ? film_->cell : cell_) == 1; }
    double now() const { return earlier_ + run_.seconds(); } // s of rendering this picture

    LiveScene& scene_;
    std::function<void()> changed_;
    std::optional<WorkClock> clock_; // of the thread of the view
    const Stopwatch whole_;

    mutable std::mutex mutex_; // of the next ones
    std::condition_variable awake_;
    Orders orders_;
    LiveReport report_;
    std::vector<ViewDiagnostic> found_; // about the picture in hand
    bool paused_ = false, rendering_ = false;
    bool shown_ = false; // something of what was begun last
    std::optional<CameraPose> pose_;
    std::optional<PixelBounds> region_;
    std::optional<std::uint32_t> goal_;
    std::shared_ptr<LiveShot> shot_;
    std::shared_ptr<const LivePicture> picture_, saved_;

    std::timed_mutex resting_; // held while threads are at work on the film
    std::timed_mutex turnstile_;
    std::atomic<int> waiting_ = 0;
    std::atomic<bool> stop_ = false, rest_ = false; // of the render in hand

    // Of the thread of the view; with `resting_`, of whoever has the film.
    std::unique_ptr<LiveFilm> film_;
    std::unique_ptr<const Camera> movedCamera_; // null: the scene's own is where it was
    CameraPose shownPose_;
    bool shownMoved_ = false;
    bool metered_ = false;            // the exposure of the shot
    std::optional<double> lastStops_; // that metering found last
    int cell_ = 8;                    // of the next stage
    bool finished_ = false;           // all stages
    double secondsOfPixel_ = 0;       // of a sample of a pixel, from the first stage that was measured; 0: unknown
    double earlier_ = 0;              // s that this picture was rendered for before run_
    double nextPublication_ = 0;      // s, as now()
    Stopwatch run_, begun_;           // since the render went on; since the save or the move
    std::uint64_t versions_ = 0;
    std::thread thread_;
};

} // namespace abbe
