// Entries of a node: arguments, keys, and the rows of plain numbers that are kept packed.
#include "parser/characters.h"
#include "parser/number.h"
#include "parser/tokens.h"
#include "parser/tree_reader.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <string_view>
#include <unordered_map>

namespace abbe::parser {

using schema::Document;
using schema::Value;
using schema::ValueKind;

void TreeReader::skipSpace() {
    bool lineComment = false;
    at_ = skipNodeSpace(at_, errors_, lineComment);
}

// Packed numbers are found again in the text, which must hold nothing odd between them.
void TreeReader::skipSpace(Record& node) {
    bool lineComment = false;
    at_ = skipNodeSpace(at_, errors_, lineComment);
    if (lineComment) document_.unpack(node);
}

void TreeReader::touch(Record& node, const char* end) const { node.headEnd = text_.offset(end); }

// At white space's end: whether the node ends here.
bool TreeReader::atEndOfNode() const {
    if (*at_ == '\n' || *at_ == ';' || *at_ == '}' || (*at_ == '/' && at_[1] == '/')) return true;
    return at_ == text_.end || newlineLength(at_, text_.end) > 0;
}

// Reads entries up to the end of the node or to its block.
void TreeReader::readEntries(const OpenNode& open) {
    Record& node = document_.nodes[open.index];
    inBrackets_ = false;
    commas_.clear();
    for (;;) {
        while (readNumber(node)) {
        }
        skipSpace(node);
        if (readNumber(node)) continue; // behind a comment or on a continued line
        if (*at_ == '{') {
            endEntries(node);
            return openBlock(open, false);
        }
        if (at_[0] == '/' && at_[1] == '-') {
            if (readSlashdashEntry(open)) return;
        } else if (!readEntry(node, open.index)) {
            break;
        }
    }
    endEntries(node);
    if (*at_ == ';') ++at_;
    finish(open);
}

// Past the plain decimal number at `p` if it is one alone that a double can hold; else null.
const char* TreeReader::packedNumberEnd(const char* p) {
    const char* end = skipDecimal(p);
    if (end == nullptr) { // digits and exponent may be too much
        double number;
        end = scanDecimal(p, number);
        if (!std::isfinite(number)) return nullptr;
    }
    return has(*end, kValueEnd) ? end : nullptr;
}

// The fast path: white space, a plain decimal number, and white space or the node's end behind it.
bool TreeReader::readNumber(Record& node) {
    const char* p = at_;
    while (*p == ' ' || *p == '\t') ++p;
    if (p == entryEnd_ || !schema::startsDecimal(p)) return false;
    const char* const end = packedNumberEnd(p);
    if (end == nullptr) return false;
    if (node.numberCount++ == 0) {
        node.firstNumber = static_cast<std::uint32_t>(document_.packedNumbers);
        node.packedBegin = text_.offset(p);
    }
    if (document_.packedNumbers++ % Document::markStep == 0) document_.marks.push_back(text_.offset(p));
    node.headEnd = text_.offset(end);
    at_ = entryEnd_ = end;
    return true;
}

// At the `{` of a node: whether its block holds nothing but rows of plain numbers, with line ends and line comments.
// Then they are not read: at_ is at the `}`. Long rows and whatever is odd are left to the reader of nodes.
bool TreeReader::readPackedRows(Record& node) {
    constexpr int kLongest = 64; // numbers; each is searched for from the beginning of its row
    const char* first = nullptr;
    std::uint32_t rows = 0;
    for (const char* p = at_ + 1;; ++rows) {
        p = skipBetweenRows(p);
        if (*p == '}' && rows > 0) {
            node.packedRows = true;
            node.firstNumber = rows;
            node.packedBegin = text_.offset(first);
            at_ = p;
            return true;
        }
        if (*p != '-' || (p[1] != ' ' && p[1] != '\t')) return false;
        if (rows == 0) first = p;
        int count = 0;
        for (++p;; ++count) {
            while (*p == ' ' || *p == '\t') ++p;
            if (!schema::startsDecimal(p)) break;
            p = packedNumberEnd(p);
            if (p == nullptr || count == kLongest) return false;
        }
        if (*p == ';')
            ++p;
        else if (*p != '\n' && *p != '\r' && *p != '}' && !(p[0] == '/' && p[1] == '/'))
            return false;
        if (count == 0) return false;
    }
}

// Past white space, line ends and line comments of plain ASCII: wide characters may end a line.
const char* TreeReader::skipBetweenRows(const char* p) {
    for (;;) {
        while (*p == ' ' || *p == '\t' || *p == '\n' || *p == '\r') ++p;
        if (p[0] != '/' || p[1] != '/') return p;
        const char* end = p;
        while (static_cast<signed char>(*end) >= ' ' || *end == '\t') ++end; // bytes above 127 are negative
        if (*end != '\n' && *end != '\r') return p;
        p = end;
    }
}

// One argument or key. False at the end of the node.
bool TreeReader::readEntry(Record& node, std::uint32_t index) {
    if (atEndOfNode()) return false;
    if (*at_ == ',') return noteComma(), true;
    document_.unpack(node);
    if (*at_ == '=') return readEquals(node), true;
    const char* const annotation = *at_ == '(' ? at_ : nullptr;
    if (annotation != nullptr) {
        if (!readAnnotation(node)) return at_ > annotation || (readValue(node, index), true);
        if (annotation == entryEnd_) reportMissingSpace(annotation);
        if (atEndOfNode() || *at_ == '{' || *at_ == '=') return true;
        entryEnd_ = nullptr;
    }
    if (const bool list = *at_ == '['; list || (*at_ == ']' && inBrackets_)) {
        if (list)
            readValue(node, index);
        else
            entryEnd_ = nullptr, ++at_;
        inBrackets_ = list;
        return true;
    }
    const bool number = startsNumber(at_) || startsPointNumber(at_);
    const bool named = startsText(at_) || (!number && isWordCharacter(at_, text_.end));
    if (named || number || (*at_ == '#' && has(at_[1], kWord))) checkSpace();
    return named ? readTextOrKey(node, index, annotation) : readValue(node, index), true;
}

// A word or text is an argument, unless `=` follows: then it was the name of a key.
void TreeReader::readTextOrKey(Record& node, std::uint32_t index, const char* annotation) {
    const char* const begin = at_;
    const std::size_t valueCount = document_.values.size();
    if (!readPlainWord(node, index)) readValue(node, index);
    const char* const end = at_;
    skipSpace();
    if (*at_ != '=' || document_.values.size() != valueCount + 1) return;
    if (annotation != nullptr)
        errors_.error("E0123", annotation, begin, "a type annotation stands before the value of a key",
                      "not before its name");
    const std::string_view name = document_.values.back().text;
    document_.values.resize(valueCount);
    --node.valueCount;
    const ParameterUse asValue{index, node.valueCount, false};
    if (!uses_.empty() && uses_.back() == asValue) uses_.pop_back();
    readKey(node, index, {begin, end, name});
}

// The fast path of words: letters first, and no keyword.
bool TreeReader::readPlainWord(Record& node, std::uint32_t index) {
    const char lower = static_cast<char>(*at_ | 0x20);
    if ((lower < 'a' || lower > 'z') && *at_ != '$') return false;
    const char* const end = wordEnd(at_, text_.end);
    Value value;
    value.kind = ValueKind::word;
    value.text = between(at_, end);
    value.span = text_.span(at_, end);
    if (isBareKeyword(value.text)) return false;
    addValue(node, index, value);
    entryEnd_ = at_ = end;
    touch(node, end);
    return true;
}

void TreeReader::readValue(Record& node, std::uint32_t index) {
    at_ = scanner_.scan(at_, Place::argument);
    // After something that was no value, and after the `=` of `5=3`, no space is missed.
    entryEnd_ = scanner_.values().empty() ? nullptr : at_;
    touch(node, at_);
    node.damaged |= scanner_.lost();
    for (const Value& value : scanner_.values()) addValue(node, index, value);
}

void TreeReader::addValue(Record& node, std::uint32_t index, const Value& value) {
    if (node.valueCount == 0) node.firstValue = static_cast<std::uint32_t>(document_.values.size());
    if (value.kind == ValueKind::word && value.text.starts_with('$')) uses_.push_back({index, node.valueCount, false});
    document_.values.push_back(value);
    ++node.valueCount;
}

// At the `=` behind the name of a key.
void TreeReader::readKey(Record& node, std::uint32_t index, const KeyName& name) {
    const char* const equals = at_++;
    skipSpace();
    if (at_[0] == '/' && at_[1] == '-') {
        errors_.error("E0122", at_, at_ + 2, "`/-` cannot remove the value of a key", "put it before the key");
        at_ += 2;
        skipSpace();
    }
    if (*at_ == '(') readAnnotation(node);
    if (atEndOfNode() || *at_ == '{' || *at_ == '=' || *at_ == ',') {
        errors_.error("E0113", equals, equals + 1, fmt::format("the key `{}` has no value", name.text),
                      "a value must follow");
        node.damaged = true;
        if (*at_ == '=') ++at_;
        entryEnd_ = nullptr;
        return touch(node, equals + 1);
    }
    entryEnd_ = at_ = scanner_.scan(at_, Place::key);
    touch(node, at_);
    node.damaged |= scanner_.lost();
    if (scanner_.values().empty()) return;
    const Value& value = scanner_.values().front();
    if (node.keyCount == 0) node.firstKey = static_cast<std::uint32_t>(document_.keys.size());
    if (value.kind == ValueKind::word && value.text.starts_with('$')) uses_.push_back({index, node.keyCount, true});
    document_.keys.push_back({name.text, text_.span(name.begin, name.end), value});
    ++node.keyCount;
}

// `/-` before an entry or block. True when a block was opened: the node goes on behind it.
bool TreeReader::readSlashdashEntry(const OpenNode& open) {
    Record& node = document_.nodes[open.index];
    const char* const dash = at_;
    at_ = skipLineSpace(at_ + 2, errors_);
    if (*at_ == '{') {
        endEntries(node);
        openBlock(open, true);
        return true;
    }
    document_.unpack(node);
    entryEnd_ = nullptr; // no space is needed behind a slashdash
    const Sizes before = sizes();
    const std::uint32_t values = node.valueCount, keys = node.keyCount;
    const bool twice = at_[0] == '/' && at_[1] == '-';
    const std::uint32_t head = node.headEnd;
    if (twice || !readEntry(node, open.index)) {
        errors_.error("E0122", dash, dash + 2, "`/-` has nothing to switch off",
                      twice ? "another `/-` follows" : "nothing follows");
        return false;
    }
    rollBack(before);
    node.valueCount = values;
    node.keyCount = keys;
    node.headEnd = head;
    return false;
}

// `fov = 40`: an equals sign without a key.
void TreeReader::readEquals(Record& node) {
    const char* const equals = at_++;
    entryEnd_ = nullptr; // the value behind it needs no space
    skipSpace();
    const bool first = node.headEnd == node.nameEnd;
    if (!first) {
        errors_.error("E0113", equals, equals + 1, "`=` needs the name of a key before it", "stands behind a value");
        node.damaged = true;
        return;
    }
    const char* const name = text_.begin + node.nameEnd;
    Diagnostic& d = errors_.error("E0113", equals, equals + 1, "a property and its value are separated by a space",
                                  "write a space instead");
    if (findLineEnd(name, at_) == at_) errors_.fix(d, name, at_, " ");
    touch(node, equals + 1);
}

// At `(`. Skips a type annotation and the space behind it. False where there is none: then `at_` is unchanged, unless a
// mistake inside was reported already.
bool TreeReader::readAnnotation(Record& node) {
    const char* const open = at_++;
    const std::size_t errorCount = errors_.count();
    skipSpace();
    std::string_view name;
    const bool named =
        startsText(at_) || (!startsNumber(at_) && !startsPointNumber(at_) && isWordCharacter(at_, text_.end));
    if (named) at_ = scanner_.scanName(at_, name);
    skipSpace();
    if (!named || *at_ != ')') {
        if (errors_.count() == errorCount) at_ = open;
        node.damaged = true;
        return false;
    }
    ++at_;
    skipSpace();
    if (!atEndOfNode() && *at_ != '{' && *at_ != '=') return true;
    errors_.error("E0123", open, at_, "a type annotation stands before a name or value", "nothing follows it");
    node.damaged = true;
    return true;
}

void TreeReader::noteComma() {
    commas_.push_back(at_);
    ++at_;
    entryEnd_ = nullptr; // no space is missed behind a comma
}

void TreeReader::checkSpace() {
    if (at_ == entryEnd_) reportMissingSpace(at_);
}

void TreeReader::reportMissingSpace(const char* place) {
    Diagnostic& d = errors_.error("E0120", place, place, "a space is missing", "write a space here");
    errors_.fix(d, place, place, " ");
}

void TreeReader::endEntries(Record& node) {
    node.end = node.headEnd;
    if (!commas_.empty()) reportCommas(node);
    if (node.keyCount > 1) removeDoubleKeys(node);
}

// One report for all commas of a node. A single one between two digits may be meant as a decimal point.
void TreeReader::reportCommas(Record& node) {
    const char* const first = commas_.front();
    Diagnostic& d =
        errors_.error("E0112", first, first + 1, "values are separated by spaces, not by commas", "remove the comma");
    if (commas_.size() == 1 && first > text_.begin && isDigit(first[-1]) && isDigit(first[1])) {
        d.label = "write a space, or a point if this is a decimal";
        node.damaged = true;
    } else {
        for (const char* comma : commas_) {
            const bool spaced = has(comma[1], kValueEnd) || blankLength(comma + 1, text_.end) > 0;
            errors_.fix(d, comma, comma + 1, spaced ? "" : " ");
        }
    }
    commas_.clear();
}

// Of several keys with one name the last one counts; the others are removed, with one warning for each name.
void TreeReader::removeDoubleKeys(Record& node) {
    struct Given {
        std::uint32_t first, last, count;
    };
    std::unordered_map<std::string_view, Given> given;
    const auto first = document_.keys.begin() + node.firstKey;
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < node.keyCount; ++i) {
        Given& g = given.try_emplace(first[i].name, Given{i, i, 0}).first->second;
        g.last = i;
        ++g.count;
    }
    if (given.size() == node.keyCount) return;
    for (std::uint32_t i = 0; i < node.keyCount; ++i) {
        const Given& g = given.at(first[i].name);
        if (g.count > 1 && g.first == i) reportDoubleKey(first[i], first[g.last], g.count);
    }
    for (std::uint32_t i = 0; i < node.keyCount; ++i)
        if (given.at(first[i].name).last == i) first[kept++] = first[i];
    node.keyCount = kept;
    document_.keys.resize(node.firstKey + kept);
    // The keys have moved: note their uses of parameters again.
    const auto index = static_cast<std::uint32_t>(&node - document_.nodes.data());
    auto own = uses_.end();
    while (own != uses_.begin() && std::prev(own)->node == index) --own;
    uses_.erase(std::remove_if(own, uses_.end(), [](const ParameterUse& use) { return use.key; }), uses_.end());
    for (std::uint32_t i = 0; i < kept; ++i)
        if (first[i].value.kind == ValueKind::word && first[i].value.text.starts_with('$'))
            uses_.push_back({index, i, true});
}

void TreeReader::reportDoubleKey(const schema::Key& first, const schema::Key& last, std::uint32_t count) {
    const std::string often = count == 2 ? "twice" : fmt::format("{} times", count);
    errors_.diagnostics()
        .warning("W0101", first.nameSpan, fmt::format("the key `{}` is given {}", first.name, often), "has no effect")
        .related.push_back({last.nameSpan, "this one counts"});
}

} // namespace abbe::parser
