// The stage: pictures on a neutral ground, zoomed and moved, with the grid of pixels, the wipe, the region and the probe's
// mark. Positions are pixels of the frame (x to the right, y down); the zoom is pixels of the screen's own for each of them.
import {byId} from "./dom.js";
import {live, other, setShrink} from "./picture.js";
import {app, on, setLook, tell} from "./store.js";

const canvas = byId("canvas"), stage = byId("stage"), context = canvas.getContext("2d");
// (x, y) is what the middle of the stage shows; `fit` follows the stage's size.
const sight = {fit: true, zoom: 1, x: 0, y: 0};
let density = 1, due = false;
export const drawing = {band: null}; // the region being dragged, in frame pixels [x0, y0, x1, y1]

export function frameSize() {
    const {width = 0, height = 0} = app.state?.frame ?? {};
    return width > 0 && height > 0 ? {width, height} : {width: live.frameWidth || 1, height: live.frameHeight || 1};
}
const largest = 256, gridFrom = 12;
function fitZoom() {
    const {width, height} = frameSize(), margin = 2 * Math.round(Math.min(16, stage.clientWidth / 50) * density);
    return Math.min(32 * density, Math.max(1, canvas.width - margin) / width, Math.max(1, canvas.height - margin) / height);
}
export const zoomNow = () => sight.fit ? fitZoom() : sight.zoom;
function middle() {
    const {width, height} = frameSize();
    return sight.fit ? {x: width / 2, y: height / 2} : sight;
}
// The picture's upper left corner in pixels of the screen, whole ones where no pixel is cut in two.
function corner() {
    const zoom = zoomNow(), {x, y} = middle(), left = canvas.width / 2 - x * zoom, top = canvas.height / 2 - y * zoom;
    return zoom >= 1 ? [Math.round(left), Math.round(top)] : [left, top];
}
// The frame's point under a point of the window, not rounded.
export function framePoint(clientX, clientY) {
    const box = canvas.getBoundingClientRect(), [left, top] = corner(), zoom = zoomNow();
    return [((clientX - box.left) * density - left) / zoom, ((clientY - box.top) * density - top) / zoom];
}
export function pixelAt(clientX, clientY) {
    const [x, y] = framePoint(clientX, clientY).map(Math.floor), {width, height} = frameSize();
    return x >= 0 && y >= 0 && x < width && y < height ? [x, y] : null;
}
// Picture heights for each pixel of the window.
export const heightsPerPixel = () => density / (zoomNow() * frameSize().height);

// Some of the picture stays on the stage.
function settle() {
    const {width, height} = frameSize();
    sight.x = Math.max(0, Math.min(width, sight.x));
    sight.y = Math.max(0, Math.min(height, sight.y));
    redraw();
}
function leaveFit() {
    if (sight.fit) Object.assign(sight, {...middle(), zoom: fitZoom(), fit: false});
}
export function fit() { sight.fit = true; redraw(); }
export function zoomTo(zoom, clientX = null, clientY = null) {
    const box = canvas.getBoundingClientRect(), px = clientX ?? box.left + box.width / 2, py = clientY ?? box.top + box.height / 2, [x, y] = framePoint(px, py);
    leaveFit();
    sight.zoom = Math.max(Math.min(fitZoom(), 1) / 8, Math.min(largest * density, zoom));
    sight.x = x - ((px - box.left) * density - canvas.width / 2) / sight.zoom;
    sight.y = y - ((py - box.top) * density - canvas.height / 2) / sight.zoom;
    settle();
}
export const zoomBy = (factor, clientX, clientY) => zoomTo(zoomNow() * factor, clientX, clientY);
export const oneToOne = (clientX, clientY) => zoomTo(1, clientX, clientY);
export const isOneToOne = () => !sight.fit && sight.zoom === 1;
export const isFit = () => sight.fit;
// By pixels of the window.
export function panBy(dx, dy) {
    leaveFit();
    sight.x -= dx * density / sight.zoom;
    sight.y -= dy * density / sight.zoom;
    settle();
}
export const middlePixel = () => { const {x, y} = middle(), {width, height} = frameSize(); return [Math.min(width - 1, Math.floor(x)), Math.min(height - 1, Math.floor(y))]; };

