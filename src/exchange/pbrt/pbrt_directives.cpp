// The directives of pbrt's scene description: of PbrtMachine.
#include "exchange/pbrt/pbrt_machine.h"
#include "exchange/shared/placement.h"
#include "io/file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// Numbers that a scene can state, with room for what is made of them.
bool pbrtIsUsable(const Transform& t) {
    constexpr double kLargest = 1e30;
    if (!t.isFinite() || !t.inverse()) return false;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            if (std::abs(t.a[r][c]) > kLargest) return false;
    return maxComponent(abs(t.t)) <= kLargest;
}

} // namespace

void PbrtMachine::identity(PbrtScanner&, const PbrtToken& word) { applyMatrix(Transform(), true, word.span); }

void PbrtMachine::applyMatrix(const Transform& t, bool replace, Span span) {
    PbrtMotion made = state_.place;
    for (unsigned i = 0; i < 2; ++i)
        if (replace && (state_.active >> i & 1u) != 0) made.at[i] = Transform();
    made.concat(t, state_.active);
    if (pbrtIsUsable(made.at[0]) && pbrtIsUsable(made.at[1]))
        state_.place = made;
    else
        shared_.faults().error("E0802", span, "this makes everything vanish or infinitely large");
}

void PbrtMachine::translate(PbrtScanner& scanner, const PbrtToken& word) {
    std::array<double, 3> v{};
    if (numbers(scanner, word, v)) applyMatrix(Transform::translate({v[0], v[1], v[2]}), false, word.span);
}

void PbrtMachine::scale(PbrtScanner& scanner, const PbrtToken& word) {
    std::array<double, 3> v{};
    if (!numbers(scanner, word, v)) return;
    if (v[0] == 0 || v[1] == 0 || v[2] == 0)
        return void(shared_.faults().error("E0802", word.span, "a scale of 0 leaves nothing"));
    applyMatrix(Transform::scale({v[0], v[1], v[2]}), false, word.span);
}

void PbrtMachine::rotate(PbrtScanner& scanner, const PbrtToken& word) {
    std::array<double, 4> v{};
    if (!numbers(scanner, word, v)) return;
    const Vec3d axis{v[1], v[2], v[3]};
    if (axis == Vec3d()) return void(shared_.faults().error("E0802", word.span, "an axis of length 0"));
    applyMatrix(Transform::rotate(axis, v[0] * kDegree), false, word.span);
}

void PbrtMachine::lookAt(PbrtScanner& scanner, const PbrtToken& word) {
    std::array<double, 9> v{};
    if (!numbers(scanner, word, v)) return;
    const Vec3d from{v[0], v[1], v[2]}, to{v[3], v[4], v[5]}, up{v[6], v[7], v[8]};
    const Vec3d ahead = to - from, across = cross(up, ahead);
    if (lengthSquared(across) <= 1e-24 * lengthSquared(up) * lengthSquared(ahead))
        return void(shared_.faults().error("E0802", word.span, "`LookAt` looks along its own up"));
    const Vec3d z = normalize(ahead), x = normalize(across), y = cross(z, x);
    if (const auto cameraFromWorld = axesTo(x, y, z, from).inverse()) applyMatrix(*cameraFromWorld, false, word.span);
}

// Sixteen numbers, column by column.
void PbrtMachine::matrix(PbrtScanner& scanner, const PbrtToken& word) {
    std::array<double, 16> m{};
    if (!numbers(scanner, word, m)) return;
    Transform t;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) t.a[r][c] = m[static_cast<std::size_t>(4 * c + r)];
    t.t = {m[12], m[13], m[14]};
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] == 0)
        return void(shared_.faults().error("E0802", word.span, "this matrix is no affine map"));
    if (m[15] != 1) {
        for (auto& row : t.a)
            for (double& value : row) value /= m[15];
        t.t = t.t / m[15];
    }
    if (!t.inverse()) return void(shared_.faults().error("E0802", word.span, "this matrix has no inverse"));
    applyMatrix(t, word.raw == "Transform", word.span);
}

void PbrtMachine::coordinateSystem(PbrtScanner& scanner, const PbrtToken& word) {
    const auto which = name(scanner, word, "the name of a coordinate system");
    if (!which) return;
    if (word.raw == "CoordinateSystem") return void(coordinateSystems_.insert_or_assign(*which, state_.place));
    const auto found = coordinateSystems_.find(*which);
    if (found != coordinateSystems_.end())
        state_.place = found->second;
    else
        shared_.faults().error("E0802", word.span, fmt::format("there is no coordinate system `{}`", *which));
}

