#include "schema/document.h"

#include "base/check.h"

namespace abbe::schema {

namespace {

bool isNumberCharacter(char c) {
    return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E' || c == '_';
}

// Skips the block comment that starts at `at`; packed rows hold no other slash.
std::size_t skipComment(std::string_view source, std::size_t at) {
    int depth = 0;
    while (at + 1 < source.size()) {
        const std::string_view pair = source.substr(at, 2);
        depth += pair == "/*" ? 1 : pair == "*/" ? -1 : 0;
        at += pair == "/*" || pair == "*/" ? 2 : 1;
        if (depth == 0) break;
    }
    return at;
}

// The next number of a packed row at or after `at`, which is not inside a number.
Span nextNumber(const Document& document, std::size_t at) {
    const std::string_view source = document.source;
    while (at < source.size() && !isNumberCharacter(source[at]))
        at = source[at] == '/' ? skipComment(source, at) : at + 1;
    std::size_t end = at;
    while (end < source.size() && isNumberCharacter(source[end])) ++end;
    return {document.file, static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(end)};
}

Span spanOfNumber(const Document& document, const Document::NodeRecord& node, std::size_t i) {
    const std::size_t index = node.firstNumber + i;
    const std::size_t mark = index / Document::markStep;
    std::size_t known = mark * Document::markStep; // a number whose place is known
    std::size_t at;
    if (known >= node.firstNumber && mark < document.marks.size()) {
        at = document.marks[mark];
    } else {
        known = node.firstNumber;
        at = node.packedBegin;
    }
    Span span = nextNumber(document, at);
    for (; known < index; ++known) span = nextNumber(document, span.end);
    return span;
}

Value numberValue(const Document& document, double number, Span span) {
    Value value;
    value.kind = ValueKind::number;
    value.number = number;
    value.span = span;
    value.text = document.source.substr(span.begin, span.end - span.begin);
    return value;
}

} // namespace

void Document::unpack(NodeRecord& node) {
    if (node.numberCount == 0) return;
    ABBE_DCHECK(node.firstNumber + node.numberCount == numbers.size());
    if (node.valueCount == 0) node.firstValue = static_cast<std::uint32_t>(values.size());
    node.valueCount += node.numberCount;
    Span span = {file, node.packedBegin, node.packedBegin};
    for (std::size_t i = 0; i < node.numberCount; ++i) {
        span = nextNumber(*this, span.end);
        values.push_back(numberValue(*this, numbers[node.firstNumber + i], span));
    }
    numbers.resize(node.firstNumber);
    marks.resize((numbers.size() + markStep - 1) / markStep);
    node.firstNumber = node.numberCount = 0;
}

std::string_view Node::name() const { return document_->nodes[index_].name; }

Span Node::nameSpan() const {
    const Document::NodeRecord& node = document_->nodes[index_];
    return {document_->file, node.begin, node.nameEnd};
}

Span Node::headSpan() const {
    const Document::NodeRecord& node = document_->nodes[index_];
    return {document_->file, node.begin, node.headEnd};
}

Span Node::span() const {
    const Document::NodeRecord& node = document_->nodes[index_];
    return {document_->file, node.begin, node.end};
}

std::size_t Node::valueCount() const {
    const Document::NodeRecord& node = document_->nodes[index_];
    return std::size_t{node.valueCount} + node.numberCount;
}

Value Node::value(std::size_t i) const {
    ABBE_DCHECK(i < valueCount());
    const Document::NodeRecord& node = document_->nodes[index_];
    if (i < node.valueCount) return document_->values[node.firstValue + i];
    i -= node.valueCount;
    return numberValue(*document_, document_->numbers[node.firstNumber + i], spanOfNumber(*document_, node, i));
}

bool Node::allNumbers() const {
    const Document::NodeRecord& node = document_->nodes[index_];
    return node.numberCount > 0 && node.valueCount == 0;
}

std::span<const double> Node::numbers() const {
    const Document::NodeRecord& node = document_->nodes[index_];
    return {document_->numbers.data() + node.firstNumber, node.numberCount};
}

std::span<const Key> Node::keys() const {
    const Document::NodeRecord& node = document_->nodes[index_];
    return {document_->keys.data() + node.firstKey, node.keyCount};
}

bool Node::hasBlock() const { return document_->nodes[index_].hasBlock; }

bool Node::damaged() const { return document_->nodes[index_].damaged; }

NodeRange Node::children() const { return {document_, document_->nodes[index_].firstChild}; }

NodeIterator& NodeIterator::operator++() {
    index_ = document_->nodes[index_].nextSibling;
    return *this;
}

NodeIterator NodeRange::end() const { return {document_, Document::kNone}; }

} // namespace abbe::schema
