// A scene as its file states it: definitions with their values checked, in SI units and with defaults, before anything
// is built of them. Writers of other formats read scenes in this way, since what is built has lost its parameters.
#pragma once

#include "base/diagnostic.h"
#include "math/motion.h"
#include "schema/scene_tree.h"
#include "spectrum/curve.h"

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::exchange {

// A spectrum that remembers how it was written. Metals have two of the same name: n (role index) and k (unbounded).
class StatedCurve final : public Curve {
  public:
    StatedCurve(schema::SpectrumValue value, schema::SpectrumRole use, const Curve& made)
        : stated(std::move(value)), role(use), curve_(made) {}

    Spectrum at(const Wavelengths& w) const override { return curve_.at(w); }
    double at(double nm) const override { return curve_.at(nm); }
    bool isConstant() const override { return curve_.isConstant(); }
    double minimum() const override { return curve_.minimum(); }
    double maximum() const override { return curve_.maximum(); }
    const Curve& curve() const { return curve_; }

    const schema::SpectrumValue stated;
    const schema::SpectrumRole role;

  private:
    const Curve& curve_;
};

class StatedThing;
class StatedScene;

// At most one of both; neither where the scene states none and there is no default.
struct StatedSpectrum {
    const StatedCurve* curve = nullptr;
    const StatedThing* texture = nullptr;
    explicit operator bool() const { return curve || texture; }
};

struct StatedNumber {
    double value = 0; // SI
    const StatedThing* texture = nullptr;
};

// One definition: of its properties those that the scene states, and defaults. Values of the block behind a property
// are called `property.value`. Whatever is asked for counts as used, so that a writer knows what it has not written.
class StatedThing {
  public:
    // Times of the blocks `at TIME { … }` of a shape or camera, in s, whose values are lists of as many: `at.points`.
    static constexpr std::string_view kMoments = "at.time";
    // Likewise those of the keys of a transform.
    static constexpr std::string_view kTransformTimes = "transform.time";
    schema::Kind kind = schema::Kind::shape;
    std::string name; // empty: unnamed
    std::string type;
    std::string target; // of instances: the object's name
    Span span;

    bool has(std::string_view property) const; // stated, not by default
    double number(std::string_view property, double otherwise) const;
    std::optional<double> number(std::string_view property) const;
    const schema::Quantity* quantity(std::string_view property) const;
    std::optional<Vec3d> vector(std::string_view property) const;
    std::optional<Vec2d> pair(std::string_view property) const;
    std::string word(std::string_view property) const; // of choices, texts and files (their path); `on` and `off`
    StatedNumber textured(std::string_view property, double otherwise) const;
    StatedSpectrum spectrum(std::string_view property) const;
    // Values at positions, rising: `stop 0.5 rgb 1 0 0`.
    std::vector<std::pair<double, StatedSpectrum>> stops(std::string_view property) const;
    const StatedThing* reference(std::string_view property) const;
    template <typename T> const T* value(std::string_view property) const {
        const auto* const all = find(property);
        return all ? std::get_if<T>(&all->front()) : nullptr;
    }
    // All values of a property that may be repeated.
    const std::vector<schema::BoundValue>* find(std::string_view property) const;

    // Whether texture coordinates count: a texture (or a highlight that is stretched along them), in it or what it
    // refers to. Nothing is used by asking.
    bool usesCoordinates(bool alsoStretched, int depth = 0) const;

    // Whether where a point is counts: a texture in the space of the shape, in it or what it refers to. Likewise.
    bool usesPosition(int depth = 0) const;

    struct Unused {
        std::string property;
        Span span;
    };
    // Stated properties that nobody has asked for; each is told once.
    std::vector<Unused> takeUnused() const;

  private:
    friend class StatedScene;
    std::map<std::string, std::vector<schema::BoundValue>, std::less<>> values_;
    std::map<std::string, Span, std::less<>> given_;
    mutable std::set<std::string, std::less<>> used_;
    const StatedScene* scene_ = nullptr;
    std::uint32_t index_ = 0; // of the scene's things
};

// Something that is seen, in the space of the world or of an object.
struct Placed {
    const StatedThing* thing = nullptr; // null: an instance of `object`
    std::string object;
    Transform toWorld; // with the thing's own transform, at the camera's time
    bool moves = false;
    Motion motion;                      // the same at any time
    std::vector<double> times;          // s, of its keys, rising
    std::vector<std::string> visibleTo; // empty: everything
    Span span;
    const schema::Definition* definition = nullptr; // of `instances`, for StatedScene::places()
};

// Makes the curve of a value; null after a diagnostic.
using MakeCurve = std::function<const Curve*(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&)>;

// Where a definition `instances` puts its object, each place without the definition's own transform; null where that is
// not known. What is returned lives as long as the scene.
using FindPlaces = std::function<const std::vector<Transform>*(const schema::Definition&)>;

class StatedScene final : private schema::Resolver {
  public:
    // Requires a tree that can be built without errors. The tree and the table outlive this; so do the curves.
    // With `FindPlaces` all `instances` stay one thing each, whose places() can be asked for. Without it those of a
    // grid become instances by themselves, and of others nobody knows the places.
    StatedScene(const schema::SceneTree&, const schema::TypeTable&, MakeCurve, FindPlaces = {});
    ~StatedScene() override;

    const StatedThing* film() const { return film_; }
    const StatedThing* render() const { return render_; }
    const std::vector<const StatedThing*>& cameras() const { return cameras_; }
    const std::vector<Placed>& placed() const { return placed_; }
    const std::vector<Placed>& object(const std::string& name) const;
    // Of `instances` that stay one thing; null where they are not known.
    const std::vector<Transform>* places(const Placed& instances) const {
        return findPlaces_ && instances.definition ? findPlaces_(*instances.definition) : nullptr;
    }
    const StatedThing* thing(schema::Reference r) const { return r.valid() ? &things_[r.index] : nullptr; }
    const StatedThing* atmosphere() const { return atmosphere_; } // its medium, or null
    Vec3d up() const { return zUp_ ? Vec3d(0, 0, 1) : Vec3d(0, 1, 0); }
    bool zUp() const { return zUp_; }
    Span span() const { return tree_.header.span; } // of what the scene does not state
    // m, of files that state none and that are named there
    double unit(Span at) const { return tree_.headerOf(at).length; }
    const StatedCurve& daylight() const { return *daylight_; } // illuminant D65, Y = 1

  private:
    friend class StatedThing;
    const StatedThing& bound(const schema::Definition&);
    const StatedThing& named(const schema::Definition&);
    void collect(const std::vector<schema::Definition>&, const Placed& outer, const std::vector<std::string>& visible,
                 std::vector<Placed>&);
    void place(const schema::Definition&, const Placed& outer, const std::vector<std::string>&, std::vector<Placed>&);
    static bool placeGrid(const Placed&, std::vector<Placed>&);
    KeyedTransform transformOf(const schema::Definition&) const;

    const Curve* curve(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&) override;
    schema::ComplexIndex metal(std::string_view, Span, Diagnostics&) override;
    schema::Reference reference(const schema::Definition&, Diagnostics&) override;
    const Texture* texture(const schema::TextureRequest&, Diagnostics&) override;

    const schema::SceneTree& tree_;
    schema::TypeTable table_; // of types that store values by name
    MakeCurve makeCurve_;
    FindPlaces findPlaces_;
    std::deque<StatedThing> things_;
    std::map<std::pair<schema::Kind, std::string>, const StatedThing*> named_;
    std::deque<StatedCurve> curves_;
    std::deque<std::unique_ptr<const Curve>> metals_;
    std::map<std::string, std::vector<Placed>> objects_;
    std::vector<Placed> placed_;
    std::vector<const StatedThing*> cameras_;
    const StatedThing *film_ = nullptr, *render_ = nullptr, *atmosphere_ = nullptr;
    const StatedCurve* daylight_ = nullptr;
    double time_ = 0; // when the shutter opens
    bool zUp_ = false;
    Diagnostics repeated_; // what building the scene has reported already
};

} // namespace abbe::exchange
