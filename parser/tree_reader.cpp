// Nodes: names, the tree and its arrays, and their blocks. Entries are in tree_entries.cpp.
#include "parser/tree_reader.h"

#include "parser/characters.h"
#include "parser/number.h"
#include "parser/parameters.h"
#include "parser/tokens.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::parser {

using schema::Document;

TreeReader::TreeReader(SyntaxErrors& errors, Document& document, std::uint32_t maxDepth,
                       std::span<const ImpliedBrace> implied)
    : errors_(errors), document_(document), scanner_(errors, document), text_(errors.text()), maxDepth_(maxDepth),
      implied_(implied), plannedBraces_(!implied.empty()), at_(text_.begin), entryEnd_(text_.begin) {}

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
            readLoneSemicolons();
        else if (at_ < text_.end)
            readNode();
        else
            break;
    }
    reportUnclosed();
    closeAtEnd();
}

// KDL knows no empty nodes: a `;` ends one that stands before it.
void TreeReader::readLoneSemicolons() {
    const char* const first = at_;
    while (*at_ == ';') ++at_;
    Diagnostic& d = errors_.error("E0128", first, at_, "this `;` ends no node", "remove it");
    errors_.fix(d, first, at_, "");
}

// Reserves the arrays by a cheap guess: every node but the last is followed by a line end, a semicolon or a brace, and
// rows of numbers have no records. What is not used costs no memory, only addresses.
void TreeReader::reserve() {
    constexpr std::ptrdiff_t block = 128;
    std::size_t ends = 1, rows = 0;
    const char* p = text_.begin;
    const auto isEnd = [](char c) { return static_cast<unsigned char>(c == '\n' || c == ';' || c == '{'); };
    const auto isRow = [](char c, char next) { return static_cast<unsigned char>(c == '-' && next == ' '); };
    for (; text_.end - p >= block; p += block) {
        unsigned char endsHere = 0, rowsHere = 0; // one byte wide, for the sake of vector code
        for (std::ptrdiff_t i = 0; i < block; ++i) {
            endsHere = static_cast<unsigned char>(endsHere + isEnd(p[i]));
            rowsHere = static_cast<unsigned char>(rowsHere + isRow(p[i], p[i + 1]));
        }
        ends += endsHere;
        rows += rowsHere;
    }
    for (; p < text_.end; ++p) ends += isEnd(*p);
    const std::size_t count = ends > rows ? ends - rows : 1;
    document_.nodes.reserve(count);
    document_.values.reserve(count);
}

TreeReader::Sizes TreeReader::sizes() const {
    return {document_.nodes.size(), document_.values.size(), document_.packedNumbers, document_.keys.size(),
            uses_.size()};
}

