#include "rendering/path_record.h"

#include <bit>
#include <cmath>
#include <string_view>

namespace abbe {

using EventKind = PathEvent::Kind;

PathEvent PathRecorder::event(EventKind kind) const {
    PathEvent e;
    e.kind = kind;
    e.vertex = vertex_;
    e.hit = at_;
    return e;
}

void PathRecorder::add(const PathEvent& e) noexcept {
    if (listens_) record_.add(e);
}

void PathRecorder::start(const Ray& fromEye, const Wavelengths& lambda) noexcept {
    if (listens_) record_.begin(fromEye.origin, lambda);
    vertex_ = 0;
    at_ = {};
}

void PathRecorder::arrives(const SurfaceHit& hit, const Spectrum& beta) noexcept {
    ++vertex_;
    at_ = hit;
    PathEvent e = event(EventKind::surface);
    e.beta = beta;
    add(e);
}

void PathRecorder::collides(Vec3 p, const Spectrum& beta) noexcept {
    ++vertex_;
    at_ = {};
    at_.p = p;
    PathEvent e = event(EventKind::collides);
    e.beta = beta;
    add(e);
}

void PathRecorder::samples(const void* source, const LightSample& light, const BsdfEval& value, float pdf) noexcept {
    PathEvent e = event(EventKind::sampled);
    e.source = source;
    e.radiance = light.radiance;
    e.direction = light.wi;
    e.value = value;
    e.pdf = pdf;
    add(e);
}

void PathRecorder::hits(const void* source, const Spectrum& emitted, float pdf) noexcept {
    PathEvent e = event(EventKind::hitLight);
    e.source = source;
    e.radiance = emitted;
    e.pdf = pdf;
    add(e);
}

void PathRecorder::gathers(const Spectrum& radiance, const void* source, bool) noexcept {
    PathEvent e = event(EventKind::gathers);
    e.source = source;
    e.light = radiance;
    add(e);
}

void PathRecorder::scatters(const SurfaceHit& hit, Lobes, const Spectrum& beta, const BsdfSample* next) noexcept {
    at_ = hit;
    PathEvent e = event(EventKind::scatters);
    e.beta = beta;
    if (next) e.next = *next;
    add(e);
}

void PathRecorder::findsFault(const void* who, const char* what, float number) noexcept {
    PathEvent e = event(EventKind::fault);
    e.source = who;
    e.what = what;
    e.pdf = number;
    add(e);
}

void PathRecorder::leaves(Vec3 direction) noexcept {
    PathEvent e = event(EventKind::leaves);
    e.direction = direction;
    add(e);
}

namespace {

using EventKind = PathEvent::Kind;
using Culprit = SampleFault::Culprit;

// Whose numbers PathObserver::findsFault() tells.
Culprit sourceOf(std::string_view what) {
    if (what == "weight") return Culprit::camera;
    if (what == "opacity") return Culprit::material;
    return what == "direction" ? Culprit::light : Culprit::medium;
}

std::optional<DropCause> causeOf(float v) {
    if (std::isnan(v)) return DropCause::nan;
    if (std::isinf(v)) return DropCause::infinite;
    if (v < 0) return DropCause::negative;
    return std::nullopt;
}

class Search {
  public:
    explicit Search(const PathRecord& record) : record_(record) {}

    SampleFault run() {
        for (const PathEvent& e : record_.events())
            if (look(e)) return fault_.culprit == Culprit::medium && !fault_.who ? namedFault() : fault_;
        return largest();
    }

  private:
    bool look(const PathEvent& e) {
        switch (e.kind) {
        case EventKind::surface:
        case EventKind::collides:
            return spectrum(e, e.beta, Culprit::medium, "transmission");
        case EventKind::sampled:
            return spectrum(e, e.radiance, Culprit::light, "radiance") || density(e, e.pdf, Culprit::light) ||
                   direction(e, e.direction, Culprit::light) || spectrum(e, e.value.fcos, scatterer(e), "value") ||
                   density(e, e.value.pdfSolidAngle, scatterer(e)) ||
                   spectrum(e, e.value.pdfRatio, scatterer(e), "ratio of densities");
        case EventKind::hitLight:
            return spectrum(e, e.radiance, Culprit::light, "radiance") || density(e, e.pdf, Culprit::light);
        case EventKind::gathers:
            return spectrum(e, e.light, Culprit::medium, "transmission");
        case EventKind::scatters:
            return e.next && (spectrum(e, e.next->weight, scatterer(e), "weight") ||
                              density(e, e.next->pdfSolidAngle, scatterer(e)) ||
                              spectrum(e, e.next->pdfRatio, scatterer(e), "ratio of densities") ||
                              direction(e, e.next->wi, scatterer(e)));
        case EventKind::fault:
            return found(e, e.pdf, 0xff, sourceOf(e.what), e.what);
        case EventKind::leaves: // of a scattered ray it was found there
            return direction(e, e.direction, Culprit::camera);
        }
        return false;
    }

    static Culprit scatterer(const PathEvent& e) { return e.hit.material ? Culprit::material : Culprit::medium; }
    // Of whoever was at fault while the path was at e: its own material, one on the way, or a medium.
    static const void* who(const PathEvent& e, Culprit culprit) {
        if (e.kind == EventKind::fault || culprit == Culprit::light) return e.source;
        return culprit == Culprit::material ? e.hit.material : nullptr;
    }

    // What a medium did to the light on the way shows before its density.
    SampleFault namedFault() {
        for (const PathEvent& e : record_.events())
            if (e.kind == EventKind::fault) look(e);
        return fault_;
    }

    bool found(const PathEvent& e, float number, std::uint32_t lanes, Culprit culprit, const char* what) {
        const auto cause = causeOf(number);
        fault_ = {culprit, who(e, culprit), what, cause.value_or(DropCause::infinite), lanes, number, e};
        return true;
    }

    // What is not a number counts before what is infinite, and that before what is negative: as in the film's gate.
    bool spectrum(const PathEvent& e, const Spectrum& s, Culprit culprit, const char* what) {
        for (const DropCause cause : {DropCause::nan, DropCause::infinite, DropCause::negative}) {
            std::uint32_t lanes = 0;
            for (int i = 0; i < kLanes; ++i)
                if (causeOf(s[i]) == cause) lanes |= 1u << i;
            if (lanes != 0) return found(e, s[std::countr_zero(lanes)], lanes, culprit, what);
        }
        return false;
    }

    bool density(const PathEvent& e, float pdf, Culprit culprit) {
        return causeOf(pdf) && found(e, pdf, 0xff, culprit, "density");
    }

    bool direction(const PathEvent& e, Vec3 w, Culprit culprit) {
        const float l2 = lengthSquared(w);
        return !(l2 < 2) && found(e, l2, 0xff, culprit, "direction");
    }

    // Numbers that are all sound may be too large together.
    SampleFault largest() {
        float most = 0;
        for (const PathEvent& e : record_.events()) {
            if (e.kind != EventKind::gathers || !(maxLane(e.light) > most)) continue;
            most = maxLane(e.light);
            std::uint32_t lanes = 0;
            for (int i = 0; i < kLanes; ++i)
                if (e.light[i] == most) lanes |= 1u << i;
            found(e, most, lanes, Culprit::light, "radiance");
        }
        return fault_;
    }

    const PathRecord& record_;
    SampleFault fault_;
};

} // namespace

SampleFault findFault(const PathRecord& record) { return Search(record).run(); }

} // namespace abbe
