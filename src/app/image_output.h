// From the film to files.
#pragma once

#include "app/options.h"
#include "base/diagnostic.h"
#include "film/film_params.h"
#include "film/pixel_film.h"
#include "io/exr_writer.h"

#include <string>
#include <vector>

namespace abbe {

// Where the image goes: -o, else the film's `output`, else the scene's name with .exr; the last two are relative to the
// current directory like -o.
std::string imagePath(const RenderOptions&, const FilmSettings&);
// The EXR's name with .png, unless the option names one.
std::string pngPath(const RenderOptions&, const std::string& imagePath);

// Whether a file can be written there, found out before hours are spent on it; tries, and leaves nothing behind.
// The reason, or empty.
std::string writeFault(const std::string& path);

// The pixels in the film's space, with the camera's exposure applied.
ResolvedImage resolveImage(const PixelFilm&, const FilmSettings&, double exposure);

// Throws IoError. Warnings (values that half floats cannot hold, channels left out) go to the list.
void writeImage(const std::string& path, const ResolvedImage&, const FilmSettings&, std::vector<ImageAttribute>,
                Diagnostics&);

// `rgb`: interleaved, linear, in `space`. Throws IoError.
struct DisplayPicture {
    int width = 0, height = 0;
    std::vector<float> rgb;
    OutputSpace space = OutputSpace::aces2065_1;
};
void writeDisplayPng(const std::string& path, DisplayPicture, const ViewOptions&, int bits);

// Name for people: "ACES2065-1", "ACEScg".
std::string_view spaceName(OutputSpace);

} // namespace abbe
