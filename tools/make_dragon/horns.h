// What grows out of the skin: horns, claws and the spines of the back, each a small closed cage.
#pragma once

#include "cage.h"

#include <string>

namespace dragon {

struct Group {
    std::string name;
    Cage cage;
};
std::vector<Group> makeHorns();

} // namespace dragon
