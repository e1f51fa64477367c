#include "scene/light_builder.h"

#include "geometry/flat_shapes.h"
#include "geometry/round_shapes.h"
#include "geometry/shape_params.h"
#include "io/ies.h"
#include "io/image.h"
#include "lights/area_light.h"
#include "lights/environment_light.h"
#include "lights/ies_light.h"
#include "lights/moving_light.h"
#include "scene/file_faults.h"
#include "scene/placer.h"
#include "scene/shape_mesh.h"
#include "schema/suggest.h"
#include "spectrum/named_spectra.h"
#include "spectrum/upsampling_table.h"

#include <fmt/format.h>
#include <set>

namespace abbe {

LightContext LightBuilder::contextOf(const Definition& d, const Motion& toRender) {
    LightContext context;
    context.toRender = motion_.atOpening(toRender);
    context.defaultColor = context_.curves.daylight();
    context.span = d.span;
    context.zUp = context_.tree.header.zUp;
    context.time = motion_.opening();
    context.besideScattering = context_.built.render.strategy == Technique::Strategy::mis;
    context.kept = context_.tables();
    return context;
}

bool LightBuilder::checkPower(const Light& light, Span span) {
    constexpr LightRange kRange = {1e-30, 1e35, "W"};
    const double power = light.power();
    if (!light.bounds(0) || kRange.holds(power)) return true;
    reportBeyondRange(power, kRange, "light", span, fmt::format("gives off {:.3g} W", power), context_.diagnostics)
        .notes.push_back(
            fmt::format("the power of a light is 0, or between {:g} and {:g} W", kRange.least, kRange.most));
    return false;
}

void LightBuilder::add(std::unique_ptr<Light> light, const Definition& d, Visibility visible) {
    if (!light) return;
    light->setVisible(visible);
    if (!(light->power() > 0))
        context_.diagnostics.warning("W0740", d.span, "this light is dark; it is left out of next-event estimation");
    if (!checkPower(*light, d.span)) return;
    context_.built.scene.names[light.get()] = context_.nameOf(d);
    context_.built.declared[light.get()] = d.nameSpan;
    if (const MediumEmission* glow = light->emission()) context_.built.scene.names[glow] = context_.nameOf(d);
    lights_.push_back(std::move(light));
    names_.emplace_back(d.name, d.type ? std::string(d.type->name) : std::string());
}

const SurfaceLight* LightBuilder::emitterOf(const LoadedShape& shape, const Shape& placed, const Motion& toRender,
                                            Visibility visible) {
    const ShapeEmission emission = shapes_.emissionOf(shape);
    const Definition& d = *shape.definition;
    std::optional<LightMotion> motion;
    if (!emission.radiance.curve || !motion_.ofLight(toRender, d.span, motion)) return nullptr;
    if (!checkLightRange(emission.radiance, kSurfaceRadiance, emission.span.valid() ? emission.span : d.span,
                         context_.diagnostics))
        return nullptr;
    // A light that is sampled would emit from its holes, too.
    if (const Material* material = shapes_.materials.ofShape(shape.common); material && material->mayBeOpen()) {
        context_.diagnostics
            .error("E0754", d.span, "a shape that emits has a material with holes", "its `opacity` is below 1")
            .help = "take the opacity off, or put the light behind a shape with holes";
        return nullptr;
    }
    std::unique_ptr<const LightTexture> texture;
    if (emission.texture) {
        if (!textures_.checkLight(*emission.texture, emission.span, {d, placed, shape.uvOnFaces})) return nullptr;
        const Transform toOwn = motion_.atOpening(toRender).inverse().value_or(Transform{});
        texture = std::make_unique<const LightTexture>(placed, *emission.texture, toOwn, *emission.radiance.curve,
                                                       context_.options.geometry);
        if (texture->black())
            context_.diagnostics.warning("W0740", d.span,
                                         "this light is dark; it is left out of next-event estimation");
    }
    const bool both = emission.bothSides;
    std::unique_ptr<AreaLight> light;
    if (motion)
        light = std::make_unique<MovingAreaLight>(placed, emission.radiance, both, std::move(*motion),
                                                  std::move(texture), emission.veil);
    else
        light = std::make_unique<AreaLight>(placed, emission.radiance, both, std::move(texture), emission.veil);
    if (!checkPower(*light, d.span)) return nullptr;
    light->setVisible(visible);
    names_.emplace_back(d.name, "shape");
    const SurfaceLight* const kept = light.get();
    lights_.push_back(std::move(light));
    context_.built.scene.names[kept] = context_.nameOf(d);
    context_.built.declared[kept] = d.nameSpan;
    return kept;
}

bool LightBuilder::takeTexture(const AreaLightParams& params, const Shape& shape, const Definition& d,
                               LightContext& context) {
    context.texturesOpen = context_.options.geometry;
    context.texture = params.radiance.texture;
    Span where = params.radiance.span;
    if (params.texture.valid()) {
        if (context.texture) {
            context_.diagnostics
                .error("E0755", where, "`texture` has no effect beside a `radiance` that is a texture itself",
                       "this texture")
                .help = "multiply the two: `texture product { first …; second … }`";
            return false;
        }
        for (const schema::Node& property : d.properties)
            if (property.name() == "texture") where = property.nameSpan();
        context.texture = textures_.textureFor(params.texture, TextureUse::light, where);
        if (!context.texture) return false;
    }
    if (!context.texture) return true;
    context.textureWhite = textures_.white(*context.texture);
    return textures_.checkLight(*context.texture, where, {d, shape});
}

void LightBuilder::checkGroups() {
    std::set<std::string_view> known;
    for (const auto& light : lights_) known.insert(context_.built.scene.names.at(light.get()));
    const std::vector<std::string_view> names(known.begin(), known.end());
    for (const LightGroup& group : context_.built.layers.groups)
        for (const std::string& member : group.members)
            if (!known.contains(member)) {
                const std::string_view near = schema::nearest(member, names);
                context_.diagnostics
                    .error("E0655", context_.built.film.layers.span, fmt::format("no light is called `{}`", member),
                           fmt::format("in the light group `{}`", group.name))
                    .help = near.empty() ? "give the light a name: `light NAME quad { … }`" : schema::didYouMean(near);
            }
}

double LightBuilder::commit(const Bounds3& box) {
    double emitted = 0;
    for (std::size_t i = 0; i < lights_.size(); ++i) {
        lights_[i]->commit(box);
        emitted += lights_[i]->power();
        context_.built.facts.lightList.push_back({names_[i].first, names_[i].second, lights_[i]->power()});
    }
    return emitted;
}

BuildContext& LightSite::scene() { return lights_.scene(); }

std::optional<LightContext> LightSite::context(const KeyedTransform* own, std::optional<LightMotion>& motion) {
    LightContext context = lights_.contextOf(definition_, place_.motion);
    if (!own) return context;
    if (!lights_.motion().ofLight(lights_.motion().within(place_.motion, *own), definition_.span, motion))
        return std::nullopt;
    if (motion) context.motion = &*motion;
    return context;
}

void LightSite::add(std::unique_ptr<PlacedLight> light, const LightContext& context, Visibility own) {
    lights_.add(inMotion(std::move(light), context), definition_, place_.visible & own);
}

void LightSite::add(std::unique_ptr<DistantLight> light, const LightContext& context, Visibility own) {
    lights_.add(inMotion(std::move(light), context), definition_, place_.visible & own);
}

void LightSite::addArea(const AreaLightParams& params, const std::function<void(DigestWriter&)>& addMeaning,
                        const MakeSurface& make) {
    const Transform outer = lights_.motion().atOpening(place_.motion);
    const Transform toRender = params.transform.at(lights_.motion().opening()).then(outer);
    const ShapeContext surroundings = lights_.shapes().contextOf(definition_);
    const auto addAll = [&](DigestWriter& writer) {
        writer.text(definition_.type->name);
        writer.number(surroundings.unit), writer.number(surroundings.zUp);
        addMeaning(writer);
    };
    auto shape =
        lights_.shapes().lightSurface(definition_, toRender, addAll, [&] { return make(toRender, surroundings); });
    if (!shape) return;
    placer_.carry(params.transform, place_, definition_.span, [&](const Place& place) {
        LightContext context = lights_.contextOf(definition_, place_.motion);
        std::optional<LightMotion> motion;
        if (!lights_.motion().ofLight(place.motion, definition_.span, motion) ||
            !lights_.takeTexture(params, *shape, definition_, context))
            return;
        const auto toOwn = toRender.inverse();
        context.toOwn = toOwn.value_or(Transform{});
        if (motion) context.motion = &*motion;
        auto light = makeAreaLight(params, *shape, context, scene().diagnostics);
        if (!light || !lights_.checkPower(*light, definition_.span)) return;
        // A light emits and reflects nothing.
        const Shape* const placed = lights_.shapes().keep(std::move(shape));
        scene().built.scene.names[placed] = scene().nameOf(definition_);
        scene().built.declared[placed] = definition_.nameSpan;
        placer_.noteBounds(definition_, placed->bounds(), place);
        const Visibility visible = place.visible & visibilityOf(params.visibleTo);
        placer_.noteVisible(visible, {}, definition_);
        placer_.add(*placed,
                    {lights_.shapes().materials.plain(0), light.get(), toOwn, context.texture != nullptr, visible},
                    place);
        lights_.add(std::move(light), definition_, visible);
    });
}

std::unique_ptr<const Shape> placeLightQuad(const LightQuadParams& p, const Transform& place, const ShapeContext& c) {
    return placeQuad(p.points, p.size, place, c.span, c.diagnostics);
}

std::unique_ptr<const Shape> placeLightDisk(const LightDiskParams& p, const Transform& place, const ShapeContext& c) {
    return placeDisk(p.center, p.normal, p.radius, place, c.span, c.diagnostics);
}

std::unique_ptr<const Shape> placeLightSphere(const LightSphereParams& p, const Transform& place,
                                              const ShapeContext& c) {
    return placeSphere(p.center, p.radius, place, c.span, c.diagnostics);
}

std::unique_ptr<const Shape> placeLightMesh(const LightMeshParams& p, const Transform& place, const ShapeContext& c) {
    const Vec3d origin = farMiddle(p.points);
    auto mesh = loadMesh(p.file, c.unit, relativeTo(origin, p.points), p.faces, c.span, c.diagnostics, c.zUp);
    if (!mesh) return nullptr;
    if (!p.file.value.empty()) c.files.push_back(p.file.value);
    return placeMesh(std::move(*mesh), Transform::translate(origin).then(place), c.span, c.diagnostics);
}

void addMeaning(DigestWriter& writer, const LightQuadParams& p) {
    for (const Vec3d corner : p.points) writer.add(corner);
    writer.number(p.size.x), writer.number(p.size.y);
}

void addMeaning(DigestWriter& writer, const LightDiskParams& p) {
    writer.add(p.center), writer.add(p.normal);
    writer.number(p.radius);
}

void addMeaning(DigestWriter& writer, const LightSphereParams& p) {
    writer.add(p.center);
    writer.number(p.radius);
}

void addMeaning(DigestWriter& writer, const LightMeshParams& p) {
    if (!p.file.value.empty()) addFile(writer, p.file.value);
    for (const auto& [key, value] : p.file.keys) writer.text(key), writer.text(value);
    writer.number(p.points.size());
    for (const Vec3d point : p.points) writer.add(point);
    writer.bytes(std::as_bytes(std::span(p.faces.counts)));
    writer.bytes(std::as_bytes(std::span(p.faces.indices)));
}

// Lights that files describe: goniometric diagrams and pictures of all directions.

namespace {

// L(λ) = 2 m R(λ; rgb / 2m) I(λ), m the largest component: reflectances of at most a half stay where the model is
// smooth, and white is the illuminant of the space with Y = 1 [Jakob2019, sec. 4].
class TableRadiance final : public RgbRadiance {
  public:
    TableRadiance(const RgbSpace& space, const NamedSpectrum& white)
        : table_(UpsamplingTable::loadOrBuild(space)), white_(illuminantCurve(white)) {}

