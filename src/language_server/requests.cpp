#include "language_server/documents.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace abbe::lsp {

namespace {

using Answer = Json (*)(const Question&);

Json completionAt(const Question& q) {
    const Json context = q.params.value("context", Json::object());
    return completion(q.view, q.offset(), context.is_object() && context.value("triggerCharacter", Json()) == " ");
}

Json referencesAt(const Question& q) {
    const Json context = q.params.value("context", Json::object());
    return referencesTo(q.view, q.offset(), context.value("includeDeclaration", true));
}

Json actionsIn(const Question& q) {
    const Json& range = q.params.at("range");
    return codeActions(q.view, {positionFrom(range.at("start")), positionFrom(range.at("end"))},
                       q.text.currentFindings());
}

constexpr std::pair<std::string_view, Answer> kAnswers[] = {
    {"textDocument/completion", completionAt},
    {"textDocument/hover", [](const Question& q) { return hover(q.view, q.offset(), q.text.currentFindings()); }},
    {"textDocument/definition", [](const Question& q) { return definitionOf(q.view, q.offset()); }},
    {"textDocument/references", referencesAt},
    {"textDocument/documentHighlight", [](const Question& q) { return highlights(q.view, q.offset()); }},
    {"textDocument/prepareRename", [](const Question& q) { return renamable(q.view, q.offset()); }},
    {"textDocument/rename",
     [](const Question& q) { return rename(q.view, q.offset(), q.params.at("newName").get<std::string>()); }},
    {"textDocument/codeAction", actionsIn},
    {"textDocument/documentSymbol", [](const Question& q) { return symbols(q.view); }},
    {"textDocument/foldingRange", [](const Question& q) { return foldings(q.view); }},
    {"textDocument/documentLink", [](const Question& q) { return links(q.view); }},
    {"textDocument/semanticTokens/full", [](const Question& q) { return semanticTokens(q.view); }},
};

} // namespace

bool isAboutText(std::string_view method) {
    return std::ranges::find(kAnswers, method, &std::pair<std::string_view, Answer>::first) != std::end(kAnswers);
}

Json answerAbout(std::string_view method, const Question& question) {
    return std::ranges::find(kAnswers, method, &std::pair<std::string_view, Answer>::first)->second(question);
}

} // namespace abbe::lsp
