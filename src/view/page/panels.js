// Sections of the panel, and what was read of the scene. A section stays as open as it was left in this window.
import {byId, make, say} from "./dom.js";
import {counted, duration, isNumber} from "./format.js";
import {app, on, remember, remembered, setLook} from "./store.js";

export function section(id, title, ...children) {
    const made = make("details", {id: `section-${id}`, class: "section"}, make("summary", {}, make("h2", {}, title)), make("div", {class: "inside"}, children));
    made.open = remembered(`open.${id}`, id !== "scene");
    made.addEventListener("toggle", () => remember(`open.${id}`, made.open));
    byId("panel").append(made);
    return made;
}
// Pairs of a name and a value; values are written anew only where they differ.
export function factsList() {
    const list = make("dl", {class: "facts"}), rows = new Map();
    return {list, set(pairs) {
        for (const [name, value] of pairs) {
            if (!rows.has(name)) {
                const dt = make("dt", {}, name), dd = make("dd", {dir: "auto"});
                list.append(dt, dd);
                rows.set(name, {dt, dd});
            }
            const {dt, dd} = rows.get(name);
            dt.hidden = dd.hidden = value === null || value === undefined || value === "";
            if (!dd.hidden) say(dd, String(value));
        }
    }};
}

const ofReuse = {
    shapes: r => [r.shapes_kept && `${counted(r.shapes_kept, "shape")} kept`, r.shapes_placed && `${r.shapes_placed} placed anew`, r.shapes_loaded && `${r.shapes_loaded} read`].filter(Boolean).join(", "),
    textures: r => [r.textures_kept && `${counted(r.textures_kept, "texture")} kept`, r.textures_read && `${r.textures_read} read`].filter(Boolean).join(", "),
    structure: r => ({kept: "kept", built: "built"})[r.structure] ?? "",
};
// In words for the status line: what the last save did not cost.
export function reuseText(reuse) {
    if (!reuse) return "";
    const first = reuse.seconds?.first_pixels;
    return [reuse.kept ? `kept ${reuse.kept}` : "", isNumber(first) ? `first pixels after ${duration(first)}` : ""].filter(Boolean).join(", ");
}
function startScene() {
    const facts = factsList();
    section("scene", "Scene", facts.list);
    on("state", () => {
        const {scene = {}, save, reuse, frame = {}, elapsed} = app.state, seconds = reuse?.seconds ?? {};
        facts.set([["scene", scene.name], ["file", scene.path], ["frame", frame.width ? `${frame.width} × ${frame.height} pixels` : ""],
                   ["region", frame.region ? `${frame.region[2] - frame.region[0]} × ${frame.region[3] - frame.region[1]} pixels from ${frame.region[0]}, ${frame.region[1]}` : ""],
                   ["loaded", isNumber(save) ? save === 1 ? "once" : `${save} times` : ""], ["shapes", reuse ? ofReuse.shapes(reuse) : ""], ["textures", reuse ? ofReuse.textures(reuse) : ""],
                   ["ray structure", reuse ? ofReuse.structure(reuse) : ""], ["kept", reuse?.kept], ["reading", isNumber(seconds.read) ? duration(seconds.read) : ""],
                   ["building", isNumber(seconds.build) ? duration(seconds.build) : ""], ["ray structure’s time", isNumber(seconds.commit) ? duration(seconds.commit) : ""],
                   ["first pixels after", isNumber(seconds.first_pixels) ? duration(seconds.first_pixels) : ""], ["rendering for", isNumber(elapsed) ? duration(Math.floor(elapsed)) : ""]]);
    });
}

export const togglePanel = () => setLook({panel: !app.look.panel});
export function startPanels(sections) {
    for (const start of sections) start();
    startScene();
    const follow = () => {
        byId("panel").hidden = !app.look.panel;
        byId("panel-button").setAttribute("aria-pressed", app.look.panel);
    };
    byId("panel-button").addEventListener("click", togglePanel);
    on("look", follow);
    follow();
}
