// What building any part of a scene needs: the definitions, and where it is noted what they ask for.
#pragma once

#include "scene/build.h"
#include "scene/curve_library.h"

#include <map>
#include <string>
#include <unordered_map>
#include <utility>

namespace abbe {

// The box around anything.
inline constexpr Bounds3 kEverything{{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};

class BuildContext {
  public:
    using Definition = schema::Definition;

    // All of it outlives this; `resolver` makes what definitions refer to.
    BuildContext(const schema::SceneTree& sceneTree, const schema::TypeTable& typeTable, const BuildOptions& asked,
                 Diagnostics& found, BuiltScene& result, schema::Resolver& resolver)
        : tree(sceneTree), types(typeTable), options(asked), diagnostics(found), built(result), resolver_(resolver) {}

    const schema::SceneTree& tree;
    const schema::TypeTable& types;
    const BuildOptions& options;
    Diagnostics& diagnostics;
    BuiltScene& built;
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
    void noteFile(const std::string& path) { built.facts.files.push_back(path); }

    // build_effects.cpp: what a scene needs simulated, and who asked for it.
    void noteEffect(Effect, Span asker, std::string_view why);
    // True if it is to be left out; notes who asked for it.
    bool leavesOut(EffectSwitch, Span asker);
    // Errors where something needs what the scene forbids, or what this build was made without.
    void checkForbidden();
    void checkCompiled();

  private:
    schema::Resolver& resolver_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::string> givenNames_; // of definitions without one, by place
    std::unordered_map<std::string, int> nameless_;                             // definitions without a name, by type
};

} // namespace abbe
