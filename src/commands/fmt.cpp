#include "app/load.h"
#include "base/check.h"
#include "base/diagnostic.h"
#include "base/text_output.h"
#include "commands/command_table.h"
#include "exchange/importer/importer.h"
#include "io/file.h"
#include "parser/parse.h"
#include "schema/describe.h"
#include "schema/json_schema.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <iostream>
#include <span>

namespace abbe {

const char* const kFmtHelp = R"(Lays scene files out in one style, without a change of what they mean.

Examples:
  abbe fmt room.scene                        in place, if anything changes
  abbe fmt --check scenes                    names those that would change in a folder, for CI
  abbe fmt --diff room.scene                 shows what would change
  abbe fmt --stdin <room.scene               from an editor: the text goes to standard output
  abbe fmt --upgrade old.scene               states the edition of the language, too
  abbe fmt --tree room.scene >room.json      its nodes as JSON, for other programs)";

namespace {

constexpr const char* kFromInput = "-";

std::optional<ArgumentFault> wrongTogether(const FmtOptions& options) {
    const auto inputs = std::ranges::count(options.paths, kFromInput) + (options.standardInput ? 1 : 0);
    if (inputs == 0 && options.paths.empty()) return ArgumentFault{"scenes", "name a file, or give --stdin"};
    if (inputs > 1) return ArgumentFault{"--stdin", "standard input can be read once"};
    if (options.standardInput && !options.paths.empty())
        return ArgumentFault{"--stdin", "it is in place of scene files"};
    if (options.tree && (options.check || options.diff || options.upgrade))
        return ArgumentFault{"--tree", "it prints the text as it is, and lays nothing out"};
    if (options.tree && options.paths.size() > 1) return ArgumentFault{"--tree", "it prints one scene"};
    if (inputs == 0 && !options.standsFor.empty()) return ArgumentFault{"--as", "it is for standard input"};
    return std::nullopt;
}

} // namespace

void addArguments(Arguments& a, FmtOptions& o) {
    a.argument("scenes", &o.paths, "Scene files, or folders of them; - is standard input");
    a.flag("--check", &o.check, "Write nothing; list the files that would change, and exit with 4 if there are any");
    a.flag("--diff", &o.diff, "Write nothing; show what would change");
    a.flag("--stdin", &o.standardInput, "The text comes from standard input and goes to standard output");
    a.value("--as", "FILE", &o.standsFor, "What standard input is called in messages");
    a.flag("--upgrade", &o.upgrade, "State the edition of the language where it is missing");
    a.flag("--tree", &o.tree, "Write nothing; print the nodes as JSON (`abbe reference json-schema` describes it)");
    a.flag("--quiet,-q", &o.quiet, "Say nothing but errors");
    MessageFormat& format = a.common().format;
    a.choice<MessageFormat>(
        "--format", format,
        {{"human", MessageFormat::human}, {"short", MessageFormat::brief}, {"json", MessageFormat::json}},
        "How faults are told; short: path:line:column: text");
    a.afterwards([&o] { return wrongTogether(o); });
}

namespace {

// Differences between texts, line by line ---------------------------------------------------------------------------

using LineList = std::vector<std::string_view>; // with their line ends

LineList linesOf(std::string_view text) {
    LineList lines;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
        lines.push_back(text.substr(0, end));
        text.remove_prefix(end);
    }
    return lines;
}

// Lines [oldBegin, oldEnd) of the old text became [newBegin, newEnd) of the new one.
struct LineChange {
    std::ptrdiff_t oldBegin, oldEnd, newBegin, newEnd;
};

