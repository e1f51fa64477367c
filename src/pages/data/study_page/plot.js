// Numbers, axes and the plot of error against time or samples, as SVG text. Nothing here needs a browser: the gallery
// (tools/make_gallery.mjs) runs the same text in Node for its static pictures.

// Colours that colour-blind readers tell apart (after Okabe and Ito, lightness moved for each background); the curves
// differ by marker and dash as well.
const themes = {
    light: {paper: "#fcfbf8", card: "#f3f1eb", ink: "#1c1d20", soft: "#5d5f66", line: "#d9d6cd", grid: "#e6e3da", accent: "#9a3b12",
            c0: "#0067a8", c1: "#c04800", c2: "#00805c", c3: "#a8437f", c4: "#8f6a00", c5: "#3b8fc0", c6: "#6b4fb3"},
    dark: {paper: "#15171b", card: "#1e2126", ink: "#ecebe6", soft: "#a3a6ae", line: "#383c44", grid: "#292d33", accent: "#ff9d66",
           c0: "#5cb3f0", c1: "#ff8f4a", c2: "#2fcc9f", c3: "#ee8fc6", c4: "#e8bb3c", c5: "#a4d4f5", c6: "#b9a3ff"},
};
const themeRules = name => Object.entries(themes[name]).map(([key, value]) => `--${key}:${value}`).join(";");

const plotRules = `
.plot text{font:12px system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue",sans-serif;fill:var(--soft)}
.plot .title{fill:var(--ink);font-weight:600}
.plot .note{font-style:italic}
.plot .axis{stroke:var(--soft);stroke-width:1;fill:none}
.plot .grid{stroke:var(--grid);stroke-width:1}
.plot .guide{stroke:var(--line);stroke-width:1;stroke-dasharray:2 4}
.plot .ink{--c:var(--ink)}
${Array.from({length: 7}, (_, i) => `.plot .c${i}{--c:var(--c${i})}`).join("\n")}
.plot .path{fill:none;stroke:var(--c);stroke-width:1.75;stroke-linejoin:round}
.plot .ink .path{stroke-width:2.5}
.plot .band{fill:var(--c);opacity:.13}
.plot .mark{fill:var(--c);stroke:var(--paper);stroke-width:1}
.plot .open{fill:var(--paper);stroke:var(--c);stroke-width:1.5}
.plot .whisker{stroke:var(--c);stroke-width:1.25;fill:none}
.plot .fit{stroke:var(--c);stroke-width:1;fill:none;opacity:.75}
.plot .floor{stroke:var(--c);stroke-width:1.25;stroke-dasharray:1 3;stroke-linecap:round}
.plot .run{fill:var(--c);opacity:0}
.plot .label{fill:var(--c)}
.plot .leader{stroke:var(--c);stroke-width:.75;opacity:.6;fill:none}
`;

