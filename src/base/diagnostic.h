// Diagnostics are data: made where a fault is found, printed at the end, all of a run at once.
#pragma once

#include "base/source.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace abbe {

enum class Severity : std::uint8_t { error, warning };

// A secondary place: "first amount", "defined here".
struct Label {
    Span span;
    std::string text;
};

// A mechanical repair: replace the span's text; applied by tools, shown as help.
struct FixIt {
    Span span;
    std::string replacement;
};

// One fault. `code` is stable and documented ("E0201"); `message` is one sentence, lower case, names in backticks;
// `label` stands beside the caret of the primary span.
struct Diagnostic {
    Severity severity = Severity::error;
    std::string code;
    std::string message;
    Span span;
    std::string label;
    std::vector<Label> related;
    std::vector<std::string> notes; // facts: "f-number = focal length / aperture diameter"
    std::string help;               // what to do, only when it is likely right
    std::vector<FixIt> fixes;
};

// Collects the diagnostics of one run in the order found. Not thread-safe.
class Diagnostics {
  public:
    Diagnostic& add(Diagnostic);
    Diagnostic& error(std::string code, Span, std::string message, std::string label = {});
    Diagnostic& warning(std::string code, Span, std::string message, std::string label = {});

    const std::vector<Diagnostic>& all() const { return list_; }
    std::size_t errorCount() const { return errors_; }
    std::size_t warningCount() const { return list_.size() - errors_; }
    bool hasErrors() const { return errors_ > 0; }

  private:
    std::vector<Diagnostic> list_;
    std::size_t errors_ = 0;
};

// The one exception of loading: everything that was found wrong.
class SceneError : public std::runtime_error {
  public:
    explicit SceneError(Diagnostics);
    const Diagnostics& diagnostics() const { return diagnostics_; }

  private:
    Diagnostics diagnostics_;
};

} // namespace abbe
