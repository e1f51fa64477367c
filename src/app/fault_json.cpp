#include "app/fault_json.h"

namespace abbe {

Json nameOrNull(const std::string& name) { return name.empty() ? Json() : Json(name); }

Json lanesJson(const Spectrum& s) {
    Json list = Json::list();
    for (int i = 0; i < kLanes; ++i) list.push(static_cast<double>(s[i]));
    return list;
}

Json faultJson(const FoundFault& f) {
    Json wavelengths = Json::list();
    for (const float nm : f.wavelengths) wavelengths.push(static_cast<double>(nm));
    return Json::object({{"x", f.sample.x},
                         {"y", f.sample.y},
                         {"replicate", f.sample.replicate},
                         {"sample", f.sample.index},
                         {"dropped_as", causeName(f.sample.cause)},
                         {"cause", causeName(f.cause)},
                         {"vertex", f.vertex},
                         {"object", nameOrNull(f.object)},
                         {"material", nameOrNull(f.material)},
                         {"light", nameOrNull(f.light)},
                         {"what", f.what},
                         {"wavelengths_nm", std::move(wavelengths)}});
}

} // namespace abbe
