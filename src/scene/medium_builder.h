// Media that fill shapes, volumes that stand by themselves, and where both scatter light.
#pragma once

#include "math/transform.h"
#include "media/medium_optics.h"
#include "render/light.h"
#include "render/medium.h"
#include "scene/build_context.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace abbe {

// Phase functions: where media scatter light.

// What a phase function is made from besides its own parameters.
struct PhaseContext {
    BuildContext& scene;
    const schema::Definition& definition;
    const std::vector<std::shared_ptr<const PhaseFunction>>& made; // by the index of a reference
};

// Makes a phase function of its registered type from bound parameters; null after an error.
using MakePhase = std::shared_ptr<const PhaseFunction> (*)(const BindParams&, const PhaseContext&);

class PhaseBuilder {
  public:
    explicit PhaseBuilder(BuildContext& context) : context_(context) {}

    schema::Reference reference(const schema::Definition&);
    const std::shared_ptr<const PhaseFunction>& operator[](schema::Reference r) const { return phases_[r.index]; }

  private:
    BuildContext& context_;
    std::vector<std::shared_ptr<const PhaseFunction>> phases_;
    std::vector<const schema::Definition*> open_; // being made
};

struct MiePhaseParams;
struct MixPhaseParams;
struct TablePhaseParams;
// Those that need more than their parameters: for Mie, tables that are kept. Null after an error.
std::shared_ptr<const PhaseFunction> makeKeptMiePhase(const MiePhaseParams&, const PhaseContext&);
std::shared_ptr<const PhaseFunction> makeTablePhase(const TablePhaseParams&, const PhaseContext&);
std::shared_ptr<const PhaseFunction> makeMixPhase(const MixPhaseParams&, const PhaseContext&);

class HomogeneousMedium;
class MediumBuilder;
class NoiseMedium;

// What a medium or volume is made from besides its own parameters.
struct MediumContext {
    BuildContext& scene;
    const schema::Definition& definition;
    MediumBuilder& media;
    Transform toRender = {}; // of volumes: from the space in which they are defined
};

// No medium after an error.
struct MadeMedium {
    std::unique_ptr<Medium> medium;
    std::unique_ptr<Light> light = {}; // that samples what it gives off, if any does
};

// Makes a medium or volume of its registered type from bound parameters.
using MakeMedium = MadeMedium (*)(const BindParams&, const MediumContext&);

class MediumBuilder {
  public:
    using Definition = schema::Definition;

    MediumBuilder(BuildContext& context, const PhaseBuilder& phases) : context_(context), phases_(phases) {}

    schema::Reference reference(const Definition&);
    std::uint32_t keep(std::unique_ptr<Medium>, const Definition&);
    const Medium& operator[](schema::Reference r) const { return *media_[r.index]; }
    Span spanOf(const Medium& medium) const { return spans_[medium.number]; } // of its definition
    // Nothing after an error.
    std::optional<MediumOptics> opticsOf(const MediumParams&, const Definition&);

    // Makes the volume of a definition; null after an error or where it is left out.
    MadeMedium makeVolume(const Definition&, const Transform& toRender);

    // Where media are: in shapes, or in all of space from where `where` says so.
    void noteInterior(const Medium&);
    void noteOpen(const Medium& medium, Span where) { open_.emplace_back(&medium, where); }
    // A shape with its box in render space; of what is placed in objects or moves: everything. `repeated`: in an
    // object, of which there may be several.
    void notePlaced(const Material&, const Bounds3& box, bool repeated);

    // Once all is placed: tells the scene what its media and dielectrics ask of paths, and hands the media over.
    // `extent`: bounds of the scene; null if it is empty.
    void finish(const Bounds3* extent);

  private:
    struct PlacedShape {
        Bounds3 box;
        const Material* material;
        bool repeated;
    };

    bool mayLieInDielectric(bool dielectrics) const;
    void noteUses();
    void noteEffects(const Medium&, Span, std::string_view what);
    void limitDense(const Bounds3* extent);

    BuildContext& context_;
    const PhaseBuilder& phases_;
    std::vector<std::unique_ptr<const Medium>> media_;
    std::vector<Span> spans_;              // like media_
    std::vector<NoiseMedium*> noise_;      // those of media_
    std::vector<HomogeneousMedium*> even_; // likewise
    std::vector<std::pair<const Medium*, Span>> open_, interior_;
    std::vector<PlacedShape> placed_; // that a medium or a dielectric fills, or that look otherwise in one
};

// Of a scene that is built: light comes on straight ways to media that have lights inside.
void noteLightsInside(Scene&);

struct AtmosphereParams;
struct HomogeneousParams;
struct NoiseMediumParams;
struct NoiseVolumeParams;
struct VdbParams;
MadeMedium makeHomogeneous(const HomogeneousParams&, const MediumContext&);
MadeMedium makeAtmosphere(const AtmosphereParams&, const MediumContext&);
MadeMedium makeNoiseMedium(const NoiseMediumParams&, const MediumContext&);
MadeMedium makeNoiseVolume(const NoiseVolumeParams&, const MediumContext&);
MadeMedium makeVdbVolume(const VdbParams&, const MediumContext&); // vdb_volume.cpp

} // namespace abbe