// The shortest script from one list of lines to the other [Myers1986]. Beyond kMostEdits edits the two differ in all.
class LineDifference {
  public:
    LineDifference(std::span<const std::string_view> a, std::span<const std::string_view> b) : a_(a), b_(b) {
        const auto ends = std::ranges::mismatch(a_, b_);
        begin_ = ends.in1 - a_.begin();
        const auto ra = a_.subspan(static_cast<std::size_t>(begin_)), rb = b_.subspan(static_cast<std::size_t>(begin_));
        const std::ptrdiff_t most = static_cast<std::ptrdiff_t>(std::min(ra.size(), rb.size()));
        while (tail_ < most && ra[ra.size() - 1 - static_cast<std::size_t>(tail_)] ==
                                   rb[rb.size() - 1 - static_cast<std::size_t>(tail_)])
            ++tail_;
        n_ = static_cast<std::ptrdiff_t>(ra.size()) - tail_;
        m_ = static_cast<std::ptrdiff_t>(rb.size()) - tail_;
    }

    std::vector<LineChange> changes() {
        if (n_ == 0 && m_ == 0) return {};
        if (n_ == 0 || m_ == 0 || !search()) return {{begin_, begin_ + n_, begin_, begin_ + m_}};
        return backtrack();
    }

  private:
    static constexpr std::ptrdiff_t kMostEdits = 2000;

    bool equal(std::ptrdiff_t x, std::ptrdiff_t y) const {
        return a_[static_cast<std::size_t>(begin_ + x)] == b_[static_cast<std::size_t>(begin_ + y)];
    }
    // Furthest x on diagonal k = x - y after d edits, k from -d to d.
    std::ptrdiff_t& reached(std::ptrdiff_t d, std::ptrdiff_t k) {
        return furthest_[static_cast<std::size_t>(d)][static_cast<std::size_t>(k + d)];
    }
    // Where d edits begin the run of equal lines on diagonal k; after one more than d - 1.
    std::ptrdiff_t entered(std::ptrdiff_t d, std::ptrdiff_t k) {
        const bool down = k == -d || (k != d && reached(d - 1, k - 1) < reached(d - 1, k + 1));
        return down ? reached(d - 1, k + 1) : reached(d - 1, k - 1) + 1;
    }

    bool search() {
        for (std::ptrdiff_t d = 0; d <= std::min(n_ + m_, kMostEdits); ++d) {
            furthest_.emplace_back(static_cast<std::size_t>(2 * d + 1), -1);
            for (std::ptrdiff_t k = -d; k <= d; k += 2) {
                std::ptrdiff_t x = d == 0 ? 0 : entered(d, k);
                if (x > n_ || x - k > m_) { // outside: goes no further
                    reached(d, k) = x;
                    continue;
                }
                while (x < n_ && x - k < m_ && equal(x, x - k)) ++x;
                reached(d, k) = x;
                if (x == n_ && x - k == m_) return true;
            }
        }
        return false;
    }

    std::vector<LineChange> backtrack() {
        std::vector<LineChange> edits; // from the end, one line each
        std::ptrdiff_t x = n_, y = m_;
        for (auto d = static_cast<std::ptrdiff_t>(furthest_.size()) - 1; d > 0; --d) {
            const std::ptrdiff_t k = x - y, start = entered(d, k);
            const bool down = k == -d || (k != d && reached(d - 1, k - 1) < reached(d - 1, k + 1));
            const std::ptrdiff_t fromX = down ? start : start - 1, fromY = down ? start - k - 1 : start - k;
            edits.push_back({begin_ + fromX, begin_ + start, begin_ + fromY, begin_ + start - k});
            x = fromX;
            y = fromY;
        }
        std::ranges::reverse(edits);
        std::vector<LineChange> joined;
        for (const LineChange& e : edits) {
            if (!joined.empty() && joined.back().oldEnd == e.oldBegin && joined.back().newEnd == e.newBegin) {
                joined.back().oldEnd = e.oldEnd;
                joined.back().newEnd = e.newEnd;
            } else {
                joined.push_back(e);
            }
        }
        return joined;
    }

    std::span<const std::string_view> a_, b_;
    std::ptrdiff_t begin_ = 0, tail_ = 0; // lines that both have at their beginnings and ends
    std::ptrdiff_t n_ = 0, m_ = 0;        // lines between
    std::vector<std::vector<std::ptrdiff_t>> furthest_;
};

