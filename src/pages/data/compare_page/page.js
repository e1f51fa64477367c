"use strict";
const facts = JSON.parse(document.getElementById("facts").textContent);
const {width, height} = facts;
const byId = id => document.getElementById(id);
const element = (name, text) => { const e = document.createElement(name); e.textContent = text; return e; };

// The element's base64 as bytes; the element goes, to free its text.
function bytesOf(id) {
    const holder = byId(id), text = atob(holder.textContent.trim());
    holder.remove();
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    return bytes;
}
// Little-endian floats, whatever the machine is.
function floatsOf(bytes) {
    if (new Uint8Array(new Uint16Array([1]).buffer)[0] === 1) return new Float32Array(bytes.buffer);
    const view = new DataView(bytes.buffer), floats = new Float32Array(bytes.length / 4);
    for (let i = 0; i < floats.length; ++i) floats[i] = view.getFloat32(4 * i, true);
    return floats;
}
const images = facts.images.map((image, i) => ({...image, rgb: floatsOf(bytesOf("image" + i))}));
const maps = facts.maps.map((map, i) => ({...map, values: bytesOf("map" + i)}));

const state = {view: "image", left: 0, right: images.length - 1, exposure: 0, wipe: 0.5, zoom: 0, x: width / 2, y: height / 2,
               held: false, pixel: null};
const luminance = (rgb, i) => facts.luminance[0] * rgb[i] + facts.luminance[1] * rgb[i + 1] +
                              facts.luminance[2] * rgb[i + 2];

function autoExposure() {
    const {rgb} = images[images.length - 1];
    let sum = 0, count = 0;
    for (let i = 0; i < rgb.length; i += 3) {
        const y = luminance(rgb, i);
        if (Number.isFinite(y)) { sum += y; ++count; }
    }
    return sum > 0 ? Math.max(-16, Math.min(16, Math.round(4 * Math.log2(0.18 * count / sum)) / 4)) : 0;
}

// Display codes of linear values in steps of 1/4095.
const codes = Uint8Array.from({length: 4096}, (_, i) => {
    const v = i / 4095;
    return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
});
const code = v => codes[v <= 0 ? 0 : v >= 1 ? 4095 : (v * 4095 + 0.5) | 0];

// Dark blue, magenta, orange, pale yellow: lightness grows evenly.
const heatStops = [[8, 6, 30], [90, 20, 110], [190, 50, 90], [245, 140, 40], [252, 250, 190]];
function between(stops, t) {
    const at = Math.max(0, Math.min(1, t)) * (stops.length - 1), i = Math.min(stops.length - 2, Math.floor(at));
    return stops[i].map((v, c) => v + (at - i) * (stops[i + 1][c] - v));
}
const heat = Array.from({length: 256}, (_, i) => between(heatStops, i / 255));
const signedStops = [[60, 150, 255], [30, 60, 110], [20, 20, 20], [120, 55, 20], [255, 160, 60]];
const signed = Array.from({length: 256}, (_, i) => between(signedStops, i / 255));

