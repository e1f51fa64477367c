#include "base/source.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace abbe {

FileId SourceMap::add(std::string path, std::string text) {
    files_.push_back({std::move(path), std::move(text), {}, {}});
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

SourceMap::Characters SourceMap::charactersBefore(FileId id, std::size_t offset) const {
    const File& file = files_[static_cast<std::size_t>(id)];
    const auto count = [&](Characters before, std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const auto byte = static_cast<unsigned char>(file.text[i]);
            const bool begins = (byte & 0xc0u) != 0x80u;
            before.points += begins;
            before.units += begins + (byte >= 0xf0u); // beyond the basic plane: two units
        }
        return before;
    };
    if (file.marks.empty()) {
        file.marks.emplace_back();
        for (std::size_t end = kBlock; end <= file.text.size(); end += kBlock)
            file.marks.push_back(count(file.marks.back(), end - kBlock, end));
    }
    const std::size_t place = std::min(offset, file.text.size()), block = place / kBlock;
    return count(file.marks[block], block * kBlock, place);
}

LineColumn SourceMap::lineColumn(FileId id, std::uint32_t offset) const {
    const auto& starts = lineStarts(id);
    const auto next = std::upper_bound(starts.begin(), starts.end(), offset);
    const std::uint32_t before = charactersBefore(id, *std::prev(next)).points;
    return {static_cast<std::uint32_t>(next - starts.begin()), charactersBefore(id, offset).points - before + 1};
}

std::uint32_t SourceMap::utf16Column(FileId id, std::uint32_t offset) const {
    const auto& starts = lineStarts(id);
    const auto next = std::upper_bound(starts.begin(), starts.end(), offset);
    return charactersBefore(id, offset).units - charactersBefore(id, *std::prev(next)).units;
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
