#include "exchange/pbrt/pbrt_machine.h"

#include "io/file.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// Files may include each other; these bounds end what would otherwise not end.
constexpr std::size_t kPbrtMostOpen = 64, kPbrtMostFiles = 20'000, kPbrtMostBytes = std::size_t(1) << 34;

struct PbrtTypeName {
    std::string_view word, proper;
    char values; // n numbers, t texts, b switches, s either numbers or a name
};
constexpr std::array<PbrtTypeName, 17> kPbrtTypes{{{"float", "float", 'n'},
                                                   {"integer", "integer", 'n'},
                                                   {"bool", "bool", 'b'},
                                                   {"string", "string", 't'},
                                                   {"texture", "texture", 't'},
                                                   {"rgb", "rgb", 'n'},
                                                   {"spectrum", "spectrum", 's'},
                                                   {"blackbody", "blackbody", 'n'},
                                                   {"point2", "point2", 'n'},
                                                   {"vector2", "vector2", 'n'},
                                                   {"point3", "point3", 'n'},
                                                   {"point", "point3", 'n'},
                                                   {"vector3", "vector3", 'n'},
                                                   {"vector", "vector3", 'n'},
                                                   {"normal3", "normal3", 'n'},
                                                   {"normal", "normal3", 'n'},
                                                   {"int", "integer", 'n'}}};

const PbrtTypeName* pbrtType(std::string_view word) {
    const auto found = std::ranges::find(kPbrtTypes, word, &PbrtTypeName::word);
    return found == kPbrtTypes.end() ? nullptr : &*found;
}

} // namespace

bool PbrtMotion::moves() const { return std::memcmp(&at[0], &at[1], sizeof(Transform)) != 0; }

PbrtMachine::PbrtMachine(PbrtShared& shared)
    : shared_(shared), textures_(shared), materials_(shared, textures_), media_(shared),
      shapes_(shared, textures_, materials_, media_), lights_(shared), view_(shared) {
    shapes_.into(shared_.world, false);
}

const std::map<std::string_view, PbrtMachine::Action>& PbrtMachine::actions() {
    using M = PbrtMachine;
    static const std::map<std::string_view, Action> kActions = {
        {"Identity", &M::identity},
        {"Translate", &M::translate},
        {"Scale", &M::scale},
        {"Rotate", &M::rotate},
        {"LookAt", &M::lookAt},
        {"Transform", &M::matrix},
        {"ConcatTransform", &M::matrix},
        {"CoordinateSystem", &M::coordinateSystem},
        {"CoordSysTransform", &M::coordinateSystem},
        {"ActiveTransform", &M::activeTransform},
        {"TransformTimes", &M::transformTimes},
        {"ReverseOrientation", &M::reverseOrientation},
        {"AttributeBegin", &M::begin},
        {"AttributeEnd", &M::end},
        {"TransformBegin", &M::begin},
        {"TransformEnd", &M::end},
        {"ObjectBegin", &M::objectBegin},
        {"ObjectEnd", &M::end},
        {"ObjectInstance", &M::objectInstance},
        {"WorldBegin", &M::worldBegin},
        {"Include", &M::include},
        {"Import", &M::include},
        {"Option", &M::option},
        {"Attribute", &M::attribute},
        {"ColorSpace", &M::colorSpace},
        {"Camera", &M::view},
        {"Film", &M::view},
        {"PixelFilter", &M::view},
        {"Sampler", &M::view},
        {"Integrator", &M::view},
        {"Accelerator", &M::view},
        {"Material", &M::material},
        {"MakeNamedMaterial", &M::material},
        {"NamedMaterial", &M::namedMaterial},
        {"MakeNamedMedium", &M::namedMedium},
        {"MediumInterface", &M::mediumInterface},
        {"Texture", &M::texture},
        {"LightSource", &M::light},
        {"AreaLightSource", &M::areaLight},
        {"Shape", &M::shape},
        {"WorldEnd", &M::oldDirective},
        {"SurfaceIntegrator", &M::oldDirective},
        {"VolumeIntegrator", &M::oldDirective},
        {"Renderer", &M::oldDirective},
        {"Volume", &M::oldDirective},
        {"SearchPath", &M::oldDirective},
    };
    return kActions;
}

