// What all parts of the page know: the program's state as it was heard last, and how the picture is looked at. Parts listen
// to "state", "look", "link", "picture", "hover" and "pin". How one looks is kept in the address, so that a reload, a
// bookmark and a second window show the same.
const initial = {exposure: 0, view: "", layer: "", denoise: false, method: "", tool: "camera", compare: "off", against: "saved", wipe: 0.5, surround: "", panel: true};
const kinds = {tool: ["camera", "look", "region"], compare: ["off", "wipe", "flip"], against: ["saved", "other"], surround: ["", "dark", "middle", "light"]};

export const app = {state: null, link: "connecting", look: {...initial}, hover: null, pin: null};

const listeners = new Map();
export function on(names, listener) {
    for (const name of names.split(" ")) listeners.set(name, [...listeners.get(name) ?? [], listener]);
}
export function tell(name) {
    for (const listener of listeners.get(name) ?? []) listener();
}

function fromFragment() {
    const look = {...initial};
    for (const [key, text] of new URLSearchParams(location.hash.slice(1))) {
        if (!(key in initial)) continue;
        if (typeof initial[key] === "number") { if (text !== "" && Number.isFinite(+text)) look[key] = +text; }
        else if (typeof initial[key] === "boolean") look[key] = text === "1";
        else if (!kinds[key] || kinds[key].includes(text)) look[key] = text;
    }
    look.exposure = Math.max(-10, Math.min(10, look.exposure));
    look.wipe = Math.max(0, Math.min(1, look.wipe));
    if (look.tool === "region") look.tool = "camera"; // it is for one drag
    return look;
}
function toFragment() {
    const kept = new URLSearchParams();
    for (const [key, value] of Object.entries(app.look))
        if (value !== initial[key]) kept.set(key, typeof value === "boolean" ? value ? "1" : "0" : typeof value === "number" ? +value.toFixed(3) : value);
    const text = String(kept);
    if (location.hash.slice(1) !== text) history.replaceState(null, "", location.pathname + location.search + (text ? `#${text}` : ""));
}

let writing = 0;
export function setLook(changes) {
    if (Object.entries(changes).every(([key, value]) => app.look[key] === value)) return;
    Object.assign(app.look, changes);
    // Browsers refuse more than a hundred changes of the address in 10 s.
    if (!writing) writing = setTimeout(() => { writing = 0; toFragment(); }, 200);
    tell("look");
}
export function readLook() {
    app.look = fromFragment();
    addEventListener("hashchange", () => { app.look = fromFragment(); tell("look"); });
}

// What is wished for where the program has it, and else what it has.
export const layerNow = () => { const {layers = []} = app.state ?? {}; return layers.includes(app.look.layer) ? app.look.layer : layers[0] ?? "beauty"; };
export const viewNow = () => { const {views = [], view = ""} = app.state ?? {}; return views.includes(app.look.view) ? app.look.view : view; };
const fast = ["oidn", "preview"]; // those that keep up with a picture that gets better
export const denoiserNow = () => { const names = (app.state?.denoisers ?? []).map(d => d.name); return names.includes(app.look.method) ? app.look.method : fast.find(name => names.includes(name)) ?? names[0] ?? null; };
export const movable = () => Boolean(app.state?.camera?.movable);
export const toolNow = () => app.look.tool === "camera" && app.state && !movable() ? "look" : app.look.tool;
// B of A/B: null where there is none.
export const otherNow = () => app.look.against === "other" ? app.state?.other ? "other" : null : app.state?.saved ? "saved" : null;

// Small things of this window: which sections are open.
export function remembered(key, otherwise) {
    try { return JSON.parse(sessionStorage.getItem(`abbe.view.${key}`)) ?? otherwise; } catch { return otherwise; }
}
export function remember(key, value) {
    try { sessionStorage.setItem(`abbe.view.${key}`, JSON.stringify(value)); } catch { /* a window without storage forgets */ }
}
