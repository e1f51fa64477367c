// What is told of a finished picture, in words and for programs.
#pragma once

#include "app/json.h"
#include "cameras/exposure.h"
#include "pictures/picture_figures.h"

#include <string>

namespace abbe {

// "picture median 12.3 nits, 99 % of it up to 840 nits   display 2.1 % below 1 %, 0.4 % above 99 %".
std::string pictureLine(const PictureFigures&);
// How to look at a PNG: "to look at it:  xdg-open room.png" where there is a screen, else where the file is.
std::string viewingLine(const std::string& png);
// The figures, and the exposure that the picture has.
Json pictureJson(const PictureFigures&, const Exposure&);

} // namespace abbe
