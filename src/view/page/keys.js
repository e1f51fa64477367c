// All keys, in one table: what they do, and what the sheet of `?` says of them.
import {byId, make} from "./dom.js";
import {copyCamera, dollyBy, move, orbitBy, resetCamera} from "./camera.js";
import {keepPresent, setCompare} from "./compare.js";
import {closeMessages, toggleMessages} from "./messages.js";
import {togglePanel} from "./panels.js";
import {cancelDrag, chooseTool, held, leaveRegion, panCamera, setRegion} from "./pointer.js";
import {movePin, pinAt} from "./probe.js";
import {restart, snapshot, togglePause} from "./status.js";
import {fit, middlePixel, nextSurround, oneToOne, isOneToOne, panBy, zoomBy} from "./stage.js";
import {app, setLook, toolNow} from "./store.js";
import {chooseLayer, exposeBy, resetExposure, stepLayer, toggleDenoise} from "./toolbar.js";

const orbiting = () => toolNow() === "camera";
const arrow = (x, y) => event => {
    if (event.altKey) movePin(x, y);
    else if (orbiting()) event.shiftKey ? panCamera(40 * x, 40 * y) : orbitBy(24 * x, 24 * y);
    else panBy(-60 * x, -60 * y);
};
const bare = () => { document.documentElement.toggleAttribute("data-bare"); };

const directions = [["ArrowLeft", -1, 0], ["ArrowRight", 1, 0], ["ArrowUp", 0, -1], ["ArrowDown", 0, 1]];
const arrowKeys = before => directions.map(([key]) => before + key);

// [keys, what the sheet shows, what it says, action]; "Shift+" is told where it matters.
const groups = [
    ["Tools", [
        [["c"], "C", "camera: drag orbits, right drag pans, Ctrl drag and wheel dolly", () => chooseTool("camera")],
        [["v"], "V", "look: drag moves the picture, wheel zooms", () => chooseTool("look")],
        [["r"], "R", "region: drag what is to be rendered, click for the whole", () => chooseTool("region")],
        [["Shift+r"], "Shift R", "render the whole frame", () => setRegion(null)],
        [[], "Space drag", "moves the picture in every tool, as the middle button does", null],
        [[], "Alt wheel", "zooms where the wheel dollies, and the other way round", null]]],
    ["Pixel", [
        [[], "click", "probes a pixel", null],
        [["Enter"], "Enter", "probes the pixel in the middle", () => pinAt(middlePixel())],
        [arrowKeys("Alt+"), "Alt Arrows", "moves the probe by a pixel", null]]],
    ["Rendering", [
        [["p"], "P", "pause, go on", togglePause],
        [["Shift+p"], "Shift P", "render again", restart],
        [["s"], "S", "snapshot: EXR and PNG", snapshot]]],
    ["Picture", [
        [["f"], "F", "the whole picture", fit],
        [["z"], "Z", "pixel by pixel, and back", () => isOneToOne() ? fit() : oneToOne()],
        [["+", "="], "+", "larger", () => zoomBy(1.25)],
        [["-"], "−", "smaller", () => zoomBy(0.8)],
        [["e"], "E", "half a stop brighter", () => exposeBy(0.5)],
        [["Shift+e"], "Shift E", "half a stop darker", () => exposeBy(-0.5)],
        [["x"], "X", "the camera’s own exposure", resetExposure],
        [["1", "2", "3", "4", "5", "6", "7", "8", "9", "0"], "1…0", "layers", event => chooseLayer((+event.key + 9) % 10)],
        [["["], "[", "layer before", () => stepLayer(-1)],
        [["]"], "]", "layer after", () => stepLayer(1)],
        [["d"], "D", "denoise", toggleDenoise],
        [["g"], "G", "next grey around it", nextSurround]]],
    ["Compare", [
        [["w"], "W", "wipe between A and B", () => setCompare("wipe")],
        [["b"], "B", "flip between A and B", () => setCompare("flip")],
        [["m"], "M", "keep this picture as B", keepPresent]]],
    ["Camera", [
        [arrowKeys(""), "Arrows", "orbit, or move the picture", null],
        [arrowKeys("Shift+"), "Shift Arrows", "pan", null],
        [["PageUp"], "PgUp", "nearer", () => dollyBy(0.9)],
        [["PageDown"], "PgDn", "farther", () => dollyBy(1 / 0.9)],
        [["Shift+PageUp"], "Shift PgUp", "fly ahead", () => move("fly", [0, 0, 0.1])],
        [["Shift+PageDown"], "Shift PgDn", "fly back", () => move("fly", [0, 0, -0.1])],
        [["Home"], "Home", "as in the scene file", resetCamera],
        [["Shift+c"], "Shift C", "copy its lines", copyCamera]]],
    ["Page", [
        [["n"], "N", "panel", togglePanel],
        [["i"], "I", "messages", toggleMessages],
        [["h"], "H", "nothing but the picture", bare],
        [["?"], "?", "this sheet", () => toggleHelp()],
        [["Escape"], "Esc", "close, cancel, let go", () => escape()]]],
];
const actions = new Map(groups.flatMap(([, rows]) => rows.flatMap(([keys, , , action]) => keys.map(key => [key, action]))));
for (const [key, x, y] of directions)
    for (const before of ["", "Shift+", "Alt+"]) actions.set(before + key, arrow(x, y));

