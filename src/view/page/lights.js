// Light groups: how much each adds to the picture, from none to four times as much. Nothing is rendered for it, since the film
// keeps each group by itself. The slider goes by the root, so that its middle is the light as rendered.
import {latest, make, notify, say, attribute} from "./dom.js";
import {section} from "./panels.js";
import {post} from "./server.js";
import {app, on, remember, remembered} from "./store.js";

const most = 4, toFactor = t => { const f = most * t * t; return Math.abs(f - 1) < 0.04 ? 1 : f; }, toPlace = f => Math.sqrt(Math.max(0, Math.min(most, f)) / most);
const rows = new Map();
let weights = {}, touched = -Infinity, inStops = remembered("stops", false);

const send = latest(async wanted => {
    try {
        await post("api/groups", {weights: wanted});
    } catch (error) {
        if (error.status !== 0) notify(`The lights are as they were: ${error.message}`, error.help);
    }
});
function set(changes) {
    Object.assign(weights, changes);
    touched = performance.now();
    show();
    send({...weights});
}
const words = f => inStops ? f === 0 ? "−∞" : `${f > 1.001 ? "+" : f < 0.999 ? "−" : ""}${Math.abs(Math.log2(f)).toFixed(2)}` : `${f.toFixed(2)}×`;
const names = () => Object.keys(weights);
const isSolo = name => weights[name] > 0 && names().length > 1 && names().every(other => other === name || weights[other] === 0);
function mute(name) { set({[name]: weights[name] === 0 ? rows.get(name).before || 1 : (rows.get(name).before = weights[name], 0)}); }
function solo(name) { set(isSolo(name) ? Object.fromEntries(names().map(n => [n, 1])) : Object.fromEntries(names().map(n => [n, n === name ? weights[n] || 1 : 0]))); }

function row(name) {
    const slider = make("input", {type: "range", min: 0, max: 1, step: 0.005, "aria-label": `Light group ${name}`, title: "Double click: as rendered",
        oninput: () => set({[name]: toFactor(+slider.value)}), ondblclick: () => set({[name]: 1})});
    const value = make("output", {title: "Double click: as rendered", ondblclick: () => set({[name]: 1})});
    const label = make("button", {type: "button", class: "group", "aria-pressed": "true", title: `${name}: on or off`, onclick: () => mute(name)}, make("bdi", {}, name));
    const alone = make("button", {type: "button", class: "quiet solo", "aria-pressed": "false", "aria-label": `${name} alone`, title: "This group alone, or all", onclick: () => solo(name)}, "solo");
    return {slider, value, label, alone, before: 1, element: make("div", {class: "light"}, label, alone, slider, value)};
}
let reset = null;
function show() {
    reset.disabled = names().every(n => weights[n] === 1);
    for (const [name, {slider, value, label, alone}] of rows) {
        const f = weights[name] ?? 1, place = toPlace(f);
        if (Math.abs(toFactor(+slider.value) - f) > 1e-6) slider.value = place;
        say(value, words(f));
        attribute(slider, "aria-valuetext", inStops ? `${words(f)} stops` : `${f.toFixed(2)} times`);
        attribute(label, "aria-pressed", f > 0);
        attribute(alone, "aria-pressed", isSolo(name));
    }
}

export function startLights() {
    const list = make("div", {class: "lights"}), none = make("p", {class: "soft"}, "The scene has one light alone: there is nothing to weigh.");
    reset = make("button", {type: "button", id: "lights-reset", onclick: () => set(Object.fromEntries(names().map(n => [n, 1])))}, "All as rendered");
    const units = make("button", {type: "button", class: "quiet", "aria-pressed": inStops, id: "lights-stops", title: "Stops instead of factors", onclick: () => {
        inStops = !inStops;
        remember("stops", inStops);
        units.setAttribute("aria-pressed", inStops);
        show();
    }}, "in stops");
    const buttons = make("div", {class: "row"}, reset, units);
    section("lights", "Light groups", none, list, buttons);
    on("state", () => {
        const groups = app.state.groups ?? [];
        if (groups.length !== rows.size || groups.some(g => !rows.has(g.name))) {
            rows.clear();
            weights = {};
            for (const g of groups) rows.set(g.name, row(g.name));
            list.replaceChildren(...[...rows.values()].map(r => r.element));
            touched = -Infinity;
        }
        // Until the program tells the weights that were sent, its events are older than what the hand did; but it may have refused them.
        if (groups.every(g => Math.abs((g.weight ?? 1) - weights[g.name]) < 1e-9) || performance.now() - touched > 3000) touched = -Infinity;
        if (touched === -Infinity) for (const g of groups) weights[g.name] = g.weight ?? 1;
        none.hidden = groups.length > 0;
        list.hidden = buttons.hidden = groups.length === 0;
        show();
    });
}
