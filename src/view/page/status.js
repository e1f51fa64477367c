// The status line, what screen readers are told (only turns: never the counting), what stands on an empty stage, and the
// banner that says that the program has gone.
import {attribute, byId, make, notify, say} from "./dom.js";
import {count, counted, duration, isNumber, percent} from "./format.js";
import {reuseText} from "./panels.js";
import {live} from "./picture.js";
import {post} from "./server.js";
import {app, on} from "./store.js";

const phases = {loading: "Loading", rendering: "Rendering", paused: "Paused", done: "Done", error: "Errors"};
// A dozen seconds that become eleven and twelve again make one nervous: time left is told in round steps.
function calm(seconds) {
    if (!isNumber(seconds)) return "";
    const step = seconds < 10 ? 1 : seconds < 60 ? 5 : seconds < 600 ? 10 : 60;
    return `${duration(Math.max(1, Math.ceil(seconds / step) * step))} left`;
}
function facts() {
    const {samples = {}, noise, left, status, picture, reuse, elapsed} = app.state, found = [];
    if (isNumber(samples.done) && samples.goal) found.push(status === "done" ? counted(samples.done, "sample") : `${count(samples.done)} of ${counted(samples.goal, "sample")}`);
    if (picture?.cell > 1 && picture.version > 0 && status !== "error") found.push(`at 1/${picture.cell} of the resolution`);
    if (isNumber(noise)) found.push(`noise ${percent(noise)}`);
    if (status === "rendering") found.push(calm(left));
    if (status === "done" && isNumber(elapsed)) found.push(`after ${duration(elapsed)}`);
    if (app.state.save > 1 && status !== "error") found.push(reuseText(reuse));
    return found.filter(Boolean);
}

let told = "";
function announce(text) {
    if (text === told) return;
    told = text;
    byId("announce").textContent = text;
}
function emptyText() {
    const {state, link} = app;
    if (live.bitmap) return "";
    if (link === "refused" || (!state && link === "gone")) return "No picture";
    if (!state || link === "connecting") return "Waiting for the program…";
    return {loading: "Loading the scene…", error: "No picture yet: the scene has errors", paused: "Paused before the first picture"}[state.status] ?? "The first picture is on its way…";
}
function banner() {
    const holder = byId("banner"), {link} = app;
    const words = {gone: ["abbe view does not answer.", "The page goes on when it returns at this address."], refused: ["The program refuses this address.", "It was started anew: open the address that it prints."]}[link];
    holder.hidden = !words;
    if (words && holder.dataset.now !== link) holder.replaceChildren(make("strong", {}, words[0]), ` ${words[1]}`);
    holder.dataset.now = link;
    document.documentElement.dataset.link = link;
}

export async function togglePause() {
    const paused = app.state?.status === "paused";
    try { await post("api/control", {pause: !paused}); } catch (error) { notify(error.message, error.help); }
}
export async function restart() {
    try { await post("api/control", {restart: true}); } catch (error) { notify(error.message, error.help); }
}
export async function snapshot() {
    const button = byId("snapshot");
    if (button.disabled) return;
    button.disabled = true;
    try {
        const {files = []} = await post("api/snapshot");
        notify("Snapshot written", files.join(", "));
    } catch (error) {
        notify(`No snapshot: ${error.message}`, error.help);
    } finally {
        button.disabled = false;
    }
}

function show() {
    const {state, link} = app;
    banner();
    say(byId("empty-text"), emptyText());
    byId("empty").hidden = !emptyText();
    if (!state) return;
    const {samples = {}, status, diagnostics = []} = state, share = samples.goal > 0 ? Math.min(1, samples.done / samples.goal) : 0;
    byId("status").dataset.phase = link === "here" ? status : "gone";
    say(byId("phase"), link === "here" ? phases[status] ?? status : "Not connected");
    say(byId("facts"), facts().join(" · "));
    byId("progress").firstChild.style.width = `${100 * share}%`;
    attribute(byId("progress"), "aria-valuemax", samples.goal || 1);
    attribute(byId("progress"), "aria-valuenow", samples.done || 0);
    const pause = byId("pause"), paused = status === "paused";
    attribute(pause, "aria-pressed", paused);
    attribute(pause, "title", paused ? "Go on (P)" : "Pause (P)");
    document.title = `${diagnostics.some(d => d.severity === "error") ? "⚠ " : ""}${state.scene?.name ?? "scene"} – abbe view`;
    const first = diagnostics.find(d => d.severity === "error"), errors = diagnostics.filter(d => d.severity === "error").length;
    if (link !== "here") announce("The program does not answer");
    else if (errors) announce(`${counted(errors, "error")} in the scene. ${first.message}`);
    else if (status === "done") announce(`Done: ${facts().slice(0, 2).join(", ")}`);
    else announce(`${phases[status] ?? status}${state.save > 1 ? `, save ${state.save}` : ""}`);
}
export function startStatus() {
    for (const [id, run] of [["pause", togglePause], ["restart", restart], ["snapshot", snapshot]]) byId(id).addEventListener("click", run);
    on("state link picture", show);
    show();
}
