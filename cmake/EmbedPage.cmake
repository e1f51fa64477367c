# Run by the build: cmake -DOUTPUT=file.cpp -DFOLDER=src/pages/data/study_page -DNAME=study -DSCRIPTS=plot,page
#                         -P EmbedPage.cmake
# Puts the style and the scripts into a page of HTML, and the page into a source file, as raw text.
file(READ ${FOLDER}/page.html page)
file(READ ${FOLDER}/style.css style)
set(script "")
string(REPLACE "," ";" names "${SCRIPTS}")
foreach(name IN LISTS names) # later ones call earlier ones
    file(READ ${FOLDER}/${name}.js text)
    string(APPEND script "${text}")
endforeach()
string(REPLACE "@STYLE@" "${style}" page "${page}")
string(REPLACE "@SCRIPT@" "${script}" page "${page}")
string(SUBSTRING ${NAME} 0 1 first)
string(SUBSTRING ${NAME} 1 -1 rest)
string(TOUPPER ${first} first)
file(WRITE ${OUTPUT} "// Made by cmake/EmbedPage.cmake from src/pages/data/${NAME}_page.
#include \"pages/data/page_templates.h\"\n\nnamespace abbe {\n\nconst char* const k${first}${rest}PageTemplate = R\"page(${page})page\";\n\n} // namespace abbe\n")