void addLines(std::string& out, char mark, const LineList& lines, std::ptrdiff_t from, std::ptrdiff_t to) {
    for (auto i = static_cast<std::size_t>(from); i < static_cast<std::size_t>(to); ++i) {
        out += mark;
        out += lines[i];
        if (!lines[i].ends_with('\n')) out += "\n\\ No newline at end of file\n";
    }
}

std::string hunkRange(std::ptrdiff_t begin, std::ptrdiff_t end) {
    if (end - begin == 1) return fmt::format("{}", begin + 1);
    return fmt::format("{},{}", end == begin ? begin : begin + 1, end - begin);
}

// As diff -u, with three lines around each change.
std::string unifiedDiff(const std::string& path, std::string_view before, std::string_view after) {
    constexpr std::ptrdiff_t around = 3;
    const LineList a = linesOf(before), b = linesOf(after);
    const std::vector<LineChange> changes = LineDifference(a, b).changes();
    const auto lastLine = static_cast<std::ptrdiff_t>(a.size());
    std::string out = fmt::format("--- {}\n+++ {}\n", path, path);
    for (std::size_t i = 0; i < changes.size();) {
        std::size_t last = i; // of the hunk: gaps of up to twice the context are in it
        while (last + 1 < changes.size() && changes[last + 1].oldBegin - changes[last].oldEnd <= 2 * around) ++last;
        const std::ptrdiff_t lead = std::min(changes[i].oldBegin, around);
        const std::ptrdiff_t rest = std::min(lastLine - changes[last].oldEnd, around);
        out += fmt::format("@@ -{} +{} @@\n", hunkRange(changes[i].oldBegin - lead, changes[last].oldEnd + rest),
                           hunkRange(changes[i].newBegin - lead, changes[last].newEnd + rest));
        std::ptrdiff_t same = changes[i].oldBegin - lead;
        for (; i <= last; ++i) {
            addLines(out, ' ', a, same, changes[i].oldBegin);
            addLines(out, '-', a, changes[i].oldBegin, changes[i].oldEnd);
            addLines(out, '+', b, changes[i].newBegin, changes[i].newEnd);
            same = changes[i].oldEnd;
        }
        addLines(out, ' ', a, same, same + rest);
    }
    return out;
}

// One file ---------------------------------------------------------------------------------------------------------

// What parse() finds beyond syntax, such as a parameter that is not there, is no business of the layout.
Diagnostics syntaxErrors(const Diagnostics& found) {
    Diagnostics errors;
    for (const Diagnostic& d : found.all())
        if (d.code.starts_with("E01")) errors.add(d);
    return errors;
}

bool hasEdition(const schema::Document& document) {
    for (const schema::Node node : document.roots())
        if (node.name() == "scene") return true;
    return false;
}

// The text as it should be; nothing after a diagnostic.
std::optional<std::string> laidOut(SourceMap& sources, FileId file, bool upgrade, Diagnostics& diagnostics) {
    const auto document = parse(sources, file, {}, diagnostics);
    diagnostics = syntaxErrors(diagnostics);
    if (diagnostics.hasErrors()) return std::nullopt;
    std::string text = schema::withCanonicalUnits(sources.text(file), *document);
    Diagnostics ignored;
    auto before =
        text == sources.text(file) ? document : parse(sources, sources.add("with its units", text), {}, ignored);
    if (upgrade && !hasEdition(*document)) {
        text = withEdition(text);
        before = parse(sources, sources.add("with its edition", text), {}, ignored);
    }
    std::string after = layOut(text);
    // A bug in the layout must not reach the file.
    const auto reread = parse(sources, sources.add("laid out", after), {}, ignored);
    ABBE_CHECK(!syntaxErrors(ignored).hasErrors() && sameMeaning(*before, *reread));
    return after;
}

