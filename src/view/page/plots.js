// Two drawings in SVG: a spectrum with its error band, and the noise against samples or time on logarithmic axes. Colours are
// classes of the style sheet, so that they follow the scheme.
import {draw} from "./dom.js";
import {isNumber, percent, significant, duration, count} from "./format.js";

const box = (width, height) => ({width, height, l: 46, r: width - 10, t: 22, b: height - 32});
const n = v => v.toFixed(1);
const placesOf = step => Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
const path = points => points.map(([x, y], i) => `${i ? "L" : "M"}${n(x)},${n(y)}`).join("");
const text = (cls, x, y, words, anchor = "middle") => draw("text", {class: cls, x: n(x), y: n(y), "text-anchor": anchor}, words);
const frame = (b, label) => draw("svg", {class: "plot", viewBox: `0 0 ${b.width} ${b.height}`, width: b.width, height: b.height, role: "img", "aria-label": label});

// At most `most` round steps from low to high.
function steps(low, high, most) {
    const rough = (high - low) / most, unit = 10 ** Math.floor(Math.log10(rough)), step = [1, 2, 5, 10].map(k => k * unit).find(s => s >= rough * 0.999) ?? rough, found = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high * (1 + 1e-12) + 1e-12; ++k) found.push(k * step);
    return found;
}
// 1, 10, 100 … and, where there are few of them, 2 and 5 between, or 1, 2, 3 … 9.
function logSteps(low, high, most) {
    const decades = Math.log10(high / low), sets = decades < 0.8 ? [[1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9]] : decades < 2.2 ? [[1, 2, 5]] : [[1]], found = [];
    for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e)
        for (const k of sets[0]) { const v = k * 10 ** e; if (v >= low * 0.999 && v <= high * 1.001) found.push(v); }
    const every = Math.ceil(found.length / most);
    return found.filter((_, i) => i % every === 0);
}

// Approximate colours of wavelengths, to find one's way along the axis.
const rainbow = [[380, "#4b0082"], [430, "#3a2cff"], [470, "#0074ff"], [500, "#00b38a"], [540, "#35c400"], [575, "#d8d000"], [600, "#ff9a00"], [640, "#ff2a00"], [720, "#8a0000"], [780, "#4a0000"]];
function ramp(b, lo, hi) {
    const within = rainbow.map(([nm, color]) => [(nm - lo) / (hi - lo), color]).filter(([t]) => t >= 0 && t <= 1);
    const shade = draw("linearGradient", {id: "rainbow"}, within.map(([t, color]) => draw("stop", {offset: t.toFixed(4), "stop-color": color})));
    return [draw("defs", {}, shade), draw("rect", {x: b.l, y: b.b, width: b.r - b.l, height: 4, fill: within.length > 1 ? "url(#rainbow)" : "none"})];
}

// spectrum: [[nm, value, standard error], …] by wavelength. Returns the drawing, and `at(x)`: the point nearest to a place in it.
export function spectrumPlot(spectrum, unit, width, height = 170) {
    const points = spectrum.filter(([nm, value]) => isNumber(nm) && isNumber(value));
    if (points.length < 2) return null;
    const b = box(width, height), lo = points[0][0], hi = points[points.length - 1][0], error = p => isNumber(p[2]) ? p[2] : 0;
    const high = Math.max(...points.map(p => p[1] + error(p))), low = Math.min(0, ...points.map(p => p[1] - error(p))), span = high - low || 1, top = high === low ? low + 1 : high + 0.06 * span;
    const X = nm => b.l + (b.r - b.l) * (nm - lo) / (hi - lo || 1), Y = v => b.b - (b.b - b.t) * (v - low) / (top - low);
    const svg = frame(b, `Spectrum from ${Math.round(lo)} to ${Math.round(hi)} nm, at most ${significant(high)} ${unit}`);
    const marks = steps(low, top, 4), size = Math.max(Math.abs(low), Math.abs(top)), places = marks.length > 1 ? placesOf(marks[1] - marks[0]) : 0, tick = v => Math.abs(v) < 1e-9 * size ? "0" : size < 1e-3 || size >= 1e5 ? significant(+v.toPrecision(3), 2) : v.toFixed(places).replace("-", "−");
    for (const v of marks) svg.append(draw("path", {class: "grid", d: `M${b.l},${n(Y(v))}H${b.r}`}), text("tick", b.l - 6, Y(v) + 4, tick(v), "end"));
    for (const nm of steps(lo, hi, Math.max(2, Math.floor((b.r - b.l) / 56)))) svg.append(draw("path", {class: "grid", d: `M${n(X(nm))},${b.t}V${b.b}`}), text("tick", Math.min(b.r - 8, X(nm)), b.b + 17, String(Math.round(nm))));
    svg.append(...ramp(b, lo, hi));
    const clampY = v => Math.max(b.t, Math.min(b.b, Y(v)));
    svg.append(draw("path", {class: "band", d: `${path([...points.map(p => [X(p[0]), clampY(p[1] + error(p))]), ...[...points].reverse().map(p => [X(p[0]), clampY(p[1] - error(p))])])}Z`}),
               draw("path", {class: "curve", d: path(points.map(p => [X(p[0]), Y(p[1])]))}),
               text("title", 2, 12, unit || "", "start"), text("title", b.r, b.height - 5, "wavelength in nm", "end"));
    const at = x => points.reduce((best, p) => Math.abs(X(p[0]) - x) < Math.abs(X(best[0]) - x) ? p : best);
    return {svg, at, x: p => X(p[0]), y: p => Y(p[1]), box: b};
}

