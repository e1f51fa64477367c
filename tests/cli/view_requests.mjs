// What a view answers:  node view_requests.mjs URL SCENE  Ends with 1 after faults.
import {readFileSync, renameSync, writeFileSync, rmSync} from "node:fs";
import http from "node:http";
import net from "node:net";

const [, , address, scene] = process.argv;
const url = new URL(address), token = url.searchParams.get("token"), port = Number(url.port);
const text = readFileSync(scene, "utf8");
let faults = 0;
function check(right, what) {
    if (right) return;
    console.log(`FAULT: ${what}`);
    ++faults;
}
const sleep = ms => new Promise(done => setTimeout(done, ms));

// The status, the headers and the body of an answer.
function ask(path, {method = "GET", headers = {}, body, secret = token} = {}) {
    return new Promise((done, fail) => {
        const all = {...(secret === null ? {} : {"X-Abbe-Token": secret}), ...headers};
        const request = http.request({host: "127.0.0.1", port, path, method, headers: all, agent: false}, response => {
            const parts = [];
            response.on("data", part => parts.push(part));
            response.on("end", () => done({status: response.statusCode, headers: response.headers, body: Buffer.concat(parts)}));
        });
        request.on("error", error => done({status: 0, headers: {}, body: Buffer.from(String(error))}));
        request.setTimeout(30000, () => { request.destroy(); fail(new Error(`no answer to ${path}`)); });
        request.end(body);
    });
}
const post = (name, value, more = {}) => ask(`/api/${name}`, {method: "POST", body: typeof value === "string" ? value : JSON.stringify(value), ...more});
const state = async () => JSON.parse((await ask("/api/state")).body);
async function until(holds, what) {
    for (let i = 0; i < 600; ++i) {
        const now = await state();
        if (holds(now)) return now;
        await sleep(50);
    }
    check(false, `never ${what}: ${JSON.stringify(await state()).slice(0, 2000)}`);
    return state();
}
// What was sent and came back over a socket of one's own; closed by the other side, or after `ms`.
function raw(bytes, ms = 8000) {
    return new Promise(done => {
        const socket = net.connect(port, "127.0.0.1");
        let got = "";
        socket.on("data", data => { got += data; });
        socket.on("error", () => done(got));
        socket.on("close", () => done(got));
        setTimeout(() => { socket.destroy(); done(got); }, ms);
        socket.on("connect", () => socket.write(bytes));
    });
}
function save(content) { // as editors do
    writeFileSync(`${scene}.new`, content);
    renameSync(`${scene}.new`, scene);
}

async function whoIsLetIn() {
    const paths = ["/", "/api/state", "/api/picture", "/api/events", "/api/probe?x=1&y=1", "/page/x/view.css", "/nothing"];
    for (const path of paths) {
        check((await ask(path, {secret: null})).status === 403, `${path} without a token`);
        check((await ask(path, {secret: token.slice(0, -1) + (token.endsWith("A") ? "B" : "A")})).status === 403, `${path} with a wrong token`);
        check((await ask(path, {secret: token + "A"})).status === 403, `${path} with a longer token`);
        check((await ask(path, {secret: ""})).status === 403, `${path} with an empty token`);
    }
    const foreign = [{Host: "evil.example"}, {Host: `evil.example:${port}`}, {Host: `127.0.0.1:${port + 1}`}, {Origin: "http://evil.example"},
                     {Origin: "null"}, {Origin: `https://127.0.0.1:${port}`}, {"Sec-Fetch-Site": "cross-site"}, {"Sec-Fetch-Site": "same-site"}];
    for (const headers of foreign) {
        check((await ask("/api/state", {headers})).status === 403, `let in with ${JSON.stringify(headers)}`);
        check((await post("camera", {orbit: [1, 0]}, {headers})).status === 403, `an order with ${JSON.stringify(headers)}`);
    }
    for (const headers of [{Origin: `http://127.0.0.1:${port}`}, {Host: `localhost:${port}`}, {"Sec-Fetch-Site": "same-origin"}, {"Sec-Fetch-Site": "none"}])
        check((await ask("/api/state", {headers})).status === 200, `refused with ${JSON.stringify(headers)}`);
    check(!(await state()).camera.moved, "an order of a stranger was carried out");
    const page = await ask(`/?token=${token}`, {secret: null});
    check(page.status === 200 ? page.headers["content-type"].startsWith("text/html") : page.status === 404, "the page"); // what is in it: tests/web
    const policy = page.headers["content-security-policy"] ?? "";
    for (const part of ["default-src 'none'", "script-src 'self'", "connect-src 'self'"]) check(policy.includes(part), `${part} in the policy`);
    check(!policy.includes("unsafe"), "nothing unsafe in the policy");
    check(page.headers["cache-control"] === "no-store" && page.headers["x-content-type-options"] === "nosniff" &&
          page.headers["referrer-policy"] === "no-referrer", "headers of the page");
    check((await ask("/favicon.ico", {secret: null})).status === 204, "an icon without a secret");
}