void PbrtMachine::syntax(Span span, std::string message) { shared_.faults().error("E0801", span, std::move(message)); }

void PbrtMachine::oldDirective(PbrtScanner&, const PbrtToken& word) {
    throw PbrtOldScene{word.span, fmt::format("`{}`", word.raw)};
}

void PbrtMachine::run(const std::filesystem::path& path) {
    const auto key = std::filesystem::absolute(path).lexically_normal();
    if (std::ranges::find(open_, key) != open_.end())
        throw IoError(fmt::format("`{}` includes itself", path.filename().string()));
    if (open_.size() >= kPbrtMostOpen || fileCount_ >= kPbrtMostFiles || bytes_ >= kPbrtMostBytes)
        throw IoError("files are included without end");
    const auto known = files_.find(key);
    FileId file = known == files_.end() ? FileId::none : known->second;
    if (file == FileId::none) {
        std::string text = pbrtReadFile(path);
        if (text.size() >= 0xffffffffu) throw IoError(fmt::format("`{}` is 4 GiB or larger", path.string()));
        file = shared_.out.sources.add(path.string(), std::move(text));
        files_.emplace(key, file);
    }
    open_.push_back(key);
    const std::string_view text = shared_.out.sources.text(file);
    bytes_ += text.size();
    ++fileCount_;
    runText(text, file);
    open_.pop_back();
}

void PbrtMachine::runText(std::string_view text, FileId file) {
    PbrtScanner scanner(text, file);
    while (true) {
        const PbrtToken token = scanner.next();
        if (token.kind == PbrtToken::Kind::end) return;
        if (token.kind == PbrtToken::Kind::word) {
            directive(scanner, token);
            continue;
        }
        syntax(token.span, token.kind == PbrtToken::Kind::fault ? token.what : "a directive is expected here");
        scanner.skipToDirective();
    }
}

void PbrtMachine::directive(PbrtScanner& scanner, const PbrtToken& word) {
    const auto action = actions().find(word.raw);
    if (action != actions().end()) {
        try {
            return (this->*action->second)(scanner, word);
        } catch (const IoError& fault) {
            return void(shared_.faults().error("E0802", word.span, fault.what()));
        }
    }
    auto& d =
        shared_.faults().error("E0801", word.span, fmt::format("there is no directive `{}`", word.raw.substr(0, 40)));
    if (word.raw.size() < 40)
        for (const auto& [known, function] : actions())
            if (schema::editDistance(known, word.raw) <= 2) d.help = schema::didYouMean(known);
    scanner.skipToDirective();
}

std::optional<std::string> PbrtMachine::name(PbrtScanner& scanner, const PbrtToken& word, const char* what) {
    if (scanner.peek().kind == PbrtToken::Kind::text) return scanner.next().text();
    syntax(word.span, fmt::format("`{}` is followed by {} in quotes", word.raw, what));
    scanner.skipToDirective();
    return std::nullopt;
}

bool PbrtMachine::numbers(PbrtScanner& scanner, const PbrtToken& word, std::span<double> out) {
    const bool isBracketed = scanner.peek().kind == PbrtToken::Kind::open;
    if (isBracketed) scanner.next();
    for (double& value : out) {
        if (scanner.peek().kind != PbrtToken::Kind::number) {
            syntax(word.span, fmt::format("`{}` takes {} numbers", word.raw, out.size()));
            scanner.skipToDirective();
            return false;
        }
        value = scanner.next().number;
    }
    if (isBracketed && scanner.peek().kind == PbrtToken::Kind::close) scanner.next();
    return true;
}

// One value of a parameter. Returns false where it is of another kind.
bool PbrtMachine::value(PbrtScanner& scanner, PbrtParam& out, const PbrtToken& token) {
    const char values = pbrtType(out.type)->values;
    if (token.kind == PbrtToken::Kind::number && (values == 'n' || values == 's')) {
        out.numbers.push_back(token.number);
        scanner.numbers(out.numbers); // the rest of a list, without a token each
        return true;
    }
    const bool isSwitch = token.raw == "true" || token.raw == "false";
    if (values == 'b' && isSwitch) {
        out.flags.push_back(token.raw == "true");
        return true;
    }
    if (token.kind != PbrtToken::Kind::text || (values != 't' && values != 's')) return false;
    out.texts.push_back(token.text());
    return true;
}