    Spectrum at(Vec3 rgb, const Wavelengths& lambda) const noexcept override {
        const float scale = 2 * maxComponent(rgb);
        if (!(scale > 0)) return Spectrum(0.f);
        return table_.lookup(rgb * (1 / scale)).at(lambda) * white_->at(lambda) * scale;
    }

  private:
    UpsamplingTable table_;
    std::unique_ptr<const Curve> white_;
};

// The upsampler of an RGB space, or null with the reason in `error`.
std::unique_ptr<const RgbRadiance> makeRgbRadiance(const RgbSpace& space, std::string& error) {
    const auto white = findIlluminant(space.illuminant);
    if (!white) {
        error = fmt::format("no spectrum is known for the white of `{}`", space.name);
        return nullptr;
    }
    return std::make_unique<TableRadiance>(space, *white);
}

} // namespace

std::unique_ptr<PlacedLight> loadIesLight(const IesLightParams& params, const LightContext& context,
                                          BuildContext& scene) {
    IntensityTable table;
    if (!readsFile(
            params.file.value, params.file.span, scene.diagnostics, [&] { table = readIes(params.file.value); },
            "E0752"))
        return nullptr;
    auto light = makeIesLight(params, std::move(table), context, scene.diagnostics);
    scene.noteFile(params.file.value);
    return light;
}

namespace {

RgbSpace environmentSpace(const EnvironmentLightParams& params, const RgbImage& file) {
    RgbSpace space = file.chromaticities ? file.chromaticities->space() : rgb::rec709;
    for (const auto& [key, word] : params.image.keys)
        if (key == "space") space = abbe::findRgbSpace(word).value_or(space);
    return space;
}

// Null after an error.
std::shared_ptr<const EnvironmentTables> readEnvironment(const EnvironmentLightParams& params,
                                                         const LightContext& context, Diagnostics& diagnostics) {
    RgbImage file;
    if (!readsFile(params.image.value, params.image.span, diagnostics, [&] { file = readImage(params.image.value); }))
        return nullptr;
    std::string reason;
    auto upsampling = makeRgbRadiance(environmentSpace(params, file), reason);
    if (!upsampling) {
        diagnostics.error("E0403", params.image.span, reason);
        return nullptr;
    }
    EnvironmentImage image{file.width(), file.height(), std::move(file.rgb)};
    if (!checkEnvironmentImage(image, environmentScale(params), context.span, diagnostics)) return nullptr;
    return std::make_shared<const EnvironmentTables>(std::move(image), std::move(upsampling), context.besideScattering);
}

} // namespace

std::unique_ptr<DistantLight> loadEnvironmentLight(const EnvironmentLightParams& params, const LightContext& context,
                                                   BuildContext& scene) {
    DigestWriter key("environment");
    addFile(key, params.image.value);
    for (const auto& [name, word] : params.image.keys) key.text(name), key.text(word);
    key.number(context.besideScattering);
    const Span spans[] = {context.span, params.image.span};
    auto tables = scene.reused<EnvironmentTables>(Reused::texture, key.digest(), spans,
                                                  [&] { return readEnvironment(params, context, scene.diagnostics); });
    if (!tables) return nullptr;
    scene.noteFile(params.image.value);
    if (!checkBrightestPixel(tables->image, environmentScale(params), context.span, scene.diagnostics)) return nullptr;
    auto light = makeEnvironmentLight(params, std::move(tables), key.digest(), context, scene.diagnostics);
    if (light && !(light->power() > 0)) {
        scene.diagnostics.warning("W0602", params.image.span, "this environment is black; the light is left out");
        return nullptr;
    }
    return light;
}

} // namespace abbe
