// What one building of a scene leaves to the next: what did not change is neither read nor made again.
#pragma once

#include "base/diagnostic.h"
#include "geometry/embree_scene_builder.h"
#include "math/digest.h"
#include "render/kept_tables.h"
#include "schema/scene_tree.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

class TextureStore;

// Of the last building.
struct ReuseCounters {
    std::size_t shapesLoaded = 0, shapesKept = 0;        // definitions: read from files, or written in place
    std::size_t placesMade = 0, placesKept = 0;          // shapes where they stand: dicing, bounds, areas
    std::size_t structuresBuilt = 0, structuresKept = 0; // acceleration structures: of the scene, of each object
    std::size_t texturesRead = 0, texturesKept = 0;      // image files, those of environments among them
    std::size_t volumesRead = 0, volumesKept = 0;        // files of voxels, and bounds of noise
    std::size_t tablesMade = 0, tablesKept = 0;          // of skies, droplets and others that take a while
    bool viewKept = false;                               // SceneReuse::keepView() made a difference
    double seconds = 0;                                  // of the building, all in all

    bool operator==(const ReuseCounters&) const = default;
};

// Its name, size, times and number. One that changed a moment ago may change again unseen: it equals nothing.
void addFile(DigestWriter&, const std::filesystem::path&);

// What a definition says, however it is laid out in its file: parameters are replaced, and textures, spectra and files
// that it names are part of it, the latter by their times and sizes.
struct Meaning {
    Digest digest;
    std::vector<Span> spans; // in an order that is the same for all of equal digests: what diagnostics may point at
};
// Without properties of these names, whose definitions and values are then no part of it; of a property that names
// groups of faces (`group=`), those are.
Meaning meaningOf(const schema::Definition&, const schema::SceneTree&, std::span<const std::string_view> without = {});

enum class Reused : std::uint8_t { shape, place, texture, volume, table };

// Owned by whoever builds a scene again and again: a view that follows its file, an animation. Not thread-safe; but
// what was built with it shares what is kept, and may go on rendering while the next is built. What the last faultless
// building did not use is forgotten with its end. Bits of pictures are those of a building without it.
class SceneReuse final : public KeptTables {
  public:
    SceneReuse();
    ~SceneReuse() override;
    SceneReuse(const SceneReuse&) = delete;
    SceneReuse& operator=(const SceneReuse&) = delete;

    // For views whose camera is moved by hand: as long as nothing else changes, the origin of render space stays where
    // it was, and surfaces stay diced for the camera that they were diced for. So no geometry is made again; but
    // rounding and dicing, and with them the bits, are not those of a building of its own. Off at first.
    void keepView(bool on) { keepsView_ = on; }
    bool keepsView() const { return keepsView_; }

    const ReuseCounters& counters() const { return counters_; }
    void forgetAll();

    // The rest is for buildScene() and its builders.

    void begin();
    void end(bool faultless, double seconds);
    ReuseCounters& count() { return counters_; }

    struct Kept {
        std::shared_ptr<const void> thing;
        std::vector<Diagnostic> warnings;               // that came of making it
        std::vector<std::vector<std::size_t>> warnedAt; // their spans and those of their labels, by Meaning::spans
        std::vector<std::string> files;                 // that were read
        Digest view;                                    // what it depends on that keepView() keeps
        std::uint64_t used = 0;                         // the last building that used it
        bool proven = false;                            // a faultless one was among those
    };
    // Null if there is none, or none of that view. Until the next call of keep().
    const Kept* find(const Digest&, const Digest& view);
    void keep(const Digest&, Kept);
    // How many times this building has asked for it before: equal shapes at equal places are not one.
    std::size_t timesAsked(const Digest& key) { return asked_[key]++; }

    KeptGeometry geometry;
    std::shared_ptr<TextureStore> textures; // null: none yet
    std::optional<Vec3d> origin;            // of render space in the last faultless building
    Vec3d nextOrigin;                       // in this one
    double reach = 0;                       // m, how far a camera may be from an origin that is kept

  private:
    std::shared_ptr<const void> find(const Digest&) override;
    void keep(const Digest&, std::shared_ptr<const void>) override;

    std::map<Digest, Kept> kept_;
    std::map<Digest, std::size_t> asked_;
    ReuseCounters counters_;
    std::uint64_t building_ = 0; // its number
    bool keepsView_ = false;
};

} // namespace abbe
