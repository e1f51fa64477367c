#include "language_server/analysis.h"

#include <algorithm>

namespace abbe::lsp {

using schema::Node;
using schema::NodeRange;
using schema::Value;

namespace {

bool isBlank(char c) { return c == ' ' || c == '\t'; }

bool endsWord(char c) {
    constexpr std::string_view kEnds = " \t\r\n;{}()\"=,[]";
    return kEnds.find(c) != std::string_view::npos;
}

// Follows the blocks around a place down to the node that is being written there.
class CursorFinder {
  public:
    CursorFinder(const Analysis& analysis, std::size_t offset)
        : analysis_(analysis), text_(analysis.text()), offset_(std::min(offset, text_.size())) {}

    Cursor find() {
        findWord();
        descend(analysis_.document().roots());
        if (!cursor_.node) return std::move(cursor_);
        for (const Value& value : writtenValues(*cursor_.node)) {
            const Span span = placeOf(value);
            if (span.end <= cursor_.wordBegin && span.begin < open_) cursor_.before.push_back(value);
        }
        return std::move(cursor_);
    }

  private:
    // The word that ends at the place, and whether it is a text in quotes or the value of a key.
    void findWord() {
        cursor_.wordEnd = cursor_.wordBegin = open_ = offset_;
        std::size_t line = offset_;
        while (line > 0 && text_[line - 1] != '\n' && text_[line - 1] != '\r') --line;
        std::size_t quote = offset_;
        bool inside = false;
        for (std::size_t i = line; i < offset_; ++i) {
            if (text_[i] == '\\' && inside) ++i;
            if (i < offset_ && text_[i] == '"') {
                inside = !inside;
                quote = i;
            } else if (!inside && text_.substr(i, 2) == "//") {
                break;
            }
        }
        if (inside) {
            cursor_.quoted = true;
            cursor_.wordBegin = quote + 1;
            open_ = quote;
        } else {
            while (cursor_.wordBegin > line && !endsWord(text_[cursor_.wordBegin - 1])) --cursor_.wordBegin;
            open_ = cursor_.wordBegin;
        }
        if (open_ == 0 || text_[open_ - 1] != '=') return;
        std::size_t begin = open_ - 1;
        while (begin > line && !endsWord(text_[begin - 1])) --begin;
        cursor_.key = text_.substr(begin, open_ - 1 - begin);
    }

    void descend(NodeRange nodes) {
        std::optional<Node> last;
        cursor_.neighbours.clear();
        for (const Node node : nodes) {
            if (node.span().begin > offset_) break;
            last = node;
        }
        if (last && holdsInBlock(*last)) {
            cursor_.scope = analysis_.scopeOf(cursor_.scope, *last);
            return descend(last->children());
        }
        constexpr std::size_t kMostNeighbours = 256; // of longer lists nobody minds what is there already
        for (const Node node : nodes) {
            const bool own = node.span().begin <= offset_ && offset_ <= node.nameSpan().end;
            if (!own) cursor_.neighbours.push_back(node.name());
            if (cursor_.neighbours.size() >= kMostNeighbours) break;
        }
        if (last && offset_ > last->nameSpan().end && holdsInHead(*last)) cursor_.node = last;
    }

    // Where the block of a node begins, or the end of the text.
    std::size_t braceOf(const Node& node) const {
        const std::size_t brace = text_.find('{', node.headSpan().end);
        return brace == std::string_view::npos ? text_.size() : brace;
    }

    bool holdsInBlock(const Node& node) const {
        if (!node.hasBlock() || offset_ <= braceOf(node)) return false;
        const Span span = node.span();
        if (offset_ < span.end) return true;
        if (span.end > 0 && text_[span.end - 1] == '}') return false;
        // The brace is still to come.
        const bool sameLine = text_.substr(span.end, offset_ - span.end).find('\n') == std::string_view::npos;
        return sameLine || indentation(offset_) > indentation(span.begin);
    }

    std::size_t indentation(std::size_t offset) const {
        std::size_t line = offset;
        while (line > 0 && text_[line - 1] != '\n') --line;
        std::size_t first = line;
        while (first < text_.size() && isBlank(text_[first])) ++first;
        return std::min(first, std::max(offset, line)) - line;
    }

    // Up to its block or, without one, to the end of its line.
    bool holdsInHead(const Node& node) const {
        const std::size_t end = node.headSpan().end;
        if (node.hasBlock()) return offset_ <= braceOf(node);
        if (offset_ <= end) return true;
        for (std::size_t i = end; i < open_; ++i) {
            const bool continued = text_[i] == '\\';
            if (continued) { // to the next line
                while (i < open_ && text_[i] != '\n') ++i;
                continue;
            }
            if (text_[i] == '\n' || text_[i] == '\r' || text_[i] == ';' || text_[i] == '}') return false;
        }
        return true;
    }

    const Analysis& analysis_;
    std::string_view text_;
    std::size_t offset_;
    std::size_t open_ = 0; // where the word begins, with its quote
    Cursor cursor_;
};

} // namespace

Cursor cursorAt(const Analysis& analysis, std::size_t offset) { return CursorFinder(analysis, offset).find(); }

} // namespace abbe::lsp