// Each painter writes the RGBA of the pixel i (its first component is 3 i).
function painterOf(view, left, right) {
    const gain = 2 ** state.exposure, m = facts.toDisplay;
    const show = (out, i, r, g, b) => {
        if (!Number.isFinite(r + g + b)) { out.set([255, 0, 255, 255], 4 * i); return; }
        out[4 * i] = code(gain * (m[0] * r + m[1] * g + m[2] * b));
        out[4 * i + 1] = code(gain * (m[3] * r + m[4] * g + m[5] * b));
        out[4 * i + 2] = code(gain * (m[6] * r + m[7] * g + m[8] * b));
        out[4 * i + 3] = 255;
    };
    const fixed = (out, i, color) => { out[4 * i] = color[0]; out[4 * i + 1] = color[1]; out[4 * i + 2] = color[2];
                                       out[4 * i + 3] = 255; };
    const a = images[left].rgb, b = images[right].rgb;
    if (view === "difference")
        return (out, i) => show(out, i, Math.abs(a[3 * i] - b[3 * i]), Math.abs(a[3 * i + 1] - b[3 * i + 1]),
                                Math.abs(a[3 * i + 2] - b[3 * i + 2]));
    if (view === "signed")
        return (out, i) => {
            const p = luminance(a, 3 * i), q = luminance(b, 3 * i), t = (p - q) / (Math.abs(p) + Math.abs(q) || 1);
            if (Number.isFinite(t)) fixed(out, i, signed[Math.round(127.5 + 127.5 * Math.max(-1, Math.min(1, 4 * t)))]);
            else fixed(out, i, [255, 0, 255]);
        };
    if (view === "flip") {
        const map = mapOf();
        return (out, i) => fixed(out, i, heat[map.values[i]]);
    }
    return (out, i) => show(out, i, a[3 * i], a[3 * i + 1], a[3 * i + 2]);
}
const mapOf = () => maps.find(map => map.image === state.left) || maps[0];

const painted = new Map();
function picture(view, left, right) {
    const key = [view, left, view === "image" ? 0 : right, view === "flip" ? 0 : state.exposure].join();
    let canvas = painted.get(key);
    if (!canvas) {
        canvas = document.createElement("canvas");
        canvas.width = width;
        canvas.height = height;
        const context = canvas.getContext("2d"), data = context.createImageData(width, height);
        const paint = painterOf(view, left, right);
        for (let i = 0; i < width * height; ++i) paint(data.data, i);
        context.putImageData(data, 0, 0);
        if (painted.size >= 6) painted.delete(painted.keys().next().value);
        painted.set(key, canvas);
    }
    return canvas;
}

const canvas = byId("canvas"), context = canvas.getContext("2d");
const fitZoom = () => Math.min(canvas.width / width, canvas.height / height);
const zoomNow = () => state.zoom || fitZoom();

function drawPart(source, x0, x1) {
    if (x1 <= x0) return;
    const zoom = zoomNow();
    context.save();
    context.beginPath();
    context.rect(x0, 0, x1 - x0, canvas.height);
    context.clip();
    context.imageSmoothingEnabled = zoom < 1;
    context.translate(canvas.width / 2 - zoom * state.x, canvas.height / 2 - zoom * state.y);
    context.scale(zoom, zoom);
    context.drawImage(source, 0, 0);
    context.restore();
}

function draw() {
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    const names = [images[state.left].name, images[state.right].name];
    if (state.view === "wipe") {
        const edge = Math.round(state.wipe * canvas.width);
        drawPart(picture("image", state.left, 0), 0, edge);
        drawPart(picture("image", state.right, 0), edge, canvas.width);
        context.fillStyle = "#fff";
        context.fillRect(edge - 1, 0, 2, canvas.height);
    } else {
        drawPart(picture(state.view, state.left, state.right), 0, canvas.width);
    }
    const map = mapOf();
    byId("label").textContent =
        state.view === "image" ? names[0] : state.view === "wipe" ? names.join("  |  ")
        : state.view === "difference" ? "|" + names.join(" − ") + "|"
        : state.view === "signed" ? names.join(" − ") + ", relative"
        : "FLIP: " + images[map.image].name + " against " + images[images.length - 1].name;
    byId("exposure").value = state.exposure;
    byId("stops").textContent = (state.exposure > 0 ? "+" : "") + state.exposure.toFixed(2);
    for (const button of byId("views").children)
        button.setAttribute("aria-pressed", button.dataset.view === state.view &&
                            (state.view !== "image" || +button.dataset.image === state.left));
    drawLegend();
    drawProbe();
}
let waiting = false;
function redraw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; draw(); });
}

