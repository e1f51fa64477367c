# Run by the build: cmake -DOUTPUT=file.cpp "-DFILES=a.scene;b.scene" -P EmbedPresets.cmake
# Writes the files of the library of materials into one source file, as raw texts.
set(text "// Made by cmake/EmbedPresets.cmake from materials/library.\n#include \"parser/presets.h\"\n\nnamespace abbe {\n\n")
string(APPEND text "std::vector<PresetFile> presetFiles() {\n    return {\n")
foreach(file ${FILES})
    file(READ ${file} content)
    get_filename_component(name ${file} NAME)
    string(APPEND text "        {\"materials/library/${name}\", R\"scene(${content})scene\"},\n")
endforeach()
string(APPEND text "    };\n}\n\n} // namespace abbe\n")
file(WRITE ${OUTPUT} "${text}")
