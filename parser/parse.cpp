#include "parser/parse.h"

#include "base/file.h"
#include "base/memory_limit.h"
#include "parser/brace_plan.h"
#include "parser/foreign_file.h"
#include "parser/parameters.h"
#include "parser/source_text.h"
#include "parser/tree_reader.h"

#include <algorithm>
#include <fmt/format.h>
#include <istream>
#include <limits>
#include <span>
#include <system_error>

namespace abbe {

namespace {

constexpr std::size_t kLongest = std::size_t{64} << 20; // bytes of a text whose braces are looked at

bool mayBeOfBraces(const Diagnostic& d) {
    return d.code == "E0110" || d.code == "E0111" || d.code == "E0121" || d.code == "E0123" || d.code == "E0101";
}

bool isOfBraces(const Diagnostic& d) { return d.code == "E0110" || d.code == "E0111"; }

// One reading of a text: the tree, where it uses parameters, and what is wrong.
struct Reading {
    std::shared_ptr<schema::Document> document = std::make_shared<schema::Document>();
    std::vector<parser::ParameterUse> uses;
    Diagnostics found;

    Reading(FileId file, std::string_view text, const parser::BracePlan* plan, std::uint32_t maxDepth) {
        document->file = file;
        document->source = plan ? document->intern(plan->text) : text;
        const char* const begin = document->source.data();
        if (plan) found = plan->found;
        parser::SyntaxErrors errors({file, begin, begin + text.size()}, found);
        if (!plan && !parser::checkCharacters(errors)) return;
        const auto implied = plan ? std::span(plan->implied) : std::span<const parser::ImpliedBrace>();
        parser::TreeReader reader(errors, *document, maxDepth, implied);
        reader.read();
        uses = reader.uses();
    }
};

// Where braces do not agree, the text is read again as indentation says that it was meant, if it then holds together.
Reading readAsMeant(FileId file, std::string_view text, std::uint32_t maxDepth) {
    Reading asWritten(file, text, nullptr, maxDepth);
    if (text.size() > kLongest || std::ranges::none_of(asWritten.found.all(), mayBeOfBraces)) return asWritten;
    const auto plan = parser::planBraces({file, text.data(), text.data() + text.size()});
    if (!plan) return asWritten;
    Reading asMeant(file, text, &*plan, maxDepth);
    const auto own = std::span(asMeant.found.all()).subspan(plan->found.all().size());
    return std::ranges::any_of(own, isOfBraces) ? std::move(asWritten) : std::move(asMeant);
}

} // namespace

std::shared_ptr<schema::Document> parse(const SourceMap& sources, FileId file, const ParseOptions& options,
                                        Diagnostics& diagnostics) {
    const Reading reading = readAsMeant(file, sources.text(file), options.maxDepth);
    diagnostics.addAll(reading.found);
    auto& own = reading.document->parameters;
    own.insert(own.end(), options.inherited.begin(), options.inherited.end());
    parser::ParameterTable parameters(*reading.document, diagnostics);
    parameters.override(options, sources);
    parameters.substitute(reading.uses);
    if (!options.layered) parameters.warnOfUnused();
    return reading.document;
}

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

std::optional<FileId> refuseUnread(SourceMap& sources, const std::filesystem::path& path, Diagnostics& diagnostics,
                                   std::string_view why, std::string help = {}) {
    return refuse(sources, path, diagnostics, "E0410", fmt::format("cannot read `{}`: {}", path.string(), why),
                  std::move(help));
}

// Of a stream, which may have no end: what is no text is not read on.
std::string readStream(std::istream& stream) {
    std::string text;
    constexpr std::size_t step = std::size_t{1} << 20;
    while (stream && text.size() < kTooLarge) {
        const std::size_t had = text.size();
        if (had == step && text.find('\0') != std::string::npos) break;
        requireMemory(static_cast<double>(2 * had)); // while it grows
        text.resize(had + step);
        stream.read(text.data() + had, step);
        text.resize(had + static_cast<std::size_t>(stream.gcount()));
    }
    return text;
}

std::optional<FileId> addText(SourceMap& sources, const std::filesystem::path& path, std::string text,
                              Diagnostics& diagnostics) {
    if (text.size() >= kTooLarge) return refuseLarge(sources, path, diagnostics);
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
    RegularFile file(path.string());
    if (!file.good())
        return refuseUnread(sources, path, diagnostics, file.why(),
                            std::filesystem::is_regular_file(status) ? "" : "`abbe check -` reads standard input");
    if (file.size() >= kTooLarge) return refuseLarge(sources, path, diagnostics);
    try {
        requireMemory(static_cast<double>(file.size()));
        std::string text = file.readAll();
        if (!file.good()) return refuseUnread(sources, path, diagnostics, file.why());
        return addText(sources, path, std::move(text), diagnostics);
    } catch (const MemoryLimitExceeded& e) {
        return refuseUnread(sources, path, diagnostics, e.what());
    }
}

std::optional<FileId> readSceneText(SourceMap& sources, const std::string& name, std::istream& stream,
                                    Diagnostics& diagnostics) {
    try {
        std::string text = readStream(stream);
        if (stream.bad()) return refuseUnread(sources, name, diagnostics, "input error");
        return addText(sources, name, std::move(text), diagnostics);
    } catch (const MemoryLimitExceeded& e) {
        return refuseUnread(sources, name, diagnostics, e.what());
    }
}

} // namespace abbe
