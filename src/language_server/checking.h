// What `abbe check` finds in a text that an editor holds, as data for the editor: the slow part of the server, which
// reads all files that a scene names.
#pragma once

#include "base/diagnostic.h"
#include "language_server/protocol.h"

#include <functional>
#include <string>
#include <vector>

namespace abbe::lsp {

struct CheckJob {
    std::string uri;
    std::string path; // names the text and says where its files are
    std::int64_t version = 0;
    std::string text;
    Encoding encoding = Encoding::utf16;
};

struct RelatedPlace {
    std::string uri;
    Range range;
    std::string text;
};

struct TextEdit {
    Range range;
    std::string newText;
};

// A diagnostic with its places as the editor counts them.
struct Finding {
    Range range;
    Severity severity = Severity::error;
    std::string code;
    std::string message; // with label, help and notes, a line each
    std::vector<RelatedPlace> related;
    std::vector<TextEdit> fixes; // all of them together; in the checked text alone
};

struct FileFindings {
    std::string uri;
    std::vector<Finding> findings;
};

struct CheckResult {
    std::string uri;
    std::int64_t version = 0;
    std::vector<Finding> findings;
    std::vector<FileFindings> others; // in other files
};

// Never throws: what keeps a check from its end is a finding, too. `early` is given what syntax and names have told,
// before files are read, if there are errors in them.
CheckResult check(const CheckJob&, const std::function<void(CheckResult)>& early = {});

// As the field `diagnostics` of a notification has it.
Json toJson(const Finding&);
Json toJson(const TextEdit&);

} // namespace abbe::lsp
