#include "app/version.h"

#include <fmt/format.h>

namespace abbe {

namespace {

constexpr const char* kCompiler =
#ifdef __clang__
    "clang " __clang_version__;
#else
    "g++ " __VERSION__;
#endif

constexpr const char* kInstructionSet =
#if defined(__AVX512F__)
    "AVX-512";
#elif defined(__AVX2__)
    "AVX2";
#else
        "x86-64";
#endif

constexpr const char* kBuildKind =
#ifdef ABBE_CHECKS
    "with assertions";
#else
    "optimised";
#endif

} // namespace

std::string versionNumber() { return ABBE_VERSION; }

std::string versionText() {
    return fmt::format("abbe {} (scene language edition {})\nbuilt by {} for {}, {}", versionNumber(), kLanguageEdition,
                       kCompiler, kInstructionSet, kBuildKind);
}

} // namespace abbe
