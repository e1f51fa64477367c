// The spectrum values of the language: `0.18`, `rgb 0.8 0.2 0.1`, `blackbody 3200 K`, `table 400 0.1 …`, a name, …
#pragma once

#include "schema/entry.h"
#include "schema/measure.h"

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

// `table` spectra, and the check of single values that all numeric forms share.

// Checks an SI value against the role and range of its use. `what` names the component: "red", "at 500 nm it"; may be
// empty. False after a diagnostic.
bool checkSpectrumValue(const SpectrumUse&, double value, const Scale&, const Value& at, std::string_view what,
                        const Header&, Diagnostics&);

// Reads `table …`, inline, as rows or from a file, into `result.numbers`. False after a diagnostic.
bool readTable(const SpectrumUse&, const Entry&, const SceneTree&, Diagnostics&, SpectrumValue& result);

// Colours as pictures and colour pickers write them: "#c0b0a0", and numbers from 0 to 255.

// The decoding curve of sRGB.
double decodeSrgb(double encoded);

// Encoded components 0 … 1 of "#rrggbb" or "#rgb".
std::optional<std::array<double, 3>> parseHex(std::string_view);

// Completes the diagnostic at a text that is a colour in hexadecimal digits with the spectrum that it is.
void suggestHex(const Value&, Diagnostic&);

// What the three numbers from value `first` on are, divided by 255 or 100; empty where they cannot be such.
std::string dividedColor(const Entry&, std::size_t first);

} // namespace abbe::schema
