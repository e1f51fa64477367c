// The interface of `abbe view` (docs/view.md) with a made-up scene behind it, so that the page can be tried without the program,
// and in states that real scenes seldom have:  node view_mock.mjs [ordinary|empty|tiny|huge|crowded|broken|still] [PORT]
import {createServer} from "node:http";
import {randomBytes} from "node:crypto";
import {readFileSync} from "node:fs";
import {dirname, extname, join} from "node:path";
import {fileURLToPath} from "node:url";

const folder = join(dirname(fileURLToPath(import.meta.url)), "../../src/view/page");
const types = {".html": "text/html; charset=utf-8", ".css": "text/css; charset=utf-8", ".js": "text/javascript; charset=utf-8", ".svg": "image/svg+xml"};
const policy = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]], dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2], scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const unit = a => scaled(a, 1 / Math.sqrt(dot(a, a))), cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const balls = [{name: "apple", material: "lacquer", at: [-0.9, 0, 0.55], r: 0.55, color: [0.62, 0.08, 0.05]}, {name: "orb", material: "porcelain", at: [0.35, 0.5, 0.75], r: 0.75, color: [0.75, 0.74, 0.7]},
               {name: "pebble", material: "slate", at: [0.55, -0.75, 0.3], r: 0.3, color: [0.1, 0.2, 0.35]}];
const lamps = [{group: "key", to: unit([-0.5, -0.6, 0.8]), color: [1.5, 1.35, 1.1]}, {group: "fill", to: unit([0.9, -0.2, 0.5]), color: [0.25, 0.32, 0.45]}];

