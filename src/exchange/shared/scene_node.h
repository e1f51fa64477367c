// A scene file that a program makes: nodes that know the spelling of the language (docs/language/syntax.md), printed as
// a person would write them.
#pragma once

#include "math/vec.h"

#include <cstdint>
#include <list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe::exchange {

// A node of the language, `name value… key=value { children }`. Functions that add return the node itself, so that
// calls can be chained: `node.child("radius").number(0.5).word("m")`.
class SceneNode {
  public:
    // `name` is a word of the language; rows are nodes called `-`.
    explicit SceneNode(std::string name) : name_(std::move(name)) {}

    // A word of the language: a type, a unit, `$parameter`; or several as they are printed. Not checked.
    SceneNode& word(std::string_view);
    // A name that somebody chose: as it is where it is a legal word, else quoted.
    SceneNode& name(std::string_view);
    // The shortest text that reads back as the same double. Requires a finite number.
    SceneNode& number(double);
    SceneNode& numbers(std::span<const double>);
    SceneNode& vector(Vec3d);
    // Quoted, with escapes: paths, titles. Bytes that are not UTF-8 become U+FFFD.
    SceneNode& text(std::string_view);
    SceneNode& key(std::string_view name, std::string_view word);
    SceneNode& key(std::string_view name, double);

    // The new child, for as long as this node lives.
    SceneNode& child(std::string name);
    SceneNode& adopt(SceneNode);
    // Values, children and remarks of another node behind its own.
    SceneNode& absorb(SceneNode);
    // A line of comment above the node. Line ends make several; what a comment may not hold is left out.
    SceneNode& remark(std::string_view);

    // Prints the node, for the top level of a file, and forgets what it is made of: of millions of nodes the text alone
    // is kept. Nothing can be added or asked but kind() from then on.
    void settle();

    const std::string& kind() const { return name_; }
    // What stands behind the name, as it is printed.
    std::string_view values() const { return std::string_view(values_).substr(values_.empty() ? 0 : 1); }
    const std::list<SceneNode>& children() const { return children_; }
    bool empty() const { return values_.empty() && children_.empty(); }

  private:
    friend class ScenePrinter;
    std::string name_;
    std::string values_;            // as they are printed, a blank before each; keys too
    std::list<SceneNode> children_; // a list: references to children stay valid
    std::vector<std::string> remarks_;
    enum class Form : std::uint8_t { parts, line, block } form_ = Form::parts; // settled: values_ is the whole text
};

// Whether a text may stand as a name without quotes.
bool isPlainWord(std::string_view);
// A finite number as it is printed.
std::string numberText(double);

// A whole file: `nodes` in order, a blank line between nodes of different kinds. A node whose children are short stands
// on one line of at most 120 characters, rows of numbers several to a line; blocks are indented by four spaces.
std::string printScene(std::span<const SceneNode> nodes);
std::string printScene(const std::list<SceneNode>& nodes);
// The same; the memory of each node is given back as soon as it is printed.
std::string printScene(std::list<SceneNode>&& nodes);

} // namespace abbe::exchange
