// What was found out before a render about light that camera paths find seldom or never, for people to read.
#pragma once

#include <any>
#include <list>

namespace abbe {

// One record for each technique, of a type of the technique's own (LightPathFindings, …). All of it depends on the
// scene, the frame, the pixel filter, the seed and the size of the pilots alone.
class CausticFindings {
  public:
    int pilot = 0; // the size of the pilots: RenderSettings::pilot; 0: none

    // As it is by default where that technique has told nothing.
    template <typename Record> const Record& of() const {
        for (const std::any& record : records_)
            if (const auto* found = std::any_cast<Record>(&record)) return *found;
        static const Record kNothing;
        return kNothing;
    }
    template <typename Record> Record& of() {
        for (std::any& record : records_)
            if (auto* found = std::any_cast<Record>(&record)) return *found;
        return std::any_cast<Record&>(records_.emplace_back(Record()));
    }

  private:
    std::list<std::any> records_; // which stay where they are, for who holds a reference
};

} // namespace abbe
