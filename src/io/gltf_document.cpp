#include "io/gltf_document.h"

#include "base/enclosure.h"
#include "base/memory_limit.h"
#include "io/file.h"
#include "io/gltf.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr int kDeepest = 256;
constexpr std::uint32_t kJsonChunk = 0x4e4f534a; // "JSON", little-endian

std::uint32_t word(std::string_view bytes, std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

std::optional<GltfFault> findDeepNesting(std::string_view json, std::size_t firstByte) {
    int depth = 0;
    bool text = false;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (text) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                text = false;
        } else if (c == '"') {
            text = true;
        } else if (c == '{' || c == '[') {
            if (++depth > kDeepest)
                return GltfFault{firstByte + i, fmt::format("JSON nested more than {} levels deep", kDeepest)};
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
    return std::nullopt;
}

} // namespace

bool isBinaryGltf(std::string_view bytes) { return bytes.starts_with("glTF"); }

std::optional<GltfFault> findContainerFault(std::string_view bytes) {
    if (!isBinaryGltf(bytes)) return findDeepNesting(bytes, 0);
    if (bytes.size() < 20)
        return GltfFault{bytes.size(), fmt::format("the file ends after {} of at least 20 bytes", bytes.size())};
    if (const std::uint32_t version = word(bytes, 4); version != 2)
        return GltfFault{4, fmt::format("version {} of the container; only 2 is known", version)};
    if (const std::uint32_t length = word(bytes, 8); length > bytes.size())
        return GltfFault{bytes.size(), fmt::format("the file ends after {} of {} bytes", bytes.size(), length)};
    const std::size_t length = word(bytes, 8);
    if (length < 20) return GltfFault{8, fmt::format("a length of {} bytes", length)};
    std::size_t at = 12;
    for (int chunk = 0; at < length; ++chunk) {
        if (length - at < 8) return GltfFault{at, "a chunk without room for its header"};
        const std::size_t size = word(bytes, at), left = length - at - 8;
        if (size > left) return GltfFault{at, fmt::format("a chunk of {} bytes where only {} are left", size, left)};
        if (chunk == 0 && word(bytes, at + 4) != kJsonChunk) return GltfFault{at + 4, "the first chunk is not JSON"};
        if (size % 4 != 0) return GltfFault{at, fmt::format("a chunk of {} bytes, no multiple of 4", size)};
        if (chunk == 0)
            if (auto fault = findDeepNesting(bytes.substr(at + 8, size), at + 8)) return fault;
        at += 8 + size;
    }
    return std::nullopt;
}

namespace {

// Required extensions that leave shapes and cameras as they are.
bool harmless(std::string_view extension) {
    return extension == "KHR_mesh_quantization" || extension.starts_with("KHR_materials_") ||
           extension.starts_with("KHR_texture_") || extension.starts_with("EXT_texture_") ||
           extension == "KHR_lights_punctual" || extension == "KHR_animation_pointer" ||
           extension.starts_with("KHR_xmp");
}

bool keepNoImage(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
    return true;
}

// Buffers lie beside the file; images are not read at all. The user pointer is the folder.
bool beside(const std::string& path, void* folder) {
    const auto extension = std::filesystem::path(path).extension();
    for (const char* image : {".png", ".jpg", ".jpeg", ".ktx2", ".webp", ".dds"})
        if (extension == image) return false;
    const auto& from = *static_cast<const std::string*>(folder);
    return path.starts_with(from) && mayName(from, path) && std::filesystem::is_regular_file(path);
}

std::string asItIs(const std::string& path, void*) { return path; }

bool readWhole(std::vector<unsigned char>* out, std::string* error, const std::string& path, void*) {
    try {
        const std::string bytes = readFileBytes(path);
        out->assign(bytes.begin(), bytes.end());
        return true;
    } catch (const IoError& e) {
        if (error) *error += e.what();
        return false;
    }
}

bool writeNothing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }

// The library's messages end in line breaks and may be several. What it read last is left out: the file may be of any
// kind, and not for everybody to read.
std::string oneLine(std::string text) {
    if (const std::size_t quote = text.find("; last read: '"); quote != std::string::npos)
        text.erase(quote, text.rfind('\'') + 1 - quote);
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ' || text.back() == '.')) text.pop_back();
    std::replace(text.begin(), text.end(), '\n', ';');
    return text.empty() ? "not a glTF file" : text;
}

} // namespace

void GltfDocument::fail(const std::string& what) const {
    throw IoError(fmt::format("cannot read `{}`: {}", name_, what));
}