function paint(picture, left, top, width, height) {
    if (!picture.bitmap) return;
    const scale = width / picture.width;
    // Coarse first pictures are smooth; pixels of the finished size keep their edges.
    context.imageSmoothingEnabled = scale < 1 || picture.cell > 1;
    context.imageSmoothingQuality = scale < 1 ? "medium" : "low";
    context.drawImage(picture.bitmap, left, top, width, height);
}
function clipped(x0, x1, painting) {
    context.save();
    context.beginPath();
    context.rect(x0, 0, x1 - x0, canvas.height);
    context.clip();
    painting();
    context.restore();
}
function grid(left, top, zoom, frame) {
    const x0 = Math.max(0, Math.floor(-left / zoom)), x1 = Math.min(frame.width, Math.ceil((canvas.width - left) / zoom));
    const y0 = Math.max(0, Math.floor(-top / zoom)), y1 = Math.min(frame.height, Math.ceil((canvas.height - top) / zoom));
    context.beginPath();
    for (let x = x0; x <= x1; ++x) { context.moveTo(Math.round(left + x * zoom) + 0.5, top + y0 * zoom); context.lineTo(Math.round(left + x * zoom) + 0.5, top + y1 * zoom); }
    for (let y = y0; y <= y1; ++y) { context.moveTo(left + x0 * zoom, Math.round(top + y * zoom) + 0.5); context.lineTo(left + x1 * zoom, Math.round(top + y * zoom) + 0.5); }
    context.lineWidth = 1;
    context.strokeStyle = "rgba(128,128,128,.4)";
    context.stroke();
}
// Dark and light, so that it is seen on anything.
function outline(x, y, width, height, dash) {
    context.lineWidth = Math.max(1, Math.round(density));
    for (const [color, offset] of [["#000", 0], ["#fff", dash]]) {
        context.setLineDash(dash ? [dash, dash] : []);
        context.lineDashOffset = offset;
        context.strokeStyle = color;
        if (!dash && color === "#fff") context.strokeRect(x + context.lineWidth, y + context.lineWidth, Math.max(0, width - 2 * context.lineWidth), Math.max(0, height - 2 * context.lineWidth));
        else context.strokeRect(x, y, width, height);
    }
    context.setLineDash([]);
}

function render() {
    due = false;
    const frame = frameSize(), zoom = zoomNow(), [left, top] = corner(), {look, state, pin} = app;
    const width = frame.width * zoom, height = frame.height * zoom;
    context.clearRect(0, 0, canvas.width, canvas.height);
    const wiped = look.compare === "wipe" && other.bitmap, cut = Math.round(look.wipe * canvas.width);
    if (wiped) {
        clipped(0, cut, () => paint(live, left, top, width, height));
        clipped(cut, canvas.width, () => paint(other, left, top, width, height));
    } else paint(look.compare === "flip" && other.bitmap ? other : live, left, top, width, height);
    if (live.bitmap && zoom >= gridFrom * density) grid(left, top, zoom, frame);
    const at = (x0, y0, x1, y1) => [Math.round(left + x0 * zoom) + 0.5, Math.round(top + y0 * zoom) + 0.5, Math.round((x1 - x0) * zoom), Math.round((y1 - y0) * zoom)];
    const region = drawing.band ?? state?.frame?.region;
    if (region) outline(...at(...region), 6 * density);
    if (pin) {
        const room = Math.max(0, (9 * density / zoom - 1) / 2);
        outline(...at(pin.x - room, pin.y - room, pin.x + 1 + room, pin.y + 1 + room), 0);
    }
    setShrink(zoom);
    tell("sight");
}
export function redraw() {
    if (due) return;
    due = true;
    requestAnimationFrame(render);
}

export function startStage() {
    new ResizeObserver(() => {
        density = devicePixelRatio || 1;
        canvas.width = Math.max(1, Math.round(stage.clientWidth * density));
        canvas.height = Math.max(1, Math.round(stage.clientHeight * density));
        render();
    }).observe(stage);
    on("picture look state pin", redraw);
    on("look", () => { document.documentElement.dataset.surround = app.look.surround; });
}
const surrounds = ["dark", "middle", "light"];
export function nextSurround() {
    const now = app.look.surround || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "middle");
    setLook({surround: surrounds[(surrounds.indexOf(now) + 1) % 3]});
}
