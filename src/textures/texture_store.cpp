#include "textures/texture_store.h"

namespace abbe {

TextureStore::TextureStore(TextureStoreSettings settings) : settings_(std::move(settings)) {}

TextureStore::~TextureStore() {
    if (system_) module_->closeSystem(system_);
}

const UpsamplingTable& TextureStore::upsampling(const RgbSpace& space) {
    auto& table = tables_[space.name];
    if (!table) table = std::make_unique<const UpsamplingTable>(UpsamplingTable::loadOrBuild(space, settings_.tables));
    return *table;
}

void* TextureStore::open(const std::string& path) {
    AbbeImageFault fault{};
    if (!system_) {
        module_ = &imageModule();
        system_ = module_->openSystem(settings_.bytes, &fault);
        if (!system_) throw ImageFileError(fault.reason);
    }
    void* const texture = module_->openTexture(system_, path.c_str(), &fault);
    if (!texture) throw ImageFileError(fault.reason);
    return texture;
}

std::string TextureStore::lookupFault() const {
    AbbeImageFault fault{};
    module_->lookupFault(system_, &fault);
    return fault.reason;
}

AbbeTextureStatistics TextureStore::statistics() const {
    AbbeTextureStatistics result{};
    if (system_) module_->statistics(system_, &result);
    return result;
}

} // namespace abbe
