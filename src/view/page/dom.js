// Elements of HTML and SVG. Text from outside enters by textContent alone, and no style is an attribute: the page's
// Content-Security-Policy forbids it.
export const byId = id => document.getElementById(id);

function filled(e, attributes, children) {
    for (const [key, value] of Object.entries(attributes)) {
        if (key.startsWith("on")) e.addEventListener(key.slice(2), value);
        else if (value !== null && value !== undefined && (value !== false || key.startsWith("aria-"))) e.setAttribute(key, value === true && !key.startsWith("aria-") ? "" : value);
    }
    e.append(...children.flat(3).filter(child => child !== null && child !== undefined && child !== false));
    return e;
}
// make("p", {class: "soft", onclick: f}, "text", element…); what is null is left out.
export const make = (name, attributes = {}, ...children) => filled(document.createElement(name), attributes, children);
export const draw = (name, attributes = {}, ...children) => filled(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, children);

// Text that changes often is written only where it differs, so that selections and tips stay.
export function say(e, text) {
    if (e.textContent !== text) e.textContent = text;
}
export function attribute(e, name, value) {
    if (value === null || value === undefined) { if (e.hasAttribute(name)) e.removeAttribute(name); } else if (e.getAttribute(name) !== String(value)) e.setAttribute(name, value);
}

// The options of a select are made anew only when others are there; the chosen one follows.
export function options(select, names, labels, now) {
    const held = JSON.stringify(labels);
    if (select.dataset.held !== held) {
        select.dataset.held = held;
        select.replaceChildren(...names.map((name, i) => make("option", {value: name}, labels[i])));
    }
    if (select.value !== now) select.value = now;
    select.disabled = names.length < 2;
}

// Something that was done, or could not be: shown for a while above the status line.
let toastTimer = 0;
export function notify(text, more = "") {
    const toast = byId("toast");
    toast.replaceChildren(make("span", {dir: "auto"}, text), more ? make("small", {dir: "auto"}, more) : "");
    toast.hidden = false;
    clearTimeout(toastTimer);
    toastTimer = setTimeout(() => { toast.hidden = true; }, Math.min(9000, 2500 + 40 * (text.length + more.length)));
}

// Without the clipboard's permission there is the old way.
export async function copy(text, what = text) {
    let done = false;
    try {
        await navigator.clipboard.writeText(text);
        done = true;
    } catch {
        const field = make("textarea", {class: "unseen", "aria-hidden": "true"}), before = document.activeElement;
        field.value = text;
        document.body.append(field);
        field.select();
        done = document.execCommand("copy");
        field.remove();
        before?.focus?.();
    }
    notify(done ? `Copied ${what}` : "The browser does not allow copying", done ? "" : text);
    return done;
}

// Runs `task` on the latest of what it is given, one at a time: what comes while it is busy replaces what waits.
export function latest(task) {
    let busy = false, waiting = null;
    return async value => {
        waiting = {value};
        if (busy) return;
        busy = true;
        try {
            while (waiting) {
                const next = waiting.value;
                waiting = null;
                await task(next);
            }
        } finally {
            busy = false;
        }
    };
}
