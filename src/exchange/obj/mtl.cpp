#include "exchange/obj/mtl.h"

#include "base/enclosure.h"
#include "base/file.h"
#include "io/number_scan.h"
#include "schema/scene_tree.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <vector>

namespace abbe::exchange {

namespace {

constexpr std::uint64_t kMostMtlBytes = 64u << 20;

enum class MtlForm : std::uint8_t {
    color,     // one or three numbers
    number,    // one
    map,       // a picture with options
    leftOut,   // has no counterpart here
    passedOver // says nothing about the picture
};

struct MtlStatement {
    std::string_view keyword; // in lower case
    MtlForm form;
    std::string_view why = {}; // it is left out
};

// Of the format [Wavefront, "MTL material format"] and of its extension for physically based materials. Ambient light
// is computed, so nothing is said by its colours.
constexpr auto kMtlStatements = std::to_array<MtlStatement>({
    {"kd", MtlForm::color},
    {"ks", MtlForm::color},
    {"ke", MtlForm::color},
    {"tf", MtlForm::color},
    {"ns", MtlForm::number},
    {"ni", MtlForm::number},
    {"d", MtlForm::number},
    {"tr", MtlForm::number},
    {"illum", MtlForm::number},
    {"pr", MtlForm::number},
    {"pm", MtlForm::number},
    {"ps", MtlForm::number},
    {"pc", MtlForm::number},
    {"pcr", MtlForm::number},
    {"aniso", MtlForm::number},
    {"anisor", MtlForm::number},
    {"map_kd", MtlForm::map},
    {"map_ks", MtlForm::map},
    {"map_ns", MtlForm::map},
    {"map_d", MtlForm::map},
    {"map_ke", MtlForm::map},
    {"map_bump", MtlForm::map},
    {"bump", MtlForm::map},
    {"norm", MtlForm::map},
    {"map_pr", MtlForm::map},
    {"map_pm", MtlForm::map},
    {"map_ps", MtlForm::map},
    {"ka", MtlForm::passedOver},
    {"map_ka", MtlForm::passedOver},
    {"sharpness", MtlForm::passedOver}, // of reflection maps
    {"map_aat", MtlForm::passedOver},
    {"disp", MtlForm::leftOut, "only subdivision surfaces are displaced, `displacement` of `shape subdivision`"},
    {"map_disp", MtlForm::leftOut, "only subdivision surfaces are displaced, `displacement` of `shape subdivision`"},
    {"decal", MtlForm::leftOut, "no texture lies over another one"},
    {"refl", MtlForm::leftOut, "surfaces reflect the scene; `light environment` puts a picture around it"},
    {"map_refl", MtlForm::leftOut, "surfaces reflect the scene; `light environment` puts a picture around it"},
    {"map_tr", MtlForm::leftOut, "a picture of opacity is `map_d`"},
    {"map_tf", MtlForm::leftOut, "what glass lets through has one colour"},
    {"map_ni", MtlForm::leftOut, "an index takes no picture"},
    {"map_pc", MtlForm::leftOut, "the coat has one thickness"},
    {"map_pcr", MtlForm::leftOut, "the coat has one roughness"},
    {"map_rma", MtlForm::leftOut, "pictures of one quantity each are read: `map_Pr`, `map_Pm`"},
    {"map_orm", MtlForm::leftOut, "pictures of one quantity each are read: `map_Pr`, `map_Pm`"},
});

std::string mtlKeyword(std::string_view text) {
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

std::optional<double> mtlNumber(std::string_view word) {
    const char* p = word.data();
    const auto value = scanNumber<double>(p, word.data() + word.size());
    if (!value || p != word.data() + word.size() || !std::isfinite(*value)) return std::nullopt;
    return value;
}

class MtlReader {
  public:
    MtlReader(FileId file, std::string_view text, std::filesystem::path folder, MtlLibrary& library, Import& import)
        : file_(file), text_(text), folder_(std::move(folder)), library_(library), import_(import) {}

    void read();

  private:
    using Word = std::string_view; // of text_
    Span spanOf(Word word) const {
        const auto begin = static_cast<std::uint32_t>(word.data() - text_.data());
        return {file_, begin, begin + static_cast<std::uint32_t>(word.size())};
    }
    void fault(Word at, std::string what) { import_.diagnostics.error("E0801", spanOf(at), std::move(what)); }

    void line(Word);
    void begin(Word line, Word name);
    void statement(const MtlStatement&, std::span<const Word>, Word line);
    void value(const MtlStatement&, std::span<const Word>);
    void picture(const MtlStatement&, std::span<const Word>, Word line);
    std::size_t option(const MtlStatement&, MtlMap&, std::span<const Word>);
    void find(MtlMap&) const;

    FileId file_;
    std::string_view text_;
    std::filesystem::path folder_;
    MtlLibrary& library_;
    Import& import_;
    MtlMaterial* current_ = nullptr;
};

std::string_view mtlTrimmed(std::string_view text) {
    const auto blank = [](char c) { return static_cast<unsigned char>(c) <= ' '; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return text;
}

std::vector<std::string_view> mtlWords(std::string_view line) {
    std::vector<std::string_view> words;
    for (std::size_t at = 0; at < line.size();) {
        std::size_t end = at;
        while (end < line.size() && static_cast<unsigned char>(line[end]) > ' ') ++end;
        if (end > at) words.push_back(line.substr(at, end - at));
        at = end + 1;
    }
    return words;
}

void MtlReader::read() {
    std::string_view rest = text_.starts_with("\xef\xbb\xbf") ? text_.substr(3) : text_;
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find_first_of("\r\n"), rest.size());
        line(mtlTrimmed(rest.substr(0, end)));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
}

void MtlReader::line(Word text) {
    if (text.empty() || text[0] == '#') return;
    const auto words = mtlWords(text);
    const std::string keyword = mtlKeyword(words[0]);
    if (keyword == "newmtl") return begin(text, mtlTrimmed(text.substr(words[0].size())));
    const auto known = std::ranges::find(kMtlStatements, keyword, &MtlStatement::keyword);
    if (known == kMtlStatements.end()) {
        std::vector<std::string_view> keywords;
        for (const MtlStatement& s : kMtlStatements) keywords.push_back(s.keyword);
        import_.diagnostics
            .warning("W0803", spanOf(words[0]),
                     fmt::format("`{}` is no statement of material libraries", words[0].substr(0, 40)))
            .help = schema::didYouMean(schema::nearest(keyword, keywords));
        return;
    }
    if (!current_) return fault(words[0], fmt::format("`{}` before the first `newmtl`", words[0]));
    statement(*known, std::span(words).subspan(1), text);
}

void MtlReader::begin(Word line, Word name) {
    if (name.empty()) return fault(line, "`newmtl` needs a name");
    const auto [at, isNew] =
        library_.insert_or_assign(std::string(name), MtlMaterial{std::string(name), spanOf(name), {}, {}});
    current_ = &at->second;
    if (!isNew)
        import_.approximated(nullptr, spanOf(name), fmt::format("material `{}`", name),
                             "it is defined more than once; the last definition counts");
}

void MtlReader::statement(const MtlStatement& s, std::span<const Word> words, Word line) {
    if (s.form == MtlForm::passedOver) return;
    if (s.form == MtlForm::leftOut)
        return import_.leftOut(nullptr, spanOf(line), fmt::format("`{}`", s.keyword), s.why);
    if (words.empty()) return fault(line, fmt::format("`{}` needs a value", line));
    if (s.form == MtlForm::map)
        picture(s, words, line);
    else
        value(s, words);
}

void MtlReader::value(const MtlStatement& s, std::span<const Word> words) {
    const Word first = words[0];
    if (s.keyword == "d" && first == "-halo" && words.size() > 1) {
        import_.approximated(nullptr, spanOf(first), "`-halo`", "as opaque in the middle as at the rim");
        words = words.subspan(1);
    } else if (s.form == MtlForm::color && (first == "spectral" || first == "xyz")) {
        return import_.leftOut(nullptr, spanOf(first), fmt::format("`{}` of `{}`", first, s.keyword),
                               "colours are red, green and blue; `table` takes spectra");
    }
    std::vector<double> numbers;
    for (const Word word : words) {
        const auto number = mtlNumber(word);
        if (!number) return fault(word, fmt::format("`{}` is no number", word.substr(0, 40)));
        numbers.push_back(*number);
    }
    const bool three = s.form == MtlForm::color && numbers.size() == 3;
    if (numbers.size() != 1 && !three)
        return fault(words[0],
                     fmt::format("`{}` takes {}, not {} numbers", s.keyword,
                                 s.form == MtlForm::color ? "one or three numbers" : "one number", numbers.size()));
    const double r = numbers[0];
    current_->values.insert_or_assign(std::string(s.keyword),
                                      MtlValue{three ? Vec3d(r, numbers[1], numbers[2]) : Vec3d(r, r, r),
                                               join(spanOf(words.front()), spanOf(words.back()))});
}

// Reads an option and its arguments; how many words these are. Numbers that are left out are those of the rest of the
// vector: `-s 2` is 2 1 1.
std::size_t MtlReader::option(const MtlStatement& s, MtlMap& map, std::span<const Word> words) {
    const std::string name = mtlKeyword(words[0]);
    const auto numbers = [&](std::size_t most) {
        std::vector<double> found;
        // The last word is the file, whatever it looks like.
        for (std::size_t i = 1; i <= most && i + 1 < words.size() && mtlNumber(words[i]); ++i)
            found.push_back(*mtlNumber(words[i]));
        return found;
    };
    const auto vector = [&](double(&to)[2]) {
        const auto found = numbers(3);
        for (std::size_t i = 0; i < std::min<std::size_t>(2, found.size()); ++i) to[i] = found[i];
        return 1 + found.size();
    };
    const Word argument = words.size() > 2 ? words[1] : Word();
    if (name == "-s") return vector(map.scale);
    if (name == "-o") return vector(map.offset);
    if (name == "-bm") {
        const auto found = numbers(1);
        if (!found.empty()) map.bump = found[0];
        return 1 + found.size();
    }
    if (name == "-clamp") {
        map.clamp = argument == "on";
        return argument.empty() ? 1 : 2;
    }
    if (name == "-imfchan") {
        map.channel = argument.empty() ? '\0' : argument[0];
        return argument.empty() ? 1 : 2;
    }
    const bool harmless = name == "-blendu" || name == "-blendv" || name == "-cc" || name == "-texres";
    if (name == "-mm" || name == "-t") {
        import_.leftOut(nullptr, spanOf(words[0]), fmt::format("`{}` of `{}`", name, s.keyword),
                        name == "-t" ? "textures have no turbulence" : "values of pictures are used as they are");
        return 1 + numbers(name == "-t" ? 3 : 2).size();
    }
    if (name == "-boost") {
        import_.leftOut(nullptr, spanOf(words[0]), "`-boost`", "pictures are filtered and not sharpened");
        return 1 + numbers(1).size();
    }
    if (name == "-type") {
        import_.leftOut(nullptr, spanOf(words[0]), "`-type`", "a picture lies on the surface");
        return argument.empty() ? 1 : 2;
    }
    if (!harmless)
        import_.diagnostics
            .warning("W0803", spanOf(words[0]),
                     fmt::format("`{}` is no option of `{}`", words[0].substr(0, 40), s.keyword))
            .help = schema::didYouMean(schema::nearest(name, {"-s", "-o", "-bm", "-clamp", "-imfchan", "-blendu"}));
    return harmless && !argument.empty() ? 2 : 1;
}

// Beside the library; of a path of another machine the name alone counts.
void MtlReader::find(MtlMap& map) const {
    std::error_code error;
    const std::filesystem::path home = folder_.empty() ? std::filesystem::path(".") : folder_;
    const bool drive = map.file.size() > 2 && map.file[1] == ':';
    const std::filesystem::path name(map.file);
    for (const auto& path : {name.is_absolute() ? name : folder_ / name,
                             drive || name.is_absolute() ? folder_ / name.filename() : std::filesystem::path()})
        if (!path.empty() && mayName(home, path) && std::filesystem::is_regular_file(path, error)) {
            map.path = path;
            return;
        }
}

void MtlReader::picture(const MtlStatement& s, std::span<const Word> words, Word line) {
    MtlMap map;
    while (words.size() > 1 && words[0].size() > 1 && words[0][0] == '-') words = words.subspan(option(s, map, words));
    const Word name = line.substr(static_cast<std::size_t>(words[0].data() - line.data())); // may hold blanks
    map.file = std::string(name);
    std::ranges::replace(map.file, '\\', '/');
    map.span = spanOf(name);
    find(map);
    if (map.path.empty()) {
        import_.diagnostics
            .warning("W0801", map.span, fmt::format("the picture `{}` is left out: there is no such file", name))
            .help = suggestFile(folder_ / std::filesystem::path(map.file));
        return;
    }
    current_->maps.insert_or_assign(std::string(s.keyword == "bump" ? "map_bump" : s.keyword), std::move(map));
}

} // namespace

double MtlMaterial::number(std::string_view keyword, double otherwise) const {
    const auto found = values.find(keyword);
    return found == values.end() ? otherwise : found->second.number();
}

const MtlMap* MtlMaterial::map(std::string_view keyword) const {
    const auto found = maps.find(keyword);
    return found == maps.end() ? nullptr : &found->second;
}

void readMtl(const std::filesystem::path& path, Span from, MtlLibrary& library, Import& import) {
    RegularFile bytes(path.string());
    if (!bytes.good() || bytes.size() > kMostMtlBytes) {
        import.diagnostics.error(
            "E0402", from,
            fmt::format("cannot read `{}`: {}", path.string(),
                        bytes.good() ? "it is too large for a library of materials" : bytes.why()));
        return;
    }
    import.files.noteRead(path);
    const FileId file = import.sources.add(path.string(), bytes.readAll());
    MtlReader(file, import.sources.text(file), path.parent_path(), library, import).read();
}

} // namespace abbe::exchange
