#include "exchange/mitsuba_export/mitsuba_writer.h"
#include "exchange/shared/scene_node.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr int kPhaseSteps = 181; // of a table of a phase function

// Rows of an angle and a value become even steps of the cosine, from straight back on.
void writeTablePhase(pugi::xml_node node, const schema::TableRows& table) {
    std::vector<std::pair<double, double>> rows; // cosine, value; falling
    for (const auto& row : table.rows)
        if (row.cells.size() == 2 && row.cells[0].number && row.cells[1].number)
            rows.emplace_back(std::cos(*row.cells[0].number * kDegree), *row.cells[1].number);
    std::ranges::sort(rows);
    // As many as the scene has, where those are even steps already.
    bool even = rows.size() > 1;
    for (std::size_t i = 0; i < rows.size() && even; ++i)
        even =
            std::abs(rows[i].first - (-1 + 2.0 * static_cast<double>(i) / static_cast<double>(rows.size() - 1))) < 1e-9;
    std::string text;
    const std::size_t steps = even ? rows.size() : kPhaseSteps;
    for (std::size_t i = 0; i < steps && !rows.empty(); ++i) {
        const double x = -1 + 2.0 * static_cast<double>(i) / static_cast<double>(steps - 1);
        auto after = std::ranges::lower_bound(rows, x, {}, &std::pair<double, double>::first);
        double value = rows.back().second;
        if (even)
            value = rows[i].second;
        else if (after == rows.begin())
            value = rows.front().second;
        else if (after != rows.end()) {
            const auto before = std::prev(after);
            value = before->second +
                    (after->second - before->second) * (x - before->first) / (after->first - before->first);
        }
        text += (text.empty() ? "" : ", ") + numberText(even ? value : rounded(value));
    }
    xmlValue(node, "string", "values", text);
}

void writePhaseOf(pugi::xml_node parent, const StatedThing* phase, MitsubaWriter& w) {
    if (!phase || phase->type == "isotropic") {
        if (phase) xmlChild(parent, "phase", "isotropic");
        return;
    }
    if (phase->type == "henyey-greenstein")
        xmlNumber(xmlChild(parent, "phase", "hg"), "g", phase->number("g", 0));
    else if (phase->type == "rayleigh")
        xmlChild(parent, "phase", "rayleigh");
    else if (const auto* table = phase->type == "table" ? phase->value<schema::TableRows>("values") : nullptr)
        writeTablePhase(xmlChild(parent, "phase", "tabphase"), *table);
    else if (const auto* parts = phase->type == "mix" ? phase->find("part") : nullptr; parts && parts->size() == 2) {
        const auto &first = std::get<schema::WeightedReference>((*parts)[0]),
                   &second = std::get<schema::WeightedReference>((*parts)[1]);
        pugi::xml_node node = xmlChild(parent, "phase", "blendphase");
        xmlNumber(node, "weight", rounded(second.weight / (first.weight + second.weight)));
        writePhaseOf(node, w.out.scene.thing(first.reference), w);
        writePhaseOf(node, w.out.scene.thing(second.reference), w);
    } else {
        w.out.approximated(phase->span, fmt::format("phase function `{}`", phase->type), "light is scattered evenly");
        xmlChild(parent, "phase", "isotropic");
        return;
    }
    w.out.leaveOutUnused(*phase);
}

// σt and albedo at a wavelength of what states σs and σa.
StatedCurve const* curveOf(const StatedThing& m, const char* property) { return m.spectrum(property).curve; }

void writeSum(pugi::xml_node node, const StatedCurve* scattering, const StatedCurve* absorption) {
    PlainSpectrum extinction, albedo;
    const bool flat = (!scattering || scattering->isConstant()) && (!absorption || absorption->isConstant());
    extinction.form = albedo.form = flat ? PlainSpectrum::Form::flat : PlainSpectrum::Form::table;
    for (double nm = 360; nm <= 830; nm += 5) {
        const double s = scattering ? scattering->at(nm) : 0, a = absorption ? absorption->at(nm) : 0;
        extinction.value = rounded(s + a);
        albedo.value = s > 0 ? rounded(s / (s + a)) : 0;
        extinction.rows.emplace_back(nm, extinction.value);
        albedo.rows.emplace_back(nm, albedo.value);
    }
    xmlSpectrum(node, "sigma_t", extinction);
    xmlSpectrum(node, "albedo", albedo);
}

void writeHomogeneous(pugi::xml_node node, const StatedThing& m, MitsubaWriter& w) {
    if (const StatedCurve* s = curveOf(m, "scattering"), *a = curveOf(m, "absorption"); s || a) {
        writeSum(node, s, a);
    } else {
        const StatedCurve *extinction = curveOf(m, "extinction"), *albedo = curveOf(m, "albedo");
        if (extinction)
            xmlSpectrum(node, "sigma_t", plainSpectrum(*extinction));
        else
            xmlValue(node, "spectrum", "sigma_t", "1");
        if (albedo)
            xmlSpectrum(node, "albedo", plainSpectrum(*albedo));
        else
            xmlValue(node, "spectrum", "albedo", "1");
    }
    if (const StatedCurve* emission = curveOf(m, "emission"))
        xmlSpectrum(node, "emission", plainSpectrum(*emission, w.exposure));
    writePhaseOf(node, m.reference("phase"), w);
}

} // namespace

void writeMitsubaMedium(pugi::xml_node shape, const StatedThing& medium, MitsubaWriter& w) {
    if (medium.type != "homogeneous") {
        w.out.leftOut(medium.span, fmt::format("medium `{}`", medium.type), "Mitsuba has no noise in media");
        return;
    }
    w.hasMedia = true;
    if (medium.name.empty()) {
        writeHomogeneous(xmlChild(shape, "medium", "homogeneous", "interior"), medium, w);
        w.out.leaveOutUnused(medium);
        return;
    }
    std::string& id = w.media[&medium];
    if (id.empty()) {
        id = w.takeId(medium.name, {});
        pugi::xml_node node = xmlChild(w.root, "medium", "homogeneous", {}, id);
        writeHomogeneous(node, medium, w);
        w.out.leaveOutUnused(medium);
        w.remark(node);
    }
    pugi::xml_node ref = shape.append_child("ref");
    ref.append_attribute("name") = "interior";
    ref.append_attribute("id") = id.c_str();
}

void writeMitsubaAbsorption(pugi::xml_node shape, const StatedThing* material, MitsubaWriter& w) {
    if (!material || material->type != "dielectric") return;
    const StatedCurve *absorption = curveOf(*material, "absorption"), *color = curveOf(*material, "attenuation-color");
    if (!absorption && !color) return;
    w.hasMedia = true;
    pugi::xml_node node = xmlChild(shape, "medium", "homogeneous", "interior");
    if (absorption) {
        xmlSpectrum(node, "sigma_t", plainSpectrum(*absorption));
    } else {
        PlainSpectrum sigma;
        sigma.form = PlainSpectrum::Form::table;
        const double distance = material->number("attenuation-distance", 1);
        for (double nm = 360; nm <= 830; nm += 5)
            sigma.rows.emplace_back(nm, rounded(-std::log(std::max(1e-6, color->at(nm))) / distance));
        xmlSpectrum(node, "sigma_t", sigma);
    }
    xmlValue(node, "spectrum", "albedo", "0");
}

} // namespace abbe::exchange
