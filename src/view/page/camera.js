// Moves of the camera, and its place in words. One request is under way at a time: what the hand does meanwhile is added up,
// so that the camera never trails behind by a queue of small steps.
import {byId, copy, make, notify, say} from "./dom.js";
import {post} from "./server.js";
import {section} from "./panels.js";
import {app, movable, on, tell} from "./store.js";

const waiting = []; // moves in order, no two neighbours of one kind
let busy = false;

const added = {
    orbit: (a, b) => a.map((v, i) => v + b[i]), pan: (a, b) => a.map((v, i) => v + b[i]), fly: (a, b) => a.map((v, i) => v + b[i]),
    dolly: (a, b) => a * b, reset: () => true,
};
async function work() {
    busy = true;
    while (waiting.length) {
        try {
            const camera = await post("api/camera", waiting.shift());
            // The answer is the camera as it stands, sooner than the next event.
            if (app.state && camera?.from) { app.state.camera = camera; tell("state"); }
        } catch (error) {
            waiting.length = 0;
            if (error.status !== 0) notify(`The camera did not move: ${error.message}`, error.help);
        }
    }
    busy = false;
}
export function move(kind, value) {
    if (!movable()) return;
    const last = waiting[waiting.length - 1];
    if (last && kind in last) last[kind] = added[kind](last[kind], value);
    else waiting.push({[kind]: value});
    if (!busy) work();
}
// Radians for each pixel of the window: half a turn in about 450.
export const orbitBy = (dx, dy) => move("orbit", [dx * 0.007, dy * 0.007]);
export const dollyBy = factor => move("dolly", Math.max(0.02, Math.min(50, factor)));
export const resetCamera = () => move("reset", true);
export function copyCamera() {
    const lines = app.state?.camera?.lines;
    if (lines) copy(lines, "the camera’s lines");
    else notify("There is no camera to copy yet");
}

export function startCamera() {
    const name = make("p", {class: "name", dir: "auto"}), lines = make("pre", {tabindex: "0", "aria-label": "Lines of the camera for the scene file"}), note = make("p", {class: "soft"});
    const reset = make("button", {type: "button", id: "camera-reset", onclick: resetCamera, title: "As in the scene file (Home)"}, "As in the file");
    section("camera", "Camera", name, lines, note,
            make("div", {class: "row"}, make("button", {type: "button", id: "camera-copy", onclick: copyCamera, title: "For the scene file (Shift+C)"}, "Copy lines"), reset));
    on("state", () => {
        const camera = app.state.camera ?? {};
        say(name, `${camera.name || "camera"}${camera.type && camera.type !== camera.name ? `, ${camera.type}` : ""}`);
        say(lines, camera.lines || "–");
        say(note, camera.movable === false ? "This camera cannot be moved here; dragging moves the picture." : camera.moved ? "Moved; the scene file is as it was." : "");
        note.hidden = !note.textContent;
        reset.disabled = !camera.moved;
        byId("tool-camera").disabled = camera.movable === false;
    });
}
