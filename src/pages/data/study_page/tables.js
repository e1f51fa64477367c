// The tables, the efficiencies, the cost report, the effects, and what is at the end.
function table(heads, rows) {
    return make("div", {class: "scroll", tabindex: "0"}, make("table", {}, make("thead", {}, make("tr", {}, heads.map(h => make("th", {scope: "col", class: h === "asked for by" || h === "without it" ? "text" : null}, h)))), make("tbody", {}, rows)));
}
function timeTable() {
    const errors = [...new Set(curves.flatMap(c => (c.timeTo || []).map(t => t.error)))].filter(positive).sort((a, b) => b - a);
    if (!errors.length && !curves.some(c => c.fit)) return;
    const cell = (curve, error) => {
        const t = timeToReach(curve, error);
        if (!t || !positive(t.seconds)) return make("td", {class: "soft"}, t && t.reachable === false ? "never" : "–",
            make("small", {}, t && t.reachable === false || curve.floor && positive(curve.floor.low) && curve.floor.relMse > error ** 2 ? "bias is larger" : ""));
        if (tooFar(curve, t)) return make("td", {class: "far", title: "too far beyond what was measured"}, `> ${timeText(farthest(curve))}`);
        return make("td", {class: t.extrapolated ? "far" : null, title: positive(t.samples) ? `${countText(t.samples)} samples` : null}, `${timeText(t.seconds)}${t.extrapolated ? " †" : ""}`,
                    make("small", {}, between(t.low, t.high, v => v > farthest(curve) ? `> ${timeText(farthest(curve))}` : timeText(v))));
    };
    const rows = [];
    let group = mainGroup;
    const rank = c => groups.indexOf(c.group || "main"); // −1: the main group
    curves.map((curve, i) => ({curve, i})).sort((a, b) => rank(a.curve) - rank(b.curve) || a.i - b.i).forEach(({curve, i}) => {
        if ((curve.group || "main") !== group) rows.push(make("tr", {class: "group"}, make("td", {colspan: errors.length + 4}, group = curve.group || "main")));
        const fit = curve.fit || {}, bias = biasOf(curve);
        rows.push(make("tr", {"data-curve": i}, make("td", {}, named(i), curve.note ? make("small", {}, curve.note) : null), errors.map(error => cell(curve, error)),
            make("td", {}, isNumber(fit.slope) ? significant(fit.slope / 2, 3) : "–", make("small", {}, between(rootSlope(fit.low), rootSlope(fit.high), v => significant(v, 3)))),
            make("td", {}, positive(fit.halfNoiseCost) ? ratioText(fit.halfNoiseCost) : "–", make("small", {}, between(fit.halfNoiseCostLow, fit.halfNoiseCostHigh, factorText))),
            make("td", {}, bias ? bias.low > 0 ? errorText(bias.relMse, 2) : positive(bias.high) ? `< ${errorText(bias.high, 2)}` : "none" : "–",
                 make("small", {}, [biasWords(curve), bias && bias.samples ? `at ${countText(bias.samples)}` : ""].filter(Boolean).join(", ")))));
    });
    section("time", "Time", "Time to reach an error", errors.length ? "Below each time its 95\u00a0% interval. † continues the fitted line beyond what was measured." : "",
            table(["", ...errors.map(e => `to ${percent(e, 1)}`), "slope", "half the noise costs", "bias"], rows));
}

