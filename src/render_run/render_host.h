// A render inside of another program: who hears of it, and gets the picture.
#pragma once

#include "pictures/image_output.h"
#include "reports/render_report.h"

#include <memory>

namespace abbe {

// Signals stay the host's, which ends a render by InterruptGuard::requestStopOfAll(). Called from the thread that
// renders, and the report from workers, too.
class RenderHost {
  public:
    virtual ~RenderHost() = default;
    // In place of one on the console. Once.
    virtual std::unique_ptr<RenderReport> report() = 0;
    // The image as it is in the end, also where it is written to files (RenderOptions::inMemory); not of parts.
    virtual void take(HeldImage) = 0;
};

} // namespace abbe
