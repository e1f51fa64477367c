#include "packs/manifest.h"

#include "base/text.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace abbe {

namespace {

using Tree = nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr std::size_t kLongestName = 1024, kLongestPart = 255; // bytes
constexpr std::size_t kDeepest = 8;                            // levels of JSON; a manifest has three

// Deeply nested text is no manifest, and is told apart before a tree of it is made.
bool isTooDeep(std::string_view text) {
    std::size_t depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted && c == '\\')
            ++i;
        else if (c == '"')
            quoted = !quoted;
        else if (!quoted && (c == '{' || c == '[') && ++depth > kDeepest)
            return true;
        else if (!quoted && (c == '}' || c == ']') && depth > 0)
            --depth;
    }
    return false;
}

bool isUtf8(std::string_view text) {
    const char* const end = text.data() + text.size();
    for (const char* p = text.data(); p < end;) {
        const CodePoint c = decodeUtf8(p, end);
        if (c.length == 0) return false;
        p += c.length;
    }
    return true;
}

// A member of an object; of the wrong kind it is missing.
std::string textOf(const Tree& object, const char* name) {
    const auto found = object.find(name);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

class ManifestReader {
  public:
    explicit ManifestReader(const std::string& pack) : pack_(pack) {}

    PackManifest read(const std::string& text) const {
        if (isTooDeep(text)) fail("its JSON is nested too deeply");
        const Tree tree = Tree::parse(text, nullptr, false);
        if (!tree.is_object()) fail("it is no JSON object");
        if (textOf(tree, "format") != "abbe pack") fail("its `format` is not `abbe pack`");
        const auto version = tree.find("version");
        if (version == tree.end() || !version->is_number_integer()) fail("it has no `version`");
        if (*version != kVersion)
            fail(fmt::format("it has version {} of the format; this program reads version {}", version->dump(),
                             kVersion));
        PackManifest manifest{textOf(tree, "program"), textOf(tree, "scene"), {}};
        const auto files = tree.find("files");
        if (files == tree.end() || !files->is_array()) fail("it has no list of `files`");
        if (files->size() > kMostPackedFiles) fail(fmt::format("it lists more than {} files", kMostPackedFiles));
        for (const Tree& file : *files) manifest.files.push_back(readFile(file));
        check(manifest);
        return manifest;
    }

  private:
    [[noreturn]] void fail(const std::string& why) const {
        throw PackFault(fmt::format("`{}`: {}: {}", pack_, kManifestName, why));
    }

    PackedFile readFile(const Tree& tree) const {
        if (!tree.is_object()) fail("an element of `files` is no object");
        PackedFile file{textOf(tree, "name"), 0, textOf(tree, "sha256")};
        if (const std::string why = nameFault(file.name); !why.empty()) fail(quotedName(file.name) + ": " + why);
        const auto bytes = tree.find("bytes");
        if (bytes == tree.end() || !bytes->is_number_unsigned())
            fail(quotedName(file.name) + ": it has no number of bytes");
        file.bytes = bytes->get<std::uint64_t>();
        const auto isDigit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
        if (file.sha256.size() != 64 || !std::ranges::all_of(file.sha256, isDigit))
            fail(quotedName(file.name) + ": its `sha256` is not 64 hexadecimal digits");
        return file;
    }

    void check(const PackManifest& manifest) const {
        std::vector<std::string_view> names{kManifestName};
        std::uint64_t sum = 0;
        for (const PackedFile& file : manifest.files) {
            names.push_back(file.name);
            if (file.bytes > std::numeric_limits<std::int64_t>::max() - sum) fail("its files have too many bytes");
            sum += file.bytes;
        }
        std::ranges::sort(names);
        const auto twice = std::ranges::adjacent_find(names);
        if (twice != names.end()) fail(quotedName(*twice) + ": it is there twice");
        for (const std::string_view name : names)
            for (auto slash = name.find('/'); slash != std::string_view::npos; slash = name.find('/', slash + 1))
                if (std::ranges::binary_search(names, name.substr(0, slash)))
                    fail(quotedName(name.substr(0, slash)) + ": it is a file and a folder");
        if (std::ranges::find(manifest.files, manifest.scene, &PackedFile::name) == manifest.files.end())
            fail("its scene is none of its files");
    }

    const std::string& pack_;
};

} // namespace

std::string quotedName(std::string_view name) { return fmt::format("`{}`", name); }

std::string nameFault(std::string_view name) {
    if (name.empty()) return "a file without a name";
    if (name.size() > kLongestName) return "its name is too long";
    if (name.front() == '/') return "its name is absolute";
    const auto odd = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '\\' || c == ':'; };
    if (std::ranges::any_of(name, odd)) return "its name has a character that is not allowed";
    if (!isUtf8(name)) return "its name is not UTF-8";
    for (std::size_t begin = 0; begin <= name.size();) {
        const std::size_t end = std::min(name.find('/', begin), name.size());
        const std::string_view part = name.substr(begin, end - begin);
        if (part == "..") return "its name leads out of the pack";
        if (part.empty() || part == ".") return "its name has an empty part";
        if (part.size() > kLongestPart) return "its name is too long";
        begin = end + 1;
    }
    return {};
}

std::string manifestText(const PackManifest& manifest) {
    Tree files = Tree::array();
    for (const PackedFile& file : manifest.files)
        files.push_back({{"name", file.name}, {"bytes", file.bytes}, {"sha256", file.sha256}});
    const Tree tree = {{"format", "abbe pack"},
                       {"version", kVersion},
                       {"program", manifest.program},
                       {"scene", manifest.scene},
                       {"files", std::move(files)}};
    return tree.dump(1) + "\n";
}

PackManifest readManifest(const std::string& text, const std::string& pack) { return ManifestReader(pack).read(text); }

} // namespace abbe
