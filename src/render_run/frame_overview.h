// An animation at a glance: its contact sheet and its clip, from the images of its frames.
#pragma once

#include "app/console.h"
#include "app/program_end.h"
#include "base/stopwatch.h"
#include "pictures/contact_sheet.h"
#include "render_run/frame_clip.h"
#include "render_run/render_options.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace abbe {

// Frames come in the order of their list, as images that are read back: those that were there already are shown like
// those that were rendered. One that fails is a gap, a cross in the sheet and black in the clip. Nothing that goes
// wrong here ends the render of frames.
class FrameOverview {
  public:
    FrameOverview(const RenderOptions&, const CommonOptions&);

    // Whether what was asked for can be made; else says why not. Throws IoError if there is no such view.
    ExitCode check() const;
    // The next frame of the list.
    void add(const std::string& image);
    void fail();
    // Writes them, with what there is, and says so. False: not all that was asked for is there.
    bool end();

  private:
    void show(const std::string& image);
    void begin(const BytePicture& first, const std::string& image);
    void giveUp(const std::string& why);
    void writeSheet();
    void tell(const char* what, const std::string& path, std::size_t shown) const;
    bool wanted() const { return !options_.sheet.empty() || !options_.clip.empty(); }

    const RenderOptions& options_;
    const CommonOptions& common_;
    ExrViewer viewer_;
    std::unique_ptr<ContactSheet> sheet_;
    std::unique_ptr<FrameClip> clip_;
    std::size_t next_ = 0;  // position in the list
    std::size_t early_ = 0; // gaps before the first frame that is there
    std::vector<int> gaps_; // numbers
    bool complete_ = true;  // all that was asked for was made
    double sheetDue_ = 0;   // s
    Stopwatch watch_;
};

} // namespace abbe