async function badRequests() {
    check((await post("camera", "x".repeat(70000))).status === 413, "a body that is too long");
    check((await post("nothing", {})).status === 404, "an unknown order");
    check((await ask("/nothing")).status === 404, "an unknown path");
    check((await ask(`/page/${token}/../../room.scene`)).status >= 400, "a way out of the page");
    check((await ask(`/page/${token}/%2e%2e%2froom.scene`)).status >= 400, "another way out of the page");
    for (const body of ["", "null", "[]", "{", '{"orbit":"x"}', "\u0000", '{"orbit":[1e999,0]}', "[".repeat(30000)]) {
        const answer = await post("camera", body);
        check(answer.status === (body === "" ? 200 : 400), `${answer.status} to the body ${body.slice(0, 20)}`);
        if (answer.status === 400) check(JSON.parse(answer.body).error.message.length > 0, "a fault has words");
    }
    for (const query of ["source=x", "layer=nothing", "exposure=x", "exposure=1e9", "exposure=nan", "view=nothing", "denoise=x", "max=x"])
        check((await ask(`/api/picture?${query}`)).status === 400, `/api/picture?${query}`);
    for (const query of ["x=1", "x=a&y=1", "x=-1&y=0", "x=96&y=0", "x=99999999999999&y=0"]) check((await ask(`/api/probe?${query}`)).status === 400, `/api/probe?${query}`);
    for (const path of ["../../etc/passwd", "/etc/passwd", "", "room.scene"].filter(p => p)) check((await post("other", {path})).status === 400, `other ${path}`);
    // No HTTP at all, and clients that take their time: others are served meanwhile.
    const slow = Array.from({length: 12}, () => raw(`GET /api/state HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\n`, 12000));
    const began = Date.now();
    check((await ask("/api/state")).status === 200 && Date.now() - began < 3000, "slow clients keep others waiting");
    for (const bytes of ["\r\n\r\n", "GARBAGE\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "\u0000\u0001\u0002\r\n\r\n", `GET /${"a".repeat(20000)} HTTP/1.1\r\n\r\n`,
                         `GET / HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\n${"X-Long: y\r\n".repeat(5000)}\r\n`, "POST /api/camera HTTP/1.1\r\nContent-Length: -1\r\n\r\n",
                         `POST /api/camera HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\nX-Abbe-Token: ${token}\r\nContent-Length: 999999999999999\r\n\r\n{}`]) {
        const answer = await raw(bytes);
        check(!/^HTTP\/1\.1 2/.test(answer), `${JSON.stringify(bytes.slice(0, 30))} is answered ${answer.slice(0, 40)}`);
    }
    await Promise.all(slow);
    check((await ask("/api/state")).status === 200, "the view lives");
}

// The picture that is shown when nothing more happens.
async function finished() {
    await until(now => now.status === "done", "done");
    const picture = await ask("/api/picture?source=live&exposure=0");
    check(picture.status === 200 && picture.headers["x-cell"] === "1" && picture.headers["x-samples"] === "16", "the finished picture");
    check(picture.body.length === 4 * 96 * 64 && picture.headers["x-width"] === "96" && picture.headers["x-height"] === "64", "its size");
    return picture.body;
}

async function edits() {
    const first = await finished();
    check(Buffer.compare(first, (await ask("/api/picture")).body) === 0, "the same picture twice");
    check(Buffer.compare(first, (await ask("/api/picture?exposure=1")).body) !== 0, "another exposure");
    check((await ask("/api/picture?max=24")).headers["x-width"] === "24", "a small picture");
    const before = await state();
    const at = Date.now();
    save(text.replace(/exposure [-0-9.]+/, match => `exposure ${Number(match.slice(9)) + 1}`));
    const after = await until(now => now.save > before.save && now.picture.version > before.picture.version, "shown after a save");
    console.log(`first pixels ${after.reuse.seconds.first_pixels} s, seen after ${Date.now() - at} ms`);
    check(Buffer.compare(first, await finished()) !== 0, "another picture after a save");
    check(after.reuse.structure === "kept", `the exposure changes no geometry: ${JSON.stringify(after.reuse)}`);
    // Twenty quick saves, some of them halves.
    const saves = (await state()).save;
    for (let i = 0; i < 20; ++i) {
        if (i % 3 === 1) writeFileSync(scene, text.slice(0, i * 40));
        else save(text);
        await sleep(15);
    }
    save(text);
    await sleep(400);
    await until(now => now.save > saves && now.status === "done" && now.diagnostics.length === 0, "well after quick saves");
    check(Buffer.compare(first, await finished()) === 0, "the first picture again, bit by bit");
    rmSync(scene);
    const gone = await until(now => now.status === "error", "told that the file is gone");
    check(gone.picture.stale && gone.diagnostics[0].code === "E0410", "the picture stays while the file is gone");
    check((await ask("/api/picture")).status === 200, "shown while the file is gone");
    save(text);
    await finished();
    const snapshot = await post("snapshot", {});
    check(snapshot.status === 200 && JSON.parse(snapshot.body).files[0] === "room.view-0001.exr", `a snapshot: ${snapshot.body}`);
}

async function events() {
    const seen = [];
    const request = http.request({host: "127.0.0.1", port, path: "/api/events", headers: {"X-Abbe-Token": token}}, response => {
        check(response.headers["content-type"] === "text/event-stream", "events have their type");
        response.on("data", data => seen.push(String(data)));
        response.on("error", () => {});
    });
    request.on("error", () => {});
    request.end();
    await sleep(500);
    const before = seen.length;
    check(before >= 1 && seen[0].startsWith("event: state\ndata: {"), `the state at once: ${seen[0]?.slice(0, 60)}`);
    await post("camera", {orbit: [0.3, 0.1]});
    await sleep(1000);
    check(seen.length > before, "an event after a move");
    check(seen.length < 40, `${seen.length} events in a second and a half`);
    request.destroy();
    await post("camera", {reset: true});
    await finished();
}

await until(now => now.picture.version > 0, "a first picture");
await whoIsLetIn();
await edits();
await events();
await badRequests();
process.exit(faults > 0 ? 1 : 0);