void PbrtMachine::activeTransform(PbrtScanner& scanner, const PbrtToken& word) {
    const PbrtToken which = scanner.next();
    if (which.raw == "StartTime")
        state_.active = 1;
    else if (which.raw == "EndTime")
        state_.active = 2;
    else if (which.raw == "All")
        state_.active = 3;
    else {
        syntax(word.span, "`ActiveTransform` takes StartTime, EndTime or All");
        scanner.skipToDirective();
    }
}

void PbrtMachine::transformTimes(PbrtScanner& scanner, const PbrtToken& word) {
    std::array<double, 2> v{};
    if (!numbers(scanner, word, v) || !inWorld(word, false)) return;
    if (v[1] <= v[0]) return void(shared_.faults().error("E0802", word.span, "the motion ends before it begins"));
    firstTime_ = v[0];
    lastTime_ = v[1];
    shapes_.setTimes(v[0], v[1]);
}

void PbrtMachine::reverseOrientation(PbrtScanner&, const PbrtToken&) { state_.isReversed = !state_.isReversed; }

void PbrtMachine::begin(PbrtScanner&, const PbrtToken& word) {
    constexpr std::size_t kMostBlocks = 1000;
    if (blocks_.size() >= kMostBlocks)
        return syntax(word.span, fmt::format("more than {} blocks in each other", kMostBlocks));
    blocks_.push_back(
        {word.raw == "AttributeBegin" ? Block::Kind::attribute : Block::Kind::transform, word.span, state_});
}

void PbrtMachine::end(PbrtScanner&, const PbrtToken& word) {
    const Block::Kind kind = word.raw == "AttributeEnd"   ? Block::Kind::attribute
                             : word.raw == "TransformEnd" ? Block::Kind::transform
                                                          : Block::Kind::object;
    if (blocks_.empty()) return syntax(word.span, fmt::format("`{}` closes nothing", word.raw));
    Block& block = blocks_.back();
    if (block.kind != kind) {
        auto& d =
            shared_.faults().error("E0801", word.span, fmt::format("`{}` closes another kind of block", word.raw));
        d.related.push_back({block.begin, "opened here"});
    }
    if (block.kind == Block::Kind::object) {
        shapes_.into(shared_.world, false);
        object_ = nullptr;
    }
    if (block.kind == Block::Kind::transform)
        state_.place = block.saved.place;
    else
        state_ = std::move(block.saved);
    blocks_.pop_back();
}

void PbrtMachine::objectBegin(PbrtScanner& scanner, const PbrtToken& word) {
    const auto which = name(scanner, word, "the name of an object");
    if (!which || !inWorld(word, true)) return;
    if (object_) return void(shared_.faults().error("E0802", word.span, "objects cannot stand in each other"));
    if (objects_.contains(*which))
        shared_.faults().error("E0802", word.span, fmt::format("the object `{}` is defined twice", *which));
    blocks_.push_back({Block::Kind::object, word.span, state_});
    object_ = &objects_[*which];
    if (object_->word.empty()) object_->word = shared_.objectNames.take(*which, "object");
    shapes_.into(object_->nodes, true);
}

void PbrtMachine::objectInstance(PbrtScanner& scanner, const PbrtToken& word) {
    const auto which = name(scanner, word, "the name of an object");
    if (!which || !inWorld(word, true)) return;
    if (object_) return void(shared_.faults().error("E0802", word.span, "an object cannot hold instances of others"));
    const auto found = objects_.find(*which);
    if (found == objects_.end())
        return void(shared_.faults().error("E0802", word.span, fmt::format("there is no object `{}`", *which)));
    shapes_.flush();
    if (found->second.nodes.empty()) return; // an instance of nothing
    SceneNode node("instance");
    node.name(found->second.word);
    shapes_.place(node, state_.place, Transform());
    shared_.world.push_back(std::move(node));
}

void PbrtMachine::worldBegin(PbrtScanner&, const PbrtToken& word) {
    if (inWorld_) return void(shared_.faults().error("E0802", word.span, "`WorldBegin` stands here again"));
    inWorld_ = true;
    state_.place = {};
    state_.active = 3;
    coordinateSystems_.insert_or_assign("world", state_.place);
}

