// Diagnostics are data: made where a fault is found, printed at the end, all of a run at once; what each code means;
// and the mechanical repairs.
#pragma once

#include "base/source.h"

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
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

// Collects the diagnostics of one run in the order found. Of one code a thousand are listed and the others counted:
// what is done with the list takes no longer for a file of a million faults. Not thread-safe.
class Diagnostics {
  public:
    static constexpr std::size_t kMostOfACode = 1000;

    // The diagnostic, to be completed until the next call; one that is not listed is forgotten then.
    Diagnostic& add(Diagnostic);
    void addAll(const Diagnostics&);
    Diagnostic& error(std::string code, Span, std::string message, std::string label = {});
    Diagnostic& warning(std::string code, Span, std::string message, std::string label = {});

    // Those listed; where some are not, a warning (W0199) says so.
    const std::vector<Diagnostic>& all() const { return list_; }
    std::size_t errorCount() const { return errors_; }
    std::size_t warningCount() const { return warnings_; }
    bool hasErrors() const { return errors_ > 0; }

  private:
    void count(Severity, std::size_t number);

    std::vector<Diagnostic> list_;
    std::map<std::string, std::size_t, std::less<>> listed_; // of each code
    Diagnostic unlisted_;                                    // the last one that is not
    std::size_t errors_ = 0, warnings_ = 0;
};

// The one exception of loading: everything that was found wrong.
class SceneError : public std::runtime_error {
  public:
    explicit SceneError(Diagnostics);
    const Diagnostics& diagnostics() const { return diagnostics_; }

  private:
    Diagnostics diagnostics_;
};

// By file and position; those without a place come first. Equal places keep the order in which they were found.
std::vector<const Diagnostic*> sortedByPlace(const Diagnostics&);

struct FixResult {
    std::string text;
    std::size_t applied = 0; // diagnostics that were repaired
};

// Applies the fixes that lie in `file`, whose text is `text`. The fixes of one diagnostic are applied together or not
// at all; where two diagnostics want to change the same place, the first one wins and the other is left for the next
// run.
FixResult applyFixes(std::string_view text, FileId file, const Diagnostics&);

struct CodeInfo {
    std::string_view code;        // "E0105"
    std::string_view title;       // one line, lower case
    std::string_view explanation; // a few sentences, with an example where that helps
};

// The entry of a code, or null.
const CodeInfo* findCode(std::string_view code);
// All entries, sorted by code within each range.
std::span<const CodeInfo> allCodes();

} // namespace abbe
