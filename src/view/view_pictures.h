// Pictures of a view as a display shows them: of the render, its layers and light groups, denoised, and of files.
#pragma once

#include "denoise/denoise.h"
#include "pictures/display_view.h"
#include "view/live_render.h"

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace abbe {

// What cannot be done for a page, in words for who looks at it.
struct ViewFault : std::runtime_error {
    explicit ViewFault(const std::string& message, std::string advice = {})
        : std::runtime_error(message), help(std::move(advice)) {}
    std::string help;
};

// That a page can choose from, the best one first.
inline constexpr DenoiseMethod kViewDenoisers[] = {DenoiseMethod::nfor, DenoiseMethod::preview, DenoiseMethod::oidn};

enum class PictureSource : std::uint8_t { live, saved, other };

struct PictureQuery {
    PictureSource source = PictureSource::live;
    std::string layer;                    // empty: the picture
    double exposure = 0;                  // stops on top of the camera's
    std::string view;                     // of OpenColorIO; empty: the one that the view was begun with
    std::optional<DenoiseMethod> denoise; // of the picture
    int most = 0;                         // of either side in pixels; 0: as it is
};

// Four bytes a pixel, R G B and 255, row by row from the top.
struct ShownBytes {
    std::shared_ptr<const LivePicture> of; // without its numbers
    int width = 0, height = 0;
    std::vector<char> rgba;
};

// Weights of light groups by name; those that are not named have 1.
using GroupWeights = std::map<std::string, double>;

class ViewPictures {
  public:
    // Throws IoError where there is no such view.
    ViewPictures(LiveRender& render, ViewOptions view);

    // Nothing: there is none yet. Throws ViewFault.
    std::optional<ShownBytes> show(const PictureQuery&);

    // Throws ViewFault for names that are no groups.
    void weigh(const GroupWeights&);
    GroupWeights weights() const;
    // The picture of a file from now on; empty: none. Throws ViewFault.
    void setOther(const std::string& path);
    bool hasOther() const;

    const std::vector<std::string>& views() const { return views_; }
    const std::string& defaultView() const { return defaultView_; }
    const ViewOptions& options() const { return options_; }

  private:
    using Picture = std::shared_ptr<const LivePicture>;
    struct Shown {
        Picture picture;
        bool colours = true; // through the view; else as they are
    };
    Shown find(const PictureQuery&);
    Shown layer(const Picture& live, const std::string& name, double exposure);
    Picture weighed(const Picture& live, const GroupWeights&);
    Picture denoised(const Picture& live, DenoiseMethod);
    std::shared_ptr<const DisplayView> viewFor(OutputSpace, const std::string& view);
    template <typename Make> Picture cached(const std::string& key, const Picture& live, const Make& make);
    void takeVersion(std::uint64_t);
    void store(const std::string& key, const Picture&);
    void published(RestingFilm&, const Picture& live);

    LiveRender& render_;
    ViewOptions options_;
    std::vector<std::string> views_;
    std::string defaultView_;

    mutable std::mutex mutex_; // of the next ones
    GroupWeights weights_;
    std::uint64_t weighings_ = 0;
    Picture other_;
    std::map<std::pair<int, std::string>, std::shared_ptr<const DisplayView>> displays_;
    std::map<std::string, Picture> made_, older_; // what was made of the present picture, and of those before it
    std::uint64_t madeOf_ = 0;                    // its version
    std::string askedLayer_;                      // last
    double askedExposure_ = 0;
    Stopwatch askedFor_;
    std::mutex denoising_; // which takes all there is of memory and cores
};

} // namespace abbe
