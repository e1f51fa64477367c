// Phase functions: where media scatter light.
#pragma once

#include "render/phase_function.h"
#include "scene/build_context.h"

#include <memory>
#include <vector>

namespace abbe {

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

struct MixPhaseParams;
struct TablePhaseParams;
// Those that need more than their parameters. Null after an error.
std::shared_ptr<const PhaseFunction> makeTablePhase(const TablePhaseParams&, const PhaseContext&);
std::shared_ptr<const PhaseFunction> makeMixPhase(const MixPhaseParams&, const PhaseContext&);

} // namespace abbe
