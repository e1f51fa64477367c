// Puts the report together. Text from outside enters by textContent, or by escaped() inside SVG.
const study = JSON.parse(document.getElementById("study").textContent);
const curves = study.curves || [], looks = curveLooks(curves);
const byId = id => document.getElementById(id);
// make("p", {class: "soft"}, "text", element…)
function make(name, attributes = {}, ...children) {
    const e = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) {
        if (key.startsWith("on")) e.addEventListener(key.slice(2), value);
        else if (key.startsWith("aria-") || (value !== null && value !== undefined && value !== false)) e.setAttribute(key, value);
    }
    e.append(...children.flat().filter(child => child !== null && child !== undefined));
    return e;
}
const bold = words => words.map((text, i) => i % 2 ? make("strong", {}, text) : text);
const pngUrl = text => `data:image/png;base64,${text}`;
function svgOf(text) {
    const holder = document.createElement("template");
    holder.innerHTML = text;
    return holder.content.firstElementChild;
}
function section(id, short, title, intro, ...children) {
    byId("nav").append(make("a", {href: `#${id}`}, short));
    const made = make("section", {id, "aria-labelledby": `${id}-title`},
                      make("header", {}, make("h2", {id: `${id}-title`}, title), intro ? make("p", {}, intro) : null), ...children);
    byId("top").append(made);
    return made;
}

// Light and dark: as the system says, unless the reader says otherwise.
document.head.append(make("style", {}, `:root{${themeRules("light")}}@media (prefers-color-scheme:dark){:root:not([data-theme=light]){${themeRules("dark")}}}` +
    `:root[data-theme=dark]{${themeRules("dark")}}@media print{:root:root:root:root{${themeRules("light")}}}${plotRules}`));
const themeButton = byId("theme"), themeNames = {auto: ["◐", "as the system"], light: ["☀", "light"], dark: ["☾", "dark"]};
function setTheme(name) {
    if (name === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = name;
    themeButton.textContent = themeNames[name][0];
    themeButton.setAttribute("aria-label", `Colours: ${themeNames[name][1]}`);
    themeButton.title = `Colours: ${themeNames[name][1]}`;
    themeButton.dataset.now = name;
}
themeButton.addEventListener("click", () => {
    const dark = matchMedia("(prefers-color-scheme: dark)").matches, order = dark ? ["auto", "light", "dark"] : ["auto", "dark", "light"];
    setTheme(order[(order.indexOf(themeButton.dataset.now) + 1) % 3]);
});
setTheme("auto");

// The key of a curve, as in the plots.
function keyOf(index) {
    const look = looks[index], dash = look.dash ? ` stroke-dasharray="${look.dash}"` : "";
    return svgOf(`<svg class="plot" width="34" height="14" viewBox="0 0 34 14" aria-hidden="true"><g class="${look.color}">` +
                 `<path class="path" d="M1,7H33"${dash}/><path class="mark" d="${markerPath(look.marker, 17, 7, 4.2)}"/></g></svg>`);
}
const named = index => make("span", {class: "chip", title: curves[index].change || null}, keyOf(index), make("span", {}, curves[index].label));

// Which curves are shown: the main group and one more, or all; single ones can be hidden.
const mainGroup = curves.length ? curves[0].group || "main" : "main";
const groups = [...new Set(curves.map(c => c.group || "main"))].filter(g => g !== mainGroup);
const choice = {group: groups[0] ?? null, hidden: new Set(), trimmed: false, listeners: []};
const inChoice = index => { const g = curves[index].group || "main"; return g === mainGroup || choice.group === "all" || g === choice.group; };
const shownCurves = () => curves.map((_, i) => i).filter(i => inChoice(i) && !choice.hidden.has(i));
// The same study without the 0.1 % of the pixels that add most: of that no bands and no fit are known.
const trimmedPoint = p => ({...p, relMse: p.trimmed, low: null, high: null, runs: (p.runs || []).map(r => ({...r, relMse: r.trimmed}))});
const trimmedStudy = {...study, curves: curves.map(c => ({...c, fit: null, floor: null, points: (c.points || []).map(trimmedPoint)}))};
const changed = () => choice.listeners.forEach(listener => listener());

function head() {
    const scene = study.scene || {}, machine = study.machine || {}, reference = study.reference || {};
    document.title = `${scene.name || "scene"} – Abbe study`;
    const what = curves.length > 1 ? `${curves.length - 1} ${curves.length === 2 ? "change" : "changes"} against the scene as rendered` : curves.length ? "the scene as rendered" : (study.effects || []).length ? "each effect, off and on" : "nothing";
    const facts = [["measured", what], ["picture", scene.width ? `${scene.width} × ${scene.height} pixels` : null],
                   ["replicates", study.replicates], ["effects in the scene", scene.effects],
                   ["reference", reference.samplesPerHalf ? `2 × ${countText(reference.samplesPerHalf)} samples, ${timeText(reference.seconds)}` : null],
                   ["noise of the reference", positive(reference.relMse) ? errorText(reference.relMse, 2) : null],
                   ["machine", machine.cpu ? `${machine.cpu}, ${machine.threads} ${machine.threads === 1 ? "thread" : "threads"}` : null],
                   ["program", study.program && study.program.version ? `Abbe ${study.program.version}` : null]];
    byId("top").append(make("div", {class: "head"},
        make("div", {}, make("p", {class: "eyebrow"}, "What accuracy costs"), make("h1", {title: scene.name || null}, scene.name || "Study"),
             scene.path ? make("p", {class: "path", title: scene.path}, scene.path) : null,
             make("ul", {class: "findings"}, findingsOf(study).map(words => make("li", {}, bold(words))))),
        study.referencePng ? make("figure", {}, make("img", {src: pngUrl(study.referencePng), alt: "The reference picture"}),
                                  make("figcaption", {}, "the reference")) : null,
        make("dl", {class: "facts"}, facts.filter(([, value]) => value !== null && value !== undefined && value !== "")
            .map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, value))))));
}