function drawLegend() {
    const scales = {flip: [heat, ["0", "0.25", "0.5", "0.75", "1"]], signed: [signed, ["−25 %", "0", "+25 %"]]};
    const scale = scales[state.view];
    byId("legend").hidden = !scale;
    if (!scale) return;
    byId("bar").style.background =
        `linear-gradient(to right, ${scale[0].filter((_, i) => i % 15 === 0).map(c => `rgb(${c})`).join()})`;
    byId("scale").replaceChildren(...scale[1].map(text => element("span", text)));
}

const digits = v => {
    const size = Math.abs(v);
    return !Number.isFinite(v) || v === 0 ? String(v) : size >= 1e-3 && size < 1e6 ? v.toPrecision(5) : v.toExponential(4);
};
function row(name, cells, head) {
    const tr = document.createElement("tr");
    tr.title = name;
    tr.append(element(head ? "th" : "td", name), ...cells.map(text => element(head ? "th" : "td", text)));
    return tr;
}
function drawProbe() {
    const table = byId("probe"), rows = [row("linear", ["R", "G", "B", "Y"], true)];
    byId("where").textContent = "";
    if (state.pixel) {
        const [x, y] = state.pixel, i = y * width + x, block = facts.block;
        byId("where").textContent = block === 1 ? `${x + facts.x0}, ${y + facts.y0}`
            : `mean of ${block}×${block} from ${x * block + facts.x0}, ${y * block + facts.y0}`;
        if (state.held) byId("where").textContent += " (held)";
        const values = image => [...image.rgb.slice(3 * i, 3 * i + 3), luminance(image.rgb, 3 * i)];
        for (const image of images) rows.push(row(image.name, values(image).map(digits)));
        const a = values(images[state.left]), b = values(images[state.right]);
        rows.push(row("difference", a.map((v, c) => digits(v - b[c]))));
        rows.push(row("ratio", a.map((v, c) => digits(v / b[c]))));
        for (const map of maps)
            rows.push(row("FLIP " + images[map.image].name, [(map.values[i] / 255).toFixed(3), "", "", ""]));
    }
    table.replaceChildren(...rows);
}

// Canvas pixels of an event, and the picture's pixel there.
function place(event) {
    const box = canvas.getBoundingClientRect(), ratio = canvas.width / box.width;
    return [(event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio];
}
function pictureAt([u, v]) {
    const zoom = zoomNow();
    return [(u - canvas.width / 2) / zoom + state.x, (v - canvas.height / 2) / zoom + state.y];
}
function probe(at) {
    if (state.held) return;
    const [x, y] = pictureAt(at).map(Math.floor);
    state.pixel = x >= 0 && y >= 0 && x < width && y < height ? [x, y] : null;
}
function zoomBy(factor, at) {
    const before = pictureAt(at);
    state.zoom = Math.max(fitZoom() / 4, Math.min(128, zoomNow() * factor));
    const after = pictureAt(at);
    state.x += before[0] - after[0];
    state.y += before[1] - after[1];
    redraw();
}
function fit() { state.zoom = 0; state.x = width / 2; state.y = height / 2; redraw(); }

let drag = null;
canvas.addEventListener("pointerdown", event => {
    const at = place(event);
    const line = state.view === "wipe" && Math.abs(at[0] - state.wipe * canvas.width) < 10 * (window.devicePixelRatio || 1);
    drag = {at, line};
    canvas.setPointerCapture(event.pointerId);
    canvas.focus();
});
canvas.addEventListener("pointermove", event => {
    const at = place(event);
    if (drag && drag.line) {
        state.wipe = Math.max(0, Math.min(1, at[0] / canvas.width));
    } else if (drag) {
        if (!state.zoom) state.zoom = zoomNow();
        state.x -= (at[0] - drag.at[0]) / state.zoom;
        state.y -= (at[1] - drag.at[1]) / state.zoom;
        drag.at = at;
    }
    probe(at);
    redraw();
});
for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { drag = null; });
canvas.addEventListener("wheel", event => {
    event.preventDefault();
    zoomBy(2 ** (-event.deltaY / 300), place(event));
}, {passive: false});

