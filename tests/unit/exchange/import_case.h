// What imports that stand in tests as text have in common.
#pragma once

#include "base/diagnostic_format.h"
#include "support/scene_test.h"
#include "unit/io/temporary_folder.h"

#include <doctest/doctest.h>
#include <string>
#include <string_view>

namespace abbe::exchange {

// What a scene becomes, with the files that it reads and writes in a folder of its own.
struct ImportCase {
    TemporaryFolder folder;
    SourceMap sources;
    Diagnostics diagnostics;
    std::string scene; // empty after errors

    std::string report() const { return formatShort(diagnostics, sources); }
    bool says(std::string_view text) const { return report().find(text) != std::string::npos; }
};

// Of a picture of an imported scene: the mean Y of a part, before the exposure.
struct ImportedPixel {
    double mean, exposure;
};

// Renders the text of a scene beside the files of its import.
inline ImportedPixel renderImported(const ImportCase& made, const std::string& text, PixelBounds part,
                                    std::uint32_t samples) {
    INFO(made.report());
    INFO(text);
    const std::string path = made.folder / "case.scene";
    writeAll(path, text);
    const auto loaded = abbe::test::TestScene::load(path);
    INFO(loaded.report());
    REQUIRE_FALSE(loaded.diagnostics().hasErrors());
    return {abbe::test::render(loaded, samples).film.tile(part).mean, loaded.built().exposure};
}

} // namespace abbe::exchange
