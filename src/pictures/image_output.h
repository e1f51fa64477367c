// From the film to files.
#pragma once

#include "base/diagnostic.h"
#include "film/film_params.h"
#include "io/exr_deep.h"
#include "io/exr_writer.h"
#include "pictures/display_view.h"
#include "pictures/film_picture.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace abbe {

// The picture for people beside an EXR.
struct PngOptions {
    bool off = false;   // none
    bool asked = false; // by `--png` or for a view: what stands in its way is an error, and else a warning
    bool named = false; // by `--png`: it replaces a file of another program
    std::string path;   // empty: named after the EXR
};

// Where the image goes: -o, else the film's `output`, else the scene's name with .exr; the last two are relative to the
// current directory like -o. `output`: of -o, or empty.
std::string imagePath(const std::string& output, const FilmSettings&, const std::string& scenePath);
// The EXR's name with .png, unless the options name one or ask for none.
std::string pngPath(const PngOptions&, const std::string& imagePath);
// Whether the name says that a file is a PNG: `.png` in any case.
bool isPngName(const std::string& path);
// Whether a file is there that is no PNG by this program: a texture, say, that must not be lost unasked.
bool isForeignPng(const std::string& path);

// Whether a file can be written there, found out before hours are spent on it; tries, and leaves nothing behind.
// The reason, or empty.
std::string writeFault(const std::string& path);

// Where the deep samples of an image go: x.deep.exr beside x.exr.
std::string deepPath(const std::string& imagePath);
// Whether a file is there that is no deep image by this program, and must not be lost unasked.
bool isForeignDeep(const std::string& path);

// With the deep image, if there is one; both row by row. Throws IoError, and what the picture's source of layers
// throws. Warnings (values that half floats cannot hold, channels left out) go to the list.
void writeImage(const std::string& path, FilmPicture&, const FilmSettings&, std::vector<ImageAttribute>, Diagnostics&);

// A whole image in memory: all that files of it hold, whoever the film belonged to.
struct HeldImage {
    ResolvedImage image; // R G B in the film's space, and the variance of Y
    std::vector<NamedPlane> layers;
    std::optional<DeepPicture> deep;
    FilmSettings film;
    std::vector<ImageAttribute> attributes; // all of them, those of layers among them
    std::size_t unequalSums = 0;            // LayerPlanes::unequalSums
};
// What writeImage() would write, and throws.
HeldImage holdImage(FilmPicture&, const FilmSettings&, std::vector<ImageAttribute>);
// The files that writeImage() would have written, but for when. Throws IoError.
void writeImage(const std::string& path, const HeldImage&, Diagnostics&);

// `rgb`: interleaved, linear, in `space`. Throws IoError.
struct DisplayPicture {
    int width = 0, height = 0;
    std::vector<float> rgb;
    OutputSpace space = OutputSpace::aces2065_1;
};
// Leaves the pixels within `display`, of those of `window`; all if there are none.
void cutOut(DisplayPicture&, const PixelWindow& window, const PixelWindow& display);
void writeDisplayPng(const std::string& path, DisplayPicture, const ViewOptions&, int bits);
// What a PNG of this program tells of the view that made it, by keywords.
std::vector<std::pair<std::string, std::string>> pngTexts(const DisplayView&, double exposure);

} // namespace abbe