// The text may have no errors of syntax; what it means is not looked at.
ExitCode printTree(const SourceMap& sources, FileId file, const Console& console) {
    Diagnostics diagnostics;
    const auto document = parse(sources, file, {}, diagnostics);
    const Diagnostics errors = syntaxErrors(diagnostics);
    if (!errors.hasErrors()) return console.data(schema::treeJson(*document)), ExitCode::done;
    console.report(errors, sources);
    return ExitCode::faulty;
}

ExitCode formatOne(const std::string& path, bool fromInput, const FmtOptions& options, const Console& console) {
    SourceMap sources;
    Diagnostics diagnostics;
    const std::string name = !fromInput ? path : options.standsFor.empty() ? "<stdin>" : options.standsFor;
    const auto file =
        fromInput ? readSceneText(sources, name, std::cin, diagnostics) : readSceneFile(sources, path, diagnostics);
    if (file && options.tree) return printTree(sources, *file, console);
    const auto after = file ? laidOut(sources, *file, options.upgrade, diagnostics) : std::nullopt;
    if (!after) {
        console.report(diagnostics, sources);
        return file ? ExitCode::faulty : ExitCode::system;
    }
    const bool changes = *after != sources.text(*file);
    if (options.diff && changes) console.data(unifiedDiff(name, sources.text(*file), *after));
    if (options.check) {
        if (changes && !options.diff) console.data(name + "\n");
        return changes ? ExitCode::threshold : ExitCode::done;
    }
    if (options.diff) return ExitCode::done;
    if (fromInput) { // byte by byte
        writeText(TextStream::out, *after);
    } else if (changes) {
        writeAtomically(path, *after);
        if (!options.quiet && console.format() == MessageFormat::human) console.line(fmt::format("{}: laid out", path));
    }
    return ExitCode::done;
}

ExitCode formatOrRefuse(const std::string& path, bool fromInput, const FmtOptions& options, const Console& console) {
    const auto refuse = [&](std::string_view what, std::string_view instead) {
        console.error(fmt::format("`{}` is {}, which has no layout; {}", path, what, instead));
        return ExitCode::usage;
    };
    if (!fromInput && exchange::importFormat(path))
        return refuse("a scene of another program", fmt::format("`abbe import {}` makes a scene file of it", path));
    if (!fromInput && isPack(path))
        return refuse("a pack", fmt::format("`abbe pack {} -o FOLDER/` makes a folder of it", path));
    try {
        return formatOne(path, fromInput, options, console);
    } catch (const IoError& fault) { // the other files are still laid out
        console.error(fault.what());
        return ExitCode::system;
    }
}

// The scene files in a folder and below it, by name; of anything else itself.
std::vector<std::string> scenesOf(const std::string& path, const Console& console) {
    std::error_code error;
    if (!std::filesystem::is_directory(path, error)) return {path};
    std::vector<std::string> files;
    auto entry = std::filesystem::recursive_directory_iterator(path, error);
    for (; !error && entry != std::filesystem::recursive_directory_iterator(); entry.increment(error))
        if (entry->path().extension() == ".scene" && entry->is_regular_file()) files.push_back(entry->path().string());
    if (error) throw IoError(fmt::format("cannot list `{}`: {}", path, error.message()));
    if (files.empty()) console.line(fmt::format("{}: no scene files", path));
    std::ranges::sort(files);
    return files;
}

} // namespace

ExitCode run(const FmtOptions& options, const CommonOptions& common) {
    if (options.standardInput) return formatOrRefuse(kFromInput, true, options, common.console);
    ExitCode result = ExitCode::done;
    for (const std::string& path : options.paths)
        if (std::error_code none; options.tree && std::filesystem::is_directory(path, none)) {
            common.console.error(fmt::format("`{}` is a folder, and `--tree` prints one scene", path));
            return ExitCode::usage;
        }
    for (const std::string& path : options.paths)
        for (const std::string& file : scenesOf(path, common.console))
            result = worse(result, formatOrRefuse(file, file == kFromInput, options, common.console));
    return result;
}

} // namespace abbe