const floor = {name: "floor", material: "tiles"}, dark = [0.32, 0.3, 0.28], pale = [0.5, 0.48, 0.45], up = [0, 0, 1];
function hit(from, to) {
    let nearest = Infinity, ball = null;
    for (const one of balls) {
        const x = from[0] - one.at[0], y = from[1] - one.at[1], z = from[2] - one.at[2], b = x * to[0] + y * to[1] + z * to[2], d = b * b - x * x - y * y - z * z + one.r ** 2;
        if (d <= 0) continue;
        const t = -b - Math.sqrt(d);
        if (t > 1e-4 && t < nearest) { nearest = t; ball = one; }
    }
    const t = -from[2] / to[2];
    if (t > 1e-4 && t < nearest && t < 60) {
        const p = add(from, to, t), odd = (Math.floor(p[0] * 2) + Math.floor(p[1] * 2)) & 1;
        return {t, thing: floor, color: odd ? dark : pale, normal: up, point: p};
    }
    if (!ball) return null;
    const point = add(from, to, nearest);
    return {t: nearest, thing: ball, color: ball.color, normal: unit(add(point, ball.at, -1)), point};
}
function radiance(from, to, weights) {
    const h = hit(from, to), sky = (weights.sky ?? 1) * (0.25 + 0.35 * Math.max(0, to[2]));
    if (!h) return [0.55 * sky, 0.7 * sky, sky];
    const light = [0.16, 0.19, 0.24].map(v => v * (weights.sky ?? 1) * (0.6 + 0.4 * h.normal[2]));
    for (const lamp of lamps) {
        const cosine = dot(h.normal, lamp.to);
        if (cosine > 0 && !hit(add(h.point, h.normal, 1e-3), lamp.to)) for (let c = 0; c < 3; ++c) light[c] += cosine * lamp.color[c] * (weights[lamp.group] ?? 1);
    }
    return light.map((v, c) => v * h.color[c]);
}
function hashed(n) { n = Math.imul(n ^ n >>> 16, 0x45d9f3b); n = Math.imul(n ^ n >>> 16, 0x45d9f3b); return ((n ^ n >>> 16) >>> 0) / 2 ** 32; }
const code = v => Math.round(255 * (v <= 0 ? 0 : v >= 1 ? 1 : v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
const codes = Uint8Array.from({length: 4096}, (_, i) => code(i / 4095));
const shoulder = v => v * (1 + v / 6) / (1 + v);

function diagnosticsOf(n) {
    const found = [{severity: "error", code: "E0312", file: "shot.scene", line: 41, column: 9, message: "there is no material “lacqer”", label: "this name", help: "Did you mean “lacquer”? It is declared in line 12."},
                   {severity: "error", code: "E0107", file: "props/" + "a-rather-long-folder-name/".repeat(4) + "table.scene", line: 3, column: 1, message: "هذه الرسالة مكتوبة من اليمين إلى اليسار: roughness = 2", label: "", help: "قيمة الخشونة بين 0 و 1"},
                   {severity: "warning", code: "W0604", file: "shot.scene", line: 7, column: 3, message: "the texture “" + "verylongnamewithoutspaces".repeat(6) + "” is 4 pixels wide", label: "", help: "It is smooth at this size."},
                   {severity: "note", code: "", file: "", line: 0, column: 0, message: "<b>no element</b> <script>document.title='taken'</script>", label: "", help: ""}];
    while (found.length < n) found.push({severity: ["error", "warning", "note"][found.length % 3], code: "E0200", file: "shot.scene", line: found.length, column: 2, message: `mistake number ${found.length}`, label: "", help: "Mend it."});
    return found.slice(0, n);
}

export async function startMock(variant = "ordinary", wantedPort = 0, token = randomBytes(18).toString("base64url")) {
    const camera0 = {from: [-1.6, -5.2, 2.1], look_at: [-0.1, 0, 0.5]};
    const sizes = {tiny: [1, 1], huge: [7680, 4320]}, [width, height] = sizes[variant] ?? [480, 300];
    const mock = {token, requests: [], posts: [], saves: 1, weights: {}, goal: variant === "ordinary" ? 256 : 1, quick: false};
    const crowd = variant === "crowded";
    const groups = crowd ? Array.from({length: 30}, (_, i) => i < 3 ? ["key", "fill", "sky"][i] : i === 3 ? "a light group with a name that goes on and on and on" : `group ${i + 1}`) : ["key", "fill", "sky"];
    const layers = ["beauty", "albedo", "depth", "normal", ...crowd ? Array.from({length: 36}, (_, i) => i === 7 ? "a-layer-with-a-very-long-name-" + "without-end-".repeat(6) : `layer-${i + 1}`) : ["key", "fill", "sky"]];
    const state = mock.state = {
        scene: {name: crowd ? "a scene whose name is longer than any title has room for, with קצת עברית in it" : "still life", path: "/scenes/still-life/shot.scene"}, status: "rendering", save: 1, picture: {version: 0, cell: 8, stale: false},
        frame: {width, height, region: null}, samples: {done: 0, goal: mock.goal}, noise: null, curve: [], elapsed: 0, left: null,
        camera: {name: "main", type: "perspective", movable: true, ...camera0, up: [0, 0, 1], moved: false, lines: ""}, layers, groups: groups.map(name => ({name, weight: 1})),
        views: ["ACES 1.0 - SDR Video", "Un-tone-mapped", "Raw"], view: "ACES 1.0 - SDR Video", exposure: 0, denoisers: [{name: "preview", version: "1"}, {name: "oidn", version: "1.4.3"}], denoiser_missing: null,
        diagnostics: crowd ? diagnosticsOf(200) : variant === "broken" ? diagnosticsOf(4) : diagnosticsOf(4).filter(d => d.severity !== "error" && variant !== "still"),
        reuse: {shapes_kept: 0, shapes_loaded: 4, shapes_placed: 0, structure: "built", textures_kept: 0, textures_read: 2, seconds: {read: 0.004, build: 0.12, commit: 0.05, first_pixels: 0.21}, kept: ""}, other: null, saved: false,
    };
    if (variant === "empty") Object.assign(state, {status: "loading", picture: {version: 0, cell: 8, stale: false}, frame: {width: 0, height: 0, region: null}, layers: [], groups: [], views: [], view: "", denoisers: [], denoiser_missing: "OIDN was not found when Abbe was built", camera: {movable: false}, diagnostics: [], reuse: null, samples: {done: 0, goal: 0}});
    if (crowd || variant === "broken") Object.assign(state, {status: "error"}, {picture: {version: 3, cell: 1, stale: true}, samples: {done: 64, goal: 256}, noise: 0.031});
    const clients = new Set();
    let saved = null, dirty = true;
    const lines = c => `from ${c.from.map(v => +v.toFixed(4)).join(" ")}\nlook-at ${c.look_at.map(v => +v.toFixed(4)).join(" ")}`;
    state.camera.lines = state.camera.from ? lines(state.camera) : "";
    const snapshotOf = () => ({camera: structuredClone(state.camera), samples: state.samples.done, weights: {...mock.weights}, cell: state.picture.cell});
    function again() { Object.assign(state, {samples: {done: 0, goal: mock.goal}, curve: [], elapsed: 0, noise: null, status: state.status === "paused" ? "paused" : "rendering"}); state.picture = {version: state.picture.version + 1, cell: 8, stale: false}; dirty = true; }
    function step() {
        if (state.status !== "rendering") return;
        state.elapsed += 0.1;
        if (state.picture.cell > 1) { state.picture.cell /= 2; if (!state.samples.done) state.samples.done = 1; } else state.samples.done = Math.min(mock.goal, state.samples.done + (mock.quick ? 64 : Math.max(1, state.samples.done >> 3)));
        ++state.picture.version;
        state.noise = 0.4 / Math.sqrt(state.samples.done);
        state.curve.push([state.elapsed, state.samples.done, state.noise * (1 + 0.03 * Math.sin(7 * state.elapsed))]);
        state.left = (mock.goal - state.samples.done) * state.elapsed / state.samples.done;
        if (state.samples.done >= mock.goal && state.picture.cell === 1) Object.assign(state, {status: "done", left: 0});
        dirty = true;
    }
    function speak() {
        if (!dirty) return;
        dirty = false;
        for (const client of clients) client.write(`event: state\ndata: ${JSON.stringify(state)}\n\n`);
    }
    const timers = [setInterval(() => { step(); speak(); }, 100), setInterval(() => { for (const client of clients) client.write(": here\n\n"); }, 1000)];

    function basis({from, look_at}) { const f = unit(add(look_at, from, -1)), r = unit(cross(f, [0, 0, 1])); return {f, r, u: cross(r, f)}; }
    function orbit([dx, dy], c) {
        const d = add(c.from, c.look_at, -1), size = Math.sqrt(dot(d, d)), azimuth = Math.atan2(d[1], d[0]) - dx, height = Math.max(-1.5, Math.min(1.5, Math.asin(d[2] / size) + dy));
        c.from = add(c.look_at, [Math.cos(azimuth) * Math.cos(height), Math.sin(azimuth) * Math.cos(height), Math.sin(height)], size);
    }
    function moveCamera(m) {
        const c = state.camera, {f, r, u} = basis(c), size = Math.sqrt(dot(add(c.from, c.look_at, -1), add(c.from, c.look_at, -1)));
        if (m.orbit) orbit(m.orbit, c);
        else if (m.pan) { const by = add(scaled(r, -m.pan[0] * size * 0.7), u, m.pan[1] * size * 0.7); c.from = add(c.from, by); c.look_at = add(c.look_at, by); }
        else if (m.dolly) c.from = add(c.look_at, add(c.from, c.look_at, -1), m.dolly);
        else if (m.fly) { const by = add(add(scaled(r, m.fly[0] * size), u, m.fly[1] * size), f, m.fly[2] * size); c.from = add(c.from, by); c.look_at = add(c.look_at, by); }
        else if (m.reset) Object.assign(c, structuredClone(camera0));
        else return false;
        Object.assign(c, {moved: !m.reset, lines: lines(c)});
        again();
        return true;
    }
    // Linear values of a pixel of the frame, in the middle.
    function at(x, y, of, layer) {
        const {f, r, u} = of.axes ??= basis(of.camera), s = 0.72 / height, to = unit(add(add(f, r, (x - width / 2) * s), u, (height / 2 - y) * s)), from = of.camera.from, h = ["beauty", "key", "fill", "sky"].includes(layer) ? null : hit(from, to);
        if (layer === "depth") return Array(3).fill(h ? h.t / 20 : 0);
        if (layer === "albedo") return h ? h.color : [0, 0, 0];
        if (layer === "normal") return h ? h.normal.map(v => 0.5 + 0.5 * v) : [0, 0, 0];
        return radiance(from, to, alone[layer] ?? of.weights);
    }
    // What is seen is kept, of each light group by itself: samples, exposure and weights change more often.
    const known = new Map(), lit = ["key", "fill", "sky"], alone = {key: {key: 1, fill: 0, sky: 0}, fill: {key: 0, fill: 1, sky: 0}, sky: {key: 0, fill: 0, sky: 1}};
    function traced(of, layer, step, w, h) {
        const key = JSON.stringify([of.camera.from, of.camera.look_at, layer, step]);
        if (known.has(key)) return known.get(key);
        const found = new Float32Array(3 * w * h), plain = {camera: of.camera, weights: {}};
        for (let y = 0; y < h; ++y) for (let x = 0; x < w; ++x) found.set(at((x + 0.5) * step, (y + 0.5) * step, plain, layer), 3 * (y * w + x));
        if (known.size > 60) known.clear();
        known.set(key, found);
        return found;
    }
    function values(of, layer, step, w, h) {
        const of3 = layer === "beauty" ? lit : lit.filter(g => g === layer);
        if (!of3.length) return traced(of, layer, step, w, h);
        if (layer === "beauty" && lit.every(g => (of.weights[g] ?? 1) === 1)) return traced(of, layer, step, w, h);
        const parts = of3.map(g => [of.weights[g] ?? 1, traced(of, g, step, w, h)]);
        return parts[0][1].map((_, i) => parts.reduce((sum, [weight, part]) => sum + weight * part[i], 0));
    }
    function picture(query) {
        const source = query.get("source") ?? "live", of = source === "saved" ? saved : source === "other" ? state.other && {...snapshotOf(), camera: {...state.camera, ...structuredClone(camera0)}, weights: {key: 0.2, sky: 2}, samples: 4096, cell: 1} : snapshotOf();
        if (!of || !of.camera.from || !state.picture.version) return null;
        const most = +query.get("max") || Infinity, block = Math.max(1, Math.ceil(Math.max(width, height) / Math.max(1, most))), cell = Math.min(of.cell, width, height), step = Math.max(cell, block, {huge: 16, tiny: 1}[variant] ?? 2);
        const w = Math.ceil(width / step), h = Math.ceil(height / step), data = Buffer.alloc(4 * w * h), gain = 2 ** (+query.get("exposure") || 0), raw = query.get("view") !== state.view, layer = query.get("layer") ?? "beauty";
        const noise = query.get("denoise") !== "0" ? 0 : 0.45 / Math.sqrt(Math.max(1, of.samples));
        const rgb = values(of, layer, step, w, h);
        for (let i = 0; i < w * h; ++i) {
            for (let c = 0; c < 3; ++c) {
                const v = gain * rgb[3 * i + c] * (1 + noise * 3.4 * (hashed(4 * i + c + 9973 * of.samples) - 0.5));
                data[4 * i + c] = codes[Math.max(0, Math.min(4095, Math.round(4095 * (raw ? v : shoulder(1.6 * v)))))];
            }
            data[4 * i + 3] = 255;
        }
        return {data, w, h, cell, samples: of.samples};
    }
    function probe(query) {
        const x = +query.get("x"), y = +query.get("y"), layer = query.get("layer") ?? "beauty";
        if (!(x >= 0 && y >= 0 && x < width && y < height)) return null;
        const of = snapshotOf(), rgb = at(x + 0.5, y + 0.5, of, layer), {f, r, u} = basis(of.camera), s = 0.72 / height, h = hit(of.camera.from, unit(add(add(f, r, (x + 0.5 - width / 2) * s), u, (height / 2 - y - 0.5) * s)));
        const relative = 0.5 / Math.sqrt(Math.max(1, state.samples.done)), spectrum = [];
        if (query.get("spectrum") === "1") for (let nm = 380; nm <= 720; nm += 5) { const v = 0.02 * (rgb[0] * Math.exp(-(((nm - 610) / 60) ** 2)) + rgb[1] * Math.exp(-(((nm - 545) / 50) ** 2)) + rgb[2] * Math.exp(-(((nm - 455) / 40) ** 2))); spectrum.push([nm, v, v * relative * 2]); }
        return {x, y, samples: state.samples.done, luminance: 683 * 0.01 * (0.27 * rgb[0] + 0.67 * rgb[1] + 0.06 * rgb[2]), unit: "cd/m²", rgb, space: "ACEScg", error: rgb.map(v => v * relative), relative_error: relative,
                object: crowd ? "an object with a name that is longer than the panel is wide, still going on" : h?.thing.name ?? null, material: h?.thing.material ?? null, depth: h?.t ?? null, position: h?.point ?? null, spectrum: spectrum.length ? spectrum : null, spectrum_unit: "W·m⁻²·sr⁻¹·nm⁻¹"};
    }
    const wrong = (message, help) => ({status: 400, body: {error: {message, help}}});
    function control(body) {
        if (body.pause !== undefined) state.status = body.pause ? "paused" : state.samples.done >= mock.goal ? "done" : "rendering";
        if (body.restart) { state.status = "rendering"; again(); }
        if (body.samples) { mock.goal = state.samples.goal = body.samples; if (state.status === "done" && state.samples.done < mock.goal) state.status = "rendering"; }
        if (body.save) { saved = snapshotOf(); state.saved = true; }
        dirty = true;
    }
    const posts = {
        "/api/camera": body => moveCamera(body) ? {status: 200, body: state.camera} : wrong("no such move", "orbit, pan, dolly, fly, reset"),
        "/api/region"(body) { state.frame.region = "x0" in body ? [body.x0, body.y0, body.x1, body.y1] : null; again(); return {status: 200, body: {}}; },
        "/api/groups"(body) { Object.assign(mock.weights, body.weights); for (const g of state.groups) g.weight = mock.weights[g.name] ?? 1; dirty = true; return {status: 200, body: {}}; },
        "/api/control"(body) { control(body); return {status: 200, body: {}}; },
        "/api/other"(body) { if (body.path && !/\.exr$/.test(body.path)) return wrong(`“${body.path}” is no EXR`, "Only files below the scene’s folder are read."); state.other = body.path ? {path: body.path} : null; dirty = true; return {status: 200, body: {}}; },
        "/api/snapshot": () => ({status: 200, body: {files: ["shot.view-0001.exr", "shot.view-0001.png"]}}),
    };
    // As if the scene's file had been saved: change(state) says what is different.
    mock.save = change => {
        if (state.status !== "error") { saved = snapshotOf(); state.saved = true; }
        state.save = ++mock.saves;
        change?.(state);
        if (state.status !== "error") { again(); state.reuse = {...state.reuse, shapes_kept: 4, shapes_loaded: 0, structure: "kept", textures_kept: 2, textures_read: 0, kept: "shapes, textures, lights", seconds: {read: 0.003, build: 0.002, commit: 0, first_pixels: 0.09}}; }
        dirty = true;
        speak();
    };
    mock.touch = () => { dirty = true; };

    function respond(response, status, type, body, more = {}) {
        response.writeHead(status, {"Content-Type": type, "Cache-Control": "no-store", "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Content-Security-Policy": policy, ...more});
        response.end(body);
    }
    const json = (response, status, value) => respond(response, status, "application/json", JSON.stringify(value));
    const allowed = (request, url, port) => {
        const mine = [`127.0.0.1:${port}`, `localhost:${port}`], {host, origin} = request.headers, site = request.headers["sec-fetch-site"];
        return mine.includes(host) && (!origin || mine.includes(origin.replace("http://", ""))) && (!site || ["none", "same-origin"].includes(site)) && [url.searchParams.get("token"), request.headers["x-abbe-token"], url.pathname.match(/^\/page\/([^/]+)\//)?.[1]].includes(token);
    };
    function pageFile(response, name) {
        try {
            if (!/^[\w.]+$/.test(name)) throw new Error("no");
            respond(response, 200, types[extname(name)], readFileSync(join(folder, name)));
        } catch { json(response, 404, {error: {message: "no such file"}}); }
    }
    const gets = {
        "/": (_, response) => respond(response, 200, types[".html"], readFileSync(join(folder, "view.html"), "utf8").replaceAll("@TOKEN@", token)),
        "/api/state": (_, response) => json(response, 200, state),
        "/api/events"(request, response) { response.writeHead(200, {"Content-Type": "text/event-stream", "Cache-Control": "no-store"}); response.write(`event: state\ndata: ${JSON.stringify(state)}\n\n`); clients.add(response); request.on("close", () => clients.delete(response)); },
        "/api/picture"(_, response, url) {
            const made = picture(url.searchParams);
            if (!made) { respond(response, 204, "application/octet-stream"); return; }
            respond(response, 200, "application/octet-stream", made.data, {"X-Width": made.w, "X-Height": made.h, "X-Frame-Width": width, "X-Frame-Height": height, "X-Version": state.picture.version, "X-Samples": made.samples, "X-Cell": made.cell});
        },
        "/api/probe"(_, response, url) { const made = probe(url.searchParams); if (made) json(response, 200, made); else json(response, 400, {error: {message: "there is no such pixel", help: ""}}); },
    };
    const server = createServer((request, response) => {
        const url = new URL(request.url, "http://127.0.0.1"), {port} = server.address();
        mock.requests.push(`${request.method} ${url.pathname}${url.search}`);
        if (url.pathname === "/favicon.ico") { respond(response, 204, "image/x-icon"); return; }
        if (!allowed(request, url, port)) { json(response, 403, {error: {message: "the token is missing or another", help: "Open the address that abbe view printed."}}); return; }
        if (request.method === "GET" && gets[url.pathname]) { gets[url.pathname](request, response, url); return; }
        if (request.method === "GET" && url.pathname.startsWith("/page/")) { pageFile(response, url.pathname.split("/").slice(3).join("/")); return; }
        if (request.method !== "POST" || !posts[url.pathname]) { json(response, 404, {error: {message: "no such thing", help: ""}}); return; }
        let text = "";
        request.on("data", data => { text += data; });
        request.on("end", () => { const body = JSON.parse(text || "{}"); mock.posts.push([url.pathname, body]); const {status, body: out} = posts[url.pathname](body); json(response, status, out); });
    });
    await new Promise(done => server.listen(wantedPort, "127.0.0.1", done));
    mock.port = server.address().port;
    mock.url = `http://127.0.0.1:${mock.port}/?token=${token}`;
    // Ends connections, too, as a program that is stopped does.
    mock.stop = () => new Promise(done => { timers.forEach(clearInterval); server.close(done); server.closeAllConnections(); });
    return mock;
}

if (process.argv[1] === fileURLToPath(import.meta.url)) console.log((await startMock(process.argv[2], +process.argv[3] || 0)).url);