function show(view, image) {
    if (view === "flip" && !maps.length) return;
    state.view = view;
    if (view === "image" && image !== state.left) { state.right = state.left; state.left = image; }
    redraw();
}
const keys = images.map((_, i) => facts.images[i].key);
function press(key) {
    const middle = [canvas.width / 2, canvas.height / 2], step = 40 / zoomNow();
    const image = keys.indexOf(key.toUpperCase());
    const actions = {
        " ": () => show("image", state.view === "image" ? state.right : state.left),
        w: () => show("wipe"), d: () => show("difference"), s: () => show("signed"), f: () => show("flip"),
        ",": () => { state.exposure = Math.max(-16, state.exposure - 0.25); },
        ".": () => { state.exposure = Math.min(16, state.exposure + 0.25); },
        "+": () => zoomBy(2, middle), "=": () => zoomBy(2, middle), "-": () => zoomBy(0.5, middle),
        "0": fit, "1": () => { state.zoom = 1; }, p: () => { state.held = !state.held; },
        ArrowLeft: () => { state.x -= step; }, ArrowRight: () => { state.x += step; },
        ArrowUp: () => { state.y -= step; }, ArrowDown: () => { state.y += step; },
    };
    const action = image >= 0 ? () => show("image", image) : actions[key.length === 1 ? key.toLowerCase() : key];
    if (!action) return false;
    action();
    redraw();
    return true;
}
window.addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === "INPUT") return;
    if (event.key === " " && event.target.tagName === "BUTTON") return;
    if (press(event.key)) event.preventDefault();
});

function addView(label, view, image, title) {
    const button = element("button", label);
    button.dataset.view = view;
    button.dataset.image = image ?? -1;
    button.title = title;
    button.addEventListener("click", () => show(view, image));
    byId("views").append(button, " ");
}
images.forEach((image, i) => {
    addView(image.name, "image", i, `${image.path} (${image.key})`);
    byId("keys").append(element("kbd", image.key), ` ${image.name}, `);
});
addView("wipe", "wipe", undefined, "one left, one right of a line (W)");
addView("difference", "difference", undefined, "absolute difference, through the exposure (D)");
addView("signed", "signed", undefined, "difference of luminances over their sum (S)");
if (maps.length) addView("FLIP", "flip", undefined, "what an observer sees when the images alternate (F)");
byId("exposure").addEventListener("input", event => { state.exposure = +event.target.value; redraw(); });
byId("auto").addEventListener("click", () => { state.exposure = autoExposure(); redraw(); });
byId("fit").addEventListener("click", fit);
byId("one").addEventListener("click", () => { state.zoom = 1; redraw(); });
new ResizeObserver(redraw).observe(byId("stage"));

const candidates = images.slice(0, facts.figures.length ? facts.figures[0].values.length : 0);
byId("figures").append(row("", candidates.map(image => image.name), true),
                       ...facts.figures.map(figure => row(figure.label, figure.values)));
byId("verdict").textContent = facts.verdict;
byId("note").textContent = facts.note;

// A state in the address: #view=wipe&left=0&right=1&exposure=2&zoom=4&x=10&y=20&wipe=0.3&pixel=12,34
state.exposure = autoExposure();
for (const [name, text] of new URLSearchParams(location.hash.slice(1))) {
    if (name === "view" && ["image", "wipe", "difference", "signed", "flip"].includes(text)) show(text, state.left);
    else if (name === "pixel") {
        const [x, y] = text.split(",").map(Number);
        if (x >= 0 && x < width && y >= 0 && y < height) { state.pixel = [x | 0, y | 0]; state.held = true; }
    } else if (["left", "right"].includes(name) && images[+text]) state[name] = +text;
    else if (["exposure", "wipe", "zoom", "x", "y"].includes(name) && Number.isFinite(+text)) state[name] = +text;
}
draw();
