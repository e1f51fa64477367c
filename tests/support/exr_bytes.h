// OpenEXR files byte by byte, for promises that no library would write.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace abbe_test {

template <typename Number> void put(std::string& to, Number v) {
    to.append(reinterpret_cast<const char*>(&v), sizeof v);
}

struct ExrBytes {
    std::array<std::int32_t, 4> window{0, 0, 3, 3}; // corners, the last ones within
    int compression = 0;                            // by OpenEXR's numbers
    std::vector<std::string> channels{"B", "G", "R"};
    int type = 1;                            // of all channels: uint, half, float
    std::array<std::uint32_t, 2> tile{0, 0}; // none
    std::string attributes;                  // more of them
    std::string rest;                        // behind the header

    static void attribute(std::string& to, const char* name, const char* kind, const std::string& value) {
        to += name;
        to += '\0';
        to += kind;
        to += '\0';
        put(to, static_cast<std::int32_t>(value.size()));
        to += value;
    }

    std::string bytes() const {
        std::string out, list, box, view, one, two;
        put(out, std::uint32_t{20000630});
        put(out, std::uint32_t{2u | (tile[0] ? 0x200u : 0u)});
        for (const std::string& name : channels) {
            list += name;
            list += '\0';
            for (const std::int32_t v : {type, 0, 1, 1}) put(list, v);
        }
        list += '\0';
        for (const std::int32_t v : window) put(box, v);
        put(one, 1.f);
        put(two, 0.f);
        put(two, 0.f);
        attribute(out, "channels", "chlist", list);
        attribute(out, "compression", "compression", std::string(1, static_cast<char>(compression)));
        attribute(out, "dataWindow", "box2i", box);
        attribute(out, "displayWindow", "box2i", box);
        attribute(out, "lineOrder", "lineOrder", std::string(1, '\0'));
        attribute(out, "pixelAspectRatio", "float", one);
        attribute(out, "screenWindowCenter", "v2f", two);
        attribute(out, "screenWindowWidth", "float", one);
        if (tile[0]) {
            std::string size;
            put(size, tile[0]);
            put(size, tile[1]);
            size += '\0';
            attribute(out, "tiles", "tiledesc", size);
        }
        return out + attributes + '\0' + rest;
    }
};

} // namespace abbe_test