GltfDocument::GltfDocument(std::string_view bytes, const std::string& name) : name_(name), bytes_(bytes.size()) {
    if (const auto fault = findContainerFault(bytes)) fail(fmt::format("byte {}: {}", fault->byte, fault->what));
    if (bytes.size() > 0xffffffffu) fail("glTF files have at most 4 GiB; keep the buffers in files of their own");
    load(bytes);
    checkExtensions();
    for (const tinygltf::Buffer& buffer : model_.buffers) bytes_ += buffer.data.size();
}

void GltfDocument::load(std::string_view bytes) {
    const std::filesystem::path parent = std::filesystem::path(name_).parent_path();
    std::string folder = parent.empty() ? std::string(".") : parent.string();
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(keepNoImage, nullptr);
    loader.SetFsCallbacks({beside, asItIs, readWhole, writeNothing, &folder});
    std::string error, warning;
    bool good = false;
    try {
        const auto size = static_cast<unsigned int>(bytes.size());
        good = isBinaryGltf(bytes)
                   ? loader.LoadBinaryFromMemory(&model_, &error, &warning,
                                                 reinterpret_cast<const unsigned char*>(bytes.data()), size, folder)
                   : loader.LoadASCIIFromString(&model_, &error, &warning, bytes.data(), size, folder);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) { // of the JSON library, and of vectors of the wrong size
        fail(oneLine(e.what()));
    }
    if (!good) fail(oneLine(error));
    if (!model_.asset.version.starts_with("2.") && model_.asset.version != "2")
        fail(fmt::format("asset.version is `{}`; only 2.x is known", model_.asset.version.substr(0, 20)));
}

void GltfDocument::checkExtensions() const {
    for (std::size_t i = 0; i < model_.extensionsRequired.size(); ++i)
        if (!harmless(model_.extensionsRequired[i]))
            fail(fmt::format("extensionsRequired[{}]: `{}` is not supported; export the file without it", i,
                             model_.extensionsRequired[i].substr(0, 60)));
}

Transform GltfDocument::localTransform(int index) const {
    const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
    const auto check = [&](const std::vector<double>& v, std::size_t size, const char* what) {
        if (v.empty()) return false;
        if (v.size() != size || !std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); }))
            fail(fmt::format("nodes[{}].{} is not {} finite numbers", index, what, size));
        return true;
    };
    if (check(node.matrix, 16, "matrix")) { // by columns
        Transform m;
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 3; ++c) m.a[r][c] = node.matrix[4 * c + r];
        m.t = {node.matrix[12], node.matrix[13], node.matrix[14]};
        return m;
    }
    Transform result;
    if (check(node.scale, 3, "scale")) result = Transform::scale({node.scale[0], node.scale[1], node.scale[2]});
    if (check(node.rotation, 4, "rotation")) {
        const auto& q = node.rotation; // x y z w
        const Vec3d axis(q[0], q[1], q[2]);
        const double sine = length(axis);
        if (!(std::hypot(sine, q[3]) > 1e-6)) fail(fmt::format("nodes[{}].rotation has no length", index));
        if (sine > 0) result = result.then(Transform::rotate(axis, 2 * std::atan2(sine, q[3])));
    }
    if (check(node.translation, 3, "translation"))
        result = result.then(Transform::translate({node.translation[0], node.translation[1], node.translation[2]}));
    return result;
}

// The map of what is above a node that may be within a tree; each is found once, however many are asked for.
Transform GltfDocument::above(int node, const std::vector<int>& parent,
                              std::vector<std::optional<Transform>>& known) const {
    std::vector<int> path;
    int at = node;
    for (; !known[static_cast<std::size_t>(at)]; at = path.back()) {
        const int up = parent[static_cast<std::size_t>(at)];
        if (up < 0) {
            known[static_cast<std::size_t>(at)] = Transform();
            break;
        }
        if (path.size() > parent.size()) fail(fmt::format("nodes[{}] is an ancestor of itself", at));
        path.push_back(up);
    }
    // From the top down to the node's parent; then the node itself.
    for (std::size_t i = path.size(); i-- > 0;) {
        const int child = i > 0 ? path[i - 1] : node;
        if (known[static_cast<std::size_t>(child)]) continue;
        known[static_cast<std::size_t>(child)] =
            localTransform(path[i]).then(*known[static_cast<std::size_t>(path[i])]);
    }
    return *known[static_cast<std::size_t>(node)];
}