function efficiencies() {
    const list = curves.map((curve, index) => ({index, ...curve.efficiency})).filter(e => positive(e.ratio)).sort((a, b) => b.ratio - a.ratio);
    if (list.length < 2) return;
    const values = list.flatMap(e => [e.ratio, e.low, e.high]).filter(positive);
    const lo = Math.min(0.5, ...values) / 1.15, hi = Math.max(2, ...values) * 1.15, at = v => 100 * Math.log(v / lo) / Math.log(hi / lo);
    const span = Math.log10(hi / lo), marks = decadesOf(span < 1.3 ? [1, 2, 5] : span < 2.6 ? [1, 3] : [1]).filter(v => v > lo && v < hi && at(v) > 4 && at(v) < 96);
    const line = (v, colour) => `<line x1="${at(v)}%" x2="${at(v)}%" y1="0" y2="27" stroke="var(--${colour})"/>`;
    const grid = marks.map(v => line(v, "grid")).join("") + line(1, "soft");
    const row = e => {
        const look = looks[e.index], known = e.index > 0 && hasInterval(e);
        const whisker = known ? `<line x1="${positive(e.low) ? at(e.low) : 0}%" x2="${positive(e.high) ? at(e.high) : 100}%" y1="13.5" y2="13.5" stroke="var(--c)" stroke-width="2"/>` : "";
        const strip = svgOf(`<svg class="plot" role="img" aria-label="${escaped(`${curves[e.index].label}: ${ratioText(e.ratio)}`)}">${grid}<g class="${look.color}">${whisker}<svg x="${at(e.ratio)}%" y="13.5" overflow="visible"><path class="mark" d="${markerPath(look.marker, 0, 0, 5)}"/></svg></g></svg>`);
        return make("div", {}, make("div", {class: "row-name"}, named(e.index)), make("div", {class: "strip"}, strip),
                    make("div", {class: "value"}, ratioText(e.ratio), " ", make("small", {}, known ? `(${between(e.low, e.high, factorText)})` : "")));
    };
    const missing = curves.length - list.length;
    section("efficiency", "Efficiency", "Efficiency against the scene as rendered",
            "How much more (right) or less (left) accuracy a second of samples buys: the inverse of error² × time, as a ratio, with 95\u00a0% intervals. Pilots and plans, whose time does not grow with the samples, are left out.",
            make("div", {class: "whiskers"}, list.map(row), make("div", {}, make("div", {class: "row-name"}),
                make("div", {class: "strip scale"}, marks.map(v => make("span", {style: `left:${at(v)}%`}, `${+v.toPrecision(2)}×`))), make("div", {class: "value"}))),
            missing ? make("p", {class: "soft"}, `${missing} without a figure: ${curves.filter(c => !c.efficiency || !positive(c.efficiency.ratio)).map(c => c.label).join(", ")}.`) : "");
}

const costColours = ["c0", "c1", "c2", "c4", "c3", "c5", "c6"];
function costReport() {
    const rows = (study.cost && study.cost.rows || []).filter(r => isNumber(r.seconds) && (r.seconds > 0 || r.elsewhere > 0 || r.rays > 0 || r.count > 0)).sort((a, b) => b.seconds - a.seconds);
    if (!rows.length) return;
    const total = rows.reduce((sum, r) => sum + Math.max(0, r.seconds), 0) || 1, share = r => isNumber(r.share) ? r.share : r.seconds / total;
    const colour = i => i < 7 ? `var(--${costColours[i]})` : "var(--soft)";
    const accounted = study.cost.accounted, elsewhere = rows.some(r => r.elsewhere > 0), counts = rows.some(r => r.count > 0);
    section("cost", "Cost", "Cost report", `Where the time goes${isNumber(study.cost.seconds) ? `: ${timeText(study.cost.seconds, 3)} on ${study.cost.threads ?? "?"} threads` : ""}${isNumber(accounted) ? `; ${percent(accounted, 3)} of it is accounted for` : ""}.${elsewhere ? " What was spent because of an effect, but counted in the rows of others, is in a column of its own; these seconds overlap." : ""}`,
        make("div", {class: "stack", role: "img", "aria-label": rows.map(r => `${r.label} ${percent(share(r), 2)}`).join(", ")},
             rows.map((r, i) => make("div", {style: `flex:${Math.max(0, r.seconds) / total} 0 0;background:${colour(i)}`, title: `${r.label}: ${percent(share(r), 2)}`}, share(r) > 0.09 ? r.label : ""))),
        table(["", "seconds", "share", ...(elsewhere ? ["in other rows"] : []), "rays", ...(counts ? ["counted"] : [])], rows.map((r, i) => make("tr", {},
            make("td", {}, make("span", {class: "swatch", style: `background:${colour(i)}`}), r.label, r.note ? make("small", {}, r.note) : null),
            make("td", {}, timeText(r.seconds, 3), make("small", {}, positive(r.uncertainty) ? `± ${timeText(r.uncertainty, 1)}` : "")), make("td", {}, percent(share(r), 3)),
            elsewhere ? make("td", {}, positive(r.elsewhere) ? timeText(r.elsewhere, 3) : "") : null, make("td", {}, positive(r.rays) ? countText(r.rays) : ""),
            counts ? make("td", {}, positive(r.count) ? `${countText(r.count)} ${r.counted || ""}` : "") : null))));
}

