// The picture of a view in the viewer tev, too.
#pragma once

#include "base/stopwatch.h"
#include "tev/tev_image.h"
#include "view/live_render.h"

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace abbe {

// What comes up in the view, from rough to fine, as linear RGB of Rec. 709 over the whole frame; of the film itself its
// layers as well, in no more than a twentieth of the time, and once more in the end. One image goes through all saves:
// it is made anew where the frame gets another size or the film other layers, and closed when the view ends. The view
// waits for tev at its end alone, for some seconds.
class ViewTev {
  public:
    // `name`: of the image in tev.
    ViewTev(TevAddress, std::string name);
    // TevImage::close().
    ~ViewTev();
    ViewTev(const ViewTev&) = delete;
    ViewTev& operator=(const ViewTev&) = delete;

    // With each picture, from one thread, while its film rests. `last`: all samples are taken.
    void show(const RestingFilm&, const LivePicture&, bool last);
    // Why tev does not have the picture at this time; empty: nothing is known to be in the way. Any thread.
    std::string absence() const;

  private:
    void shape(const RestingFilm&, const LivePicture&);
    void showPicture(const LivePicture&);
    void showFilm(const RestingFilm&);

    const TevAddress address_;
    const std::string name_;
    mutable std::mutex mutex_; // of the pointer
    std::unique_ptr<TevImage> image_;
    std::vector<std::string> channels_;
    std::uint64_t load_ = 0; // whose channels these are
    double due_ = 0;         // s, layers
    Stopwatch watch_;
};

} // namespace abbe
