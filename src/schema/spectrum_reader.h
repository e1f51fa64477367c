// The spectrum values of the language: `0.18`, `rgb 0.8 0.2 0.1`, `blackbody 3200 K`, `table 400 0.1 …`, a name, …
#pragma once

#include "schema/entry.h"

#include <limits>
#include <span>

namespace abbe::schema {

// What a spectrum is for.
struct SpectrumUse {
    std::string_view name;            // of the property, for messages
    std::optional<SpectrumRole> role; // nothing: the definition of a named spectrum, checked without a use
    std::span<const Dimension> dimensions;
    double lower = -std::numeric_limits<double>::infinity(); // of every plain, rgb and table value; SI
    double upper = std::numeric_limits<double>::infinity();
};

SpectrumUse useOf(const FieldInfo&);

// Reads and checks a value; nothing after a diagnostic.
std::optional<SpectrumValue> readSpectrum(const SpectrumUse&, const Entry&, const SceneTree&, Diagnostics&);

// Checks the definitions of all named spectra.
void checkSpectra(const SceneTree&, Diagnostics&);

// One form of a spectrum value, for reading, messages and the manual.
struct SpectrumForm {
    std::string_view name;
    SpectrumValue::Form form;
    std::string_view example;
    std::string_view doc;
};

// `rgb`, `srgb`, `table`, …: every form that begins with a word.
std::span<const SpectrumForm> spectrumForms();
const SpectrumForm* findSpectrumForm(std::string_view name);

// True if values of this form make sense in the role.
bool fits(SpectrumValue::Form, SpectrumRole);

} // namespace abbe::schema
