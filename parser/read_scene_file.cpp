#include "parser/foreign_file.h"
#include "parser/parse.h"
#include "parser/source_text.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <system_error>

namespace abbe {

namespace {

// A file that could not be read has no text; its diagnostic points at the beginning of an empty one.
std::optional<FileId> refuse(SourceMap& sources, const std::filesystem::path& path, Diagnostics& diagnostics,
                             const char* code, std::string message, std::string help = {}) {
    const FileId file = sources.add(path.string(), {});
    diagnostics.error(code, {file, 0, 0}, std::move(message)).help = std::move(help);
    return std::nullopt;
}

constexpr std::uintmax_t kTooLarge = std::numeric_limits<std::uint32_t>::max();

std::optional<FileId> refuseLarge(SourceMap& sources, const std::filesystem::path& path, Diagnostics& diagnostics) {
    return refuse(sources, path, diagnostics, "E0411", fmt::format("`{}` is larger than 4 GiB", path.string()),
                  "keep meshes in PLY or OBJ files");
}

// All of a stream of that many bytes, as far as it is known: pipes have no size.
std::optional<FileId> readText(SourceMap& sources, const std::filesystem::path& path, std::istream& stream,
                               std::size_t size, Diagnostics& diagnostics) {
    std::string text;
    if (size > 0) text.reserve(size + 1);
    constexpr std::size_t step = std::size_t{1} << 20, largestStep = std::size_t{1} << 30;
    while (stream) {
        const std::size_t had = text.size();
        text.resize(had + (had >= size ? step : std::min(size - had, largestStep)));
        stream.read(text.data() + had, static_cast<std::streamsize>(text.size() - had));
        text.resize(had + static_cast<std::size_t>(stream.gcount()));
        if (text.size() >= kTooLarge) return refuseLarge(sources, path, diagnostics);
    }
    if (stream.bad())
        return refuse(sources, path, diagnostics, "E0410", fmt::format("cannot read `{}`: input error", path.string()));
    // Nothing of these is quoted.
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
        return refuse(sources, path, diagnostics, "E0412", fmt::format("`{}` is not UTF-8 text", path.string()),
                      "this looks like UTF-16; save the file as UTF-8");
    if (const auto foreign = parser::recogniseForeign(text, path.filename().string()))
        return refuse(sources, path, diagnostics, "E0413",
                      fmt::format("`{}` is {}, not a scene", path.string(), foreign->what), foreign->help);
    const FileId file = sources.add(path.string(), std::move(text));
    const std::string_view added = sources.text(file);
    parser::SyntaxErrors errors({file, added.data(), added.data() + added.size()}, diagnostics);
    return parser::checkUtf8(errors) ? std::optional(file) : std::nullopt;
}

} // namespace

std::optional<FileId> readSceneFile(SourceMap& sources, const std::filesystem::path& path, Diagnostics& diagnostics) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status))
        return refuse(sources, path, diagnostics, "E0410", fmt::format("file not found: `{}`", path.string()));
    if (std::filesystem::is_directory(status))
        return refuse(sources, path, diagnostics, "E0410", fmt::format("`{}` is a directory", path.string()),
                      "name the scene file in it");
    std::ifstream stream(path, std::ios::binary);
    if (!stream)
        return refuse(sources, path, diagnostics, "E0410",
                      fmt::format("cannot read `{}`: {}", path.string(), std::strerror(errno)));
    const std::uintmax_t size = std::filesystem::file_size(path, error); // pipes have none
    if (!error && size >= kTooLarge) return refuseLarge(sources, path, diagnostics);
    return readText(sources, path, stream, error ? 0 : static_cast<std::size_t>(size), diagnostics);
}

std::optional<FileId> readSceneText(SourceMap& sources, const std::string& name, std::istream& stream,
                                    Diagnostics& diagnostics) {
    return readText(sources, name, stream, 0, diagnostics);
}

} // namespace abbe
