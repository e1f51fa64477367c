// pbrt's scene description as it is: a list of commands that change a state. Reads files, keeps the state, and gives
// what is described to those who make nodes of it.
#pragma once

#include "exchange/pbrt/pbrt_lights.h"
#include "exchange/pbrt/pbrt_scanner.h"
#include "exchange/pbrt/pbrt_shapes.h"
#include "exchange/pbrt/pbrt_view.h"

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace abbe::exchange {

class PbrtMachine {
  public:
    explicit PbrtMachine(PbrtShared&);

    // Reads a whole file. Throws PbrtOldScene.
    void run(const std::filesystem::path&);
    // After the last file: what is open, and the settings.
    void finish();

  private:
    struct Block { // that a directive opened
        enum class Kind : unsigned char { attribute, transform, object };
        Kind kind;
        Span begin;
        PbrtState saved;
    };
    using Action = void (PbrtMachine::*)(PbrtScanner&, const PbrtToken&);
    static const std::map<std::string_view, Action>& actions();

    void runText(std::string_view text, FileId);
    void directive(PbrtScanner&, const PbrtToken&);

    // What stands behind a directive. All of them report what is wrong and return nothing or false then.
    std::optional<std::string> name(PbrtScanner&, const PbrtToken& word, const char* what);
    bool numbers(PbrtScanner&, const PbrtToken& word, std::span<double>);
    bool params(PbrtScanner&, PbrtParams&, std::string_view attributes);
    bool param(PbrtScanner&, PbrtParam&);
    bool value(PbrtScanner&, PbrtParam&, const PbrtToken&);
    std::optional<PbrtView::Said> said(PbrtScanner&, const PbrtToken& word);
    void syntax(Span, std::string message);
    bool inWorld(const PbrtToken& word, bool wanted);

    // The directives.
    void identity(PbrtScanner&, const PbrtToken&);
    void translate(PbrtScanner&, const PbrtToken&);
    void scale(PbrtScanner&, const PbrtToken&);
    void rotate(PbrtScanner&, const PbrtToken&);
    void lookAt(PbrtScanner&, const PbrtToken&);
    void matrix(PbrtScanner&, const PbrtToken&);
    void coordinateSystem(PbrtScanner&, const PbrtToken&);
    void activeTransform(PbrtScanner&, const PbrtToken&);
    void transformTimes(PbrtScanner&, const PbrtToken&);
    void reverseOrientation(PbrtScanner&, const PbrtToken&);
    void begin(PbrtScanner&, const PbrtToken&);
    void end(PbrtScanner&, const PbrtToken&);
    void objectBegin(PbrtScanner&, const PbrtToken&);
    void objectInstance(PbrtScanner&, const PbrtToken&);
    void worldBegin(PbrtScanner&, const PbrtToken&);
    void include(PbrtScanner&, const PbrtToken&);
    void option(PbrtScanner&, const PbrtToken&);
    void attribute(PbrtScanner&, const PbrtToken&);
    void colorSpace(PbrtScanner&, const PbrtToken&);
    void view(PbrtScanner&, const PbrtToken&);
    void material(PbrtScanner&, const PbrtToken&);
    void namedMaterial(PbrtScanner&, const PbrtToken&);
    void namedMedium(PbrtScanner&, const PbrtToken&);
    void mediumInterface(PbrtScanner&, const PbrtToken&);
    void texture(PbrtScanner&, const PbrtToken&);
    void light(PbrtScanner&, const PbrtToken&);
    void areaLight(PbrtScanner&, const PbrtToken&);
    void shape(PbrtScanner&, const PbrtToken&);
    void oldDirective(PbrtScanner&, const PbrtToken&);

    void applyMatrix(const Transform&, bool replace, Span);

    PbrtShared& shared_;
    PbrtTextures textures_;
    PbrtMaterials materials_;
    PbrtMedia media_;
    PbrtShapes shapes_;
    PbrtLights lights_;
    PbrtView view_;

    PbrtState state_;
    std::vector<Block> blocks_;
    std::map<std::string, PbrtMotion, std::less<>> coordinateSystems_;
    struct Object {
        std::string word;
        std::list<SceneNode> nodes;
    };
    std::map<std::string, Object, std::less<>> objects_;
    Object* object_ = nullptr; // that is being made
    std::vector<std::shared_ptr<const PbrtParams>> areaLights_;
    double firstTime_ = 0, lastTime_ = 1;
    bool inWorld_ = false;

    std::vector<std::filesystem::path> open_; // files, from the main one on
    std::map<std::filesystem::path, FileId> files_;
    std::size_t fileCount_ = 0, bytes_ = 0; // read so far, again and again
};

} // namespace abbe::exchange
