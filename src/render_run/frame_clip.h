// The frames of an animation as a film, by ffmpeg.
#pragma once

#include "base/process.h"
#include "io/file.h"
#include "pictures/byte_picture.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace abbe {

// Whether it ends like a kind of file that clips can be.
bool isClipName(const std::string& path);
// What keeps a clip from being made, found out before hours are spent: its folder, and whether ffmpeg is there with its
// encoder, which is tried. Throws CodedFault.
void checkClip(const std::string& path);

// Starts ffmpeg, found on the PATH, and gives it frame after frame; the file appears under its name when all of it is
// there. H.264 at 4:2:0, so that everything plays it; odd sizes get a row or column of black.
class FrameClip {
  public:
    // `fps`: frames of a second. `srgb`: the bytes are sRGB-encoded, and are tagged so. Throws IoError.
    FrameClip(const std::string& path, int width, int height, double fps, bool srgb);
    FrameClip(const FrameClip&) = delete;
    FrameClip& operator=(const FrameClip&) = delete;

    // One of another size is made to fit. Throws IoError with what ffmpeg says when it takes no more.
    void add(const BytePicture&);
    void addBlack();
    std::size_t frames() const { return frames_; }
    // The file is there. Throws IoError.
    void finish();

  private:
    [[noreturn]] void fail(const ProcessEnd&);

    std::string path_;
    int width_, height_;
    AtomicFile file_;
    std::optional<FedProcess> ffmpeg_;
    std::size_t frames_ = 0;
};

} // namespace abbe
