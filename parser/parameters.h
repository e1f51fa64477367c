// `param name value… ["doc"]` and `$name`: typed values that stand for other values. No text is replaced.
#pragma once

#include "parser/parse.h"
#include "parser/tree_reader.h"

#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace abbe::parser {

// Keeps a top-level `param` node as a parameter of the document.
void defineParameter(schema::Document&, std::uint32_t node, Diagnostics&);

// Warns of a parameter without a use.
void reportUnused(const schema::Document::Parameter&, Diagnostics&);

// The parameters of a document, once all of it has been read.
class ParameterTable {
  public:
    // Reports and removes second definitions.
    ParameterTable(schema::Document&, Diagnostics&);
    // Sets the values that were given from outside.
    void override(const ParseOptions&, const SourceMap&);
    // Puts the values of parameters where their names are used; each keeps its own span and remembers that of its use.
    // Notes which are used, there or in texts that are computed.
    void substitute(std::span<const ParameterUse>);
    void warnOfUnused() const;

  private:
    using Parameter = schema::Document::Parameter;

    Parameter* find(std::string_view name);
    const Parameter* lookUp(const schema::Value& word);
    bool reportExpression(const schema::Value& word, std::string_view text);
    void noteTexts();
    void noteText(const schema::Value&);
    std::string_view nearest(std::string_view name);
    std::string listNames() const;
    std::vector<schema::Value> readValues(const SourceText&, const Parameter&);
    void replaceKey(schema::Document::NodeRecord&, std::uint32_t key);
    void replaceValues(schema::Document::NodeRecord&);

    schema::Document& document_;
    Diagnostics& diagnostics_;
    std::unordered_map<std::string_view, std::size_t> index_;
    std::vector<bool> used_;
    int searches_ = 0;
};

} // namespace abbe::parser
