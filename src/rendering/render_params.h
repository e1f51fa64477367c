// What `render { … }` says: parameters, and the words for each choice of a Technique.
#pragma once

#include "render/integrator.h"
#include "render/technique.h"
#include "schema/type.h"

#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace abbe {

// The words of the scene language for the enumerators of each choice, in their order; the first is the default.
template <typename E> std::span<const std::string_view> words();
template <> std::span<const std::string_view> words<Technique::Numbers>();
template <> std::span<const std::string_view> words<Technique::Strategy>();
template <> std::span<const std::string_view> words<Technique::Weights>();
template <> std::span<const std::string_view> words<Technique::Directions>();
template <> std::span<const std::string_view> words<Technique::LightChoice>();
template <> std::span<const std::string_view> words<Technique::Roulette>();
template <> std::span<const std::string_view> words<Technique::LightPaths>();
template <> std::span<const std::string_view> words<Technique::Merging>();
template <> std::span<const std::string_view> words<Technique::Guiding>();
template <> std::span<const std::string_view> words<Technique::Windows>();

template <typename E>
requires std::is_enum_v<E> std::string_view word(E e) { return words<E>()[static_cast<std::size_t>(e)]; }

// All of it, as properties of `render` with their values.
std::vector<std::pair<std::string, std::string>> properties(const Technique&);

// What `render { … }` says.
struct RenderParams {
    schema::Choice integrator{"path", {}};
    std::int64_t samples = 64;
    std::int64_t seed = 0;
    std::int64_t maxDepth = 0; // 0: no limit
    std::int64_t replicates = 2;
    double noise = 0;           // relative error to stop at; 0: none
    double timeLimit = 0;       // s; 0: none
    double textureCache = 2048; // MiB
    double fps = 24;            // frames of an animation in a second
    bool adaptive = false;
    schema::TableRows forbid; // rows of one word: effects that the scene must not need
    // The choices of a Technique.
    Technique::Numbers sampler{};
    Technique::Strategy strategy{};
    Technique::Weights weights{};
    Technique::Directions directions{};
    Technique::Roulette roulette{};
    Technique::LightPaths lightPaths{};
    Technique::Merging merging{};
    Technique::Guiding guiding{};
    Technique::Windows windows{};
    std::int64_t wavelengths = 8; // 1, 2, 4 or 8
    Technique::LightChoice lightChoice{};
};

schema::TypeInfo renderType();
// Requires possibleWavelengths(params.wavelengths).
RenderSettings renderSettings(const RenderParams& params);
// Frames of an animation have other random numbers each, so that their noise does not stand still like dirt on a
// window; that of frame 0 is the scene's own.
std::int64_t seedOfFrame(std::int64_t seed, int frame);
// Whether a path can have so many different ones, which repeat evenly in its lanes.
bool possibleWavelengths(std::int64_t count);

} // namespace abbe
