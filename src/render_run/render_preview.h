// Pictures to look at while a render goes on: a file, and the viewer tev.
#pragma once

#include "base/stopwatch.h"
#include "pictures/image_output.h"
#include "render/integrator.h"
#include "tev/tev_image.h"

#include <string>
#include <vector>

namespace abbe {

// A PNG beside the image, in its colours as a view shows them: first the look at the frame, in cells, then the film,
// each time when half as long again has passed and never for more than a twentieth of the time. Nothing hangs on it:
// where it cannot be written there is none. The image itself is not touched, since an older one is to survive a
// render that is left at once. Used from one thread.
class RenderPreview {
  public:
    struct How {
        std::string image; // its path
        FilmSettings film;
        double exposure = 1; // of the camera, a factor
        ViewOptions view;
        double samples = 0;     // of a pixel in the whole render
        double mostSeconds = 0; // the render's time limit; 0: none
        bool mayTrace = false;  // light paths, which take a multiple
    };
    explicit RenderPreview(How);
    // Removes the file.
    ~RenderPreview();
    RenderPreview(const RenderPreview&) = delete;
    RenderPreview& operator=(const RenderPreview&) = delete;

    // "room.preview.png" for "room.exr".
    const std::string& path() const { return path_; }
    // Whether it was written, here and below; not if the image will be there as soon. No thread may be at work on the
    // film.
    bool show(const FramePreview&);
    // Only after a look was shown.
    bool show(const PixelFilm&);

  private:
    bool write(DisplayPicture);

    How how_;
    std::string path_;
    bool shown_ = false;
    double due_ = 0; // s after the start
    Stopwatch watch_;
};

// The film in tev: its picture as linear RGB of Rec. 709, which is what tev takes numbers for, and the film's layers
// under their names, colours among them converted likewise. Takes no more than a twentieth of the time, but for the
// last picture, and nothing while tev does not listen. Used from one thread.
class TevFilm {
  public:
    struct How {
        TevAddress address;
        std::string name; // of the image in tev
        FilmSettings film;
        double exposure = 1; // of the camera, a factor
        Vec3d origin;        // world position of the origin of render space
    };
    // The film tells bounds and layers.
    TevFilm(How, const PixelFilm&);

    // No thread may be at work on the film, here and below.
    void show(const FramePreview&);
    void show(const PixelFilm&);
    // The last picture, as the file has it. Waits for tev for a while, as TevImage::finish() does.
    void finish(FilmPicture&);
    // As TevImage::takeWarning().
    std::string takeWarning() { return image_.takeWarning(); }

  private:
    void send(FilmPicture&);

    How how_;
    PixelBounds bounds_;
    std::vector<std::string> channels_;
    TevImage image_;
    double due_ = 0; // s after the start
    Stopwatch watch_;
};

// Cells in linear colours of the film: each a square of as many pixels as it has in the image, but fewer if that would
// be wider than `most`.
DisplayPicture pictureOf(const FramePreview&, const FilmSettings&, double exposure, int most);

// Paints pixels without samples as they looked at first. The number of them.
std::size_t paintMissing(ResolvedImage&, const PixelFilm&, const FramePreview&, const FilmSettings&, double exposure);

} // namespace abbe
