// The parsed file as a tree of KDL nodes with spans: what the parser makes and everything later reads.
#pragma once

#include "base/large_array.h"
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

// Numbers of a packed row, read from its text one after the other: nothing else holds them. Valid while the Document
// is.
class PackedNumbers {
  public:
    class Iterator {
      public:
        double operator*() const { return value_; }
        Iterator& operator++();
        bool operator==(const Iterator& o) const { return left_ == o.left_; }

      private:
        friend class PackedNumbers;
        Iterator(const char* at, std::size_t left) : at_(at), left_(left) {}
        void read();
        const char* at_; // behind the current number
        std::size_t left_;
        double value_ = 0;
    };
    Iterator begin() const;
    Iterator end() const { return {nullptr, 0}; }
    std::size_t size() const { return count_; }
    PackedNumbers without(std::size_t first) const; // of them. Requires: first <= size()

  private:
    friend class Node;
    PackedNumbers(const char* at, std::size_t count) : at_(at), count_(count) {}
    const char* at_;
    std::size_t count_;
};

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
    PackedNumbers numbers() const; // requires allNumbers()
    std::span<const Key> keys() const;
    bool hasBlock() const;
    // A syntax error was reported in its head and something of it was lost: what is missing or odd here is no new
    // error.
    bool damaged() const;
    NodeRange children() const;
    // How many rows its block holds if it holds nothing but rows of plain numbers, which take no memory but their text;
    // else 0.
    std::size_t packedRows() const;

  private:
    friend class Document;
    friend class NodeIterator;
    Node(const Document* document, std::uint32_t index, std::uint32_t row)
        : document_(document), index_(index), row_(row) {}
    bool isPackedRow() const;
    const Document* document_;
    std::uint32_t index_; // of a packed row: of the node that has the block
    std::uint32_t row_;   // where in the text a packed row begins, or Document::kNone
};

class NodeIterator {
  public:
    Node operator*() const { return {document_, index_, row_}; }
    NodeIterator& operator++();
    bool operator==(const NodeIterator& o) const { return index_ == o.index_ && row_ == o.row_; }

  private:
    friend class NodeRange;
    NodeIterator(const Document* document, std::uint32_t index, std::uint32_t row)
        : document_(document), index_(index), row_(row) {}
    const Document* document_;
    std::uint32_t index_, row_; // as in Node
};

class NodeRange {
  public:
    NodeIterator begin() const { return {document_, first_, row_}; }
    NodeIterator end() const;
    bool empty() const { return begin() == end(); }

  private:
    friend class Node;
    friend class Document;
    NodeRange(const Document* document, std::uint32_t first, std::uint32_t row)
        : document_(document), first_(first), row_(row) {}
    const Document* document_;
    std::uint32_t first_, row_; // as in Node
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
        // Packed values that follow the others, and where their text begins. With packed rows in its block it has none
        // itself, and these are the number of the rows, 0, and where the first one begins.
        std::uint32_t firstNumber = 0, numberCount = 0;
        std::uint32_t packedBegin = 0;
        std::uint32_t firstKey = 0, keyCount = 0;
        std::uint32_t firstChild = kNone, nextSibling = kNone;
        bool hasBlock = false;
        bool packedRows = false; // the block holds nothing but rows of plain numbers, which have no records
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

    Node node(std::uint32_t index) const { return {this, index, kNone}; }
    NodeRange roots() const { return {this, nodes.empty() ? kNone : 0u, kNone}; }
    // Turns packed numbers into values again; only for the node whose values and packed numbers are the last ones.
    void unpack(NodeRecord&);
    std::string_view intern(std::string text) { return pool.emplace_back(std::move(text)); }

    LargeArray<NodeRecord> nodes; // the first one is the first root
    LargeArray<Value> values;
    std::size_t packedNumbers = 0;    // so far, of all nodes; they are read from the text when they are asked for
    std::vector<std::uint32_t> marks; // source offset of packed number markStep * k
    std::vector<Key> keys;
    std::vector<Parameter> parameters;
    std::deque<std::string> pool;
    FileId file = FileId::none;
    std::string_view source; // the file's text with a NUL behind it, which packed numbers are read from
};

} // namespace abbe::schema
