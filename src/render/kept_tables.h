// Tables that take a while to make, for who builds scenes again and again.
#pragma once

#include "math/digest.h"

#include <memory>

namespace abbe {

// Has those that the last buildings made. What is kept is immutable and shared.
class KeptTables {
  public:
    virtual ~KeptTables() = default;

    // What `make` returns, or what it once returned for the same key, which stands for all that it depends on.
    template <typename T, typename Make>
    static std::shared_ptr<const T> get(KeptTables* kept, const Digest& key, Make make) {
        if (!kept) return make();
        if (auto known = kept->find(key)) return std::static_pointer_cast<const T>(known);
        std::shared_ptr<const T> made = make();
        kept->keep(key, made);
        return made;
    }

  private:
    virtual std::shared_ptr<const void> find(const Digest&) = 0;
    virtual void keep(const Digest&, std::shared_ptr<const void>) = 0;
};

} // namespace abbe
