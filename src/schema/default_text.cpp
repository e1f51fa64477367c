#include "schema/default_text.h"

#include <charconv>

namespace abbe::schema {

namespace {

Value parseValue(std::string_view word) {
    Value value;
    value.text = word;
    value.kind = ValueKind::word;
    if (word.size() > 1 && word.front() == '"' && word.back() == '"') {
        value.kind = ValueKind::string;
        value.text = word.substr(1, word.size() - 2);
        return value;
    }
    double number = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    const bool digits = word.find_first_of("0123456789") != std::string_view::npos; // not `inf`
    if (error == std::errc() && stop == word.data() + word.size() && digits) {
        value.kind = ValueKind::number;
        value.number = number;
    }
    return value;
}

} // namespace

std::unique_ptr<Document> documentOf(std::string_view name, std::string_view text) {
    auto document = std::make_unique<Document>();
    Document::NodeRecord node;
    node.name = document->intern(std::string(name));
    std::string_view rest = document->intern(std::string(text));
    while (true) {
        const auto start = rest.find_first_not_of(' ');
        if (start == std::string_view::npos) break;
        rest.remove_prefix(start);
        const auto end = rest.find(' ');
        document->values.push_back(parseValue(rest.substr(0, end)));
        ++node.valueCount;
        if (end == std::string_view::npos) break;
        rest.remove_prefix(end);
    }
    document->nodes.push_back(node);
    return document;
}

} // namespace abbe::schema
