// Blocks: opening, closing, and finding the brace that is missing.
#include "parser/characters.h"
#include "parser/text_literal.h"
#include "parser/tree_reader.h"
#include "parser/whitespace.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::parser {

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
    if (!discard) document_.nodes[owner.index].hasBlock = true;
    ++at_;
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
    lastClosing_ = nullptr;
}

} // namespace abbe::parser
