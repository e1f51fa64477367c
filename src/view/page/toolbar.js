// The bar at the top: tool, zoom, layer, view, exposure, denoiser.
import {attribute, byId, notify, options, say} from "./dom.js";
import {signedStops} from "./format.js";
import {live} from "./picture.js";
import {chooseTool} from "./pointer.js";
import {fit, isFit, isOneToOne, oneToOne, zoomNow} from "./stage.js";
import {app, denoiserNow, layerNow, movable, on, setLook, toolNow, viewNow} from "./store.js";

const toExposure = stops => setLook({exposure: Math.max(-10, Math.min(10, Math.round(10 * stops) / 10))});
export const exposeBy = stops => toExposure(app.look.exposure + stops);
export const resetExposure = () => toExposure(0);
export function chooseLayer(index) {
    const {layers = []} = app.state ?? {};
    if (layers[index]) setLook({layer: layers[index]});
}
export function stepLayer(by) {
    const {layers = []} = app.state ?? {};
    if (layers.length) chooseLayer((layers.indexOf(layerNow()) + by + layers.length) % layers.length);
}
export function toggleDenoise() {
    if (!denoiserNow()) { notify("There is no denoiser", app.state?.denoiser_missing ?? ""); return; }
    setLook({denoise: !app.look.denoise});
}

const numbered = (name, i) => i < 10 ? `${(i + 1) % 10}  ${name}` : name;

// Arrow keys go from button to button, as in every tool bar.
function arrows(event) {
    const step = {ArrowLeft: -1, ArrowRight: 1}[event.key], button = event.target.closest("button");
    if (!step || !button) return;
    const all = [...byId("bar").querySelectorAll("button:not(:disabled), select:not(:disabled)")].filter(e => e.getClientRects().length);
    all[(all.indexOf(button) + step + all.length) % all.length]?.focus();
    event.preventDefault();
    event.stopPropagation();
}

export function startToolbar() {
    const layer = byId("layer"), view = byId("view"), exposure = byId("exposure"), tools = ["camera", "look", "region"];
    for (const tool of tools) byId(`tool-${tool}`).addEventListener("click", () => chooseTool(tool));
    byId("fit").addEventListener("click", fit);
    byId("one").addEventListener("click", () => oneToOne());
    byId("denoise").addEventListener("click", toggleDenoise);
    layer.addEventListener("change", () => setLook({layer: layer.value}));
    view.addEventListener("change", () => setLook({view: view.value}));
    exposure.addEventListener("input", () => toExposure(+exposure.value));
    for (const e of [exposure, byId("stops")]) e.addEventListener("dblclick", resetExposure);
    byId("bar").addEventListener("keydown", arrows);
    const show = () => {
        const {look, state} = app, {layers = [], views = []} = state ?? {};
        for (const tool of tools) attribute(byId(`tool-${tool}`), "aria-checked", toolNow() === tool);
        options(layer, layers, layers.map(numbered), layerNow());
        options(view, views, views, viewNow());
        if (+exposure.value !== look.exposure) exposure.value = look.exposure;
        say(byId("stops"), signedStops(look.exposure));
        attribute(exposure, "aria-valuetext", `${signedStops(look.exposure)} stops`);
        attribute(byId("denoise"), "aria-pressed", Boolean(look.denoise && denoiserNow()));
        attribute(byId("denoise"), "title", denoiserNow() ? `Denoise what is shown, by ${denoiserNow()} (D)` : `No denoiser: ${state?.denoiser_missing ?? "none was built in"}`);
        attribute(byId("tool-camera"), "title", state && !movable() ? "This camera cannot be moved here" : "Camera: dragging orbits, the wheel dollies (C)");
    };
    on("state look", show);
    on("sight", () => {
        const zoom = zoomNow();
        say(byId("zoom"), !live.bitmap ? "–" : zoom >= 10 ? `${Math.round(zoom)}×` : `${Math.round(100 * zoom)} %`);
        attribute(byId("fit"), "aria-pressed", isFit());
        attribute(byId("one"), "aria-pressed", isOneToOne());
    });
}
