#include "view/view_session.h"

#include "view/live_scene.h"

#include <chrono>

namespace abbe {

ViewSession::ViewSession(ViewRequest request)
    : request_(std::move(request)), scene_(request_.input, request_.build), render_(scene_, [this] { changed(); }),
      pictures_(render_, request_.view), watch_([this] { render_.reload(); }) {
    if (request_.tev) {
        tev_ = std::make_unique<ViewTev>(*request_.tev, request_.input.path);
        render_.onPublish = [this, shown = render_.onPublish](RestingFilm& resting, const auto& picture) {
            shown(resting, picture);
            tev_->show(resting, *picture, false);
        };
    }
    render_.onEnd = [this](RestingFilm& resting, const auto& picture) {
        if (tev_) tev_->show(resting, *picture, true);
        return warningsOf(resting);
    };
    render_.onLoad = [this](const LoadOutcome& outcome) { loaded(outcome); };
    render_.start();
}

// The render tells the watch which files to follow, and the watch the render that they changed.
ViewSession::~ViewSession() { render_.end(); }

// After errors the files of the scene that is still shown count, too: it may have been one of them.
void ViewSession::loaded(const LoadOutcome& outcome) {
    auto files = outcome.files;
    {
        const std::lock_guard lock(mutex_);
        if (outcome.shot)
            known_ = outcome.files;
        else
            files.insert(files.end(), known_.begin(), known_.end());
    }
    watch_.follow(files, outcome.begun, outcome.folders);
}

void ViewSession::changed() {
    {
        const std::lock_guard lock(mutex_);
        ++changes_;
    }
    changed_.notify_all();
}

std::uint64_t ViewSession::changes() const {
    const std::lock_guard lock(mutex_);
    return changes_;
}

std::uint64_t ViewSession::waitForChange(std::uint64_t seen, double seconds) {
    const std::string absence = tevAbsence(); // tev tells nobody that it comes or goes
    std::unique_lock lock(mutex_);
    if (absence_ != absence) {
        absence_ = absence;
        ++changes_;
    }
    changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return changes_ != seen; });
    return changes_;
}

} // namespace abbe