function effects() {
    const all = study.effects || [];
    if (!all.length) return;
    const measured = all.filter(e => isNumber(e.deltaTime) && isNumber(e.flip)).sort((a, b) => b.deltaTime - a.deltaTime);
    const made = section("effects", "Effects", "What each effect is worth",
        "Each effect off and on with the same seeds. To the right it takes more of the time; upwards it changes more of what an observer sees (HDR-FLIP, 0 … 1).");
    if (measured.length) {
        const frame = make("div", {class: "frame"}), draw = () => frame.replaceChildren(svgOf(effectPlot(measured, Math.max(300, frame.clientWidth || 900))));
        made.append(make("figure", {}, frame));
        new ResizeObserver(() => { if (+frame.dataset.width !== frame.clientWidth) { frame.dataset.width = frame.clientWidth; draw(); } }).observe(frame);
        draw();
    }
    const thumb = e => e.png ? make("button", {type: "button", style: "border:0;padding:0", "aria-label": `Picture without ${e.name}`,
        onclick: event => event.currentTarget.firstChild.classList.toggle("large")}, make("img", {class: "thumb", src: pngUrl(e.png), alt: `without ${e.name}`})) : null;
    made.append(table(["effect", "without it", "asked for by", "share of the time", "time on", "time off", "FLIP", "error if left out"],
        [...measured, ...all.filter(e => !measured.includes(e))].map(e => measured.includes(e)
            ? make("tr", {}, make("td", {}, e.name, e.note ? make("small", {}, e.note) : null), make("td", {class: "text"}, thumb(e) ?? "–"), make("td", {class: "text"}, e.place || "–"),
                make("td", {}, percent(e.deltaTime, 2), make("small", {}, between(e.low, e.high, v => percent(v, 2)))), make("td", {}, timeText(e.secondsOn, 3)), make("td", {}, timeText(e.secondsOff, 3)),
                make("td", {}, significant(e.flip, 2)), make("td", {}, positive(e.relMse) ? errorText(e.relMse, 2) : "–"))
            : make("tr", {}, make("td", {}, e.name), make("td", {class: "text"}, "–"), make("td", {class: "text"}, e.place || "–"), make("td", {class: "text", colspan: 5}, e.reason || "not measured")))));
}
// FLIP goes by its root: small changes are apart, and nothing is at minus infinity.
function effectPlot(list, width) {
    const height = Math.round(Math.max(250, Math.min(340, width * 0.5))), box = {l: 48, r: width - 18, t: 30, b: height - 42};
    const lo = Math.min(0, ...list.flatMap(e => [e.deltaTime, e.low]).filter(isNumber)) - 0.01, hi = Math.max(0.1, ...list.flatMap(e => [e.deltaTime, e.high]).filter(isNumber)) * 1.12;
    const top = Math.max(0.02, ...list.map(e => e.flip)) * 1.25, X = v => box.l + (box.r - box.l) * (v - lo) / (hi - lo), Y = v => box.b - (box.b - box.t) * Math.sqrt(Math.max(0, v) / top);
    const n = v => v.toFixed(1), parts = [], taken = [];
    const step = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5].find(s => (X(s) - X(0)) >= 56) ?? 1;
    for (let v = Math.ceil(lo / step) * step; v <= hi; v += step)
        parts.push(`<line class="grid" x1="${n(X(v))}" x2="${n(X(v))}" y1="${box.t}" y2="${box.b}"/><text class="xtick" x="${n(X(v))}" y="${box.b + 18}" text-anchor="middle">${escaped(`${Math.round(100 * v)} %`)}</text>`);
    let last = Infinity;
    for (const v of [0, 0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.4, 0.8]) {
        if (v > top || last - Y(v) < 22) continue;
        last = Y(v);
        parts.push(`<line class="grid" x1="${box.l}" x2="${box.r}" y1="${n(last)}" y2="${n(last)}"/><text class="ytick" x="${box.l - 7}" y="${n(last + 4)}" text-anchor="end">${v}</text>`);
    }
    parts.push(`<path class="axis" d="M${box.l},${box.t}V${box.b}H${box.r}"/><text class="title" x="6" y="14">FLIP without the effect</text>`,
               `<text class="title" x="${box.r}" y="${height - 6}" text-anchor="end">share of the time</text>`);
    list.forEach((e, i) => {
        const y = Y(e.flip), known = isNumber(e.low) && isNumber(e.high), room = Math.floor((box.r - box.l) / 17),
            name = e.name.length > room ? `${e.name.slice(0, room - 1)}…` : e.name, w = 7 * name.length, side = X(known ? e.high : e.deltaTime) + 12 + w < box.r ? 1 : -1;
        const x = X(known ? side > 0 ? e.high : e.low : e.deltaTime);
        let ty = y + 4;
        const hits = v => taken.some(t => Math.abs(t.y - v) < 14 && Math.max(t.x, side > 0 ? x : x - w - 12) < Math.min(t.x + t.w, side > 0 ? x + w + 12 : x));
        for (let k = 1; hits(ty) && k < 12; ++k) ty = y + 4 + (k % 2 ? -1 : 1) * 15 * Math.ceil(k / 2);
        taken.push({x: side > 0 ? x : x - w - 12, y: ty, w: w + 12});
        const whisker = known ? `<path class="whisker" d="M${n(X(e.low))},${n(y)}H${n(X(e.high))}"/>` : "";
        parts.push(`<g class="effect c${i % 7}">${whisker}<path class="mark" d="${markerPath(i % 8, X(e.deltaTime), y, 5)}"/><text class="label" x="${n(x + 10 * side)}" y="${n(ty)}" text-anchor="${side > 0 ? "start" : "end"}">${escaped(name)}</text></g>`);
    });
    return `<svg class="plot" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}" role="img" aria-label="Effects: visible change against share of the time">${parts.join("")}</svg>`;
}

