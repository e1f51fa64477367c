// The program behind the page, by HTTP on the loopback interface (docs/view.md, "The interface"). Each request carries the
// token of the page's own address; nothing else is ever asked.
const token = new URLSearchParams(location.search).get("token") ?? "";
const headers = {"X-Abbe-Token": token};

export class ServerError extends Error {
    constructor(status, message, help = "") { super(message); Object.assign(this, {status, help}); }
}

async function answer(path, options) {
    let response;
    try {
        response = await fetch(path, {cache: "no-store", ...options, headers: {...headers, ...options?.headers}});
    } catch {
        throw new ServerError(0, "abbe view does not answer", "It has ended, or is about to start again.");
    }
    if (response.ok) return response;
    const {error} = await response.json().catch(() => ({}));
    throw new ServerError(response.status, error?.message ?? `the program answered ${response.status}`, error?.help ?? "");
}
export const get = (path, options) => answer(path, options);
// null where there is nothing yet.
export async function getJson(path) {
    const response = await answer(path);
    return response.status === 204 ? null : response.json();
}
export async function post(path, body = {}) {
    const response = await answer(path, {method: "POST", headers: {"Content-Type": "application/json"}, body: JSON.stringify(body)});
    const text = await response.text();
    return text ? JSON.parse(text) : {};
}

// The program says something at least every 10 s, if only a comment; silence means that it has gone or hangs.
const silence = 25000;

// Reads the events until the connection ends. Reading them by hand shows the status of a refusal and the comments, both of
// which EventSource hides.
async function follow(heard) {
    const stop = new AbortController();
    let watch = setTimeout(() => stop.abort(), silence);
    try {
        const response = await answer("api/events", {signal: stop.signal, headers: {Accept: "text/event-stream"}});
        const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
        for (let rest = ""; ;) {
            const {value, done} = await reader.read();
            if (done) return;
            clearTimeout(watch);
            watch = setTimeout(() => stop.abort(), silence);
            const blocks = (rest + value).replaceAll("\r\n", "\n").split("\n\n");
            rest = blocks.pop();
            for (const block of blocks) {
                const data = block.split("\n").filter(line => line.startsWith("data:")).map(line => line.slice(5).trimStart()).join("\n");
                if (data) heard(JSON.parse(data));
            }
        }
    } finally {
        clearTimeout(watch);
        stop.abort();
    }
}

// Calls heard(state) for ever, and told("here" | "gone" | "refused") when that changes. After a loss it tries again, soon at
// first and every 3 s later; a refusal is final for this address, since a program that starts again has another token.
export async function listen(heard, told) {
    for (let wait = 300; ;) {
        try {
            await follow(state => { wait = 300; told("here"); heard(state); });
        } catch (error) {
            if (error instanceof SyntaxError) console.error(error);
            if (error.status === 403) { told("refused"); return; }
        }
        told("gone");
        await new Promise(done => setTimeout(done, wait));
        wait = Math.min(3000, 1.5 * wait);
    }
}
