#include "language_server/documents.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace abbe::lsp {

OpenText::OpenText(std::string uri, std::string text, std::int64_t version)
    : uri_(std::move(uri)), text_(std::move(text)), version_(version), lines_(text_) {}

void OpenText::change(const Json& change, Encoding encoding) {
    const auto& inserted = change.at("text").get_ref<const std::string&>();
    analysis_.reset();
    if (!change.contains("range")) {
        text_ = inserted;
        lines_ = TextLines(text_);
        return;
    }
    const Json& range = change.at("range");
    const std::size_t begin = offset(range.at("start"), encoding);
    const std::size_t end = std::max(begin, offset(range.at("end"), encoding));
    text_.replace(begin, end - begin, inserted);
    lines_.replaced(text_, begin, end, inserted.size());
}

std::string OpenText::path() const {
    if (const auto path = pathOf(uri_)) return path->string();
    std::error_code error;
    const auto folder = std::filesystem::current_path(error);
    return (folder / "untitled.scene").string();
}

View OpenText::view(const Language& language, Encoding encoding, const Workspace& workspace) {
    if (analysis_ && !analysis_->isCurrent(workspace)) analysis_.reset();
    if (!analysis_) analysis_ = std::make_unique<const Analysis>(language, path(), text_, &workspace);
    return {uri_, *analysis_, lines_, encoding, &workspace};
}

std::span<const Finding> OpenText::currentFindings() const {
    return checkedVersion == version_ ? std::span<const Finding>(findings) : std::span<const Finding>();
}

OpenText& Documents::open(const std::string& uri, std::string text, std::int64_t version) {
    OpenText& opened = texts_.insert_or_assign(uri, OpenText(uri, std::move(text), version)).first->second;
    workspace_.open(opened);
    return opened;
}

void Documents::close(const std::string& uri) {
    if (const OpenText* const text = find(uri)) workspace_.close(*text);
    texts_.erase(uri);
}

OpenText* Documents::find(const std::string& uri) {
    const auto found = texts_.find(uri);
    return found == texts_.end() ? nullptr : &found->second;
}

std::vector<std::string> Documents::take(const CheckResult& result, bool complete) {
    std::vector<std::string> changed = {result.uri};
    OpenText* const text = find(result.uri);
    if (text) {
        text->findings = result.findings;
        text->checkedVersion = result.version;
    }
    if (!complete) return changed;
    for (auto& [uri, byText] : others_)
        if (byText.erase(result.uri) > 0) changed.push_back(uri);
    for (const FileFindings& other : text ? result.others : std::vector<FileFindings>{}) {
        others_[other.uri][result.uri] = other.findings;
        if (std::ranges::find(changed, other.uri) == changed.end()) changed.push_back(other.uri);
    }
    std::erase_if(others_, [](const auto& file) { return file.second.empty(); });
    return changed;
}

Json Documents::published(const std::string& uri) const {
    Json list = Json::array();
    Json result = {{"uri", uri}};
    const auto text = texts_.find(uri);
    if (text != texts_.end()) {
        for (const Finding& finding : text->second.findings) list.push_back(toJson(finding));
        if (text->second.checkedVersion) result["version"] = *text->second.checkedVersion;
    }
    if (const auto others = others_.find(uri); others != others_.end())
        for (const auto& [owner, findings] : others->second)
            for (const Finding& finding : findings) {
                Json json = toJson(finding);
                // A file that several texts name, or that is open itself, has each fault once.
                if (std::ranges::find(list, json) == list.end()) list.push_back(std::move(json));
            }
    result["diagnostics"] = std::move(list);
    return result;
}

} // namespace abbe::lsp
