#include "binding/material_handle.h"

#include "math/vec.h"

#include <algorithm>
#include <stdexcept>

namespace abbe::python {

namespace {

// What only a picture needs.
bool isOfPictures(const Diagnostic& d) { return d.code == "E0601" || d.code == "E0610"; }

Vec3 row(std::span<const double> rows, std::size_t i) {
    return Vec3(Vec3d{rows[3 * i], rows[3 * i + 1], rows[3 * i + 2]});
}

// Rounding must not make it 1.
float unitNumber(double u) { return std::min(static_cast<float>(u), kOneMinusEpsilon); }

Wavelengths wavelengthsOf(const Float8& nm) { return Wavelengths::at(Spectrum(nm), Spectrum(1.f)); }

// The wavelengths that draw: the first one is the hero, seven more are taken at even steps from the others. With eight
// they are those of a path; fewer are repeated.
std::size_t drawnIndex(int lane, std::size_t count) { return static_cast<std::size_t>(lane) * count / kLanes; }

// Those that differ are seen to differ: whether light disperses depends on it.
Wavelengths drawing(std::span<const double> nanometres) {
    Float8 nm;
    for (int lane = 0; lane < kLanes; ++lane)
        nm[lane] = static_cast<float>(nanometres[drawnIndex(lane, nanometres.size())]);
    const auto other = std::ranges::find_if(nanometres, [&](double one) { return one != nanometres[0]; });
    const bool same = maxLane(abs(Spectrum(nm) - Spectrum(nm[0]))) == 0;
    if (same && other != nanometres.end()) nm[kLanes - 1] = static_cast<float>(*other);
    return wavelengthsOf(nm);
}

} // namespace

// The Bsdfs of all wavelengths, eight at a time; the last ones are repeated to fill the last block.
class LaneBlocks {
  public:
    LaneBlocks(const Material& material, const SurfaceHit& hit, std::span<const double> nanometres)
        : nanometres_(nanometres), arenas_((nanometres.size() + kLanes - 1) / kLanes) {
        for (std::size_t block = 0; block < arenas_.size(); ++block) {
            Float8 nm;
            for (int lane = 0; lane < kLanes; ++lane)
                nm[lane] = static_cast<float>(
                    nanometres[std::min(block * kLanes + static_cast<std::size_t>(lane), nanometres.size() - 1)]);
            bsdfs_.push_back(material.bsdf(hit, wavelengthsOf(nm), arenas_[block]));
        }
    }

    std::size_t size() const { return nanometres_.size(); }
    double nanometres(std::size_t i) const { return nanometres_[i]; }
    // What `of` says of each block's Bsdf, a Spectrum, by wavelength.
    template <typename Of> void fill(float* values, Of of) const {
        for (std::size_t block = 0; block < bsdfs_.size(); ++block) {
            const Spectrum found = of(*bsdfs_[block]);
            const std::size_t first = block * kLanes, count = std::min<std::size_t>(kLanes, size() - first);
            for (std::size_t i = 0; i < count; ++i) values[first + i] = found[static_cast<int>(i)];
        }
    }

