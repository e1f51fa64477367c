// Nodes: names, the tree and its arrays. Entries are in tree_entries.cpp, blocks in tree_blocks.cpp.
#include "parser/tree_reader.h"

#include "parser/characters.h"
#include "parser/number.h"
#include "parser/parameters.h"
#include "parser/text_literal.h"
#include "parser/whitespace.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::parser {

using schema::Document;

TreeReader::TreeReader(SyntaxErrors& errors, Document& document, std::uint32_t maxDepth,
                       std::span<const ImpliedBrace> implied)
    : errors_(errors), document_(document), scanner_(errors, document), text_(errors.text()), maxDepth_(maxDepth),
      implied_(implied), at_(text_.begin), entryEnd_(text_.begin) {}

void TreeReader::read() {
    if (std::string_view(text_.begin, text_.end).starts_with("\xef\xbb\xbf")) at_ += 3;
    reserve();
    blocks_.push_back({{}, false, {}, Document::kNone, text_.begin});
    for (;;) {
        at_ = skipLineSpace(at_, errors_);
        if (!implied_.empty()) readImplied();
        if (*at_ == '}')
            closeBlock();
        else if (*at_ == ';')
            ++at_;
        else if (at_ < text_.end)
            readNode();
        else
            break;
    }
    reportUnclosed();
    closeAtEnd();
}

// Reserves the arrays by cheap bounds: every node but the last is followed by a line end, a semicolon or a brace. What
// is not used costs no memory, only addresses.
void TreeReader::reserve() {
    constexpr std::ptrdiff_t block = 128;
    std::size_t count = 1;
    const char* p = text_.begin;
    const auto ends = [](char c) { return static_cast<unsigned char>(c == '\n' || c == ';' || c == '{'); };
    for (; text_.end - p >= block; p += block) {
        unsigned char inBlock = 0; // one byte wide, for the sake of vector code
        for (std::ptrdiff_t i = 0; i < block; ++i) inBlock = static_cast<unsigned char>(inBlock + ends(p[i]));
        count += inBlock;
    }
    for (; p < text_.end; ++p) count += ends(*p);
    document_.nodes.reserve(count);
    document_.values.reserve(count);
    document_.numbers.reserve(static_cast<std::size_t>(text_.end - text_.begin) / 8);
}

TreeReader::Sizes TreeReader::sizes() const {
    return {document_.nodes.size(), document_.values.size(), document_.numbers.size(), document_.keys.size(),
            uses_.size()};
}

void TreeReader::rollBack(const Sizes& s) {
    document_.nodes.resize(s.nodes);
    document_.values.resize(s.values);
    document_.numbers.resize(s.numbers);
    document_.marks.resize((s.numbers + Document::markStep - 1) / Document::markStep);
    document_.keys.resize(s.keys);
    uses_.resize(s.uses);
}

void TreeReader::readNode() {
    OpenNode open;
    open.before = sizes();
    if (at_[0] == '/' && at_[1] == '-') {
        if (!readSlashdash()) return;
        open.discard = true;
    }
    if (*at_ == '{') return readLooseBlock(open.discard);
    open.index = static_cast<std::uint32_t>(document_.nodes.size());
    Record& node = document_.nodes.emplace_back();
    if (*at_ == '(') {
        readAnnotation(node);
    }
    const char* const begin = at_;
    const bool nothing = atEndOfNode() || *at_ == '{'; // behind a type annotation: reported
    if (nothing || !readName(node)) {
        // What stands here is no node; the rest of the line is still read for further mistakes.
        if (at_ == begin && !nothing) at_ = scanner_.scan(at_, Place::argument);
        entryEnd_ = nullptr;
        open.discard = true;
        node.damaged = true;
        node.begin = text_.offset(begin);
        node.nameEnd = text_.offset(at_);
    }
    node.headEnd = node.nameEnd;
    readEntries(open);
}

// At `/-` before a node. False when there is nothing to remove.
bool TreeReader::readSlashdash() {
    const char* const dash = at_;
    at_ = skipLineSpace(at_ + 2, errors_);
    const bool twice = at_[0] == '/' && at_[1] == '-';
    if (at_ < text_.end && *at_ != '}' && *at_ != ';' && !twice) return true;
    errors_.error("E0122", dash, dash + 2, "`/-` has nothing to switch off",
                  twice ? "another `/-` follows" : "no node follows");
    return false;
}

bool TreeReader::readName(Record& node) {
    const char* const begin = at_;
    std::string_view name;
    const char* end = wordEnd(at_, text_.end);
    if (end > at_ && !isDigit(*at_) && *at_ != '-' && *at_ != '+' && *at_ != '.' && !has(*at_, kWide)) {
        name = between(at_, end);
        if (isBareKeyword(name)) scanner_.scanName(at_, name);
    } else {
        end = scanner_.scanName(at_, name);
        if (end == nullptr) return readOddName(node);
    }
    at_ = entryEnd_ = end;
    node.name = name;
    node.begin = text_.offset(begin);
    node.nameEnd = text_.offset(end);
    return true;
}

// A line that begins with a number lacks the `-` of a row; all else is no node.
bool TreeReader::readOddName(Record& node) {
    if (!startsNumber(at_) && !startsPointNumber(at_)) {
        if (*at_ == '#') return readHashComment(), false;
        if (*at_ != '=') return false;
        errors_.error("E0113", at_, at_ + 1, "`=` needs the name of a key before it", "nothing stands before it");
        ++at_;
        return false;
    }
    const char* const word = wordEnd(at_, text_.end);
    const bool misspelt = parseNumber(between(at_, word)).error != NumberError::none;
    if (!misspelt && *word != '=' && !(*word == '/' && isDigit(word[1]))) { // else an error of its own
        Diagnostic& d =
            errors_.error("E0121", at_, word, "a line begins with a word", "rows of numbers begin with `-`");
        errors_.fix(d, at_, at_, "- ");
    }
    node.name = "-";
    node.begin = node.nameEnd = text_.offset(at_);
    node.damaged = true;
    entryEnd_ = nullptr; // no space is missed before the first number
    return true;
}

void TreeReader::readHashComment() {
    const char* const hash = at_;
    while (*at_ == '#') ++at_;
    Diagnostic& d = errors_.error("E0108", hash, at_, "`#` does not begin a comment", "write `//`");
    errors_.fix(d, hash, at_, "//");
    at_ = findLineEnd(at_, text_.end);
}

void TreeReader::finish(const OpenNode& open) {
    if (open.linked || open.index == Document::kNone) return;
    if (open.discard) return rollBack(open.before);
    Block& parent = blocks_.back();
    if (blocks_.size() == 1 && document_.nodes[open.index].name == "param") {
        defineParameter(document_, open.index, errors_.diagnostics());
        return rollBack(open.before);
    }
    if (parent.lastChild != Document::kNone)
        document_.nodes[parent.lastChild].nextSibling = open.index;
    else if (parent.owner.index != Document::kNone && !parent.discard)
        document_.nodes[parent.owner.index].firstChild = open.index;
    parent.lastChild = open.index;
}

} // namespace abbe::parser
