#include "parser/parse.h"

#include "parser/parameters.h"
#include "parser/source_text.h"
#include "parser/tree_reader.h"

namespace abbe {

std::shared_ptr<schema::Document> parse(const SourceMap& sources, FileId file, const ParseOptions& options,
                                        Diagnostics& diagnostics) {
    auto document = std::make_shared<schema::Document>();
    const std::string_view text = sources.text(file);
    document->file = file;
    document->source = text;
    parser::SyntaxErrors errors({file, text.data(), text.data() + text.size()}, diagnostics);
    if (!parser::checkCharacters(errors)) return document;
    parser::TreeReader reader(errors, *document, options.maxDepth);
    reader.read();
    parser::ParameterTable parameters(*document, diagnostics);
    parameters.override(options, sources);
    parameters.substitute(reader.uses());
    return document;
}

} // namespace abbe