bool PbrtMachine::param(PbrtScanner& scanner, PbrtParam& out) {
    const PbrtToken declaration = scanner.next();
    out.span = declaration.span;
    out.colorSpace = state_.colorSpace;
    const std::string text = declaration.text();
    const auto space = text.find_first_not_of(" \t");
    const auto typeEnd = text.find_first_of(" \t", space == std::string::npos ? 0 : space);
    const auto nameBegin = typeEnd == std::string::npos ? typeEnd : text.find_first_not_of(" \t", typeEnd);
    if (nameBegin == std::string::npos) {
        syntax(out.span, fmt::format("a parameter is declared as \"type name\", not `{}`", text.substr(0, 40)));
        return false;
    }
    const std::string word = text.substr(space, typeEnd - space);
    const PbrtTypeName* type = pbrtType(word);
    if (!type) {
        if (word == "color" || word == "xyz")
            throw PbrtOldScene{out.span, fmt::format("a parameter of type `{}`", word)};
        syntax(out.span, fmt::format("there is no type of parameter `{}`", word.substr(0, 40)));
        return false;
    }
    out.type = type->proper;
    out.name = text.substr(nameBegin, text.find_first_of(" \t", nameBegin) - nameBegin);
    const auto wrong = [&](const PbrtToken& token) {
        syntax(token.span,
               token.kind == PbrtToken::Kind::fault
                   ? token.what
                   : fmt::format("this is no value of the parameter `{}` of type `{}`", out.name, out.type));
        return false;
    };
    PbrtToken token = scanner.next();
    if (token.kind != PbrtToken::Kind::open) return value(scanner, out, token) || wrong(token);
    while (true) {
        token = scanner.next();
        if (token.kind == PbrtToken::Kind::close) return true;
        if (!value(scanner, out, token)) return wrong(token);
    }
}

bool PbrtMachine::params(PbrtScanner& scanner, PbrtParams& out, std::string_view attributes) {
    while (scanner.peek().kind == PbrtToken::Kind::text) {
        PbrtParam one;
        if (!param(scanner, one)) {
            scanner.skipToDirective();
            return false;
        }
        out.add(std::move(one));
    }
    if (const auto found = state_.attributes.find(attributes); found != state_.attributes.end())
        out.addDefaults(found->second);
    return true;
}

bool PbrtMachine::inWorld(const PbrtToken& word, bool wanted) {
    if (inWorld_ == wanted) return true;
    shared_.faults().error("E0802", word.span,
                           fmt::format("`{}` stands {} `WorldBegin`", word.raw, wanted ? "before" : "behind"));
    return false;
}

void PbrtMachine::finish() {
    shapes_.flush();
    for (const Block& block : blocks_) syntax(block.begin, "this block is never closed");
    if (!inWorld_) shared_.faults().error("E0802", {}, "there is no `WorldBegin`, so that the scene has no contents");
    for (auto& [name, object] : objects_) {
        SceneNode node("object");
        node.name(object.word);
        for (SceneNode& inner : object.nodes) node.adopt(std::move(inner));
        shared_.definitions.push_back(std::move(node));
    }
    materials_.finish();
    for (const auto& light : areaLights_)
        if (light->has("L") || light->has("filename") || light->has("scale"))
            light->reportUnused("an area light", shared_.faults());
    view_.finish(firstTime_, lastTime_);
    const bool isEverywhere = shapes_.placeMedia(view_.mediumName(), view_.eye());
    if (view_.mediumName().empty()) return;
    const PbrtMedium* medium = media_.use(view_.mediumName(), {});
    if (medium && !medium->word.empty() && isEverywhere) {
        SceneNode around("atmosphere");
        shared_.definitions.push_back(std::move(around.name(medium->word)));
    }
}

} // namespace abbe::exchange
