// What editors ask about a place in a text, or about all of it. Each answers as the protocol wants it; null where there
// is nothing to say.
#pragma once

#include "language_server/analysis.h"
#include "language_server/checking.h"
#include "language_server/protocol.h"
#include "language_server/server.h"

#include <span>
#include <stdexcept>
#include <string>

namespace abbe::lsp {

// A request that cannot be answered; the message is for the user.
struct RequestError : std::runtime_error {
    RequestError(ErrorCode c, const std::string& message) : std::runtime_error(message), code(c) {}
    ErrorCode code;
};

// An open text as its editor sees it.
struct View {
    const std::string& uri;
    const Analysis& analysis;
    const TextLines& lines;
    Encoding encoding;
    const Workspace* workspace = nullptr;

    Range range(std::size_t begin, std::size_t end) const {
        return {lines.position(analysis.text(), begin, encoding), lines.position(analysis.text(), end, encoding)};
    }
    Range range(Span span) const { return range(span.begin, span.end); }
    // `{uri, range}` in whichever file the span lies.
    Json location(Span) const;
};

// A place in a file of a scene.
Range rangeIn(const Analysis&, Span, Encoding);

Json completion(const View&, std::size_t offset, bool afterSpace);
// `findings`: of the same version of the text; those at the place are explained.
Json hover(const View&, std::size_t offset, std::span<const Finding> findings);

Json definitionOf(const View&, std::size_t offset);
Json referencesTo(const View&, std::size_t offset, bool withDefinition);
Json highlights(const View&, std::size_t offset);
// Range and name of what can be renamed.
Json renamable(const View&, std::size_t offset);
// The edits of all files that use the name: those of the scene, and scenes of the workspace that include one of them.
// Throws RequestError for a name that is none, is taken, or would change what a scene means.
Json rename(const View&, std::size_t offset, const std::string& newName);

Json symbols(const View&);
Json foldings(const View&);
// Files that the text names.
Json links(const View&);
Json semanticTokens(const View&);
Json semanticLegend();

// Repairs of the findings in `range`, and one of all.
Json codeActions(const View&, const Range&, std::span<const Finding> findings);
// The edits that lay the text out; none where it has syntax errors.
Json formatting(const View&, const Formatter&);

// What a property takes, for people: Markdown. `title` names it.
std::string fieldMarkdown(const schema::FieldInfo&, const std::string& title);

} // namespace abbe::lsp
