#include "base/enclosure.h"
#include "io/file.h"
#include "io/gltf_document.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

// Required extensions that leave shapes and cameras as they are.
bool harmless(std::string_view extension) {
    return extension == "KHR_mesh_quantization" || extension == "KHR_draco_mesh_compression" ||
           extension == "EXT_meshopt_compression" || extension == "KHR_meshopt_compression" ||
           extension == "EXT_mesh_gpu_instancing" || extension.starts_with("KHR_materials_") ||
           extension.starts_with("KHR_texture_") || extension.starts_with("EXT_texture_") ||
           extension == "KHR_lights_punctual" || extension == "KHR_animation_pointer" ||
           extension.starts_with("KHR_xmp");
}

// Of images only those in data URIs are kept, as they are: the library keeps the others' places.
bool keepImage(tinygltf::Image* image, const int, std::string*, std::string*, int, int, const unsigned char* bytes,
               int size, void*) {
    if (image->bufferView < 0 && image->uri.empty() && size > 0) image->image.assign(bytes, bytes + size);
    return true;
}

// Buffers lie beside the file; images there are not read. The user pointer is the folder.
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

GltfDocument::GltfDocument(std::string_view bytes, std::string name) : name_(std::move(name)), bytes_(bytes.size()) {
    if (const auto fault = findContainerFault(bytes)) fail(fmt::format("byte {}: {}", fault->byte, fault->what));
    const std::optional<std::string> mended = mendedGltf(bytes);
    load(mended ? *mended : bytes);
    checkExtensions();
    for (const tinygltf::Buffer& buffer : model_.buffers) bytes_ += buffer.data.size();
    unpackViews();
}

void GltfDocument::load(std::string_view bytes) {
    if (bytes.size() > 0xffffffffu) fail("glTF files have at most 4 GiB; keep the buffers in files of their own");
    const std::filesystem::path parent = std::filesystem::path(name_).parent_path();
    std::string folder = parent.empty() ? std::string(".") : parent.string();
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(keepImage, nullptr);
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

void GltfDocument::bound(double elements, const std::string& who) const {
    constexpr double kMostPerByte = 1024;
    if (elements > kMostPerByte * static_cast<double>(bytes_))
        fail(fmt::format("{}: {:.4g} elements, more than {} for each of its {} bytes", who, elements, kMostPerByte,
                         bytes_));
}

void GltfDocument::unpackViews() {
    unpacked_.resize(model_.bufferViews.size());
    double all = 0;
    for (std::size_t i = 0; i < model_.bufferViews.size(); ++i) {
        const char* const extension = meshoptName(model_.bufferViews[i]);
        if (!extension) continue;
        const std::string path = fmt::format("bufferViews[{}].extensions.{}", i, extension);
        unpacked_[i] = unpackMeshopt(*this, model_.bufferViews[i].extensions.at(extension), path);
        bound(all += static_cast<double>(unpacked_[i].size()), path); // views may share what they unpack
    }
}

const tinygltf::Mesh* GltfDocument::meshOf(int node) const {
    const int mesh = model_.nodes[static_cast<std::size_t>(node)].mesh;
    if (mesh < 0) return nullptr;
    if (static_cast<std::size_t>(mesh) >= model_.meshes.size())
        fail(fmt::format("nodes[{}].mesh is {}, but there are {}", node, mesh, model_.meshes.size()));
    return &model_.meshes[static_cast<std::size_t>(mesh)];
}

} // namespace abbe
