// Sums of samples, and whole renders.
#pragma once

namespace abbe::doctor {

// Relative error of a film's mean after 1e8 samples (docs/hard_cases.md, case 52).
double filmMeanError();
// Of twenty orders of the same terms, those whose exact sum has other bits than the first (case 60).
double orderDependentSums();
// Pixels of a small render that differ between one thread and all of them (case 60).
double threadDependentPixels();

} // namespace abbe::doctor
