// How the noise went down, when the goal is reached, and by what the rest is taken off the screen.
import {make, notify, options} from "./dom.js";
import {duration, isNumber, percent} from "./format.js";
import {factsList, section} from "./panels.js";
import {noisePlot} from "./plots.js";
import {post} from "./server.js";
import {app, denoiserNow, on, remember, remembered, setLook} from "./store.js";

export function startNoise() {
    const plot = make("div", {class: "drawing"}), facts = factsList(), waiting = make("p", {class: "soft"}, "Noise is known after a few samples.");
    let axis = remembered("axis", "samples"), drawn = "";
    const button = (value, label) => make("button", {type: "button", class: "quiet", "data-axis": value, onclick: () => { axis = value; remember("axis", value); show(); }}, label);
    const goal = make("input", {type: "number", id: "goal", min: 1, max: 1048576, step: 1, "aria-label": "Goal: samples a pixel", onchange: async () => {
        try {
            if (goal.value) await post("api/control", {samples: Math.max(1, Math.round(+goal.value))});
        } catch (error) {
            notify(`The goal is as it was: ${error.message}`, error.help);
        }
    }});
    const buttons = make("div", {class: "row axes", role: "group", "aria-label": "Noise against"}, make("span", {class: "soft"}, "against"), button("samples", "samples"), button("time", "time"));
    const aim = make("label", {class: "choice"}, make("span", {}, "Goal"), goal, make("span", {class: "soft"}, "samples a pixel"));
    const method = make("select", {id: "method", onchange: () => setLook({method: method.value, denoise: true})}), by = make("label", {class: "choice"}, make("span", {}, "Denoise by"), method);
    section("noise", "Noise", buttons, plot, waiting, facts.list, aim, by);
    function show() {
        const {curve = [], samples = {}, noise, left, denoisers = []} = app.state ?? {}, width = Math.max(200, plot.clientWidth);
        for (const b of buttons.querySelectorAll("[data-axis]")) b.setAttribute("aria-pressed", b.dataset.axis === axis);
        if (document.activeElement !== goal && isNumber(samples.goal)) goal.value = samples.goal;
        const now = JSON.stringify([curve.length, curve[curve.length - 1], samples.goal, axis, width]);
        if (now !== drawn) {
            drawn = now;
            const made = noisePlot(curve, samples.goal ?? 0, axis, width);
            plot.replaceChildren(...made ? [made.svg] : []);
            waiting.hidden = Boolean(made);
            buttons.hidden = !made;
        }
        const expected = isNumber(noise) && samples.done > 0 && samples.goal > samples.done ? noise * Math.sqrt(samples.done / samples.goal) : null;
        facts.set([["noise", isNumber(noise) ? percent(noise) : ""], ["at the goal", isNumber(expected) ? `about ${percent(expected)}` : ""],
                   ["time left", isNumber(left) && left > 0 ? duration(left) : ""]]);
        const names = denoisers.map(d => d.name);
        options(method, names, denoisers.map(d => d.version ? `${d.name} ${d.version}` : d.name), denoiserNow() ?? "");
        by.hidden = names.length < 2;
    }
    on("state look", show);
    new ResizeObserver(show).observe(plot);
}