std::vector<PlacedGltfNode> GltfDocument::nodes(const std::string& root) const {
    const auto count = static_cast<int>(model_.nodes.size());
    // Every node has one parent at most: then every walk downwards ends.
    std::vector<int> parent(model_.nodes.size(), -1);
    for (int i = 0; i < count; ++i) {
        const auto& children = model_.nodes[static_cast<std::size_t>(i)].children;
        for (std::size_t k = 0; k < children.size(); ++k) {
            const int child = children[k];
            if (child < 0 || child >= count)
                fail(fmt::format("nodes[{}].children[{}] is {}, but there are {} nodes", i, k, child, count));
            int& of = parent[static_cast<std::size_t>(child)];
            if (of >= 0) fail(fmt::format("nodes[{}] is a child of nodes[{}] and of nodes[{}]", child, of, i));
            of = i;
        }
    }
    std::vector<int> roots;
    const int scene = model_.defaultScene >= 0 ? model_.defaultScene : 0;
    if (!root.empty()) {
        const auto found = std::ranges::find(model_.nodes, root, &tinygltf::Node::name);
        if (found == model_.nodes.end()) fail(fmt::format("no node is named `{}`", root));
        roots.push_back(static_cast<int>(found - model_.nodes.begin()));
    } else if (model_.scenes.empty()) {
        for (int i = 0; i < count; ++i)
            if (parent[static_cast<std::size_t>(i)] < 0) roots.push_back(i);
    } else if (static_cast<std::size_t>(scene) < model_.scenes.size()) {
        roots = model_.scenes[static_cast<std::size_t>(scene)].nodes;
    } else {
        fail(fmt::format("scene is {}, but there are {} scenes", scene, model_.scenes.size()));
    }
    std::vector<PlacedGltfNode> placed;
    std::vector<bool> seen(model_.nodes.size(), false);
    std::vector<std::optional<Transform>> known(model_.nodes.size()); // by above()
    std::vector<PlacedGltfNode> open;
    for (auto r = roots.rbegin(); r != roots.rend(); ++r) {
        if (*r < 0 || *r >= count) fail(fmt::format("scenes[{}] names node {} of {}", scene, *r, count));
        open.push_back({*r, above(*r, parent, known)});
    }
    while (!open.empty()) {
        const PlacedGltfNode next = open.back();
        open.pop_back();
        if (seen[static_cast<std::size_t>(next.node)])
            fail(fmt::format("nodes[{}] is met twice in one scene", next.node));
        seen[static_cast<std::size_t>(next.node)] = true;
        placed.push_back({next.node, localTransform(next.node).then(next.map)});
        if (!placed.back().map.isFinite()) fail(fmt::format("nodes[{}]: the transforms overflow", next.node));
        const auto& children = model_.nodes[static_cast<std::size_t>(next.node)].children;
        for (auto c = children.rbegin(); c != children.rend(); ++c) open.push_back({*c, placed.back().map});
    }
    return placed;
}

namespace {

constexpr std::size_t kGlbHead = 20; // of the container and its first chunk

// The JSON of a glTF file, without the buffers that a binary one has behind it.
std::string gltfJsonOf(RegularFile& file) {
    std::string head(kGlbHead, '\0');
    head.resize(file.readAt(0, head));
    std::uint64_t begin = 0, size = file.size();
    if (isBinaryGltf(head)) {
        if (head.size() < kGlbHead) return {};
        begin = kGlbHead;
        size = 0;
        for (std::size_t i = 4; i-- > 0;) size = size << 8 | static_cast<unsigned char>(head[12 + i]);
        size = std::min(size, file.size() - begin);
    }
    requireMemory(static_cast<double>(size));
    std::string text(static_cast<std::size_t>(size), '\0');
    text.resize(file.readAt(begin, text));
    return text;
}

// A file's name out of a URI exactly as the library that reads glTF takes it: `+` is a space, too.
std::string decodedUri(const std::string& uri) {
    const auto digit = [](char c) {
        if (c >= '0' && c <= '9') return c - '0';
        if (c >= 'a' && c <= 'f') return c - 'a' + 10;
        return c >= 'A' && c <= 'F' ? c - 'A' + 10 : 0;
    };
    std::string path;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const bool code = uri[i] == '%' && uri.size() > i + 2;
        path += code ? static_cast<char>(digit(uri[i + 1]) << 4 | digit(uri[i + 2])) : uri[i] == '+' ? ' ' : uri[i];
        if (code) i += 2;
    }
    return path;
}

} // namespace

std::vector<std::string> gltfBufferFiles(const std::string& path) {
    std::vector<std::string> files;
    RegularFile file(path);
    if (!file.good()) return files;
    const std::string text = gltfJsonOf(file);
    if (findContainerFault(text)) return files; // nested too deeply
    const nlohmann::json tree = nlohmann::json::parse(text, nullptr, false);
    if (!tree.is_object()) return files;
    const auto buffers = tree.find("buffers");
    if (buffers == tree.end() || !buffers->is_array()) return files;
    for (const auto& buffer : *buffers) {
        const auto uri = buffer.is_object() ? buffer.find("uri") : buffer.end();
        if (uri == buffer.end() || !uri->is_string()) continue;
        if (const auto name = uri->get<std::string>(); !name.starts_with("data:")) files.push_back(decodedUri(name));
    }
    return files;
}

} // namespace abbe
