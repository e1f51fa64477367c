// Reads the nodes of a KDL text into a Document, and goes on after every mistake.
#pragma once

#include "parser/brace_plan.h"
#include "parser/source_text.h"
#include "parser/value_scanner.h"
#include "schema/document.h"

#include <span>
#include <vector>

namespace abbe::parser {

// A word `$name` that stands for a parameter: value or key number `index` of a node.
struct ParameterUse {
    std::uint32_t node = 0;
    std::uint32_t index = 0;
    bool key = false;

    bool operator==(const ParameterUse&) const = default;
};

// Requires: checkCharacters() accepted the text; the document is empty. The implied braces are read as if they stood in
// the text.
class TreeReader {
  public:
    TreeReader(SyntaxErrors&, schema::Document&, std::uint32_t maxDepth, std::span<const ImpliedBrace> = {});
    void read();
    // In the order of the nodes.
    const std::vector<ParameterUse>& uses() const { return uses_; }

  private:
    using Record = schema::Document::NodeRecord;

    // Sizes of the growing arrays: what a slashdash removes is cut off again.
    struct Sizes {
        std::size_t nodes, values, packedNumbers, keys, uses;
    };
    // A node whose end has not been reached.
    struct OpenNode {
        std::uint32_t index = schema::Document::kNone;
        bool discard = false; // behind a slashdash, or not a node at all
        bool linked = false;  // known to its parent already: a block on the next line
        Sizes before{};
    };
    struct Block {
        OpenNode owner;
        bool discard = false;
        Sizes before{};
        std::uint32_t lastChild = schema::Document::kNone;
        const char* brace = nullptr;
    };
    struct KeyName {
        const char* begin;
        const char* end;
        std::string_view text;
    };
    // A closing brace that is indented like a line outside of the block that it closes.
    struct Suspect {
        const char* brace;
        const char* closing;
    };

    Sizes sizes() const;
    void rollBack(const Sizes&);
    void reserve();

    void readNode();
    void readLoneSemicolons();
    bool readSlashdash();
    bool readName(Record&);
    bool readOddName(Record&);
    void readHashComment();
    void finish(const OpenNode&);

    void readEntries(const OpenNode&);
    bool readEntry(Record&, std::uint32_t index);
    bool readPlainWord(Record&, std::uint32_t index);
    void readValue(Record&, std::uint32_t index);
    void addValue(Record&, std::uint32_t index, const schema::Value&);
    void readTextOrKey(Record&, std::uint32_t index, const char* annotation);
    void readKey(Record&, std::uint32_t index, const KeyName&);
    static const char* packedNumberEnd(const char* p);
    bool readNumber(Record&);
    bool readPackedRows(Record&);
    static const char* skipBetweenRows(const char* p);
    bool readSlashdashEntry(const OpenNode&);
    void readEquals(Record&);
    bool readAnnotation(Record&);
    void noteComma();
    void checkSpace();
    void reportMissingSpace(const char* place);
    void endEntries(Record&);
    void reportCommas(Record&);
    void removeDoubleKeys(Record&);
    void reportDoubleKey(const schema::Key& first, const schema::Key& last, std::uint32_t count);
    bool atEndOfNode() const;
    void skipSpace();
    void skipSpace(Record&);
    void touch(Record&, const char* end) const;

    void readImplied();
    void openImplied();
    void closeImplied();
    void readLooseBlock(bool discard);
    void openBlock(const OpenNode&, bool discard);
    void skipDeepBlock();
    void closeBlock();
    void readTail(const OpenNode&);
    void compareIndentation(const Block&);
    void reportUnclosed();
    void reportStray();
    void closeAtEnd();

    SyntaxErrors& errors_;
    schema::Document& document_;
    ValueScanner scanner_;
    const SourceText text_;
    const std::uint32_t maxDepth_;
    std::span<const ImpliedBrace> implied_; // those to come
    const bool plannedBraces_;              // there are some: no block is what it looks like
    const char* at_;                        // next character to read
    const char* entryEnd_;                  // end of the last entry, where no other may begin; or null
    std::vector<Block> blocks_;             // the first one is the whole file
    std::vector<Suspect> suspects_;
    std::vector<ParameterUse> uses_;
    std::vector<const char*> commas_;   // of the current node
    const char* lastClosing_ = nullptr; // the brace that closed the last top-level block
    bool inBrackets_ = false;           // behind a `[` of the current node, reported already
};

} // namespace abbe::parser