function convergence() {
    if (!curves.some(c => (c.points || []).length)) return;
    const made = section("convergence", "Error", "Error against time and samples",
        "Relative error is the root of the mean square error over the pixels, relative to the reference. Bands hold 95\u00a0% of what other seeds would give; a thin straight line is the fitted power law. An arrow marks a measurement that drowns in the noise of the reference: its top is the upper bound.");
    const switches = make("div", {class: "switches", role: "group", "aria-label": "Group of curves"}), chips = make("div", {class: "switches chips", role: "group", "aria-label": "Curves"});
    const options = [...groups, ...(groups.length > 1 ? ["all"] : [])];
    if (options.length) {
        switches.append(make("span", {class: "name"}, "as rendered, and"), ...options.map(group => make("button", {type: "button", "data-group": group,
            onclick: () => { choice.group = choice.group === group ? null : group; changed(); }}, group === "all" ? "all curves" : group)));
        made.append(switches);
    }
    const pixels = make("div", {class: "switches", role: "group", "aria-label": "Pixels that count"}, make("span", {class: "name"}, "error of"),
        [[false, "all pixels"], [true, "all but the worst 0.1\u00a0%"]].map(([trimmed, words]) => make("button", {type: "button", "data-trimmed": trimmed ? "yes" : "no",
            onclick: () => { choice.trimmed = trimmed; changed(); }}, words)));
    if (curves.some(c => (c.points || []).some(p => positive(p.trimmed)))) made.append(pixels);
    const plots = make("div", {class: "plots"}, ["seconds", "samples"].map(axis => {
        const frame = make("div", {class: "frame", tabindex: "0", "data-axis": axis, role: "application",
                                   "aria-label": `Error against ${axis === "seconds" ? "time" : "samples"}; arrow keys go from point to point`});
        pointing(frame, made);
        return make("figure", {}, frame, make("figcaption", {}));
    }));
    made.append(chips, plots);
    const draw = () => {
        for (const button of switches.querySelectorAll("button")) button.setAttribute("aria-pressed", button.dataset.group === choice.group);
        for (const button of pixels.querySelectorAll("button")) button.setAttribute("aria-pressed", (button.dataset.trimmed === "yes") === choice.trimmed);
        chips.replaceChildren(...curves.map((curve, i) => inChoice(i) ? make("button", {type: "button", class: "chip", "aria-pressed": !choice.hidden.has(i), "data-curve": i,
            title: [curve.change, curve.note, biasWords(curve)].filter(Boolean).join(" · "),
            onclick: () => { if (!choice.hidden.delete(i)) choice.hidden.add(i); changed(); chips.querySelector(`[data-curve="${i}"]`)?.focus(); },
            onpointerenter: () => highlight(made, i), onpointerleave: () => highlight(made, null),
            onfocus: () => highlight(made, i), onblur: () => highlight(made, null)}, keyOf(i), make("span", {}, curve.label)) : null).filter(Boolean));
        for (const figure of plots.children) drawPlot(figure);
    };
    choice.listeners.push(draw);
    new ResizeObserver(() => { for (const figure of plots.children) if (+figure.dataset.width !== widthOf(figure)) drawPlot(figure); }).observe(plots);
    draw();
}
const biasWords = curve => ({exact: "unbiased", consistent: "consistent", biased: "biased"})[curve.bias] || "";
const widthOf = figure => Math.max(280, Math.floor(figure.clientWidth || 560));
function drawPlot(figure) {
    const frame = figure.firstChild, axis = frame.dataset.axis, width = widthOf(figure);
    figure.dataset.width = width;
    const plot = errorPlot(choice.trimmed ? trimmedStudy : study, {axis, width, height: Math.round(Math.max(320, Math.min(460, width * 0.78))), shown: shownCurves(), id: `plot-${axis}`});
    frame.replaceChildren(svgOf(plot.svg));
    frame.spots = plot.spots;
    const fit = choice.trimmed ? null : curves[0].fit;
    figure.lastChild.textContent = fit && isNumber(fit.slope) && axis === "samples"
        ? `${curves[0].label}: error falls as N to the power ${significant(fit.slope / 2, 3)}${isNumber(fit.low) && isNumber(fit.high) ? ` (95\u00a0%: ${between(rootSlope(fit.low), rootSlope(fit.high), v => significant(v, 3))})` : ""}; averaging gives −0.5.`
        : axis === "seconds" ? `Wall time of one render${study.machine && study.machine.threads ? ` on ${study.machine.threads} threads` : ""}.` : "";
}
function highlight(root, index) {
    root.classList.toggle("hot", index !== null);
    for (const e of root.querySelectorAll("[data-curve]")) e.classList.toggle("on", index !== null && +e.dataset.curve === index);
}