void TreeReader::rollBack(const Sizes& s) {
    document_.nodes.resize(s.nodes);
    document_.values.resize(s.values);
    document_.packedNumbers = s.packedNumbers;
    document_.marks.resize((s.packedNumbers + Document::markStep - 1) / Document::markStep);
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
    if (*at_ == ';') ++at_;
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

// Blocks: opening, closing, and finding the brace that is missing.

using schema::Document;

// The braces that belong before the line here.
void TreeReader::readImplied() {
    while (!implied_.empty() && text_.offset(at_) >= implied_.front().before) {
        if (implied_.front().opens)
            openImplied();
        else
            closeImplied();
        implied_ = implied_.subspan(1);
    }
}

// As if the last node's line ended in `{`.
void TreeReader::openImplied() {
    const std::uint32_t previous = blocks_.back().lastChild;
    const bool owned = previous != Document::kNone && !document_.nodes[previous].hasBlock;
    blocks_.push_back({{owned ? previous : Document::kNone, false, owned, {}}, !owned, sizes(), Document::kNone, at_});
    if (owned) document_.nodes[previous].hasBlock = true;
}

void TreeReader::closeImplied() {
    if (blocks_.size() == 1) return;
    const Block block = blocks_.back();
    blocks_.pop_back();
    if (block.discard) {
        rollBack(block.before);
    } else {
        Document::NodeRecord& owner = document_.nodes[block.owner.index];
        owner.end = text_.offset(at_);
        owner.damaged |= at_ == text_.end; // what it holds may have been cut off
    }
    finish(block.owner);
}

// At a `{` where a node should begin. Mostly the author put it on the line after its node: then it belongs to that.
void TreeReader::readLooseBlock(bool discard) {
    const std::uint32_t previous = blocks_.back().lastChild;
    if (discard || previous == Document::kNone || document_.nodes[previous].hasBlock) {
        errors_.error("E0121", at_, at_ + 1, "a block needs a name before it", "what is this?");
        return openBlock({}, true);
    }
    const Document::NodeRecord& node = document_.nodes[previous];
    const char* const end = text_.begin + node.end;
    Diagnostic& d =
        errors_.error("E0109", at_, at_ + 1, fmt::format("the `{{` of `{}` must stand on its line", node.name),
                      "a line end finishes a node");
    d.related.push_back({{text_.file, node.begin, node.nameEnd}, "the node"});
    const auto isGap = [](char c) { return has(c, kBlank | kNewline) || c == ';'; };
    if (std::all_of(end, at_, isGap)) errors_.fix(d, end, at_, " ");
    openBlock({previous, false, true, {}}, false);
}

// At `{`. The nodes of a discarded block are read, for their mistakes, and thrown away.
void TreeReader::openBlock(const OpenNode& owner, bool discard) {
    if (blocks_.size() > maxDepth_) {
        errors_.error("E0119", at_, at_ + 1, "blocks are nested too deeply",
                      fmt::format("more than {} levels", maxDepth_));
        blocks_.push_back({owner, true, sizes(), Document::kNone, at_});
        return skipDeepBlock();
    }
    blocks_.push_back({owner, discard, sizes(), Document::kNone, at_});
    if (discard) {
        ++at_;
        return;
    }
    Record& node = document_.nodes[owner.index];
    node.hasBlock = true;
    if (node.numberCount > 0 || plannedBraces_ || !readPackedRows(node)) ++at_;
}

// To the brace that matches the one here, minding only comments and texts.
void TreeReader::skipDeepBlock() {
    std::size_t depth = 0;
    for (;;) {
        at_ = skipLineSpace(at_, errors_);
        if (at_ == text_.end) return errors_.markCutOff();
        if (startsText(at_)) {
            at_ = scanText(at_, errors_, document_).end;
            continue;
        }
        depth += *at_ == '{';
        depth -= *at_ == '}';
        if (depth == 0) return;
        ++at_;
    }
}

// At `}`.
void TreeReader::closeBlock() {
    if (blocks_.size() == 1) return reportStray();
    const Block block = blocks_.back();
    compareIndentation(block);
    blocks_.pop_back();
    if (block.discard) rollBack(block.before);
    if (blocks_.size() == 1) lastClosing_ = at_;
    ++at_;
    if (block.owner.index != Document::kNone && !block.discard)
        document_.nodes[block.owner.index].end = text_.offset(at_);
    readTail(block.owner);
}

// Behind a block: another one may follow only if those so far were behind a slashdash.
void TreeReader::readTail(const OpenNode& open) {
    const bool hasBlock = open.index == Document::kNone || document_.nodes[open.index].hasBlock;
    const char* const blockEnd = at_;
    skipSpace();
    if (atEndOfNode()) {
        if (*at_ == ';') ++at_;
        return finish(open);
    }
    const char* const dash = at_;
    const bool slashdash = at_[0] == '/' && at_[1] == '-';
    if (slashdash) at_ = skipLineSpace(at_ + 2, errors_);
    if (*at_ == '{') {
        if (!slashdash && hasBlock) errors_.error("E0124", at_, at_ + 1, "a node has only one block", "a second block");
        const bool discard = slashdash || hasBlock;
        return openBlock(open, discard);
    }
    at_ = dash;
    const char* const word = wordEnd(at_, text_.end);
    const bool oddWord = startsNumber(at_) || startsPointNumber(at_) || isBareKeyword(between(at_, word));
    if (slashdash || *at_ == '(' || startsText(at_) || (word > at_ && !oddWord)) { // else reported as a bad node name
        Diagnostic& d =
            errors_.error("E0124", at_, std::max(word, at_ + 1), "a node ends with its block", "begin a new line here");
        errors_.fix(d, blockEnd, at_, "; ");
    }
    finish(open);
}

// Remembers a `}` that begins its line further left than the line of the node whose block it closes.
void TreeReader::compareIndentation(const Block& block) {
    const auto firstOnLine = [&](const char* p) {
        while (p > text_.begin && (p[-1] == ' ' || p[-1] == '\t')) --p;
        return p;
    };
    const char* const lineStart = firstOnLine(at_);
    if (lineStart > text_.begin && !has(lineStart[-1], kNewline)) return;
    const char* const opener = findLineStart(
        block.owner.index == Document::kNone ? block.brace : text_.begin + document_.nodes[block.owner.index].begin,
        text_.begin);
    const char* text = opener;
    while (*text == ' ' || *text == '\t') ++text;
    if (at_ - lineStart < text - opener) suspects_.push_back({block.brace, at_});
}

// One error for every block that is open at the end of the text. Blame falls first on those whose closing brace is
// indented like an outer line: one of their own was forgotten, and the rest of the file moved out by one level.
void TreeReader::reportUnclosed() {
    std::size_t missing = blocks_.size() - 1;
    if (errors_.cutOff()) return;
    for (const Suspect& suspect : suspects_) {
        if (missing == 0) return;
        --missing;
        errors_.error("E0110", suspect.brace, suspect.brace + 1, "this block is not closed", "no matching `}`")
            .related.push_back({text_.span(suspect.closing, suspect.closing + 1),
                                "this `}` closes it, but is indented like an outer block"});
    }
    for (std::size_t i = blocks_.size() - missing; i < blocks_.size(); ++i)
        errors_.error("E0110", blocks_[i].brace, blocks_[i].brace + 1, "this block is not closed", "no matching `}`");
}

// Blocks that are still open end with the text. What they hold is doubtful, so their nodes count as damaged.
void TreeReader::closeAtEnd() {
    while (blocks_.size() > 1) {
        const Block block = blocks_.back();
        blocks_.pop_back();
        if (block.discard) {
            rollBack(block.before);
        } else {
            document_.nodes[block.owner.index].end = text_.offset(text_.end);
            document_.nodes[block.owner.index].damaged = true;
        }
        finish(block.owner);
    }
}

void TreeReader::reportStray() {
    Diagnostic& d = errors_.error("E0111", at_, at_ + 1, "this `}` closes nothing", "no block is open");
    if (lastClosing_ != nullptr)
        d.related.push_back({text_.span(lastClosing_, lastClosing_ + 1), "the last open block ends here"});
    ++at_;
    skipSpace();
    if (*at_ == ';') ++at_; // its end, as it would be that of a block
    lastClosing_ = nullptr;
}

} // namespace abbe::parser
