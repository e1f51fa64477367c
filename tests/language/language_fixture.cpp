#include "language_fixture.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <unistd.h>

namespace language_test {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kDeg = kPiD / 180;

TypeInfo camera() {
    return {Kind::camera,
            "perspective",
            "A camera.",
            "camera { lens 50 mm }",
            true,
            {
                make(FieldType::quantity, "lens", &Params::lens)
                    .doc("Focal length.")
                    .example("lens 50 mm")
                    .byDefault("50 mm")
                    .unit({Dimension::length})
                    .range(0.0001, 10)
                    .usually(3, "mm")
                    .group("field of view")
                    .synonyms({"focal-length"}),
                make(FieldType::quantity, "fov", &Params::fov)
                    .doc("Full horizontal angle.")
                    .example("fov 40 deg")
                    .unit({Dimension::angle})
                    .range(0.1 * kDeg, 179 * kDeg)
                    .group("field of view")
                    .synonyms({"fovy", "angle"}),
                make(FieldType::number, "f-stop", &Params::fStop)
                    .doc("Aperture.")
                    .example("f-stop 2.8")
                    .range(0.5, 128)
                    .note("f-number = focal length / aperture diameter; to give the diameter, use `aperture 30 mm`"),
                make(FieldType::vector3, "from", &Params::from)
                    .doc("Position.")
                    .example("from 0 1 4")
                    .unit({Dimension::length}),
                make(FieldType::vector3, "look-at", &Params::center).doc("Target.").unit({Dimension::length}),
                make(FieldType::vector2, "sensor", &Params::sensor)
                    .doc("Sensor size.")
                    .unit({Dimension::length})
                    .byDefault("36 24 mm"),
                make(FieldType::quantity, "shutter", &Params::time).doc("Exposure time.").unit({Dimension::time}),
            }};
}

TypeInfo light(std::string_view name) {
    return {
        Kind::light,
        name,
        "A light.",
        "light quad { power 60 W }",
        false,
        {
            make(FieldType::quantity, "power", &Params::amount)
                .unit({Dimension::power, Dimension::luminousFlux})
                .range(0, kInf)
                .example("power 60 W")
                .group("amount")
                .required(),
            make(FieldType::quantity, "luminance", &Params::luminance)
                .unit({Dimension::luminance})
                .range(0, kInf)
                .group("amount"),
            make(FieldType::spectrum, "radiance", &Params::radiance).role(SpectrumRole::emission).group("amount"),
            make(FieldType::spectrum, "color", &Params::color).role(SpectrumRole::shape).byDefault("illuminant D65"),
            make(FieldType::vector2, "size", &Params::size).unit({Dimension::length}),
            make(FieldType::transform, "transform", &Params::transform),
        }};
}

std::vector<FieldInfo> shapeFields(std::vector<FieldInfo> own) {
    own.push_back(make(FieldType::reference, "material", &Params::material).to(Kind::material));
    own.push_back(make(FieldType::transform, "transform", &Params::transform));
    return own;
}

FieldInfo pointsField() { return make(FieldType::points, "points", &Params::points).unit({Dimension::length}); }

TypeInfo shape(std::string_view name, std::vector<FieldInfo> own) {
    return {Kind::shape, name, "A shape.", "shape sphere { radius 1 }", false, shapeFields(std::move(own))};
}

TypeInfo meshLike(std::string_view name) {
    return shape(name, {make(FieldType::file, "file", &Params::file).argument(0), pointsField(),
                        make(FieldType::indexRows, "faces", &Params::faces),
                        make(FieldType::numbers, "weights", &Params::numbers).range(0, 1)});
}

FieldInfo roughness() { return make(FieldType::number, "roughness", &Params::roughness).range(0, 1).byDefault("0"); }

FieldInfo reflectance() {
    return make(FieldType::spectrum, "reflectance", &Params::reflectance)
        .role(SpectrumRole::albedo)
        .synonyms({"Kd", "albedo"});
}

TypeInfo material(std::string_view name, std::vector<FieldInfo> fields) {
    return {Kind::material, name, "A material.", "material diffuse { reflectance 0.5 }", false, std::move(fields)};
}

TypeInfo texture(std::string_view name) {
    return {Kind::texture,
            name,
            "A texture.",
            "texture noise { scale 2 cm }",
            false,
            {make(FieldType::quantity, "scale", &Params::radius).unit({Dimension::length}),
             make(FieldType::text, "pattern", &Params::file).argument(0).key({"space", {"data"}, "The space."}),
             make(FieldType::spectrum, "odd", &Params::paint).range(0, 1)}};
}

} // namespace

