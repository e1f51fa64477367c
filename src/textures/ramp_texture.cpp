#include "textures/ramp_texture.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe {

RampTexture::RampTexture(std::vector<schema::SpectrumStop> stops, Over over, const schema::TexturedNumber& input)
    : over_(over), input_(input.texture), number_(static_cast<float>(input.value)) {
    for (const schema::SpectrumStop& s : stops) stops_.push_back({s.position, TexturePart(s.value, 0)});
}

bool RampTexture::needsUv() const {
    const bool own = over_ == Over::u || over_ == Over::v || (input_ && input_->needsUv());
    return own || std::ranges::any_of(stops_, [](const Stop& s) { return s.part.needsUv(); });
}

const RgbSpace* RampTexture::rgbSpace() const {
    for (const Stop& s : stops_)
        if (s.part.rgbSpace()) return s.part.rgbSpace();
    return nullptr;
}

bool RampTexture::prepare(TextureUse use, Span user, Diagnostics& diagnostics) {
    for (const Stop& s : stops_) s.part.prepare(use, user, diagnostics);
    return true;
}

// The mean of the hat functions of the stops over an interval: of each straight piece, the value in its middle.
template <typename Add> void RampTexture::weigh(double from, double to, Add add) const {
    const double scale = 1 / (to - from);
    const double before = std::min(to, stops_.front().position) - from,
                 after = to - std::max(from, stops_.back().position);
    if (before > 0) add(stops_.front().part, static_cast<float>(before * scale));
    for (std::size_t i = 0; i + 1 < stops_.size(); ++i) {
        const double a = stops_[i].position, b = stops_[i + 1].position;
        const double lower = std::max(a, from), upper = std::min(b, to);
        if (!(upper > lower)) continue;
        const double share = (upper - lower) * scale, second = share * ((0.5 * (lower + upper) - a) / (b - a));
        if (share > second) add(stops_[i].part, static_cast<float>(share - second));
        if (second > 0) add(stops_[i + 1].part, static_cast<float>(second));
    }
    if (after > 0) add(stops_.back().part, static_cast<float>(after * scale));
}

template <typename Add> void RampTexture::mean(const TextureQuery& q, Add add) const {
    double t = 0, half = 0;
    switch (over_) {
    case Over::u:
        t = static_cast<double>(q.uv.x);
        half = boxHalfWidth(q.du.x, q.dv.x);
        break;
    case Over::v:
        t = static_cast<double>(q.uv.y);
        half = boxHalfWidth(q.du.y, q.dv.y);
        break;
    case Over::input:
        t = static_cast<double>(input_ ? input_->number(q) : number_);
        break;
    case Over::x:
        t = static_cast<double>(q.position.x);
        half = boxHalfWidth(q, q.normal.x);
        break;
    case Over::y:
        t = static_cast<double>(q.position.y);
        half = boxHalfWidth(q, q.normal.y);
        break;
    case Over::z:
        t = static_cast<double>(q.position.z);
        half = boxHalfWidth(q, q.normal.z);
        break;
    }
    // A point is a very short interval.
    half = std::max(half, 1e-9 * std::max(1e-6, std::abs(t)));
    if (!std::isfinite(t) || !(half < 1e15)) return add(stops_.front().part, 1.f);
    weigh(t - half, t + half, add);
}

Vec3 RampTexture::value(const TextureQuery& query) const noexcept {
    Vec3 sum;
    mean(query, [&](const TexturePart& part, float weight) { sum += part.value(query) * weight; });
    return sum;
}

Spectrum RampTexture::spectrum(const TextureQuery& query, const Wavelengths& lambda) const noexcept {
    Spectrum sum(0.f);
    mean(query, [&](const TexturePart& part, float weight) { sum = sum + part.spectrum(query, lambda) * weight; });
    return sum;
}

Spectrum RampTexture::lightFactor(const TextureQuery& query, const Wavelengths& lambda) const noexcept {
    Spectrum sum(0.f);
    mean(query, [&](const TexturePart& part, float weight) { sum += part.lightFactor(query, lambda) * weight; });
    return sum;
}

