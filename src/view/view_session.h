// One live view: its scene, its render, its files, and what a page asks of them, whatever way it asks.
#pragma once

#include "app/console.h"
#include "app/json.h"
#include "view/file_watch.h"
#include "view/view_pictures.h"
#include "view/view_tev.h"

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace abbe {

// What `abbe view` was asked for.
struct ViewRequest {
    SceneInput input;
    BuildOptions build;
    ViewOptions view;
    std::string commandLine;       // for the headers of snapshots
    int port = 0;                  // 0: a free one
    bool open = false;             // the page, in the browser of whoever runs the program
    std::optional<TevAddress> tev; // where the picture is shown, too
};

struct ProbeQuery {
    int x = 0, y = 0;      // pixel of the frame
    bool spectrum = false; // takes samples of the pixel, some tenths of a second
};

// What to do when tev does not listen.
inline constexpr const char* kTevHelp = "start tev, where it listens at port 14158, or write `--tev=HOST:PORT`; the "
                                        "view goes on without it, and shows its picture there as soon as tev answers";

class ViewSession {
  public:
    // Begins to load and render. Throws IoError where there is no such view.
    explicit ViewSession(ViewRequest);
    ~ViewSession();
    ViewSession(const ViewSession&) = delete;
    ViewSession& operator=(const ViewSession&) = delete;

    // All of these from any thread. What cannot be done throws ViewFault.
    Json state() const;
    // A number that rises whenever something of the state may have changed.
    std::uint64_t changes() const;
    // Returns when it is no longer `seen`, or after the time.
    std::uint64_t waitForChange(std::uint64_t seen, double seconds);
    std::optional<ShownBytes> picture(const PictureQuery& query) { return pictures_.show(query); }
    // Nothing: the picture is not there yet.
    std::optional<Json> probe(const ProbeQuery&);
    // An order of a page: one of "camera", "region", "groups", "control", "other" and "snapshot", with its members as
    // JSON. The answer.
    Json order(std::string_view name, const std::string& body);
    static bool isOrder(std::string_view name);
    // Why tev, which was asked for, does not have the picture at this time; empty: nothing is known to be in the way.
    std::string tevAbsence() const { return tev_ ? tev_->absence() : std::string(); }

  private:
    struct Orders; // view_orders.cpp
    Json cameraState(const LiveReport&) const;
    Json sceneState() const;
    Json denoisersState(std::string& missing) const;
    std::vector<ViewDiagnostic> allDiagnostics(const LiveReport&) const;
    std::string replayCommand() const;
    std::vector<ViewDiagnostic> warningsOf(const RestingFilm&) const;
    Json snapshot();
    std::string nextSnapshot(std::uint64_t& number) const; // path without an extension
    std::vector<ImageAttribute> snapshotHeader(const RestingFilm&, const LiveReport&, double noise) const;
    void moveCamera(const std::function<CameraPose(const CameraPose&)>&);
    void loaded(const LoadOutcome&);
    void changed();

    const ViewRequest request_;
    LiveScene scene_;
    LiveRender render_;
    ViewPictures pictures_;
    std::unique_ptr<ViewTev> tev_; // null: not asked for
    std::string absence_;          // of tev, as it was told last
    // Denoisers that can be used, and why others cannot: asked for once, and again after a save, since asking looks for
    // libraries.
    mutable std::mutex denoisersMutex_;
    mutable std::uint64_t denoisersOf_ = ~std::uint64_t{0}; // number of saves
    mutable Json denoisers_;
    mutable std::string denoiserMissing_;
    std::string other_;                        // path as the page gave it
    mutable std::mutex mutex_;                 // of `other_`, `absence_` and what follows
    std::vector<std::filesystem::path> known_; // files of the last scene without errors
    std::condition_variable changed_;
    std::uint64_t changes_ = 0;
    std::mutex writing_; // one snapshot at a time
    FileWatch watch_;    // the first to go
};

} // namespace abbe