TypeTable testTypes() {
    TypeTable table;
    table.add(camera());
    for (const char* name : {"quad", "sky", "sun"}) table.add(light(name));
    table.add(shape("sphere", {make(FieldType::quantity, "radius", &Params::radius)
                                   .unit({Dimension::length})
                                   .range(std::numeric_limits<double>::min(), kInf)
                                   .byDefault("1")
                                   .synonyms({"r"}),
                               make(FieldType::vector3, "center", &Params::center).unit({Dimension::length})}));
    table.add(shape("plane", {}));
    table.add(
        shape("quad", {pointsField(), make(FieldType::vector2, "size", &Params::size).unit({Dimension::length})}));
    table.add(meshLike("mesh"));
    table.add(material(
        "diffuse",
        {reflectance(), roughness(), make(FieldType::spectrum, "paint", &Params::paint).range(0, 1),
         make(FieldType::number, "gloss", &Params::gloss).unit({Dimension::none, Dimension::fraction}).range(0, 1)}));
    table.add(texture("noise"));
    table.add(texture("image"));
    table.add(material("dielectric",
                       {make(FieldType::spectrum, "ior", &Params::ior).role(SpectrumRole::index).byDefault("glass BK7"),
                        make(FieldType::spectrum, "absorption", &Params::absorption)
                            .role(SpectrumRole::unbounded)
                            .unit({Dimension::inverseLength}),
                        roughness()}));
    table.add(material("conductor", {make(FieldType::complexIndex, "ior", &Params::metal).required(), roughness()}));
    table.add(
        {Kind::film,
         "image",
         "The film.",
         "film { }",
         true,
         {make(FieldType::choice, "filter", &Params::filter)
              .choices({"box", "gaussian", "blackman-harris"})
              .range(0, 10),
          make(FieldType::text, "output", &Params::output).key({"space", {"acescg", "aces2065-1"}, "The space."})}});
    table.add({Kind::render,
               "path",
               "Settings.",
               "render { samples 16 }",
               true,
               {make(FieldType::integer, "samples", &Params::samples).range(1, 1e6).byDefault("64").synonyms({"spp"}),
                make(FieldType::toggle, "denoise", &Params::denoise).byDefault("off"),
                make(FieldType::number, "noise", &Params::radianceScale).unit({Dimension::fraction}).range(0, 1)}});
    return table;
}

const Curve* RecordingResolver::curve(const SpectrumValue& value, SpectrumRole, Diagnostics&) {
    values.push_back(value);
    return &curve_;
}

ComplexIndex RecordingResolver::metal(std::string_view name, Span, Diagnostics&) {
    metals.emplace_back(name);
    return {&curve_, &curve_};
}

Reference RecordingResolver::reference(const Definition& d, Diagnostics&) {
    references.push_back(!d.name.empty() ? d.name : d.type ? "(" + std::string(d.type->name) + ")" : "(?)");
    return d.type ? Reference{static_cast<std::uint32_t>(references.size() - 1)} : Reference{};
}

const Texture* RecordingResolver::texture(const TextureRequest& use, Diagnostics&) {
    const Definition& d = use.definition;
    textures.push_back(fmt::format("{}{}", d.name.empty() ? fmt::format("({})", d.type->name) : d.name,
                                   use.role ? "" : " as a number"));
    return reinterpret_cast<const Texture*>(kTexture);
}

namespace {

void bindAll(Loaded& loaded, const std::vector<Definition>& definitions, Diagnostics& diagnostics) {
    for (const Definition& d : definitions) {
        bindAll(loaded, d.children, diagnostics);
        if (d.kind == Kind::group || d.kind == Kind::object || d.kind == Kind::instance || d.kind == Kind::instances ||
            d.kind == Kind::atmosphere || d.kind == Kind::spectrum)
            continue;
        const std::string key = std::string(keyword(d.kind)) + (d.name.empty() ? "" : " " + d.name);
        Params params;
        bind(d, loaded.tree, loaded.types, loaded.resolver, d.type ? &params : nullptr, diagnostics);
        loaded.params[key] = params;
    }
}

} // namespace

std::string Loaded::codes() const {
    std::vector<Diagnostic> sorted = diagnostics.all();
    std::ranges::stable_sort(sorted, {}, [](const Diagnostic& d) { return d.span.begin; });
    std::string text;
    for (const Diagnostic& d : sorted) text += (text.empty() ? "" : " ") + d.code;
    return text;
}

const Diagnostic& Loaded::get(std::string_view code) const {
    for (const Diagnostic& d : diagnostics.all())
        if (d.code == code) return d;
    static const Diagnostic none;
    FAIL_CHECK("no diagnostic " << std::string(code) << " in:\n" << human());
    return none;
}

std::string Loaded::names() const {
    std::string text;
    const auto list = [&](const auto& self, const std::vector<Definition>& definitions) -> void {
        for (const Definition& d : definitions) {
            text +=
                fmt::format("{}{}{}{}", text.empty() ? "" : ", ", keyword(d.kind), d.name.empty() ? "" : " ", d.name);
            self(self, d.children);
        }
    };
    list(list, tree.definitions);
    return text;
}

std::unique_ptr<Loaded> load(std::string text, std::filesystem::path directory, const Choices& choices) {
    auto loaded = std::make_unique<Loaded>();
    const FileId file = loaded->map.add("test.scene", std::move(text));
    LayerOptions options{{}, choices.variants, choices.sets};
    for (const std::string& define : choices.defines)
        if (auto given = readOverride(loaded->map, define, loaded->diagnostics))
            options.defines.push_back(std::move(*given));
    const auto files = readLayerFiles(loaded->map, file, directory / "test.scene", options, loaded->diagnostics);
    loaded->tree = resolve(files, loaded->types, loaded->diagnostics);
    Diagnostics found = loaded->diagnostics;
    const std::size_t known = found.all().size();
    bindAll(*loaded, loaded->tree.definitions, found);
    addWithIncluders(loaded->tree, found, known, loaded->diagnostics); // as buildScene() does
    return loaded;
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "abbe-language-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

void TemporaryFolder::write(const std::filesystem::path& name, std::string_view text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
}

} // namespace language_test
