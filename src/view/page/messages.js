// What the program has to say of the scene. Errors lie over the lower part of the last good picture and go with the save that
// mends them; warnings and notes wait in a drawer.
import {attribute, byId, copy, make, say} from "./dom.js";
import {counted} from "./format.js";
import {app, on, remember, remembered} from "./store.js";

const atFirst = 40; // so many are shown before one asks for the rest
const plural = {error: "errors", warning: "warnings", note: "notes"};

function place(d) {
    if (!d.file) return null;
    const line = d.line > 0 ? `${d.file}:${d.line}` : d.file, text = d.line > 0 && d.column > 0 ? `${line}:${d.column}` : line;
    return make("button", {type: "button", class: "place", title: `Copy ${line}`, dir: "ltr", onclick: () => copy(line)}, text);
}
// What stands in `back quotes` is code.
const marked = text => text.split(/`([^`\n]+)`/).map((part, i) => i % 2 ? make("code", {}, part) : part);
function item(d) {
    const words = text => String(text ?? "").trim();
    return make("li", {class: `message ${d.severity}`},
        make("p", {class: "head"}, make("span", {class: "severity"}, d.severity), d.code ? make("button", {type: "button", class: "code", title: `Copy “abbe explain ${d.code}”`, onclick: () => copy(`abbe explain ${d.code}`)}, d.code) : null, place(d)),
        make("p", {class: "text", dir: "auto"}, marked(words(d.message))),
        words(d.label) && words(d.label) !== words(d.message) ? make("p", {class: "label", dir: "auto"}, marked(words(d.label))) : null,
        words(d.help) ? make("p", {class: "help", dir: "auto"}, marked(words(d.help))) : null);
}
function listOf(diagnostics) {
    const list = make("ol", {tabindex: "0"}, diagnostics.slice(0, atFirst).map(item)), rest = diagnostics.slice(atFirst);
    if (rest.length) {
        const more = make("li", {class: "more"}, make("button", {type: "button", onclick: () => { more.replaceWith(...rest.map(item)); list.focus(); }}, `${counted(rest.length, "more", "more")}`));
        list.append(more);
    }
    return list;
}
const sum = list => Object.keys(plural).map(s => [s, list.filter(d => d.severity === s).length]).filter(([, n]) => n).map(([s, n]) => counted(n, s, plural[s])).join(", ");

let open = remembered("drawer", false), folded = false;
export function toggleMessages() {
    const errors = (app.state?.diagnostics ?? []).some(d => d.severity === "error");
    if (errors) folded = !folded;
    else { open = !open; remember("drawer", open); }
    show();
}
// For Escape: true if there was something to close.
export function closeMessages() {
    if (byId("drawer").hidden) return false;
    open = false;
    remember("drawer", open);
    show();
    byId("messages-button").focus();
    return true;
}

let heard = "";
function fill() {
    const all = app.state?.diagnostics ?? [], now = JSON.stringify(all);
    if (now === heard) return;
    heard = now;
    const errors = all.filter(d => d.severity === "error"), others = all.filter(d => d.severity !== "error"), stale = app.state.picture?.stale;
    folded = false; // what is new is shown
    const header = (id, title, action, tip, more = "") => make("header", {}, make("h2", {id}, title), make("p", {class: "soft"}, more), make("button", {type: "button", class: "quiet fold", "aria-label": tip, title: tip, onclick: action}));
    byId("errors").replaceChildren(...errors.length ? [header("errors-title", sum(errors), toggleMessages, "Fold or unfold (I)", stale ? "the last good picture stays until a save loads" : "the picture comes with a save that loads"), listOf(errors)] : []);
    byId("drawer").replaceChildren(...others.length ? [header("drawer-title", sum(others), closeMessages, "Close (Esc)"), listOf(others)] : []);
    byId("errors").dataset.count = errors.length;
    byId("drawer").dataset.count = others.length;
}
function show() {
    fill();
    const all = app.state?.diagnostics ?? [], errors = +byId("errors").dataset.count || 0, others = +byId("drawer").dataset.count || 0, button = byId("messages-button");
    byId("errors").hidden = errors === 0;
    byId("errors").toggleAttribute("data-folded", folded);
    byId("drawer").hidden = !(open && others > 0 && errors === 0);
    button.hidden = all.length === 0;
    say(button, sum(all));
    attribute(button, "data-worst", errors ? "error" : all.some(d => d.severity === "warning") ? "warning" : "note");
    attribute(button, "aria-expanded", errors ? !folded : !byId("drawer").hidden);
    attribute(button, "aria-controls", errors ? "errors" : "drawer");
    document.documentElement.dataset.errors = errors;
}
export function startMessages() {
    byId("messages-button").addEventListener("click", toggleMessages);
    on("state", show);
}
