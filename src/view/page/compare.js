// A/B: A is the picture, B is the one before the last save that changed it, or an EXR below the scene's folder. Wipe shows A
// on the left and B on the right of a line that is dragged; flip shows one or the other in the same place.
import {attribute, byId, make, notify, say} from "./dom.js";
import {section} from "./panels.js";
import {againFor, live, other} from "./picture.js";
import {post} from "./server.js";
import {app, denoiserNow, on, otherNow, setLook} from "./store.js";

export function setCompare(mode) {
    if (app.look.compare === mode) mode = "off";
    if (mode !== "off" && !otherNow()) {
        // What there is decides, before asking people to choose.
        const instead = app.look.against === "other" ? app.state?.saved && "saved" : app.state?.other && "other";
        if (!instead) { notify("There is no B yet", "It is kept when a save changes the picture, by M, or loaded from an EXR."); return; }
        setLook({against: instead});
    }
    setLook({compare: mode});
}
export async function keepPresent() {
    try {
        await post("api/control", {save: true});
        againFor.saved();
        notify("Kept as B");
    } catch (error) {
        notify(`Not kept: ${error.message}`, error.help);
    }
}
const nameOfB = () => otherNow() === "other" ? String(app.state.other.path).split("/").pop() : "last save";

function startDivider() {
    const divider = byId("divider"), stage = byId("stage");
    const to = x => setLook({wipe: Math.max(0, Math.min(1, x))});
    divider.addEventListener("pointerdown", event => { divider.setPointerCapture(event.pointerId); divider.dataset.held = ""; event.preventDefault(); divider.focus(); });
    divider.addEventListener("pointermove", event => {
        if (!("held" in divider.dataset)) return;
        const box = stage.getBoundingClientRect();
        to((event.clientX - box.left) / box.width);
    });
    for (const end of ["pointerup", "pointercancel"]) divider.addEventListener(end, () => delete divider.dataset.held);
    divider.addEventListener("keydown", event => {
        const by = {ArrowLeft: -0.02, ArrowRight: 0.02, PageDown: -0.1, PageUp: 0.1}[event.key], goal = {Home: 0, End: 1}[event.key];
        if (by === undefined && goal === undefined) return;
        to(goal ?? app.look.wipe + by);
        event.preventDefault();
        event.stopPropagation();
    });
    divider.addEventListener("dblclick", () => to(0.5));
    return () => {
        divider.hidden = app.look.compare !== "wipe" || !otherNow();
        divider.style.left = `${100 * app.look.wipe}%`;
        attribute(divider, "aria-valuenow", Math.round(100 * app.look.wipe));
        attribute(divider, "aria-valuetext", `A left of ${Math.round(100 * app.look.wipe)} %, B is ${nameOfB()}`);
    };
}

// Which picture is where, and that it is an old one, at the upper edge of the stage.
function tags() {
    const {look, state} = app, b = otherNow(), found = [];
    if (b && look.compare === "wipe") found.push(["left", "A: now"], ["right", `B: ${nameOfB()}`]);
    else if (b && look.compare === "flip") found.push(["left", `B: ${nameOfB()}`]);
    if (state?.picture?.stale) found.push(["middle", "last good picture"]);
    if (live.late && look.denoise && denoiserNow()) found.push(["middle", `denoising by ${denoiserNow()}…`]);
    if (b && look.compare !== "off" && !other.bitmap) found.push(["middle", "B has no picture yet"]);
    return found;
}

export function startCompare() {
    const choice = (value, label) => make("label", {class: "choice"}, make("input", {type: "radio", name: "against", value, onchange: () => setLook({against: value})}), make("span", {}, label));
    const radios = make("div", {class: "row", role: "radiogroup", "aria-label": "B is"}, choice("saved", "the last save"), choice("other", "an EXR"));
    const path = make("input", {type: "text", id: "other-path", placeholder: "reference.exr", spellcheck: "false", autocomplete: "off", "aria-label": "EXR below the scene’s folder"});
    const trouble = make("p", {class: "trouble", dir: "auto", role: "alert", hidden: true}), soft = make("p", {class: "soft", dir: "auto"});
    async function load(name) {
        trouble.hidden = true;
        try {
            await post("api/other", name ? {path: name} : {});
            if (name) againFor.saved();
            setLook(name ? {against: "other"} : {against: "saved"});
            if (name && app.look.compare === "off") setLook({compare: "wipe"});
        } catch (error) {
            say(trouble, [error.message, error.help].filter(Boolean).join(" – "));
            trouble.hidden = false;
        }
    }
    const drop = make("button", {type: "button", onclick: () => load("")}, "Drop");
    const form = make("form", {class: "row", onsubmit: event => { event.preventDefault(); if (path.value.trim()) load(path.value.trim()); }}, path, make("button", {type: "submit"}, "Load"), drop);
    const mode = (value, label, keys) => make("button", {type: "button", "data-compare": value, "aria-pressed": "false", title: keys, onclick: () => setCompare(value)}, label);
    const modes = make("div", {class: "row"}, mode("wipe", "Wipe", "W"), mode("flip", "Flip", "B"),
        make("button", {type: "button", id: "keep", title: "Keep the present picture as B (M)", onclick: keepPresent}, "Keep this as B"));
    section("compare", "Compare", modes, radios, soft, form, trouble);
    byId("wipe").addEventListener("click", () => setCompare("wipe"));
    byId("flip").addEventListener("click", () => setCompare("flip"));
    const divide = startDivider();
    const show = () => {
        const {look, state} = app;
        for (const button of document.querySelectorAll("#wipe, #flip, [data-compare]")) attribute(button, "aria-pressed", look.compare === (button.dataset.compare ?? button.id));
        for (const radio of radios.querySelectorAll("input")) radio.checked = radio.value === look.against;
        form.hidden = look.against !== "other";
        drop.hidden = !state?.other;
        say(soft, look.against === "other" ? state?.other ? state.other.path : "" : state?.saved ? "The picture before the last save that changed it, or the one you kept." : "None yet: it is kept when a save changes the picture.");
        soft.hidden = !soft.textContent;
        divide();
        const made = tags(), now = JSON.stringify(made), holder = byId("tags");
        if (holder.dataset.now !== now) {
            holder.dataset.now = now;
            holder.replaceChildren(...made.map(([side, text]) => make("span", {class: `tag ${side}`}, make("bdi", {}, text))));
        }
    };
    on("look state picture", show);
}
