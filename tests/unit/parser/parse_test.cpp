#include "parse_text.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>

using namespace abbe;

namespace {

// A folder of its own that is removed again.
struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("abbe-read-scene-" + std::to_string(getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() { std::filesystem::remove_all(path); }
    std::filesystem::path write(const char* name, std::string_view text) const {
        std::ofstream(path / name, std::ios::binary) << text;
        return path / name;
    }
};

std::string codeOf(const std::filesystem::path& path) {
    SourceMap sources;
    Diagnostics diagnostics;
    const auto file = readSceneFile(sources, path, diagnostics);
    if (file) return "text: " + std::string(sources.text(*file));
    REQUIRE(diagnostics.all().size() == 1);
    CHECK(formatHuman(diagnostics, sources).find(path.string()) != std::string::npos);
    return diagnostics.all()[0].code;
}

} // namespace

TEST_CASE("scene files are read as they are") {
    const Folder folder;
    CHECK(codeOf(folder.write("a.scene", "scene 1\r\n")) == "text: scene 1\r\n");
    CHECK(codeOf(folder.write("empty.scene", "")) == "text: ");
    const std::string large = "scene 1\n" + std::string(3'000'001, 'x');
    CHECK(codeOf(folder.write("large.scene", large)) == "text: " + large);
    CHECK(codeOf(folder.write("bom.scene", "\xef\xbb\xbfscene 1")) == "text: \xef\xbb\xbfscene 1");
}

// Whoever may give the program a path must not learn from it what stands in any file.
TEST_CASE("nothing is quoted of a file that is no scene") {
    const Folder folder;
    const std::string_view texts[] = {"hunter2\n", "user:hunter2:x\n", "# my keys\nhunter2 hunter2\n",
                                      "\xff\xfeh\0u\0hunter2\n", "hunter2 \xe9t\xe9\n"};
    for (const std::string_view text : texts) {
        SourceMap sources;
        Diagnostics diagnostics;
        CHECK(!readSceneFile(sources, folder.write("secret", text), diagnostics));
        CHECK(diagnostics.errorCount() == 1);
        for (const std::string& shown :
             {formatHuman(diagnostics, sources), formatShort(diagnostics, sources), formatJson(diagnostics, sources)})
            CHECK_MESSAGE(shown.find("hunter") == std::string::npos, shown);
    }
}

TEST_CASE("files that cannot be read") {
    const Folder folder;
    CHECK(codeOf(folder.path / "missing.scene") == "E0410");
    CHECK(codeOf(folder.path) == "E0410");
    CHECK(codeOf(folder.write("a.png", "\x89PNG\r\n\x1a\n")) == "E0413");
    CHECK(codeOf(folder.write("utf16.scene", std::string_view("\xff\xfes\0", 4))) == "E0412");
    const auto sparse = folder.write("sparse.scene", "x");
    std::error_code error;
    std::filesystem::resize_file(sparse, (std::uintmax_t{1} << 32) + 5, error); // costs no space
    if (!error) CHECK(codeOf(sparse) == "E0411");
}