const escaped = text => String(text).replace(/[&<>"']/g, c => `&#${c.charCodeAt(0)};`);
const isNumber = v => typeof v === "number" && Number.isFinite(v);
const positive = v => isNumber(v) && v > 0;

// With `digits` significant ones, without a power of ten in the range that people read.
function significant(v, digits = 3) {
    if (!isNumber(v)) return "–";
    if (v === 0) return "0";
    const size = Math.floor(Math.log10(Math.abs(v)) + 1e-12);
    if (size < -4 || size > 8) {
        const [factor, power] = v.toExponential(digits - 1).replace(/-/g, "−").replace("+", "").split("e");
        return `${factor}·10${[...power].map(c => c === "−" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]).join("")}`;
    }
    return v.toFixed(Math.max(0, Math.min(20, digits - 1 - size))).replace("-", "−");
}
const percent = (v, digits = 3) => isNumber(v) ? `${significant(100 * v, digits)}\u00a0%` : "–";
// relMSE as the relative root mean square that people mean by "a 1 % error".
const errorText = (relMse, digits = 3) => !isNumber(relMse) ? "–" : relMse > 0 ? percent(Math.sqrt(relMse), digits) : "below the noise";
const ratioText = v => v > 9999 ? "> 9999×" : isNumber(v) ? `${significant(v, v >= 99.5 ? 3 : 2)}×` : "–";
const factorText = v => isNumber(v) && v > 9999 ? "> 9999" : significant(v, 2);
const countText = v => isNumber(v) ? String(Math.round(v)).replace(/\B(?=(\d{3})+$)/g, "\u202f") : "–";
function timeText(seconds, digits = 2) {
    if (!isNumber(seconds)) return "–";
    const sign = seconds < 0 ? "−" : "", t = Math.abs(seconds);
    if (t === 0) return "0 s";
    if (t < 1e-3) return `${sign}${significant(t * 1e6, digits)} µs`;
    if (t < 0.0995) return `${sign}${significant(t * 1e3, digits)} ms`;
    if (t < 99.5) return `${sign}${significant(t, digits)} s`;
    const whole = (first, one, second, other) => `${sign}${first} ${one}${second ? ` ${second} ${other}` : ""}`;
    if (t < 3570) { const s = 5 * Math.round(t / 5); return t < 600 ? whole(Math.floor(s / 60), "min", s % 60, "s") : whole(Math.round(t / 60), "min"); }
    if (t < 86400) { const m = Math.round(t / 60); return t < 36000 ? whole(Math.floor(m / 60), "h", m % 60, "min") : whole(Math.round(t / 3600), "h"); }
    return t < 8640000 ? `${sign}${significant(t / 86400, digits)} days` : `${sign}${significant(t / 31557600, digits)} years`;
}

// Ticks of a logarithmic axis: the densest of some regular sets that leaves `room` pixels between two labels.
const decadesOf = steps => { const all = []; for (let e = -9; e <= 9; ++e) for (const s of steps) all.push(s * 10 ** e); return all; };
const tickSets = {
    error: [[1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 3, 5, 7], [1, 2, 5], [1, 3], [1]].map(decadesOf),
    seconds: [
        [...decadesOf([1, 2, 5]).filter(v => v < 9), 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600, 7200, 18000, 36000, 72000, 144000],
        [...decadesOf([1, 3]).filter(v => v < 9), 10, 30, 60, 180, 600, 1800, 3600, 10800, 36000, 108000],
        [...decadesOf([1]).filter(v => v < 9), 10, 60, 600, 3600, 36000], [1e-6, 1e-3, 1, 60, 3600, 86400]],
    samples: [1, 2, 4, 6].map(step => Array.from({length: 41}, (_, i) => i).filter(i => i % step === 0).map(i => 2 ** i)),
};
function chosenTicks(sets, from, to, place, room) {
    let best = [];
    for (const set of sets) {
        const ticks = set.filter(v => v >= from * 0.999 && v <= to * 1.001);
        if (ticks.every((v, i) => i === 0 || Math.abs(place(v) - place(ticks[i - 1])) >= room)) return ticks;
        best = ticks;
    }
    return best.slice(0, 1);
}

// Look of a curve: stable whatever is shown beside it. The first curve (as rendered) has the colour of text.
function curveLooks(curves) {
    const groups = [...new Set(curves.map(c => c.group || "main"))], counts = {};
    return curves.map((curve, index) => {
        const group = curve.group || "main", g = groups.indexOf(group), i = counts[group] = (counts[group] ?? -1) + 1;
        if (index === 0) return {color: "ink", marker: 0, dash: ""};
        // As long as there are colours enough nobody shares one; those of the main group, which are beside all others, never do.
        const main = curves.filter(c => (c.group || "main") === groups[0]).length - 1, colour = curves.length <= 8 ? index - 1 : g === 0 ? i - 1 : main < 4 ? main + i % (7 - main) : i;
        return {color: `c${colour % 7}`, marker: (1 + colour + 2 * g) % 8, dash: ["", "7 3", "2 3", "9 3 2 3", "4 2"][(colour + g) % 5]};
    });
}
function markerPath(kind, x, y, r) {
    const at = (px, py) => `${(x + r * px).toFixed(1)},${(y + r * py).toFixed(1)}`;
    const polygon = points => `M${points.map(([a, b]) => at(a, b)).join("L")}Z`;
    const star = (count, inner, turn) => polygon(Array.from({length: 2 * count}, (_, i) => {
        const q = turn + Math.PI * i / count, s = i % 2 ? inner : 1.25;
        return [s * Math.sin(q), -s * Math.cos(q)];
    }));
    switch (kind) {
    case 0: return `M${at(-1, 0)}a${r},${r} 0 1,0 ${2 * r},0a${r},${r} 0 1,0 ${-2 * r},0Z`;
    case 1: return polygon([[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]);
    case 2: return polygon([[0, -1.2], [1.1, 0.8], [-1.1, 0.8]]);
    case 3: return polygon([[0, -1.3], [1.2, 0], [0, 1.3], [-1.2, 0]]);
    case 4: return polygon([[0, 1.2], [1.1, -0.8], [-1.1, -0.8]]);
    case 5: return star(4, 0.45, Math.PI / 4);
    case 6: return star(5, 0.55, 0);
    default: return star(4, 0.45, 0);
    }
}

const xOf = (point, axis) => axis === "samples" ? point.samples : point.seconds;
// The straight line of the fit, as y(x) of the relative RMS: its slope is half that of relMSE. It goes through the middle of the later
// half of the points, where a constant time for starting no longer counts.
function fitLine(curve, axis) {
    const all = (curve.points || []).filter(p => positive(p.relMse) && positive(xOf(p, axis))).sort((p, q) => xOf(p, axis) - xOf(q, axis));
    if (!curve.fit || !isNumber(curve.fit.slope) || all.length < 2) return null;
    const points = axis === "seconds" ? all.slice(Math.floor(all.length / 2)) : all;
    const slope = curve.fit.slope / 2;
    const log = points.reduce((sum, p) => sum + Math.log(Math.sqrt(p.relMse)) - slope * Math.log(xOf(p, axis)), 0) / points.length;
    return {at: x => Math.exp(log + slope * Math.log(x)), from: Math.min(...points.map(p => xOf(p, axis))),
            to: Math.max(...points.map(p => xOf(p, axis)))};
}

function plotRange(curves, axis) {
    let [x0, x1, y0, y1] = [Infinity, 0, Infinity, 0];
    const seeY = v => { if (positive(v)) { y0 = Math.min(y0, v); y1 = Math.max(y1, v); } };
    for (const curve of curves) {
        for (const point of curve.points || []) {
            const x = xOf(point, axis);
            if (!positive(x) || !(positive(point.relMse) || positive(point.high))) continue;
            x0 = Math.min(x0, x);
            x1 = Math.max(x1, x);
            seeY(Math.sqrt(Math.max(0, point.relMse)));
            if (positive(point.high)) seeY(Math.sqrt(point.high));
            if (positive(point.high) && !positive(point.relMse)) seeY(Math.sqrt(point.high) / 2.5); // room for its arrow
            if (positive(point.low) && positive(point.relMse)) seeY(Math.sqrt(Math.max(point.low, point.relMse / 9)));
        }
        if (curve.floor && positive(curve.floor.low)) seeY(Math.sqrt(curve.floor.relMse));
    }
    if (!(x1 > 0 && y1 > 0)) return null;
    const widened = (a, b, least, pad) => {
        const grow = Math.max(1, Math.sqrt(least / (b / a))) * pad;
        return [a / grow, b * grow];
    };
    [x0, x1] = widened(x0, x1, 6, 1.12);
    [y0, y1] = widened(y0, y1, 6, 1.15);
    return {x0, x1, y0, y1};
}

// Labels beside the ends of the curves, moved apart.
function endLabels(entries, top, bottom, gap) {
    entries.sort((a, b) => a.y - b.y);
    let last = -Infinity;
    for (const e of entries) last = e.at = Math.max(e.y, last + gap, top);
    last = bottom + gap;
    for (const e of [...entries].reverse()) last = e.at = Math.min(e.at, last - gap);
    return entries;
}

// options: axis "seconds" or "samples", width, height, shown (indices of curves), id (unique in the document), labels (names at
// the ends of the curves), runs (false: without the dots of single replicates), title, standalone (a file of its own). Returns {svg, spots}: spots are what a pointer can find.
function errorPlot(study, options) {
    const {axis, width, height, id} = options, all = study.curves || [], looks = curveLooks(all);
    const shown = options.shown ?? all.map((_, i) => i), curves = shown.map(i => all[i]);
    const longest = options.labels ? Math.max(0, ...curves.map(c => String(c.label).length)) : 0;
    const right = options.labels ? Math.min(width * 0.34, 30 + 6.6 * longest) : 16;
    const head = options.title ? 62 : 26, box = {l: 62, r: width - right, t: head, b: height - 42};
    const range = plotRange(curves, axis), parts = [], spots = [];
    const n = v => v.toFixed(1);
    const text = (x, y, words, more = "") => `<text x="${n(x)}" y="${n(y)}" ${more}>${escaped(words)}</text>`;
    const open = `<svg xmlns="http://www.w3.org/2000/svg" class="plot" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}" ` +
        `role="img" aria-label="${escaped(`Relative error against ${axis === "samples" ? "samples" : "time"}`)}">`;
    if (options.standalone)
        parts.push(`<style>svg{${themeRules("light")}}@media(prefers-color-scheme:dark){svg{${themeRules("dark")}}}${plotRules}.curve:not(.ink) .fit{display:none}</style>` +
                   `<rect width="${width}" height="${height}" rx="8" fill="var(--paper)"/>`);
    if (options.title) parts.push(text(14, 26, options.title, `class="title" style="font-size:15px"`));
    if (!range) {
        parts.push(text(width / 2, height / 2, "no error was measured", `text-anchor="middle" class="note"`));
        return {svg: `${open}${parts.join("")}</svg>`, spots};
    }
    const X = x => box.l + (box.r - box.l) * Math.log(x / range.x0) / Math.log(range.x1 / range.x0);
    const Y = y => box.b - (box.b - box.t) * Math.log(y / range.y0) / Math.log(range.y1 / range.y0);
    parts.push(axesSvg({axis, box, range, X, Y, text, n, id}));
    const ends = [];
    for (const index of [...shown].sort((a, b) => b - a)) { // the first curve on top
        parts.push(curveSvg(all[index], index, looks[index], {axis, box, X, Y, n, spots, range, id, replicates: options.runs !== false}));
        const last = spots.filter(s => s.curve === index).pop();
        if (last && options.labels) ends.push({index, y: last.y, x: last.x});
    }
    for (const e of endLabels(ends, box.t + 4, box.b - 2, 16)) {
        const room = Math.floor((right - 26) / 6.4), name = String(all[e.index].label);
        parts.push(`<g class="${looks[e.index].color}"><path class="leader" d="M${n(e.x + 5)},${n(e.y)}L${n(box.r + 8)},${n(e.at)}h6"/>` +
                   text(box.r + 17, e.at + 4, name.length > room ? name.slice(0, room - 1) + "…" : name, `class="label"`) + "</g>");
    }
    return {svg: `${open}${parts.join("")}</svg>`, spots};
}

function axesSvg({axis, box, range, X, Y, text, n, id}) {
    const parts = [`<clipPath id="${id}-clip"><rect x="${n(box.l)}" y="${n(box.t)}" width="${n(box.r - box.l)}" height="${n(box.b - box.t)}"/></clipPath>`];
    // Parallels of 1/√N, two to a decade: what averaging does, to hold any curve against.
    parts.push(`<g clip-path="url(#${id}-clip)">`);
    const step = Math.sqrt(10), high = range.y1 * Math.sqrt(range.x1 / range.x0);
    for (let y = range.y0 * step ** 0.5; y < high; y *= step)
        parts.push(`<line class="guide" x1="${n(X(range.x0))}" y1="${n(Y(y))}" x2="${n(X(range.x1))}" y2="${n(Y(y * Math.sqrt(range.x0 / range.x1)))}"/>`);
    parts.push("</g>");
    for (const y of chosenTicks(tickSets.error, 100 * range.y0, 100 * range.y1, v => Y(v / 100), 26))
        parts.push(`<line class="grid" x1="${n(box.l)}" x2="${n(box.r)}" y1="${n(Y(y / 100))}" y2="${n(Y(y / 100))}"/>` +
                   text(box.l - 8, Y(y / 100) + 4, `${+y.toPrecision(2)} %`, `text-anchor="end" class="ytick"`));
    const name = axis === "samples" ? v => v >= 1048576 ? `${v / 1048576} M` : v >= 16384 ? `${v / 1024} k` : String(v)
        : v => v < 0.999e-3 ? `${+(v * 1e6).toPrecision(2)} µs` : v < 0.0999 ? `${+(v * 1e3).toPrecision(2)} ms` : v < 59 ? `${+v.toPrecision(2)} s`
        : v < 3599 ? `${Math.round(v / 60)} min` : v < 86399 ? `${Math.round(v / 3600)} h` : `${Math.round(v / 86400)} d`;
    for (const x of chosenTicks(tickSets[axis], range.x0, range.x1, X, 52)) {
        const anchor = X(x) > box.r - 12 ? "end" : "middle";
        parts.push(`<line class="axis" x1="${n(X(x))}" x2="${n(X(x))}" y1="${n(box.b)}" y2="${n(box.b + 5)}"/>` +
                   text(X(x) + (anchor === "end" ? 10 : 0), box.b + 19, name(x), `text-anchor="${anchor}" class="xtick"`));
    }
    parts.push(`<path class="axis" d="M${n(box.l)},${n(box.t)}V${n(box.b)}H${n(box.r)}"/>`,
               text(box.l - 48, box.t - 11, "relative error (RMS)", `class="title"`),
               text(box.r, box.t - 11, axis === "samples" ? "dotted: 1/√N" : "dotted: 1/√time", `text-anchor="end" class="note"`),
               text(box.r, box.b + 37, axis === "samples" ? "samples per pixel" : "time to render", `text-anchor="end" class="title"`));
    return parts.join("");
}

function curveSvg(curve, index, look, {axis, box, X, Y, n, spots, range, id, replicates}) {
    const line = [], upper = [], lower = [], marks = [], runs = [];
    const inside = y => Math.min(box.b, Math.max(box.t, y));
    (curve.points || []).forEach((point, k) => {
        const x = xOf(point, axis);
        if (!positive(x)) return;
        for (const run of replicates && point.runs || [])
            if (positive(run.relMse)) {
                const rx = axis === "samples" || !positive(run.seconds) ? x : run.seconds;
                runs.push(`<circle class="run" cx="${n(X(rx))}" cy="${n(inside(Y(Math.sqrt(run.relMse))))}" r="1.6"/>`);
            }
        if (positive(point.high)) {
            upper.push(`${n(X(x))},${n(inside(Y(Math.sqrt(point.high))))}`);
            lower.unshift(`${n(X(x))},${n(positive(point.low) ? inside(Y(Math.sqrt(point.low))) : box.b)}`);
        }
        if (positive(point.relMse)) {
            const y = inside(Y(Math.sqrt(point.relMse)));
            line.push(`${n(X(x))},${n(y)}`);
            marks.push(`<path class="mark" d="${markerPath(look.marker, X(x), y, 4.2)}"/>`);
            spots.push({curve: index, point: k, x: X(x), y});
        } else if (positive(point.high)) { // the noise of the reference is larger: only an upper bound is known
            const y = inside(Y(Math.sqrt(point.high)));
            marks.push(`<path class="whisker" d="M${n(X(x) - 5)},${n(y)}h10M${n(X(x))},${n(y)}V${n(box.b - 7)}m-4,-5l4,6l4,-6"/>`);
            spots.push({curve: index, point: k, x: X(x), y});
        }
    });
    const parts = [];
    if (upper.length > 1) parts.push(`<polygon class="band" points="${[...upper, ...lower].join(" ")}"/>`);
    if (line.length > 1) parts.push(`<polyline class="path" points="${line.join(" ")}"${look.dash ? ` stroke-dasharray="${look.dash}"` : ""}/>`);
    const fit = fitLine(curve, axis);
    if (fit) {
        const a = Math.max(range.x0, fit.from / 1.6), b = Math.min(range.x1, fit.to * 1.6);
        parts.push(`<line class="fit" x1="${n(X(a))}" y1="${n(Y(fit.at(a)))}" x2="${n(X(b))}" y2="${n(Y(fit.at(b)))}"/>`);
    }
    if (curve.floor && positive(curve.floor.low)) {
        const y = inside(Y(Math.sqrt(curve.floor.relMse)));
        parts.push(`<line class="floor" x1="${n(box.l + (box.r - box.l) / 2)}" x2="${n(box.r)}" y1="${n(y)}" y2="${n(y)}"/>`);
    }
    return `<g class="curve ${look.color}" data-curve="${index}"><g clip-path="url(#${id}-clip)">${parts.join("")}</g>${runs.join("")}${marks.join("")}</g>`;
}