  private:
    std::span<const double> nanometres_;
    std::vector<Arena> arenas_;
    std::vector<const Bsdf*> bsdfs_;
};

MaterialHandle::MaterialHandle(const SceneInput& input, const std::string& name) : loaded_(loadScene(input)) {
    BuildOptions options;
    options.geometry = false;
    if (loaded_->readable) built_ = buildScene(loaded_->tree, loaded_->types, options, loaded_->diagnostics);
    Diagnostics found;
    for (const Diagnostic& d : loaded_->diagnostics.all())
        if (!isOfPictures(d)) found.add(d);
    log_->add(found, loaded_->sources);
    if (found.hasErrors()) return;
    for (const auto& material : built_.scene.materials) {
        const auto named = built_.scene.names.find(material.get());
        if (named == built_.scene.names.end() || !loaded_->tree.find(schema::Kind::material, named->second)) continue;
        if (std::ranges::find(names_, named->second) != names_.end()) continue; // the same with a shape's interior
        names_.push_back(named->second);
        if (named->second == name) material_ = material.get();
    }
    built_.scene.lights.clear();
    built_.scene.surfaces.clear();
    built_.scene.shapes.clear(); // no material refers to any
    hit_.ng = hit_.localNormal = {0, 0, 1};
    hit_.dpdu = {1, 0, 0};
    hit_.dpdv = {0, 1, 0};
    hit_.material = material_;
}

std::string MaterialHandle::obstacle() const {
    if (material_->isBoundary()) return "a boundary has no surface: light goes straight on";
    if (!material_->reversible())
        return "hair scatters by where its fibre is hit, not by a normal: it is no surface to evaluate";
    if (material_->usesTextures()) return "a texture changes it over the surface; evaluate a material of plain values";
    return {};
}

const Bsdf& MaterialHandle::bsdf(const Wavelengths& wavelengths, Arena& arena) const {
    return *material_->bsdf(hit_, wavelengths, arena);
}

void MaterialHandle::eval(std::span<const double> wo, std::span<const double> wi, std::span<const double> nanometres,
                          Transport transport, float* fcos) const {
    const LaneBlocks blocks(*material_, hit_, nanometres);
    for (std::size_t i = 0; i < wo.size() / 3; ++i)
        blocks.fill(fcos + i * blocks.size(),
                    [&](const Bsdf& b) { return b.eval(row(wo, i), row(wi, i), transport).fcos; });
}

void MaterialHandle::pdf(std::span<const double> wo, std::span<const double> wi, std::span<const double> nanometres,
                         float* density) const {
    Arena arena;
    const Bsdf& b = bsdf(drawing(nanometres), arena);
    for (std::size_t i = 0; i < wo.size() / 3; ++i)
        density[i] = b.eval(row(wo, i), row(wi, i), Transport::radiance).pdfSolidAngle;
}

void MaterialHandle::sample(std::span<const double> wo, std::span<const double> u, std::span<const double> nanometres,
                            Transport transport, Samples out) const {
    const LaneBlocks blocks(*material_, hit_, nanometres);
    const std::size_t count = blocks.size();
    Arena arena;
    const Bsdf& drawn = bsdf(drawing(nanometres), arena);
    for (std::size_t i = 0; i < wo.size() / 3; ++i) {
        const Vec3 o = row(wo, i);
        const auto s =
            drawn.sample(o, unitNumber(u[3 * i + 2]), {unitNumber(u[3 * i]), unitNumber(u[3 * i + 1])}, transport);
        out.pdf[i] = s ? s->pdfSolidAngle : 0;
        out.delta[i] = s && s->lobe.has(Lobe::delta);
        const Vec3 wi = s ? s->wi : Vec3{};
        out.wi[3 * i] = wi.x, out.wi[3 * i + 1] = wi.y, out.wi[3 * i + 2] = wi.z;
        float* const weight = out.weight + i * count;
        if (!s) {
            std::fill_n(weight, count, 0.f);
        } else if (out.delta[i]) {
            weighDelta(*s, drawn, o, blocks, transport, weight);
        } else {
            blocks.fill(weight, [&](const Bsdf& b) { return b.eval(o, wi, transport).fcos / s->pdfSolidAngle; });
        }
    }
}

// Where the direction depends on wavelength, those of other wavelengths than the hero's go elsewhere.
void MaterialHandle::weighDelta(const BsdfSample& s, const Bsdf& drawn, Vec3 wo, const LaneBlocks& blocks,
                                Transport transport, float* weight) const {
    if (s.lobe.has(Lobe::dispersive)) {
        for (std::size_t i = 0; i < blocks.size(); ++i)
            weight[i] = blocks.nanometres(i) == blocks.nanometres(0) ? s.weight[0] : 0;
        return;
    }
    const float probability = drawn.evalDelta(wo, s.wi).probability; // of all lobes that lead there
    if (!(probability > 0)) throw std::logic_error("a specular sample is not known to its material");
    const bool importance = transport == Transport::importance && s.lobe.has(Lobe::transmission);
    const float scale = (importance ? s.eta * s.eta : 1.f) / probability;
    blocks.fill(weight, [&](const Bsdf& b) { return b.evalDelta(wo, s.wi).ratio * scale; });
}

} // namespace abbe::python