// Pointer and keys find points; the tip tells their values.
function pointing(frame, root) {
    let at = null;
    const show = spot => {
        at = spot;
        highlight(root, spot ? spot.curve : null);
        if (!spot) { hideTip(); return; }
        const box = frame.getBoundingClientRect(), scale = box.width / frame.firstChild.viewBox.baseVal.width;
        showTip(pointTip(curves[spot.curve], curves[spot.curve].points[spot.point]), box.left + spot.x * scale, box.top + spot.y * scale);
    };
    frame.addEventListener("pointermove", event => {
        const box = frame.getBoundingClientRect(), scale = frame.firstChild.viewBox.baseVal.width / box.width;
        const x = (event.clientX - box.left) * scale, y = (event.clientY - box.top) * scale;
        let best = null, least = 40 ** 2;
        for (const s of frame.spots) { const d = (s.x - x) ** 2 + (s.y - y) ** 2; if (d < least) { least = d; best = s; } }
        show(best);
    });
    frame.addEventListener("pointerleave", () => show(null));
    frame.addEventListener("blur", () => show(null));
    frame.addEventListener("keydown", event => {
        const spots = frame.spots, i = spots.findIndex(s => at && s.curve === at.curve && s.point === at.point);
        if (event.key === "Escape") { show(null); return; }
        if (!spots.length || !event.key.startsWith("Arrow")) return;
        event.preventDefault();
        if (i < 0) { show(spots[0]); return; }
        if (event.key === "ArrowLeft" || event.key === "ArrowRight") {
            const next = spots[i + (event.key === "ArrowRight" ? 1 : -1)];
            if (next && next.curve === at.curve) show(next);
        } else {
            const shown = [...new Set(spots.map(s => s.curve))], step = event.key === "ArrowDown" ? 1 : shown.length - 1;
            const curve = shown[(shown.indexOf(at.curve) + step) % shown.length];
            show(spots.filter(s => s.curve === curve).sort((a, b) => Math.abs(a.x - at.x) - Math.abs(b.x - at.x))[0]);
        }
    });
}
function pointTip(curve, p) {
    const rows = [["error", errorText(p.relMse)], ["95 %", between(p.low, p.high, v => errorText(v))], ["samples", countText(p.samples)], ["time", timeText(p.seconds, 3)],
                  ["core time", isNumber(p.coreSeconds) ? timeText(p.coreSeconds, 3) : ""], ["rays", isNumber(p.rays) ? countText(p.rays) : ""],
                  ["trimmed", positive(p.trimmed) ? errorText(p.trimmed) : ""], ["relMSE", isNumber(p.relMse) ? significant(p.relMse) : ""],
                  ["bias²", isNumber(p.bias2) ? `${significant(p.bias2, 2)} (${between(p.bias2Low, p.bias2High, v => significant(v, 2))})` : ""]];
    return [make("b", {}, curve.label), make("dl", {}, rows.filter(([, value]) => value).flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]))];
}
function showTip(content, x, y) {
    const tip = byId("tip");
    tip.replaceChildren(...content);
    tip.hidden = false;
    const {width, height} = tip.getBoundingClientRect();
    tip.style.left = `${Math.max(6, x + 16 + width > innerWidth ? x - 16 - width : x + 16)}px`;
    tip.style.top = `${Math.max(6, Math.min(innerHeight - height - 6, y - height / 2))}px`;
}
const hideTip = () => { byId("tip").hidden = true; };
window.addEventListener("scroll", hideTip, {passive: true});
