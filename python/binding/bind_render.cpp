#include "base/memory_limit.h"
#include "binding/arguments.h"
#include "binding/bindings.h"
#include "binding/command_words.h"
#include "binding/image_handle.h"
#include "binding/render_job.h"
#include "checkpoints/render_checkpoint.h"
#include "commands/command_table.h"

#include <chrono>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace abbe::python {

namespace nb = nanobind;

namespace {

nb::dict progressDict(const Progress& p) {
    nb::dict d;
    d["done"] = p.fraction;
    d["samples"] = p.samplesPerPixel;
    d["of_samples"] = p.totalSamples;
    d["noise"] = p.noise > 0 ? nb::cast(p.noise) : nb::none();
    d["elapsed"] = p.elapsed;
    d["left"] = p.left >= 0 ? nb::cast(p.left) : nb::none();
    d["paths_per_second"] = p.pathsPerSecond;
    return d;
}

nb::object figureDict(const ErrorFigure& f) {
    nb::dict d;
    d["value"] = f.value;
    d["low"] = f.low;
    d["high"] = f.high;
    return d;
}

nb::dict summaryDict(const RenderSummary& s) {
    nb::dict d, phases;
    for (const auto& [name, seconds] : s.phases) phases[name.c_str()] = seconds;
    d["phases"] = phases;
    d["seconds"] = s.totalSeconds;
    d["render_seconds"] = s.statistics.seconds;
    d["samples"] = s.statistics.samplesPerPixel;
    d["noise"] = s.noise;
    d["partial"] = s.partial;
    d["memory_bytes"] = s.memoryBytes;
    d["kernel"] = s.statistics.kernel;
    if (s.certificate && s.certificate->reason.empty()) {
        d["error"] = figureDict(s.certificate->relative);
        if (s.certificate->display) d["display_error"] = figureDict(*s.certificate->display);
    } else if (s.certificate) {
        d["no_error"] = s.certificate->reason;
    }
    return d;
}

// Whether this thread is inside of a call of `progress`, which must not render itself: it would wait for itself.
thread_local bool inProgress = false;

// How long a render that is stopped while its scene is read and built may take to come to its end, before it is
// abandoned.
constexpr std::chrono::milliseconds kPatience{400};

// Looks after Python while the job renders: signals and `progress` are the calling thread's. What they throw ends the
// job, and is thrown when nothing of it runs any more; or while the scene is still read or built, which nothing ends,
// and then the job is abandoned.
void follow(std::unique_ptr<RenderJob>& owned, nb::object progress) {
    RenderJob& job = *owned;
    std::optional<nb::python_error> raised;
    std::chrono::steady_clock::time_point since;
    for (bool done = false; !done;) {
        {
            const nb::gil_scoped_release free;
            if (raised) job.stop();
            job.wait();
            done = job.done();
        }
        if (raised) {
            job.takeProgress();
            if (done || job.isBuilt() || std::chrono::steady_clock::now() - since < kPatience) continue;
            const nb::gil_scoped_release free;
            RenderJob::abandon(std::move(owned));
            break;
        }
        try {
            if (PyErr_CheckSignals() != 0) nb::raise_python_error();
            if (const auto state = job.takeProgress(); state && !progress.is_none()) {
                inProgress = true;
                progress(progressDict(*state));
                inProgress = false;
            }
        } catch (nb::python_error& e) {
            inProgress = false;
            raised.emplace(std::move(e));
            since = std::chrono::steady_clock::now();
        }
    }
    if (raised) throw std::move(*raised);
}

nb::tuple render(std::shared_ptr<SceneHandle> scene, RenderOptions options, int threads, nb::object progress) {
    if (inProgress) throw std::runtime_error("a progress function cannot render itself");
    RenderOutcome outcome;
    {
        auto job = std::make_unique<RenderJob>(std::move(scene), std::move(options), threads);
        try {
            follow(job, std::move(progress));
        } catch (...) {
            const nb::gil_scoped_release free;
            job.reset();
            throw;
        }
        outcome = job->outcome();
    }
    nb::object image = nb::none(), summary = nb::none();
    if (outcome.image) image = nb::cast(ImageHandle(std::move(outcome.image)));
    if (outcome.summary) summary = summaryDict(*outcome.summary);
    return nb::make_tuple(static_cast<int>(outcome.exit), outcome.log, image, summary, outcome.files);
}

nb::tuple renderScene(std::shared_ptr<SceneHandle> scene, nb::dict arguments, int threads, nb::object progress) {
    RenderOptions options = renderOptions(arguments);
    const std::optional<int> frame = options.input.frame;
    options.input = scene->input();
    options.input.frame = frame;
    return render(std::move(scene), std::move(options), threads, std::move(progress));
}

nb::tuple mergeParts(std::vector<std::string> parts, std::optional<std::string> scenePath,
                     std::optional<std::string> sceneText, std::string output, bool soFar, nb::object progress) {
    MergeOptions merge;
    merge.parts = std::move(parts);
    merge.scene = scenePath.value_or("");
    merge.output = output;
    merge.soFar = soFar;
    RenderOptions options = renderOf(merge);
    options.input.text = std::move(sceneText);
    options.quiet = true;
    options.preview = false;
    options.inMemory = output.empty();
    return render(nullptr, std::move(options), 0, std::move(progress));
}

} // namespace

void bindRender(nb::module_& m) {
    nb::exception<CheckpointFault>(m, "CheckpointFault", PyExc_ValueError);
    m.def("render", &renderScene, nb::arg("scene"), nb::arg("arguments"), nb::arg("threads"),
          nb::arg("progress").none());
    m.def("merge", &mergeParts, nb::arg("parts"), nb::arg("scene").none(), nb::arg("text").none(), nb::arg("output"),
          nb::arg("so_far"), nb::arg("progress").none());
    nb::register_exception_translator(
        [](const std::exception_ptr& p, void*) {
            try {
                std::rethrow_exception(p);
            } catch (const std::bad_alloc& e) {
                PyErr_SetString(PyExc_MemoryError, memoryReason(e).c_str());
            }
        },
        nullptr);
}

} // namespace abbe::python
