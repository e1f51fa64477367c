// A film as numbers: the picture, and row by row what is beside it.
#pragma once

#include "film/film_params.h"
#include "film/layer_planes.h"
#include "film/pixel_film.h"

#include <functional>
#include <optional>

namespace abbe {

// Fills the film's layers with those of some rows: where the film has not all of them at once.
using BringLayers = std::function<void(PixelBounds rows)>;

// `part`: some whole rows of the film, else all of it.
ResolvedImage resolveImage(const PixelFilm&, const FilmSettings&, double exposure,
                           std::optional<PixelBounds> part = {});

// The picture in the film's space, with the camera's exposure applied, and the channels beside it, which take more
// memory than it does and are made when they are written. Refers to film and settings; no thread may be adding.
class FilmPicture {
  public:
    // `origin`: world position of the origin of render space.
    FilmPicture(const PixelFilm&, const FilmSettings&, double exposure, Vec3d origin, BringLayers = {});

    // Of a film with light groups or components it has its last bits once all rows were made (layerPlanes()).
    ResolvedImage image;
    // What pixels without samples have in `image` is not the film's, and stays.
    bool painted = false;

    bool hasDeep() const { return film_.layers() && film_.layers()->deep(); }
    struct Rows {
        LayerPlanes layers;
        std::optional<DeepImage> deep;
    };
    // Rows [y0, y1) of the image's; as often as wanted. Of no rows: what channels there are, and their attributes.
    // Throws std::bad_alloc, and what the source of layers throws.
    Rows rows(int y0, int y1);

  private:
    void add(Rows&, PixelBounds);
    void take(const ResolvedImage& part);

    const PixelFilm& film_;
    const FilmSettings& settings_;
    LayerView view_;
    BringLayers bring_;
};

} // namespace abbe
