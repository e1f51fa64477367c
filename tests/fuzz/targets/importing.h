// What every importer of foreign scenes must keep to, whatever is in the file.
#pragma once

#include "base/diagnostic_format.h"
#include "exchange/shared/import.h"
#include "fuzz/target.h"
#include "fuzz/targets/reading.h"
#include "parser/parse.h"

#include <filesystem>
#include <string>

namespace abbe::fuzz {

using Importer = void (*)(const std::filesystem::path&, exchange::Import&);

// The import ends, and without errors it makes a scene file that can be read.
inline void importingMakesAScene(Importer read, const std::uint8_t* data, std::size_t size) {
    const MemoryFile file(bytesOf(data, size));
    reading([&] {
        SourceMap sources;
        Diagnostics diagnostics;
        exchange::SideFiles files("fuzz.scene", exchange::SideFiles::Target::nowhere);
        exchange::Import import{sources, diagnostics, files, {}};
        read(file.path(), import);
        formatHuman(diagnostics, sources);
        if (diagnostics.hasErrors()) return;
        Diagnostics second;
        const FileId again = sources.add("fuzz.scene", "scene 1\n" + exchange::printScene(import.nodes));
        parse(sources, again, {}, second);
        require(!second.hasErrors(), "the scene that was made cannot be read");
    });
}

// What `read` makes prints as a scene, and its diagnostics have places in the text.
template <typename F> void importingPrints(const F& read) {
    reading([&] {
        SourceMap sources;
        Diagnostics diagnostics;
        exchange::SideFiles files("fuzz.scene", exchange::SideFiles::Target::nowhere);
        exchange::Import import{sources, diagnostics, files, {}};
        read(import);
        exchange::printScene(import.nodes);
        for (const Diagnostic& d : diagnostics.all())
            if (d.span.valid()) require(d.span.end <= sources.text(d.span.file).size(), "a place behind the text");
    });
}

} // namespace abbe::fuzz
