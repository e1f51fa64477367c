#include "rendering/path_record.h"

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

void PathRecorder::meets(const void* source, const Spectrum& emitted, float pdf) noexcept {
    PathEvent e = event(EventKind::met);
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

} // namespace abbe
