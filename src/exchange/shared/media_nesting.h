// What other programs say of the medium around a shape, and whether a scene of ours has that there. In Mitsuba and pbrt
// a surface that states media sets the medium of a ray that passes or leaves it. Here a medium fills a closed shape or,
// as an atmosphere, everything; a shape in another one has the media of both, but for dielectrics in dielectrics.
#pragma once

#include "exchange/shared/import.h"
#include "math/bounds.h"

#include <optional>
#include <string>
#include <vector>

namespace abbe::exchange {

// A shape that states a medium on at least one of its sides.
struct FilledShape {
    enum class Surface : std::uint8_t { opaque, boundary, dielectric };
    std::string name; // as messages call it
    Span span;
    Surface surface = Surface::opaque;
    const void* inside = nullptr;  // whatever identifies a medium; null: none
    const void* outside = nullptr; // the same
    bool isFilled = false;         // the scene has its medium inside
    std::optional<Bounds3d> box;   // in the world; nothing where it is not known, as in objects that are instanced
};

class MediaNesting {
  public:
    void note(FilledShape);
    // Whether a shape that has the medium inside holds the point, by its box: then the medium needs no atmosphere.
    bool isHeldAt(const void* medium, Vec3d point) const;
    // Says where the scene, whose atmosphere is the medium or null, has other media than were stated. `property` is
    // what states the outside, for messages.
    void report(const void* atmosphere, const std::string& property, Import&) const;

  private:
    std::vector<const FilledShape*> around(const FilledShape&) const;
    void reportOutside(const FilledShape&, const std::vector<const FilledShape*>& around, const std::string& property,
                       Import&) const;

    std::vector<FilledShape> shapes_;
    std::vector<std::size_t> filled_; // of these
};

} // namespace abbe::exchange