export function toggleHelp() {
    const sheet = byId("help");
    if (sheet.open) sheet.close();
    else sheet.showModal();
}
// The innermost thing first.
function escape() {
    if (cancelDrag() || leaveRegion() || closeMessages()) return;
    if (document.documentElement.hasAttribute("data-bare")) bare();
    else if (app.pin) pinAt(null);
    else if (app.look.compare !== "off") setLook({compare: "off"});
}

const typing = e => e.matches?.("input:not([type=range]):not([type=radio]), textarea, select");
// Keys that a control needs for itself.
const ofControl = (e, key) => e.matches?.("button, summary, a") ? key === "Enter" || key === " " : e.matches?.("input") ? /^(Arrow|Page|Home|End| )/.test(key) : e.matches?.("pre, ol") && /^(Arrow|Page|Home|End)/.test(key);
function down(event) {
    if (event.defaultPrevented || event.ctrlKey || event.metaKey) return;
    if (typing(event.target)) { if (event.key === "Escape") event.target.blur(); return; }
    if (byId("help").open) { if (event.key === "?") { toggleHelp(); event.preventDefault(); } return; }
    if (ofControl(event.target, event.key)) return;
    if (event.key === " ") {
        held.space = true;
        byId("stage").dataset.space = "";
        event.preventDefault();
        return;
    }
    const letter = event.key.length === 1, key = letter ? event.key.toLowerCase() : event.key, upper = event.shiftKey && (!letter || /[a-z]/.test(key));
    const action = actions.get(`${event.altKey ? "Alt+" : ""}${upper ? "Shift+" : ""}${key}`);
    if (!action || (event.repeat && /^[a-z]$/.test(key) && key !== "e")) return;
    event.preventDefault();
    action(event);
}
function released() {
    held.space = false;
    delete byId("stage").dataset.space;
}

export function startKeys() {
    const sheet = byId("help");
    sheet.append(make("header", {}, make("h2", {id: "help-title"}, "Keys"), make("button", {type: "button", class: "quiet", "aria-label": "Close", onclick: () => sheet.close()}, "✕")),
        make("div", {class: "columns"}, groups.map(([title, rows]) => make("section", {}, make("h3", {}, title), make("dl", {class: "keys"}, rows.map(([, shown, words]) => [make("dt", {}, shown.split(" ").map(k => make(/^[a-z]/.test(k) ? "span" : "kbd", {}, k))), make("dd", {}, words)]))))),
        make("p", {class: "soft"}, "Fingers: one does as the left button; two pan and pinch the camera, or the picture in the tool Look. A tap probes."));
    byId("help-button").addEventListener("click", toggleHelp);
    sheet.addEventListener("click", event => { if (event.target === sheet) sheet.close(); });
    addEventListener("keydown", down);
    addEventListener("keyup", event => { if (event.key === " ") released(); });
    addEventListener("blur", released);
}
