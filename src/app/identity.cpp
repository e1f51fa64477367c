#include "app/identity.h"

#include <fmt/format.h>
#include <fstream>
#include <sys/resource.h>

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

std::string processorName() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);)
        if (const auto colon = line.find(": "); line.starts_with("model name") && colon != std::string::npos)
            return line.substr(colon + 2);
    return {};
}

std::uint64_t peakMemory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::string Hash128::digits() const {
    return fmt::format("{:016x}{:016x}", static_cast<std::uint64_t>(state_ >> 64), static_cast<std::uint64_t>(state_));
}

} // namespace abbe