void PbrtMachine::include(PbrtScanner& scanner, const PbrtToken& word) {
    const auto file = name(scanner, word, "the name of a file");
    if (!file) return;
    const bool isImport = word.raw == "Import"; // whose state does not come back
    const PbrtState saved = isImport ? state_ : PbrtState();
    const std::size_t blocks = blocks_.size();
    try {
        run(shared_.file(*file));
    } catch (const IoError& fault) {
        shared_.faults().error("E0802", word.span, fault.what());
    }
    if (!isImport) return;
    for (; blocks_.size() > blocks; blocks_.pop_back()) syntax(blocks_.back().begin, "this block is never closed");
    state_ = saved;
}

void PbrtMachine::option(PbrtScanner& scanner, const PbrtToken& word) {
    PbrtParam one;
    if (scanner.peek().kind != PbrtToken::Kind::text || !param(scanner, one)) return scanner.skipToDirective();
    if (one.name == "seed" && one.numbers.size() == 1 && std::abs(one.numbers[0]) < 2e9) {
        view_.seed = static_cast<int>(one.numbers[0]);
        return;
    }
    // What changes the speed or the files of pbrt alone is no loss.
    constexpr std::array<std::string_view, 5> kOthers = {"gpu", "wavefront", "pixelstats", "msereferenceimage",
                                                         "msereferenceout"};
    constexpr std::array<std::string_view, 6> kChanging = {"disablepixeljitter",      "disabletexturefiltering",
                                                           "disablewavelengthjitter", "forcediffuse",
                                                           "rendercoordsys",          "displacementedgescale"};
    if (std::ranges::find(kChanging, one.name) != kChanging.end()) {
        const bool isOff = one.flags.size() == 1 && !one.flags[0];
        if (!isOff && one.name != "rendercoordsys")
            shared_.out.leftOut(nullptr, one.span, fmt::format("the option `{}`", one.name), "it has no counterpart");
    } else if (std::ranges::find(kOthers, one.name) == kOthers.end()) {
        shared_.faults().warning("W0803", one.span, fmt::format("pbrt has no option `{}`", one.name));
    }
    static_cast<void>(word);
}

void PbrtMachine::attribute(PbrtScanner& scanner, const PbrtToken& word) {
    const auto target = name(scanner, word, "what it is for");
    if (!target) return;
    PbrtParams defaults;
    if (!params(scanner, defaults, "")) return;
    constexpr std::array<std::string_view, 5> kTargets = {"shape", "light", "material", "medium", "texture"};
    if (std::ranges::find(kTargets, *target) == kTargets.end())
        return void(shared_.faults().error("E0802", word.span,
                                           fmt::format("`Attribute` is for shape, light, material, medium or texture, "
                                                       "not `{}`",
                                                       *target)));
    auto& list = state_.attributes[*target];
    constexpr std::size_t kMostAttributes = 1000;
    std::vector<PbrtParam> added = defaults.take();
    list.insert(list.begin(), added.begin(), added.end()); // later ones come first
    if (list.size() > kMostAttributes) list.resize(kMostAttributes);
}

void PbrtMachine::colorSpace(PbrtScanner& scanner, const PbrtToken& word) {
    const auto which = name(scanner, word, "a colour space");
    if (!which) return;
    if (pbrtSpaceWord(*which).empty())
        return void(shared_.faults().error("E0802", word.span,
                                           fmt::format("there is no colour space `{}`: srgb, dci-p3, rec2020 and "
                                                       "aces2065-1 are some",
                                                       *which)));
    state_.colorSpace = *which;
}

std::optional<PbrtView::Said> PbrtMachine::said(PbrtScanner& scanner, const PbrtToken& word) {
    const auto type = name(scanner, word, "a type");
    if (!type) return std::nullopt;
    PbrtView::Said said;
    said.type = *type;
    said.colorSpace = state_.colorSpace;
    said.params.directive = word.span;
    if (!params(scanner, said.params, "")) return std::nullopt;
    return said;
}

