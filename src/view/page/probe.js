// The probe: what the picture holds at a pixel. Under the pointer it is a short reading; a click pins it, with its spectrum,
// and it is read again while the picture gets better.
import {byId, copy, latest, make, say} from "./dom.js";
import {isNumber, percent, point, significant, withError} from "./format.js";
import {factsList, section} from "./panels.js";
import {live} from "./picture.js";
import {spectrumPlot} from "./plots.js";
import {getJson} from "./server.js";
import {frameSize} from "./stage.js";
import {app, layerNow, on, tell} from "./store.js";

let shown = null, fault = ""; // the last reading of the pin
const pause = ms => new Promise(done => setTimeout(done, ms));
async function read(x, y, spectrum) {
    return getJson(`api/probe?${new URLSearchParams({x, y, layer: layerNow(), ...spectrum ? {spectrum: 1} : {}})}`);
}

const readHover = latest(async pixel => {
    if (!pixel || app.hover?.x !== pixel[0] || app.hover?.y !== pixel[1]) return;
    try {
        const reading = await read(...pixel, false);
        if (app.hover?.x === pixel[0] && app.hover?.y === pixel[1]) { app.hover.reading = reading; tell("hover"); }
    } catch { /* the short reading has the screen's codes alone, then */ }
    await pause(40);
});
export function hoverAt(pixel) {
    if (pixel && app.hover?.x === pixel[0] && app.hover?.y === pixel[1]) return;
    if (!pixel && !app.hover) return;
    app.hover = pixel ? {x: pixel[0], y: pixel[1], reading: null} : null;
    tell("hover");
    if (pixel && app.state?.picture) readHover(pixel);
}

const readPin = latest(async () => {
    const {pin} = app;
    if (!pin) return;
    try {
        const reading = await read(pin.x, pin.y, true);
        if (app.pin !== pin) return;
        if (reading) shown = reading;
        else setTimeout(() => { if (app.pin === pin) readPin(); }, 300); // the picture has only begun
        fault = "";
    } catch (error) {
        if (app.pin !== pin) return;
        fault = error.message;
    }
    tell("probed");
    // At most once a second, but a new pin does not wait.
    for (let i = 0; i < 20 && app.pin === pin; ++i) await pause(50);
});
export function pinAt(pixel) {
    app.pin = pixel ? {x: pixel[0], y: pixel[1]} : null;
    shown = null;
    fault = "";
    tell("pin");
    tell("probed");
    if (pixel) {
        readPin();
        byId("section-probe").open = true;
    }
}
export function movePin(dx, dy) {
    if (!app.pin) return false;
    const {width, height} = frameSize();
    pinAt([Math.max(0, Math.min(width - 1, app.pin.x + dx)), Math.max(0, Math.min(height - 1, app.pin.y + dy))]);
    return true;
}

// The short reading at the right of the status line.
function readout() {
    const {hover} = app;
    if (!hover) return "";
    const codes = live.codesAt(hover.x + 0.5, hover.y + 0.5), {rgb, object} = hover.reading ?? {};
    const values = rgb ? rgb.map(v => significant(v, 3)).join("  ") : codes ? `screen ${codes.join(" ")}` : "";
    return `${hover.x}, ${hover.y}  ${values}${object ? `  ${object}` : ""}`;
}

const channels = ["R", "G", "B"];
function valuesTable(reading) {
    const {rgb = [], error = []} = reading, single = rgb.length === 1;
    return make("table", {class: "values"}, make("tbody", {}, rgb.map((v, i) => {
        const words = withError(v, error?.[i]);
        return make("tr", {}, make("th", {scope: "row"}, single ? "value" : channels[i] ?? String(i + 1)), make("td", {}, words.value), make("td", {class: "soft"}, words.error));
    })));
}
const withUnit = (value, error, unit) => { const words = withError(value, error); return isNumber(value) ? `${words.value} ${words.error} ${unit ?? ""}`.replace(/ +/g, " ").trim() : ""; };

export function startProbe() {
    const hint = make("p", {class: "soft"}, "Click a pixel, or press Enter on the picture."), where = make("p", {class: "name"}), swatch = make("canvas", {class: "swatch", width: 1, height: 1, "aria-hidden": "true"});
    const values = make("div"), facts = factsList(), plot = make("div", {class: "drawing"}), caption = make("p", {class: "soft caption"}), trouble = make("p", {class: "trouble", dir: "auto", role: "alert"});
    const body = make("div", {}, make("div", {class: "row"}, swatch, where,
        make("button", {type: "button", class: "quiet end", id: "probe-copy", onclick: () => shown && copy(JSON.stringify(shown), "the reading as JSON")}, "Copy"),
        make("button", {type: "button", class: "quiet", id: "probe-close", "aria-label": "No pin", title: "No pin (Esc)", onclick: () => pinAt(null)}, "✕")), trouble, values, facts.list, plot, caption);
    section("probe", "Pixel", hint, body);

    function drawSpectrum() {
        const width = Math.max(200, plot.clientWidth), made = shown?.spectrum ? spectrumPlot(shown.spectrum, shown.spectrum_unit ?? "", width) : null;
        plot.replaceChildren(...made ? [made.svg] : []);
        say(caption, made ? "The band is the standard error." : shown && shown.spectrum === null ? "No spectrum of this layer." : "");
        if (made) made.svg.addEventListener("pointermove", event => {
            const p = made.at((event.clientX - made.svg.getBoundingClientRect().left) * made.box.width / made.svg.clientWidth);
            say(caption, `${Math.round(p[0])} nm: ${withUnit(p[1], p[2], shown.spectrum_unit)}`);
        });
    }
    function color() {
        const codes = app.pin && live.codesAt(app.pin.x + 0.5, app.pin.y + 0.5), context = swatch.getContext("2d");
        swatch.hidden = !codes;
        if (codes) { context.fillStyle = `rgb(${codes.join()})`; context.fillRect(0, 0, 1, 1); }
    }
    function show() {
        hint.hidden = Boolean(app.pin);
        body.hidden = !app.pin;
        if (!app.pin) return;
        say(where, `${app.pin.x}, ${app.pin.y}`);
        say(trouble, fault);
        trouble.hidden = !fault;
        color();
        const r = shown ?? {}, unit = r.unit ?? "";
        values.replaceChildren(shown ? valuesTable(r) : make("p", {class: "soft"}, fault ? "" : "Reading…"));
        facts.set([["space", r.space], ["luminance", isNumber(r.luminance) ? withUnit(r.luminance, isNumber(r.relative_error) ? r.relative_error * Math.abs(r.luminance) : null, unit) : ""],
                   ["relative error", isNumber(r.relative_error) ? percent(r.relative_error) : ""], ["samples", r.samples], ["object", r.object], ["material", r.material],
                   ["depth", isNumber(r.depth) ? `${significant(r.depth, 4)} m` : ""], ["position", r.position ? `${point(r.position)} m` : ""]]);
        drawSpectrum();
    }
    on("probed", show);
    on("picture", color);
    let version = null, layer = null;
    on("state look", () => {
        if (!app.pin || (app.state?.picture?.version === version && layerNow() === layer)) return;
        version = app.state?.picture?.version;
        layer = layerNow();
        readPin();
    });
    on("hover picture", () => say(byId("readout"), readout()));
    new ResizeObserver(() => { if (app.pin && +plot.dataset.width !== plot.clientWidth) { plot.dataset.width = plot.clientWidth; drawSpectrum(); } }).observe(plot);
    show();
}
