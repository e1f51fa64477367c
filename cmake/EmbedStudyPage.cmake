# Run by the build: cmake -DOUTPUT=file.cpp -DFOLDER=src/app/data/study_page -P EmbedStudyPage.cmake
# Puts the style and the scripts into the page of `abbe study`, and the page into a source file, as raw text.
file(READ ${FOLDER}/page.html page)
file(READ ${FOLDER}/style.css style)
set(script "")
foreach(name plot findings page tables strips start) # later ones call earlier ones
    file(READ ${FOLDER}/${name}.js text)
    string(APPEND script "${text}")
endforeach()
string(REPLACE "@STYLE@" "${style}" page "${page}")
string(REPLACE "@SCRIPT@" "${script}" page "${page}")
file(WRITE ${OUTPUT} "// Made by cmake/EmbedStudyPage.cmake from src/app/data/study_page.
#include \"app/data/study_page_template.h\"\n\nnamespace abbe {\n\nconst char* const kStudyPageTemplate = R\"page(${page})page\";\n\n} // namespace abbe\n")
