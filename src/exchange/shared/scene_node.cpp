#include "exchange/shared/scene_node.h"

#include "exchange/shared/decimal.h"

#include <algorithm>
#include <array>

namespace abbe::exchange {

namespace {

constexpr std::size_t kLineLength = 120;
constexpr int kIndent = 4;

// Bytes from `at` on that form one character of UTF-8, or 0.
std::size_t utf8Length(std::string_view text, std::size_t at) {
    const auto lead = static_cast<unsigned char>(text[at]);
    const std::size_t length = lead < 0x80 ? 1 : lead >> 5 == 6 ? 2 : lead >> 4 == 14 ? 3 : lead >> 3 == 30 ? 4 : 0;
    if (length == 0 || at + length > text.size()) return 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((static_cast<unsigned char>(text[at + i]) & 0xc0) != 0x80) return 0;
    constexpr std::array<unsigned, 5> kFirst = {0, 0, 0x80, 0x800, 0x10000};
    unsigned point = length == 1 ? lead : lead & (0xffu >> (length + 1));
    for (std::size_t i = 1; i < length; ++i) point = point << 6 | (static_cast<unsigned char>(text[at + i]) & 0x3fu);
    const bool surrogate = point >= 0xd800 && point < 0xe000;
    return point < kFirst[length] || point > 0x10ffff || surrogate ? 0 : length;
}

// Marks that change the direction of writing and other characters that the language wants as escapes.
bool mustBeEscaped(std::string_view character) {
    if (character.size() == 1) {
        const auto byte = static_cast<unsigned char>(character[0]);
        return byte < 0x20 || byte == 0x7f;
    }
    if (character.size() == 2)
        return static_cast<unsigned char>(character[0]) == 0xc2 && // U+0080 to U+009F
               static_cast<unsigned char>(character[1]) < 0xa0;
    const auto between = [&](std::string_view first, std::string_view last) {
        return character.size() == first.size() && character >= first && character <= last;
    };
    return between("\u200e", "\u200f") || between("\u2028", "\u202e") || between("\u2066", "\u2069") ||
           character == "\ufeff";
}

unsigned codePoint(std::string_view character) {
    const auto lead = static_cast<unsigned char>(character[0]);
    unsigned point = character.size() == 1 ? lead : lead & (0xffu >> (character.size() + 1));
    for (std::size_t i = 1; i < character.size(); ++i)
        point = point << 6 | (static_cast<unsigned char>(character[i]) & 0x3fu);
    return point;
}

void appendEscaped(std::string& out, std::string_view character) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    if (character == "\n")
        out += "\\n";
    else if (character == "\t")
        out += "\\t";
    else if (character == "\r")
        out += "\\r";
    else {
        const unsigned point = codePoint(character);
        out += "\\u{";
        for (int shift = 20; shift >= 0; shift -= 4)
            if (point >> shift != 0 || shift == 0) out += kDigits[point >> shift & 15u];
        out += '}';
    }
}

std::string quotedText(std::string_view text) {
    std::string out = "\"";
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = utf8Length(text, at);
        if (length == 0) {
            out += "\ufffd";
            ++at;
            continue;
        }
        const std::string_view character = text.substr(at, length);
        if (character == "\"" || character == "\\") out += '\\';
        if (mustBeEscaped(character))
            appendEscaped(out, character);
        else
            out += character;
        at += length;
    }
    return out + '"';
}

} // namespace

bool isPlainWord(std::string_view text) {
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    const auto inside = [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == ':'; };
    constexpr std::array<std::string_view, 6> kKeywords = {"true", "false", "null", "inf", "nan", "-inf"};
    return !text.empty() && letter(text[0]) && std::ranges::all_of(text, inside) &&
           std::ranges::find(kKeywords, text) == kKeywords.end();
}

namespace {

// For so many numbers, so that a text need not move while it grows.
void makeRoom(std::string& values, std::size_t numbers) {
    constexpr std::size_t kOfNumber = 12;
    const std::size_t wanted = values.size() + numbers * kOfNumber;
    if (values.capacity() < wanted) values.reserve(std::max(wanted, 2 * values.capacity()));
}

} // namespace

std::string numberText(double value) {
    std::string text;
    appendDecimal(text, value);
    return text;
}

SceneNode& SceneNode::word(std::string_view text) {
    if (!text.empty()) values_.append(1, ' ').append(text);
    return *this;
}

SceneNode& SceneNode::name(std::string_view text) { return isPlainWord(text) ? word(text) : this->text(text); }

SceneNode& SceneNode::number(double value) {
    values_ += ' ';
    appendDecimal(values_, value);
    return *this;
}

SceneNode& SceneNode::numbers(std::span<const double> values) {
    makeRoom(values_, values.size());
    for (const double value : values) number(value);
    return *this;
}

SceneNode& SceneNode::vector(Vec3d v) {
    makeRoom(values_, 3);
    return number(v.x).number(v.y).number(v.z);
}

SceneNode& SceneNode::text(std::string_view value) { return word(quotedText(value)); }

SceneNode& SceneNode::key(std::string_view name, std::string_view word) {
    values_.append(1, ' ').append(name).append(1, '=').append(isPlainWord(word) ? std::string(word) : quotedText(word));
    return *this;
}

SceneNode& SceneNode::key(std::string_view name, double value) {
    values_.append(1, ' ').append(name).append(1, '=');
    appendDecimal(values_, value);
    return *this;
}

