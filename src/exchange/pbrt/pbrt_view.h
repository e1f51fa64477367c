// How a pbrt scene is looked at: camera, film, filter, sampler and integrator become camera, film and render.
#pragma once

#include "exchange/pbrt/pbrt_shared.h"
#include "exchange/pbrt/pbrt_state.h"

#include <string>

namespace abbe::exchange {

class PbrtView {
  public:
    explicit PbrtView(PbrtShared& shared);

    // The directives before WorldBegin. Each keeps what it says; the last of a kind counts.
    struct Said {
        std::string type;
        PbrtParams params;
        std::string colorSpace = "srgb";
    };
    void camera(Said, const PbrtState&); // says which way the world is turned
    Said film, filter, sampler, integrator, accelerator;
    int seed = 0; // of `Option`

    // The medium around the camera, or an empty name.
    const std::string& mediumName() const { return medium_; }
    // Where it is when the motion begins, in the world.
    Vec3d eye() const { return worldFromCamera_.at[0].t; }
    // When all is said: writes the settings.
    void finish(double firstTime, double lastTime);

  private:
    struct Frame { // the film's proportions as the camera sees them
        double left, right, bottom, top;
    };
    Frame screen();
    void size();
    void perspective(SceneNode&);
    void orthographic(SceneNode&);
    void spherical(SceneNode&);
    void realistic(SceneNode&);
    void lens(SceneNode&);
    void place(SceneNode&, double firstTime, double lastTime);
    void filmNode(SceneNode&);
    void crop(SceneNode&);
    void sensor(SceneNode&);
    void filterNode(SceneNode& film);
    void renderNode();
    double cameraScale();

    PbrtShared& shared_;
    Said camera_;
    PbrtMotion worldFromCamera_;
    std::string medium_;
    int width_ = 1280, height_ = 720;
    double exposure_ = 1; // factor of the pixels
};

} // namespace abbe::exchange
