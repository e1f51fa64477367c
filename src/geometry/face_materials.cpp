#include "geometry/face_materials.h"

#include "base/check.h"
#include "render/material.h"

#include <algorithm>
#include <utility>

namespace abbe {

FaceMaterials::FaceMaterials(std::unique_ptr<const Shape> shape, std::vector<const Material*> materials,
                             std::vector<std::uint16_t> choice)
    : shape_(std::move(shape)), materials_(std::move(materials)), choice_(std::move(choice)) {
    for (const std::uint16_t c : choice_) ABBE_CHECK(c < materials_.size());
}

void FaceMaterials::surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    shape_->surface(raw, ray, hit);
    ABBE_DCHECK(hit.primitive < choice_.size());
    if (const Material* own = materials_[choice_[hit.primitive]]) hit.material = own;
}

bool FaceMaterials::usesTextures() const {
    return std::ranges::any_of(materials_, [](const Material* m) { return m && m->usesTextures(); });
}

} // namespace abbe