// curve: [[seconds, samples, noise], …] as they came; goal: samples. Noise falls with the root of the samples, so that the way
// to the goal is a line.
export function noisePlot(curve, goal, axis, width, height = 150) {
    const points = curve.map(([seconds, samples, noise]) => [axis === "time" ? seconds : samples, noise, samples]).filter(p => p[0] > 0 && p[1] > 0);
    if (points.length < 2) return null;
    const last = points[points.length - 1], end = goal > last[2] ? [last[0] * goal / last[2], last[1] * Math.sqrt(last[2] / goal)] : null, all = end ? [...points, end] : points;
    const b = box(width, height), lo = Math.min(...all.map(p => p[0])), hi = Math.max(lo * 1.5, ...all.map(p => p[0])), low = Math.min(...all.map(p => p[1])) / 1.15, high = Math.max(...all.map(p => p[1])) * 1.15;
    const X = v => b.l + (b.r - b.l) * Math.log(v / lo) / Math.log(hi / lo), Y = v => b.b - (b.b - b.t) * Math.log(v / low) / Math.log(high / low);
    const svg = frame(b, `Noise against ${axis === "time" ? "time" : "samples"}: ${percent(last[1])} now${end ? `, ${percent(end[1])} expected at the end` : ""}`);
    const short = v => axis === "time" ? duration(v).replace(/\u00a0/g, " ") : count(v);
    for (const v of logSteps(low, high, 5)) svg.append(draw("path", {class: "grid", d: `M${b.l},${n(Y(v))}H${b.r}`}), text("tick", b.l - 6, Y(v) + 4, percent(v, 1 + (v * 100 % 1 > 0)).replace(/\.0(?=\u00a0)/, ""), "end"));
    const xs = logSteps(lo, hi, Math.max(2, Math.floor((b.r - b.l) / 58)));
    for (const v of xs) svg.append(draw("path", {class: "grid", d: `M${n(X(v))},${b.t}V${b.b}`}), text("tick", Math.max(b.l + 6, Math.min(b.r - 14, X(v))), b.b + 14, short(v)));
    svg.append(draw("path", {class: "axis", d: `M${b.l},${b.t}V${b.b}H${b.r}`}));
    if (end) svg.append(draw("path", {class: "ahead", d: path([last, end].map(p => [X(p[0]), Y(p[1])]))}), draw("circle", {class: "goal", cx: n(X(end[0])), cy: n(Y(end[1])), r: 3}));
    svg.append(draw("path", {class: "curve", d: path(points.map(p => [X(p[0]), Y(p[1])]))}), draw("circle", {class: "now", cx: n(X(last[0])), cy: n(Y(last[1])), r: 3}),
               text("title", 2, 12, "noise", "start"), text("title", b.r, b.height - 5, axis === "time" ? "time" : "samples a pixel", "end"));
    return {svg};
}
