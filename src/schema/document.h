// The parsed file as a tree of KDL nodes with spans: what the parser makes and everything later reads.
#pragma once

#include "base/source.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::schema {

enum class ValueKind : std::uint8_t { number, word, string, boolean, null };

// One argument of a node. `text` is decoded (escapes resolved); for numbers it is the spelling in the file.
struct Value {
    ValueKind kind = ValueKind::null;
    bool boolean = false;
    double number = 0;
    std::string_view text;
    Span span;
    Span use; // where `$name` stood, if this value came from a parameter; else invalid

    bool isText() const { return kind == ValueKind::word || kind == ValueKind::string; }
};

// key=value
struct Key {
    std::string_view name;
    Span nameSpan;
    Value value;
};

class Document;
class NodeRange;

// A view of one node: kind words, property names and `-` rows are all nodes. Cheap to copy; valid while the Document
// is.
class Node {
  public:
    std::string_view name() const;
    Span nameSpan() const;
    Span headSpan() const; // name, arguments and keys, without the block
    Span span() const;     // everything, with the block
    std::size_t valueCount() const;
    Value value(std::size_t i) const; // by value: rows of numbers are stored packed and unpacked here
    // Numbers at the end of a row keep no Value each. A row made of them alone has a fast path, for points and faces.
    bool allNumbers() const;
    std::span<const double> numbers() const; // requires allNumbers()
    std::span<const Key> keys() const;
    bool hasBlock() const;
    // A syntax error was reported in its head and something of it was lost: what is missing or odd here is no new
    // error.
    bool damaged() const;
    NodeRange children() const;

  private:
    friend class Document;
    friend class NodeIterator;
    Node(const Document* document, std::uint32_t index) : document_(document), index_(index) {}
    const Document* document_;
    std::uint32_t index_;
};

class NodeIterator {
  public:
    Node operator*() const { return {document_, index_}; }
    NodeIterator& operator++();
    bool operator==(const NodeIterator& o) const { return index_ == o.index_; }

  private:
    friend class NodeRange;
    NodeIterator(const Document* document, std::uint32_t index) : document_(document), index_(index) {}
    const Document* document_;
    std::uint32_t index_;
};

class NodeRange {
  public:
    NodeIterator begin() const { return {document_, first_}; }
    NodeIterator end() const;
    bool empty() const { return begin() == end(); }

  private:
    friend class Node;
    friend class Document;
    NodeRange(const Document* document, std::uint32_t first) : document_(document), first_(first) {}
    const Document* document_;
    std::uint32_t first_;
};

// Flat storage: nodes in file order with 32-bit links. Built by the parser through the append functions below; inert
// afterwards. Texts point into the SourceMap or into the document's own pool (decoded escapes).
class Document {
  public:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    struct NodeRecord {
        std::string_view name;
        // Offsets of the name, of the head's end and of the node's end.
        std::uint32_t begin = 0, nameEnd = 0, headEnd = 0, end = 0;
        std::uint32_t firstValue = 0, valueCount = 0;
        std::uint32_t firstNumber = 0, numberCount = 0; // packed values that follow the others
        std::uint32_t packedBegin = 0;                  // where the text of the packed values begins
        std::uint32_t firstKey = 0, keyCount = 0;
        std::uint32_t firstChild = kNone, nextSibling = kNone;
        bool hasBlock = false;
        bool damaged = false;
    };

    // `param name value… ["doc"]`, taken out of the tree. `given` replaces the written value (`-D name=value`).
    struct Parameter {
        std::string_view name;
        Span nameSpan;
        std::vector<Value> written;
        std::vector<Value> given;
        std::string_view doc;
        std::string_view defaultText; // as it stands in the file: "-32.9 deg"
        bool used = false;            // its name stands somewhere in the tree
        bool inText = false;          // in a text, which may be computed (schema/expression.h)

        const std::vector<Value>& values() const { return given.empty() ? written : given; }
    };

    // Every markStep-th packed number has its offset kept, so that the span of any of them is found in a few steps.
    static constexpr std::size_t markStep = 64;

    Node node(std::uint32_t index) const { return {this, index}; }
    NodeRange roots() const { return {this, nodes.empty() ? kNone : 0u}; }
    // Turns packed numbers into values again; only for the node whose values and numbers are the last ones.
    void unpack(NodeRecord&);
    std::string_view intern(std::string text) { return pool.emplace_back(std::move(text)); }

    std::vector<NodeRecord> nodes; // the first one is the first root
    std::vector<Value> values;
    std::vector<double> numbers;
    std::vector<std::uint32_t> marks; // source offset of numbers[markStep * k]
    std::vector<Key> keys;
    std::vector<Parameter> parameters;
    std::deque<std::string> pool;
    FileId file = FileId::none;
    std::string_view source; // the file's text, to recover the spans of packed numbers
};

} // namespace abbe::schema
