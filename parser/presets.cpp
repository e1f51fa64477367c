#include "parser/presets.h"

#include "parser/parse.h"
#include "schema/preset_library.h"

namespace abbe {

void addPresets(schema::TypeTable& types, SourceMap& sources, Diagnostics& diagnostics) {
    auto library = std::make_shared<schema::PresetLibrary>();
    for (const PresetFile& file : presetFiles()) {
        const FileId id = sources.add(std::string(file.path), std::string(file.text));
        library->add(parse(sources, id, {}, diagnostics));
    }
    types.add(schema::presetType(schema::Kind::material));
    types.add(schema::presetType(schema::Kind::medium));
    types.setPresets(std::move(library));
}

} // namespace abbe
