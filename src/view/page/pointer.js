// Mouse, pen and fingers on the stage. What dragging does is the tool's affair; the middle button, and the space bar held,
// move the picture whatever the tool is.
//   camera: drag orbits, Shift or the right button pans, Ctrl dollies; wheel dollies (Alt: zooms the picture)
//   look:   drag moves the picture, Ctrl zooms; wheel zooms to the pointer (Alt: dollies)
//   region: drag chooses what is rendered; a click chooses the whole frame
// One finger does as the left button; two pan and pinch the camera, or the picture.
import {byId, notify} from "./dom.js";
import {post} from "./server.js";
import {dollyBy, move, orbitBy} from "./camera.js";
import {hoverAt, pinAt} from "./probe.js";
import {drawing, frameSize, framePoint, heightsPerPixel, panBy, pixelAt, redraw, zoomBy} from "./stage.js";
import {app, on, setLook, toolNow} from "./store.js";

const stage = byId("stage"), fingers = new Map();
let drag = null, before = "camera";
export const held = {space: false};

export const panCamera = (dx, dy) => move("pan", [dx * heightsPerPixel(), dy * heightsPerPixel()]);

export function chooseTool(tool) {
    if (tool === "region") before = toolNow() === "region" ? before : toolNow();
    setLook({tool});
}
export async function setRegion(region) {
    try {
        await post("api/region", region ? {x0: region[0], y0: region[1], x1: region[2], y1: region[3]} : {});
    } catch (error) {
        notify(`No region: ${error.message}`, error.help);
    }
}

function actionOf(event) {
    if (event.button === 1 || held.space) return "picture";
    const tool = toolNow();
    if (tool === "region") return event.button === 0 ? "region" : "picture";
    const zooming = event.ctrlKey || event.metaKey;
    if (tool === "look") return zooming ? "zoom" : "picture";
    return event.button === 2 || event.shiftKey ? "pan" : zooming ? "dolly" : "orbit";
}
// Whole pixels, inside the frame, at least one.
function bandOf([ax, ay], [bx, by]) {
    const {width, height} = frameSize(), side = (a, b, most) => {
        const low = Math.max(0, Math.min(most - 1, Math.floor(Math.min(a, b))));
        return [low, Math.max(low + 1, Math.min(most, Math.ceil(Math.max(a, b))))];
    };
    const [x0, x1] = side(ax, bx, width), [y0, y1] = side(ay, by, height);
    return [x0, y0, x1, y1];
}
const apply = {
    picture: panBy, orbit: orbitBy, pan: panCamera,
    dolly: (dx, dy) => dollyBy(Math.exp(0.006 * dy)),
    zoom: (dx, dy) => zoomBy(Math.exp(-0.006 * dy), drag.startX, drag.startY),
    region(dx, dy, event) { drawing.band = bandOf(drag.from, framePoint(event.clientX, event.clientY)); redraw(); },
};

function down(event) {
    if (event.target.closest("#divider, .messages, button, a")) return;
    stage.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (fingers.size === 2) { cancelDrag(); return; }
    if (fingers.size > 2) return;
    drag = {action: actionOf(event), x: event.clientX, y: event.clientY, startX: event.clientX, startY: event.clientY, moved: false, from: framePoint(event.clientX, event.clientY), button: event.button};
    stage.dataset.drag = drag.action;
}
// Fingers and hands shake: less than that is a click.
const slack = event => event.pointerType === "mouse" ? 3 : 8;
function moved(event) {
    if (fingers.size >= 2 && fingers.has(event.pointerId)) { pinch(event); return; }
    if (!drag) {
        if (event.pointerType !== "touch") hoverAt(event.target.closest("#divider, .messages, button") ? null : pixelAt(event.clientX, event.clientY));
        return;
    }
    if (!drag.moved && Math.hypot(event.clientX - drag.startX, event.clientY - drag.startY) < slack(event)) return;
    drag.moved = true;
    const dx = event.clientX - drag.x, dy = event.clientY - drag.y;
    Object.assign(drag, {x: event.clientX, y: event.clientY});
    apply[drag.action](dx, dy, event);
}
function pinch(event) {
    const spread = () => { const [a, b] = [...fingers.values()]; return {x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2, size: Math.max(20, Math.hypot(a[0] - b[0], a[1] - b[1]))}; };
    const old = spread();
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    const now = spread(), factor = now.size / old.size, dx = now.x - old.x, dy = now.y - old.y;
    if (toolNow() === "camera") {
        if (factor !== 1) dollyBy(1 / factor);
        if (dx || dy) panCamera(dx, dy);
    } else {
        zoomBy(factor, old.x, old.y);
        panBy(dx, dy);
    }
}
function up(event) {
    fingers.delete(event.pointerId);
    if (!drag || event.type === "pointercancel") { cancelDrag(); return; }
    const {action, moved: far, button} = drag, band = drawing.band, pixel = pixelAt(event.clientX, event.clientY);
    cancelDrag();
    if (action === "region") {
        setRegion(far && band ? band : null);
        chooseTool(before);
    } else if (!far && button === 0 && action !== "zoom" && action !== "dolly" && pixel) pinAt(pixel);
}
export function cancelDrag() {
    const dragging = Boolean(drag);
    drag = null;
    delete stage.dataset.drag;
    if (drawing.band) { drawing.band = null; redraw(); }
    return dragging;
}
export function leaveRegion() {
    if (app.look.tool !== "region") return false;
    chooseTool(before);
    return true;
}

function wheel(event) {
    if (event.target.closest(".messages")) return;
    event.preventDefault();
    const lines = [1, 16, 400][event.deltaMode] ?? 1, turn = Math.max(-240, Math.min(240, (event.deltaY || event.deltaX) * lines));
    if (turn === 0) return;
    // Pinching on a touch pad comes as a wheel with Ctrl: it is the picture that one pinches.
    const zooms = event.ctrlKey || (toolNow() === "camera") === event.altKey;
    if (zooms) zoomBy(Math.exp(-turn * (event.ctrlKey ? 0.008 : 0.0022)), event.clientX, event.clientY);
    else dollyBy(Math.exp(turn * 0.0011));
}

export function startPointer() {
    stage.addEventListener("pointerdown", down);
    stage.addEventListener("mousedown", event => { if (event.button === 1) event.preventDefault(); }); // no scrolling by itself
    stage.addEventListener("pointermove", moved);
    stage.addEventListener("pointerup", up);
    stage.addEventListener("pointercancel", up);
    stage.addEventListener("pointerleave", () => { if (!drag) hoverAt(null); });
    stage.addEventListener("wheel", wheel, {passive: false});
    stage.addEventListener("contextmenu", event => { if (!event.target.closest(".messages")) event.preventDefault(); });
    stage.addEventListener("auxclick", event => event.preventDefault());
    on("look state", () => { stage.dataset.tool = toolNow(); });
}
