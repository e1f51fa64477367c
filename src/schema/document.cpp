#include "schema/document.h"

#include "base/check.h"
#include "schema/decimal.h"

#include <array>

namespace abbe::schema {

namespace {

// By the byte: millions of rows are passed over.
constexpr auto kNumberCharacters = [] {
    std::array<bool, 256> table{};
    for (const char c : std::string_view("0123456789.-+eE_")) table[static_cast<unsigned char>(c)] = true;
    return table;
}();
bool isNumberCharacter(char c) { return kNumberCharacters[static_cast<unsigned char>(c)]; }

// Past the block comment that starts at `p`; packed rows hold no other slash.
const char* skipComment(const char* p) {
    int depth = 0;
    while (*p != 0) {
        const bool opens = p[0] == '/' && p[1] == '*', closes = p[0] == '*' && p[1] == '/';
        depth += opens ? 1 : closes ? -1 : 0;
        p += opens || closes ? 2 : 1;
        if (depth == 0) break;
    }
    return p;
}

// The next number of a packed row at or after `at`, which is not inside a number.
Span nextNumber(const Document& document, std::size_t at) {
    const char* const begin = document.source.data();
    const char* p = begin + at;
    while (*p != 0 && !isNumberCharacter(*p)) p = *p == '/' ? skipComment(p) : p + 1;
    const char* end = p;
    while (isNumberCharacter(*end)) ++end;
    return {document.file, static_cast<std::uint32_t>(p - begin), static_cast<std::uint32_t>(end - begin)};
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

Value numberValue(const Document& document, Span span) {
    Value value;
    value.kind = ValueKind::number;
    scanDecimal(document.source.data() + span.begin, value.number);
    value.span = span;
    value.text = document.source.substr(span.begin, span.end - span.begin);
    return value;
}

// Rows that have no records hold numbers with blanks between them; line ends, `;` and line comments stand between rows.
bool isBlank(char c) { return c == ' ' || c == '\t'; }

// Past the last number of the row whose `-` is at `p`.
const char* endOfRow(const char* p) {
    const char* end = p + 1;
    for (p = end;;) {
        while (isBlank(*p)) ++p;
        if (!startsDecimal(p)) return end;
        while (isNumberCharacter(*p)) ++p;
        end = p;
    }
}

// The `-` of the row behind the one at `p`, or null at the end of the block.
const char* rowAfter(const char* p) {
    for (p = endOfRow(p); *p != '-'; ++p) {
        if (*p == '}') return nullptr;
        if (*p == '/')
            while (*p != '\n' && *p != '\r') ++p;
    }
    return p;
}

std::size_t countInRow(const char* p) {
    std::size_t count = 0;
    for (++p;; ++count) {
        while (isBlank(*p)) ++p;
        if (!startsDecimal(p)) return count;
        while (isNumberCharacter(*p)) ++p;
    }
}

} // namespace

PackedNumbers::Iterator PackedNumbers::begin() const {
    Iterator first(at_, count_);
    if (count_ > 0) first.read();
    return first;
}

PackedNumbers::Iterator& PackedNumbers::Iterator::operator++() {
    if (--left_ > 0) read();
    return *this;
}

void PackedNumbers::Iterator::read() {
    while (*at_ == ' ') ++at_;
    while (!startsDecimal(at_)) at_ = *at_ == '/' ? skipComment(at_) : at_ + 1;
    at_ = scanDecimal(at_, value_);
}

PackedNumbers PackedNumbers::without(std::size_t first) const {
    Iterator last(at_, first + 1);
    for (std::size_t i = 0; i < first; ++i) last.read();
    return {last.at_, count_ - first};
}

void Document::unpack(NodeRecord& node) {
    if (node.numberCount == 0) return;
    ABBE_DCHECK(node.firstNumber + node.numberCount == packedNumbers);
    if (node.valueCount == 0) node.firstValue = static_cast<std::uint32_t>(values.size());
    node.valueCount += node.numberCount;
    Span span = {file, node.packedBegin, node.packedBegin};
    for (std::size_t i = 0; i < node.numberCount; ++i) {
        span = nextNumber(*this, span.end);
        values.push_back(numberValue(*this, span));
    }
    packedNumbers = node.firstNumber;
    marks.resize((packedNumbers + markStep - 1) / markStep);
    node.firstNumber = node.numberCount = 0;
}

bool Node::isPackedRow() const { return row_ != Document::kNone; }

std::string_view Node::name() const {
    return isPackedRow() ? document_->source.substr(row_, 1) : document_->nodes[index_].name;
}

Span Node::nameSpan() const {
    if (isPackedRow()) return {document_->file, row_, row_ + 1};
    const Document::NodeRecord& node = document_->nodes[index_];
    return {document_->file, node.begin, node.nameEnd};
}

Span Node::headSpan() const {
    if (isPackedRow()) {
        const char* const begin = document_->source.data();
        return {document_->file, row_, static_cast<std::uint32_t>(endOfRow(begin + row_) - begin)};
    }
    const Document::NodeRecord& node = document_->nodes[index_];
    return {document_->file, node.begin, node.headEnd};
}

Span Node::span() const {
    if (isPackedRow()) return headSpan();
    const Document::NodeRecord& node = document_->nodes[index_];
    return {document_->file, node.begin, node.end};
}

std::size_t Node::valueCount() const {
    if (isPackedRow()) return countInRow(document_->source.data() + row_);
    const Document::NodeRecord& node = document_->nodes[index_];
    return std::size_t{node.valueCount} + node.numberCount;
}

Value Node::value(std::size_t i) const {
    ABBE_DCHECK(i < valueCount());
    if (isPackedRow()) {
        Span span = nextNumber(*document_, row_ + 1);
        for (; i > 0; --i) span = nextNumber(*document_, span.end);
        return numberValue(*document_, span);
    }
    const Document::NodeRecord& node = document_->nodes[index_];
    if (i < node.valueCount) return document_->values[node.firstValue + i];
    return numberValue(*document_, spanOfNumber(*document_, node, i - node.valueCount));
}

bool Node::allNumbers() const {
    if (isPackedRow()) return true;
    const Document::NodeRecord& node = document_->nodes[index_];
    return node.numberCount > 0 && node.valueCount == 0;
}

PackedNumbers Node::numbers() const {
    const char* const text = document_->source.data();
    if (isPackedRow()) return {text + row_ + 1, countInRow(text + row_)};
    const Document::NodeRecord& node = document_->nodes[index_];
    return {text + node.packedBegin, node.numberCount};
}

std::span<const Key> Node::keys() const {
    if (isPackedRow()) return {};
    const Document::NodeRecord& node = document_->nodes[index_];
    return {document_->keys.data() + node.firstKey, node.keyCount};
}

bool Node::hasBlock() const { return !isPackedRow() && document_->nodes[index_].hasBlock; }

bool Node::damaged() const { return !isPackedRow() && document_->nodes[index_].damaged; }

NodeRange Node::children() const {
    if (isPackedRow()) return {document_, Document::kNone, Document::kNone};
    const Document::NodeRecord& node = document_->nodes[index_];
    if (node.packedRows) return {document_, index_, node.packedBegin};
    return {document_, node.firstChild, Document::kNone};
}

std::size_t Node::packedRows() const {
    if (isPackedRow()) return 0;
    const Document::NodeRecord& node = document_->nodes[index_];
    return node.packedRows ? node.firstNumber : 0;
}

NodeIterator& NodeIterator::operator++() {
    if (row_ == Document::kNone) {
        index_ = document_->nodes[index_].nextSibling;
        return *this;
    }
    const char* const begin = document_->source.data();
    const char* const next = rowAfter(begin + row_);
    row_ = next != nullptr ? static_cast<std::uint32_t>(next - begin) : Document::kNone;
    if (next == nullptr) index_ = Document::kNone;
    return *this;
}

NodeIterator NodeRange::end() const { return {document_, Document::kNone, Document::kNone}; }

} // namespace abbe::schema
