// What building any part of a scene needs: the definitions, their spectra as curves, and where it is noted what they
// ask for.
#pragma once

#include "base/diagnostic.h"
#include "base/enclosure.h"
#include "scene/build.h"
#include "scene/instance_places.h"
#include "scene/reuse.h"
#include "schema/scene_tree.h"
#include "spectrum/color_space.h"
#include "spectrum/curve.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace abbe {

// Reports what cannot be: unknown names with suggestions, light used as reflectance, colours without a spectrum.
class CurveLibrary {
  public:
    // Null after a diagnostic.
    const Curve* curve(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&);
    schema::ComplexIndex metal(std::string_view name, Span, Diagnostics&);
    const Curve* constant(double value);
    // Illuminant D65, scaled to Y = 1.
    const Curve* daylight();
    // What `rgb 1 1 1` of a space is as light: its illuminant, Y = 1.
    const Curve* white(const RgbSpace&);

    std::vector<std::unique_ptr<const Curve>> release() { return std::move(curves_); }

  private:
    const Curve* keep(std::unique_ptr<const Curve>);
    const Curve* named(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&);
    const Curve* rgb(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&);
    const Curve* table(const schema::SpectrumValue&, schema::SpectrumRole);
    const Curve* tint(const schema::SpectrumValue&, Diagnostics&);

    std::vector<std::unique_ptr<const Curve>> curves_;
    const Curve* daylight_ = nullptr;
};

// The box around anything.
inline constexpr Bounds3 kEverything{{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};

class BuildContext {
  public:
    using Definition = schema::Definition;

    // All of it outlives this; `resolver` makes what definitions refer to.
    BuildContext(const schema::SceneTree& sceneTree, const schema::TypeTable& typeTable, const BuildOptions& asked,
                 Diagnostics& found, BuiltScene& result, schema::Resolver& resolver, SceneReuse* kept)
        : tree(sceneTree), types(typeTable), options(asked), diagnostics(found), built(result), reuse(kept),
          resolver_(resolver) {}

    const schema::SceneTree& tree;
    const schema::TypeTable& types;
    const BuildOptions& options;
    Diagnostics& diagnostics;
    BuiltScene& built;
    SceneReuse* const reuse;                  // null: nothing is taken over from other buildings
    InstancePlaces* instancePlaces = nullptr; // where to note where instances stand; null: nobody asks
    CurveLibrary curves;

    Vec3d up() const { return tree.header.zUp ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0}; }

    // Binds a definition to the parameters that it is given. Both arguments must outlive it.
    BindParams binder(const Definition&, Diagnostics&);
    BindParams binder(const Definition& d) { return binder(d, diagnostics); }
    template <typename P> std::optional<P> bound(const Definition& d) {
        P params;
        if (!binder(d)(d.type ? &params : nullptr)) return std::nullopt;
        return params;
    }

    // What a definition is referred to by, made if need be; invalid after an error.
    schema::Reference reference(const Definition& d) { return resolver_.reference(d, diagnostics); }

    // Its name or, without one, its type and a number.
    const std::string& nameOf(const Definition&);
    // The only definition of its kind, or the one of that name; null if there is none. A second one is an error.
    const Definition* only(schema::Kind, std::string_view name);
    // What reading a file is noted by, for who asks which files a scene consists of.
    // Those that were made for inserted texts do not count, what these were made of does (noteInserts).
    void noteFile(const std::string& path) {
        if (tree.made.empty() || !isBelow(path, tree.made)) built.facts.files.push_back(path);
    }
    void noteInserts() {
        auto& files = built.facts.files; // of these alone yet; one may be included several times
        for (const auto& [file, insert] : tree.inserts)
            if (!insert.source.empty() && std::ranges::find(files, insert.source) == files.end())
                files.push_back(insert.source);
    }

    // What a scene needs simulated, and who asked for it.
    void noteEffect(Effect, Span where, std::string_view why);
    // True if it is to be left out; notes who asked for it.
    bool leavesOut(EffectSwitch, Span where);
    // Errors where something needs what the scene forbids, or what this build was made without.
    void checkForbidden();
    void checkCompiled();

    // What `make` returns, or what an earlier building got from it for the same key: with its warnings, at `spans`, and
    // the files that it read. `make` must depend on nothing else, but on what `view` stands for, and return null
    // exactly after an error.
    template <typename T, typename Make>
    std::shared_ptr<const T> reused(Reused kind, const Digest& key, std::span<const Span> spans, Make make,
                                    const Digest& view = {}) {
        if (!reuse) return make();
        const Making start = takeOver(kind, key, view, spans);
        if (start.kept) return std::static_pointer_cast<const T>(start.kept);
        std::shared_ptr<const T> made = make();
        leave(kind, key, view, spans, start, made);
        return made;
    }

    KeptTables* tables() { return reuse; }

  private:
    // Before a thing is made: that of an earlier building, or what had been reported and read until then.
    struct Making {
        std::shared_ptr<const void> kept;
        std::size_t diagnostics = 0, counted = 0, files = 0;
    };
    Making takeOver(Reused, const Digest& key, const Digest& view, std::span<const Span>);
    void leave(Reused, const Digest& key, const Digest& view, std::span<const Span>, const Making&,
               std::shared_ptr<const void> made);

    schema::Resolver& resolver_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::string> givenNames_; // of definitions without one, by place
    std::unordered_map<std::string, int> nameless_;                             // definitions without a name, by type
};

} // namespace abbe
