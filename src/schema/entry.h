// What binding reads: one property, or the arguments of a definition, as a row of values with keys and a block.
#pragma once

#include "base/diagnostic.h"
#include "schema/document.h"
#include "schema/scene_tree.h"

#include <optional>
#include <string_view>
#include <vector>

namespace abbe::schema {

// Views into the Document; valid while it is. Rows of numbers stay packed as the Document holds them.
class Entry {
  public:
    explicit Entry(Node property)
        : node_(property), name_(property.name()), span_(property.headSpan()), keys_(property.keys()) {}
    // Arguments: `name` is that of the field they fill.
    Entry(std::string_view name, Span span, std::vector<Value> values, std::span<const Key> keys = {})
        : values_(std::move(values)), name_(name), span_(span), keys_(keys) {}

    // The same property without its first `skipped` values.
    Entry(Node property, std::size_t skipped) : Entry(property) { skipped_ = skipped; }

    std::string_view name() const { return name_; }
    Span span() const { return span_; } // of the whole entry without its block
    std::size_t count() const { return node_ ? node_->valueCount() - skipped_ : values_.size(); }
    Value value(std::size_t i) const { return node_ ? node_->value(skipped_ + i) : values_[i]; }
    bool packed() const { return node_ && node_->allNumbers(); }
    PackedNumbers numbers() const { return node_->numbers().without(skipped_); } // requires packed()
    std::span<const Key> keys() const { return keys_; }
    const std::optional<Node>& node() const { return node_; } // nothing for arguments
    bool hasBlock() const { return node_ && node_->hasBlock(); }

  private:
    std::optional<Node> node_;
    std::size_t skipped_ = 0; // of the node's values
    std::vector<Value> values_;
    std::string_view name_;
    Span span_;
    std::span<const Key> keys_;
};

// Where to point for a value: at its `$name` if it came from a parameter.
inline Span place(const Value& value) { return value.use.valid() ? value.use : value.span; }

// Adds what `found` holds and `diagnostics` does not hold yet: a named spectrum that is used ten times is wrong once.
void mergeOnce(Diagnostics& diagnostics, const Diagnostics& found);

// An error at a value, with a second label at the parameter that it came from.
Diagnostic& reportAt(Diagnostics&, const Value&, std::string_view code, std::string message, std::string label = {});
Diagnostic& report(Diagnostics&, Span, std::string_view code, std::string message, std::string label = {});

// Name and values as one writes them, for messages: "rotate y 45 deg".
std::string headText(const Node&);

// "`light rim`", "`camera`", "`material dielectric`": how messages name a definition.
std::string title(const Definition&);

} // namespace abbe::schema
