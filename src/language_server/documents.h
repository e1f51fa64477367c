// The texts that an editor has open, and what is known of each.
#pragma once

#include "language_server/analysis.h"
#include "language_server/checking.h"
#include "language_server/features.h"
#include "language_server/server.h"
#include "language_server/workspace.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace abbe::lsp {

class OpenText {
  public:
    OpenText(std::string uri, std::string text, std::int64_t version);

    // Replaces a range, or all of the text without one. Throws Json::exception for a change that is none.
    void change(const Json& change, Encoding);
    void setVersion(std::int64_t version) { version_ = version; }

    const std::string& uri() const { return uri_; }
    const std::string& text() const { return text_; }
    const TextLines& lines() const { return lines_; }
    std::int64_t version() const { return version_; }
    // Names the text, and says where its files are: the path of its file, or of one in the working folder.
    std::string path() const;
    std::size_t offset(const Json& position, Encoding e) const {
        return lines_.offset(text_, positionFrom(position), e);
    }
    // Of this version, and of files as they are: made when it is first asked for.
    View view(const Language&, Encoding, const Workspace&);
    // Forgets what is known of this version: files may have come that were not there.
    void forget() { analysis_.reset(); }

    std::optional<Server::Clock::time_point> checkAt; // when it wants to be checked
    std::vector<Finding> findings;                    // of the last check
    std::optional<std::int64_t> checkedVersion;       // that they are of
    // Those of this version; none while it is being checked.
    std::span<const Finding> currentFindings() const;

  private:
    std::string uri_, text_;
    std::int64_t version_ = 0;
    TextLines lines_;
    std::unique_ptr<const Analysis> analysis_;
};

// All open texts, and what was found in files by checks of texts that name them.
class Documents {
  public:
    OpenText& open(const std::string& uri, std::string text, std::int64_t version);
    void close(const std::string& uri);
    // Null: not open.
    OpenText* find(const std::string& uri);
    std::map<std::string, OpenText>& all() { return texts_; }
    Workspace& workspace() { return workspace_; }

    // Takes what a check has found. The URIs of files whose list is another one now.
    std::vector<std::string> take(const CheckResult&, bool complete);
    // What is known of a file, as `textDocument/publishDiagnostics` has it.
    Json published(const std::string& uri) const;

  private:
    std::map<std::string, OpenText> texts_;
    Workspace workspace_;
    std::map<std::string, std::map<std::string, std::vector<Finding>>> others_; // by file, then by the checked text
};

// A request about an open text.
struct Question {
    const View& view;
    const OpenText& text;
    const Json& params;

    // Of its `position`. Throws Json::exception where there is none.
    std::size_t offset() const { return text.offset(params.at("position"), view.encoding); }
};
bool isAboutText(std::string_view method);
// Requires: isAboutText(method). Throws RequestError, and Json::exception where parameters are missing.
Json answerAbout(std::string_view method, const Question&);

} // namespace abbe::lsp
