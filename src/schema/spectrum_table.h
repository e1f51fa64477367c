// `table` spectra, and the check of single values that all numeric forms share.
#pragma once

#include "schema/measure.h"
#include "schema/spectrum_reader.h"

namespace abbe::schema {

// Checks an SI value against the role and range of its use. `what` names the component: "red", "at 500 nm it"; may be
// empty. False after a diagnostic.
bool checkSpectrumValue(const SpectrumUse&, double value, const Scale&, const Value& at, std::string_view what,
                        const Header&, Diagnostics&);

// Reads `table …`, inline, as rows or from a file, into `result.numbers`. False after a diagnostic.
bool readTable(const SpectrumUse&, const Entry&, const SceneTree&, Diagnostics&, SpectrumValue& result);

} // namespace abbe::schema
