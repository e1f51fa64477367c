#include "reports/study_progress.h"

#include "app/json.h"
#include "reports/progress_text.h"

#include <fmt/format.h>

namespace abbe {

void StudyProgressLine::show(const StudyProgress& p) {
    const double interval = form_ == Form::json || console_.interactive() ? 0.25 : 30;
    if (form_ == Form::none || p.elapsed - lastShown_ < interval) return;
    const bool first = lastShown_ < 0;
    lastShown_ = p.elapsed;
    if (form_ == Form::json) {
        console_.data(Json::object({{"event", "progress"},
                                    {"done", p.fraction},
                                    {"step", p.what},
                                    {"renders", p.renders},
                                    {"total_renders", p.totalRenders},
                                    {"elapsed_s", p.elapsed},
                                    {"eta_s", p.left >= 0 ? Json(p.left) : Json()}})
                          .text() +
                      "\n");
        return;
    }
    if (first && !console_.interactive()) return; // nothing is known yet
    std::string text = fmt::format("{:3d} %   ", static_cast<int>(100 * p.fraction));
    if (p.totalRenders > 0) text += fmt::format("{}/{}   ", p.renders, p.totalRenders);
    text += fmt::format("{}   {} elapsed", p.what, clockText(p.elapsed));
    if (p.left >= 0) text += fmt::format("   {} left", clockText(p.left));
    if (!console_.interactive()) {
        console_.line(text);
        return;
    }
    if (static_cast<int>(text.size()) >= console_.width()) text.resize(static_cast<std::size_t>(console_.width()) - 1);
    if (console_.status(text)) shown_ = true;
}

void StudyProgressLine::clear() {
    if (!shown_) return;
    console_.clearStatus();
    shown_ = false;
}

} // namespace abbe