function csvText() {
    const quote = v => v === null || v === undefined ? "" : typeof v === "number" ? String(v) : `"${String(v).replace(/"/g, '""')}"`;
    const names = ["samples", "seconds", "coreSeconds", "rays", "relMse", "low", "high", "trimmed", "bias2", "bias2Low", "bias2High"];
    return [["curve", "label", "group", ...names].join(","), ...curves.flatMap(c => (c.points || []).map(p => [c.id, c.label, c.group, ...names.map(k => p[k])].map(quote).join(",")))].join("\n") + "\n";
}
function closing() {
    const download = (text, type, ending) => {
        const url = URL.createObjectURL(new Blob([text], {type})), name = String((study.scene || {}).name || "study").replace(/[^\w.-]+/g, "_").slice(0, 60);
        const link = make("a", {href: url, download: `${name}.study.${ending}`});
        link.click();
        setTimeout(() => URL.revokeObjectURL(url), 10000);
    };
    const command = study.program && study.program.command, leftOut = study.leftOut || [];
    section("data", "Data", "Data, and how to repeat it", "",
        command ? make("pre", {tabindex: "0"}, command) : null,
        make("div", {class: "switches buttons"},
            make("button", {type: "button", onclick: () => download(byId("study").textContent, "application/json", "json")}, "Save JSON"),
            make("button", {type: "button", onclick: () => download(csvText(), "text/csv", "csv")}, "Save CSV"),
            command ? make("button", {type: "button", onclick: event => {
                const button = event.currentTarget;
                navigator.clipboard?.writeText(command).then(() => { button.textContent = "Copied"; }, () => { button.textContent = "Copying is not allowed here"; });
            }}, "Copy the command") : null),
        leftOut.length ? make("div", {class: "measure"}, make("h3", {}, "Not measured"), make("ul", {class: "left-out soft"}, leftOut.map(v => make("li", {}, `${v.label}: ${v.reason}`)))) : null,
        make("div", {class: "measure soft"}, study.measure ? make("p", {}, study.measure) : null,
            make("p", {}, `${/1 %/.test(study.measure || "") ? "" : "An error of 1 % is a relMSE of 10⁻⁴. "}${isNumber(study.replicates) ? `Each point is the mean of ${study.replicates} independent renders` : "Each point is a mean of independent renders"}${isNumber(study.seed) ? `, from seed ${study.seed} on` : ""}; the products with two independent halves of the reference cancel its noise, so that a small error may come out negative.`)));
}
