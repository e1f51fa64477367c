#include "base/source_map.h"

#include <algorithm>
#include <utility>

namespace abbe {

FileId SourceMap::add(std::string path, std::string text) {
    files_.push_back({std::move(path), std::move(text), {}});
    return static_cast<FileId>(files_.size() - 1);
}

std::string_view SourceMap::path(FileId id) const { return files_[static_cast<std::size_t>(id)].path; }

std::string_view SourceMap::text(FileId id) const { return files_[static_cast<std::size_t>(id)].text; }

std::string_view SourceMap::text(Span span) const {
    return span.valid() ? text(span.file).substr(span.begin, span.end - span.begin) : std::string_view{};
}

const std::vector<std::uint32_t>& SourceMap::lineStarts(FileId id) const {
    const File& file = files_[static_cast<std::size_t>(id)];
    if (file.lineStarts.empty()) {
        file.lineStarts.push_back(0);
        // Line feed, carriage return, or both: what editors count.
        for (std::size_t i = 0; i < file.text.size(); ++i)
            if (file.text[i] == '\n' || (file.text[i] == '\r' && file.text[i + 1] != '\n'))
                file.lineStarts.push_back(static_cast<std::uint32_t>(i + 1));
    }
    return file.lineStarts;
}

LineColumn SourceMap::lineColumn(FileId id, std::uint32_t offset) const {
    const auto& starts = lineStarts(id);
    const auto next = std::upper_bound(starts.begin(), starts.end(), offset);
    const auto line = static_cast<std::uint32_t>(next - starts.begin());
    std::uint32_t column = 1;
    const std::string_view all = text(id);
    for (std::size_t i = starts[line - 1]; i < offset && i < all.size(); ++i)
        column += (static_cast<unsigned char>(all[i]) & 0xc0u) != 0x80u; // count code points, not bytes
    return {line, column};
}

std::string_view SourceMap::line(FileId id, std::uint32_t number) const {
    const auto& starts = lineStarts(id);
    if (number == 0 || number > starts.size()) return {};
    const std::string_view all = text(id);
    const std::size_t begin = starts[number - 1];
    std::size_t end = number < starts.size() ? starts[number] : all.size();
    while (end > begin && (all[end - 1] == '\n' || all[end - 1] == '\r')) --end;
    return all.substr(begin, end - begin);
}

} // namespace abbe
