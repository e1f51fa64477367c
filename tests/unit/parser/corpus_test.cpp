// The corpora of tests/language: good scenes give no diagnostic, bad ones exactly the output that stands beside them.
// ABBE_UPDATE_GOLDEN=1 writes the expected outputs anew.
#include "parse_text.h"

#include <algorithm>
#include <cstdlib>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <iterator>

using namespace abbe;

namespace {

std::vector<std::filesystem::path> scenesIn(const char* folder) {
    std::vector<std::filesystem::path> scenes;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(ABBE_SOURCE_DIR) / "tests/language" / folder))
        if (entry.path().extension() == ".scene") scenes.push_back(entry.path());
    std::sort(scenes.begin(), scenes.end());
    return scenes;
}

std::string contents(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// The whole output of one run over a file, which is shown without its folder.
std::string outputOf(const std::filesystem::path& path) {
    SourceMap sources;
    Diagnostics diagnostics;
    const FileId file = sources.add(path.filename().string(), contents(path));
    parse(sources, file, {}, diagnostics);
    return formatHuman(diagnostics, sources);
}

} // namespace

TEST_CASE("good scenes") {
    const auto scenes = scenesIn("good");
    CHECK(scenes.size() >= 8);
    for (const auto& path : scenes)
        CHECK_MESSAGE(outputOf(path).empty(), path.filename().string() << "\n" << outputOf(path));
}

TEST_CASE("scenes with syntax errors") {
    std::size_t count = 0;
    for (const auto& path : scenesIn("bad")) {
        if (!path.filename().string().starts_with("syntax-")) continue;
        ++count;
        const std::string output = outputOf(path);
        std::filesystem::path golden = path;
        golden.replace_extension(".expected");
        if (const char* update = std::getenv("ABBE_UPDATE_GOLDEN"); update != nullptr && *update == '1')
            std::ofstream(golden, std::ios::binary) << output;
        CHECK_MESSAGE(output == contents(golden), path.filename().string() << ": expected\n"
                                                                           << contents(golden) << "\nbut got\n"
                                                                           << output);
    }
    CHECK(count >= 10);
}
