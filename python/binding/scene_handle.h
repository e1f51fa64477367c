// A scene as Python holds it: where its text comes from, and what one render leaves to the next.
#pragma once

#include "app/load.h"
#include "binding/diagnostic_records.h"
#include "render_run/render_run.h"

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace abbe::python {

// The text of a scene, or the path of a file, with what is chosen beside it. Checking and rendering read it, so that a
// change of the file in between is seen.
class SceneHandle {
  public:
    explicit SceneHandle(SceneInput input) : input_(std::move(input)) {}

    const SceneInput& input() const { return input_; }
    // One render of a process at a time: threads, stop flags and what is carried on are its own.
    static std::mutex& oneAtATime();
    // Only with that lock.
    RenderCarry& carry() { return carry_; }
    void forget();

  private:
    SceneInput input_;
    RenderCarry carry_;
};

// Everything that is wrong, as `abbe check` has it. Of a moment of an animation, if there is one.
std::shared_ptr<DiagnosticLog> checkScene(SceneInput, std::optional<int> frame);

} // namespace abbe::python