TextureJet RampTexture::jet(const TexturePoint& point, int channels) const noexcept {
    TextureJet t; // of the coordinate, in its first channel
    switch (over_) {
    case Over::u:
        t.value.x = point.uv.x;
        t.byUv[0].x = 1;
        break;
    case Over::v:
        t.value.x = point.uv.y;
        t.byUv[1].x = 1;
        break;
    case Over::input:
        if (input_)
            t = input_->jet(point, 1);
        else
            t.value.x = number_;
        break;
    default: {
        const auto axis = static_cast<std::size_t>(over_) - static_cast<std::size_t>(Over::x);
        t.value.x = static_cast<float>(axis == 0 ? point.position.x : axis == 1 ? point.position.y : point.position.z);
        t.byPosition[axis].x = 1;
    }
    }
    const double x = static_cast<double>(t.value.x);
    std::size_t i = 0;
    while (i + 1 < stops_.size() && !(x < stops_[i + 1].position)) ++i;
    if (i + 1 == stops_.size() || x < stops_[0].position) return stops_[i].part.jet(point, channels);
    const double width = stops_[i + 1].position - stops_[i].position;
    const auto share = static_cast<float>((x - stops_[i].position) / width), slope = static_cast<float>(1 / width);
    const TextureJet a = stops_[i].part.jet(point, channels), b = stops_[i + 1].part.jet(point, channels);
    const Vec3 rise = (b.value - a.value) * slope;
    TextureJet j;
    j.value = a.value * (1 - share) + b.value * share;
    for (std::size_t k = 0; k < 3; ++k)
        j.byPosition[k] = a.byPosition[k] * (1 - share) + b.byPosition[k] * share + rise * t.byPosition[k].x;
    for (std::size_t k = 0; k < 2; ++k) j.byUv[k] = a.byUv[k] * (1 - share) + b.byUv[k] * share + rise * t.byUv[k].x;
    return j;
}

std::unique_ptr<Texture> makeRampTexture(const RampTextureParams& p, Diagnostics& diagnostics) {
    for (std::size_t i = 0; i + 1 < p.stops.size(); ++i)
        if (p.stops[i + 1].position < p.stops[i].position) {
            auto& d = diagnostics.error("E0735", p.stops[i + 1].value.span, "the stops of a ramp must be in order",
                                        "lies before the one above");
            d.related.push_back({p.stops[i].value.span, "after this one"});
            return nullptr;
        }
    using Over = RampTexture::Over;
    const std::string_view word = p.over.word;
    const Over over = p.input.texture || p.input.span.valid() ? Over::input
                      : word == "u"                           ? Over::u
                      : word == "v"                           ? Over::v
                      : word == "x"                           ? Over::x
                      : word == "y"                           ? Over::y
                                                              : Over::z;
    return std::make_unique<RampTexture>(p.stops, over, p.input);
}

schema::TypeInfo rampTextureType() {
    using namespace schema;
    using P = RampTextureParams;
    return {Kind::texture,
            "ramp",
            "A gradient: values at stops, in between linear.",
            "texture dusk ramp { over v; stop 0 rgb 0.9 0.5 0.2; stop 1 rgb 0.1 0.2 0.6 }",
            false,
            {
                field<P, std::vector<SpectrumStop>>(FieldType::stop, "stop", &P::stops)
                    .role(SpectrumRole::albedo)
                    .range(0, 1)
                    .required()
                    .synonyms({"key", "color", "point", "at"})
                    .doc("A position and the spectrum or texture there; repeated, in the order of positions.")
                    .example("stop 0.5 rgb 0.9 0.5 0.2"),
                field<P, Choice>(FieldType::choice, "over", &P::over)
                    .choices({"u", "v", "x", "y", "z"})
                    .byDefault("u")
                    .group("coordinate")
                    .synonyms({"along", "axis", "direction"})
                    .doc("Texture coordinate, or coordinate in the space of the shape in metres, that it follows.")
                    .example("over v"),
                field<P, TexturedNumber>(FieldType::number, "input", &P::input)
                    .group("coordinate")
                    .synonyms({"factor", "fac", "t"})
                    .doc("Texture whose values it follows instead.")
                    .example("input noise { scale 5 cm }"),
            }};
}

} // namespace abbe
