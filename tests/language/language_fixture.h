// A small set of types, a resolver that records what it is asked, and a whole load of a text for the tests.
#pragma once

#include "base/diagnostic.h"
#include "base/diagnostic_format.h"
#include "base/source.h"
#include "parser/layer_files.h"
#include "schema/scene_tree.h"
#include "spectrum/curve.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace language_test {

using namespace abbe;
using namespace abbe::schema;

// The members of all test types: one struct is enough to see what is stored.
struct Params {
    double lens = 0, fov = 0, fStop = 0, radius = 0, roughness = -1, power = 0, radianceScale = -1;
    Quantity amount;
    double luminance = -1;
    std::int64_t samples = 0;
    Vec3d from, center;
    Vec2d sensor, size;
    bool denoise = false;
    Choice filter;
    Text output, file;
    std::vector<Vec3d> points;
    std::vector<double> numbers;
    IndexRows faces;
    const Curve* reflectance = nullptr;
    TexturedSpectrum paint;
    TexturedNumber gloss = {0.25, nullptr, {}};
    const Curve* ior = nullptr;
    const Curve* radiance = nullptr;
    const Curve* absorption = nullptr;
    const Curve* color = nullptr;
    ComplexIndex metal;
    Reference material;
    Transform transform;
    std::optional<double> time;
};

template <typename Member> auto make(FieldType type, std::string_view name, Member Params::*member) {
    return field(type, name, member);
}

TypeTable testTypes();

// Gives every curve a number and keeps the values it was asked for.
class RecordingResolver final : public Resolver {
  public:
    const Curve* curve(const SpectrumValue& value, SpectrumRole, Diagnostics&) override;
    ComplexIndex metal(std::string_view name, Span, Diagnostics&) override;
    Reference reference(const Definition&, Diagnostics&) override;
    const Texture* texture(const TextureRequest&, Diagnostics&) override;

    std::vector<SpectrumValue> values;
    std::vector<std::string> metals;
    std::vector<std::string> references; // "name" or "(type)"
    std::vector<std::string> textures;   // the same

    static constexpr std::uintptr_t kTexture = 0x1000; // stands for any texture

  private:
    ConstantCurve curve_{1};
};

// One text taken through parser, resolve and bind.
struct Loaded {
    SourceMap map;
    TypeTable types = testTypes();
    Diagnostics diagnostics;
    SceneTree tree;
    RecordingResolver resolver;
    std::map<std::string, Params> params; // by "kind name", or "kind" for unnamed ones

    // "E0201 E0302": the codes in the order of the text.
    std::string codes() const;
    // The first diagnostic with that code; fails the test if there is none.
    const Diagnostic& get(std::string_view code) const;
    std::string text(Span span) const { return std::string(map.text(span)); }
    std::string human() const { return formatHuman(diagnostics, map); }
    // "kind name" of all definitions, nested ones behind theirs.
    std::string names() const;
};

// The command line's part: `-D` as "name=value", variants, and `--set`.
struct Choices {
    std::vector<std::string> defines = {}, variants = {}, sets = {};
};

// The text stands for the file `test.scene` of the folder.
std::unique_ptr<Loaded> load(std::string text, std::filesystem::path directory = ".", const Choices& = {});

// The same with `scene 1` in front, so that the missing edition is no warning.
inline std::unique_ptr<Loaded> loadBody(const std::string& text, std::filesystem::path directory = ".") {
    return load("scene 1\n" + text, std::move(directory));
}

// A folder that exists during a test.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    void write(const std::filesystem::path& name, std::string_view text) const;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

} // namespace language_test
