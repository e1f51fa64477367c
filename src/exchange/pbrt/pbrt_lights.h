// `LightSource` of pbrt scenes: lights at points, far away and all around.
#pragma once

#include "exchange/pbrt/pbrt_spectrum.h"
#include "exchange/pbrt/pbrt_state.h"

namespace abbe::exchange {

class PbrtLights {
  public:
    explicit PbrtLights(PbrtShared& shared) : shared_(shared) {}

    // In our own world, whatever way pbrt's is turned.
    void add(const std::string& type, const PbrtParams&, const PbrtState&);

  private:
    struct Making; // one light

    void point(Making&);
    void spot(Making&);
    void distant(Making&);
    void infinite(Making&);
    void infiniteImage(Making&, const std::string& file);
    void portals(Making&);
    void goniometric(Making&);
    void projection(Making&);
    // Lights of IES files, one for each colour of `image`, by the intensity that `at` gives for directions in the
    // light's own space.
    template <typename At> void measured(Making&, std::string_view stem, Vec3d colour, const At& at);

    PbrtShared& shared_;
};

} // namespace abbe::exchange