SceneNode& SceneNode::child(std::string name) { return children_.emplace_back(std::move(name)); }

SceneNode& SceneNode::adopt(SceneNode node) { return children_.emplace_back(std::move(node)); }

SceneNode& SceneNode::absorb(SceneNode other) {
    values_ += other.values_;
    children_.splice(children_.end(), other.children_);
    remarks_.insert(remarks_.end(), other.remarks_.begin(), other.remarks_.end());
    return *this;
}

SceneNode& SceneNode::remark(std::string_view text) {
    std::string line;
    const auto end = [&] {
        if (!line.empty()) remarks_.push_back(std::exchange(line, {}));
    };
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = std::max<std::size_t>(utf8Length(text, at), 1);
        const std::string_view character = text.substr(at, length);
        if (character == "\n")
            end();
        else if (utf8Length(text, at) != 0 && !mustBeEscaped(character))
            line += character;
        at += length;
    }
    end();
    return *this;
}

// Writes nodes behind each other into one text. A node is tried on one line, and taken back where it does not fit.
class ScenePrinter {
  public:
    // Writes behind what the text holds.
    explicit ScenePrinter(std::string& text) : out_(text) {}

    void file(const SceneNode& node, const SceneNode* before) {
        const bool apart = before && (before->name_ != node.name_ || !node.remarks_.empty() || wasBlock_);
        if (apart) out_ += '\n';
        const std::size_t begin = out_.size();
        if (node.form_ == SceneNode::Form::parts)
            wasBlock_ = print(node, 0);
        else
            out_ += node.values_, wasBlock_ = node.form_ == SceneNode::Form::block;
        if (before && !apart && wasBlock_) out_.insert(begin, 1, '\n');
    }

    // Whether it took more than one line, or a longer one than others have.
    bool print(const SceneNode& node, std::size_t indent) {
        for (const std::string& remark : node.remarks_)
            out_.append(indent, ' ').append("// ").append(remark).append(1, '\n');
        out_.append(indent, ' ');
        const std::size_t begin = out_.size();
        const bool fits = onOneLine(node, begin + kLineLength - indent);
        if (!fits && !node.children_.empty()) {
            out_.resize(begin);
            out_.append(node.name_).append(node.values_).append(" {\n");
            block(node, indent + kIndent);
            out_.append(indent, ' ').append(1, '}');
        }
        out_ += '\n';
        return !fits;
    }

  private:
    // False where the text would go beyond `end`, or lose remarks.
    bool onOneLine(const SceneNode& node, std::size_t end) {
        out_.append(node.name_).append(node.values_);
        if (out_.size() > end) return false;
        if (node.children_.empty()) return true;
        out_ += " { ";
        bool first = true;
        for (const SceneNode& child : node.children_) {
            if (!child.remarks_.empty()) return false;
            if (!std::exchange(first, false)) out_ += "; ";
            if (!onOneLine(child, end)) return false;
        }
        out_ += " }";
        return out_.size() <= end;
    }

    // Rows stand several to a line.
    void block(const SceneNode& node, std::size_t indent) {
        std::size_t length = 0; // of the line of rows that is not ended
        const auto end = [&] {
            if (std::exchange(length, 0) > 0) out_ += '\n';
        };
        for (const SceneNode& child : node.children_) {
            if (child.name_ != "-" || !child.children_.empty() || !child.remarks_.empty()) {
                end();
                print(child, indent);
                continue;
            }
            const std::size_t row = child.name_.size() + child.values_.size();
            if (indent + length + row + 2 > kLineLength) end();
            if (length == 0)
                out_.append(indent, ' ');
            else
                out_ += "; ";
            out_.append(child.name_).append(child.values_);
            length += row + (length == 0 ? 0 : 2);
        }
        end();
    }

    std::string& out_;
    bool wasBlock_ = false;
};

void SceneNode::settle() {
    if (form_ != Form::parts) return;
    thread_local std::string text; // its memory serves the next node
    text.clear();
    form_ = ScenePrinter(text).print(*this, 0) ? Form::block : Form::line;
    values_ = text;
    constexpr std::size_t kMostKept = 1 << 20;
    if (text.capacity() > kMostKept) std::string().swap(text);
    children_.clear();
    if (!remarks_.empty()) remarks_.resize(1); // whether there are any still counts
}

template <typename Nodes> std::string printed(const Nodes& nodes) {
    std::string text;
    ScenePrinter printer(text);
    const SceneNode* before = nullptr;
    for (const SceneNode& node : nodes) printer.file(node, std::exchange(before, &node));
    return text;
}

std::string printScene(std::span<const SceneNode> nodes) { return printed(nodes); }

std::string printScene(const std::list<SceneNode>& nodes) { return printed(nodes); }

std::string printScene(std::list<SceneNode>&& nodes) {
    std::size_t room = 0;
    for (const SceneNode& node : nodes) room += node.values().size() + 2; // the whole text of settled ones
    std::string text;
    text.reserve(room);
    ScenePrinter printer(text);
    const SceneNode* before = nullptr;
    for (auto node = nodes.begin(); node != nodes.end(); ++node) {
        printer.file(*node, before);
        if (before) nodes.pop_front();
        before = &*node;
    }
    nodes.clear();
    return text;
}

} // namespace abbe::exchange