void PbrtMachine::view(PbrtScanner& scanner, const PbrtToken& word) {
    auto what = said(scanner, word);
    if (!what || !inWorld(word, false)) return;
    if (word.raw == "Camera") {
        PbrtMotion worldFromCamera;
        for (int i = 0; i < 2; ++i)
            if (const auto inverse = state_.place.at[i].inverse()) worldFromCamera.at[i] = *inverse;
        coordinateSystems_.insert_or_assign("camera", worldFromCamera);
        return view_.camera(std::move(*what), state_);
    }
    if (word.raw == "Film" && what->type == "image") throw PbrtOldScene{word.span, "`Film \"image\"`"};
    (word.raw == "Film"          ? view_.film
     : word.raw == "PixelFilter" ? view_.filter
     : word.raw == "Sampler"     ? view_.sampler
     : word.raw == "Integrator"  ? view_.integrator
                                 : view_.accelerator) = std::move(*what);
}

void PbrtMachine::material(PbrtScanner& scanner, const PbrtToken& word) {
    const auto first = name(scanner, word, "a name");
    if (!first) return;
    PbrtParams list;
    list.directive = word.span;
    if (!params(scanner, list, "material")) return;
    const bool isNamed = word.raw == "MakeNamedMaterial";
    const std::string type = isNamed ? list.text("type", "", shared_.faults()) : *first;
    if (isNamed && type.empty())
        return void(shared_.faults().error("E0802", word.span, fmt::format("the material `{}` has no `type`", *first)));
    const PbrtMaterial* made = materials_.define(isNamed ? *first : "", type, list);
    if (isNamed) return;
    state_.material = made;
    state_.materialName.clear();
}

void PbrtMachine::namedMaterial(PbrtScanner& scanner, const PbrtToken& word) {
    const auto which = name(scanner, word, "the name of a material");
    if (!which) return;
    materials_.wordOf(*which, word.span);
    state_.materialName = *which;
    state_.material = nullptr;
}

void PbrtMachine::namedMedium(PbrtScanner& scanner, const PbrtToken& word) {
    const auto which = name(scanner, word, "the name of a medium");
    if (!which) return;
    PbrtParams list;
    list.directive = word.span;
    if (params(scanner, list, "medium")) media_.define(*which, list, state_.place.at[0]);
}

void PbrtMachine::mediumInterface(PbrtScanner& scanner, const PbrtToken& word) {
    const auto inside = name(scanner, word, "the names of two media");
    if (!inside) return;
    state_.inside = state_.outside = *inside;
    if (scanner.peek().kind == PbrtToken::Kind::text) state_.outside = scanner.next().text();
}

void PbrtMachine::texture(PbrtScanner& scanner, const PbrtToken& word) {
    const auto which = name(scanner, word, "the name of a texture");
    const auto values = which ? name(scanner, word, "`float` or `spectrum`") : std::nullopt;
    const auto type = values ? name(scanner, word, "the type of a texture") : std::nullopt;
    if (!type) return;
    if (*values == "color") throw PbrtOldScene{word.span, "a texture of type `color`"};
    PbrtParams list;
    list.directive = word.span;
    if (!params(scanner, list, "texture")) return;
    if (*values != "float" && *values != "spectrum")
        return void(shared_.faults().error("E0802", word.span,
                                           fmt::format("a texture is `float` or `spectrum`, not `{}`", *values)));
    textures_.define(*which, *values == "spectrum", *type, list, state_.place.at[0]);
}

void PbrtMachine::light(PbrtScanner& scanner, const PbrtToken& word) {
    const auto type = name(scanner, word, "the type of a light");
    if (!type) return;
    PbrtParams list;
    list.directive = word.span;
    if (!params(scanner, list, "light") || !inWorld(word, true)) return;
    if (list.has("mapname")) throw PbrtOldScene{list.spanOf("mapname"), "the parameter `mapname`"};
    lights_.add(*type, list, state_);
}

void PbrtMachine::areaLight(PbrtScanner& scanner, const PbrtToken& word) {
    const auto type = name(scanner, word, "the type of an area light");
    if (!type) return;
    auto list = std::make_shared<PbrtParams>();
    list->directive = word.span;
    if (!params(scanner, *list, "light")) return;
    if (*type != "diffuse")
        return void(shared_.faults().error("E0802", word.span, fmt::format("there is no area light `{}`", *type)));
    areaLights_.push_back(list);
    state_.areaLight = std::move(list);
}

void PbrtMachine::shape(PbrtScanner& scanner, const PbrtToken& word) {
    const auto type = name(scanner, word, "the type of a shape");
    if (!type) return;
    PbrtParams list;
    list.directive = word.span;
    if (!params(scanner, list, "shape") || !inWorld(word, true)) return;
    shapes_.add(*type, list, state_);
}

} // namespace abbe::exchange
