#include "binding/scene_handle.h"

#include "scene/build.h"

namespace abbe::python {

std::mutex& SceneHandle::oneAtATime() {
    static std::mutex mutex;
    return mutex;
}

std::shared_ptr<DiagnosticLog> checkScene(SceneInput input, std::optional<int> frame) {
    input.frame = frame;
    auto log = std::make_shared<DiagnosticLog>();
    const auto loaded = loadScene(input);
    BuildOptions options;
    options.geometry = false;
    if (loaded->readable) buildScene(loaded->tree, loaded->types, options, loaded->diagnostics);
    log->add(loaded->diagnostics, loaded->sources);
    return log;
}

void SceneHandle::forget() {
    const std::scoped_lock lock(oneAtATime());
    carry_.reuse.forgetAll();
}

} // namespace abbe::python
