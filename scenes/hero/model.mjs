#!/usr/bin/env node
// Makes the models and the sky of hero.scene:
//
//     node scenes/hero/model.mjs
//
// Everything is a formula, but for the cloth: a net of springs that falls onto the table. Lengths are centimetres, y is up. What
// has a colour at its vertices (peel, petals, leaves) has it linear, as Rec. 709.
import fs from "node:fs";
import path from "node:path";
import {fileURLToPath} from "node:url";

const folder = path.dirname(fileURLToPath(import.meta.url));
const {sin, cos, PI, abs, min, max, sqrt, exp, hypot} = Math;
const mix = (a, b, t) => a + (b - a) * t;
const mixed = (a, b, t) => a.map((x, i) => mix(x, b[i], t));
const smooth = (from, to, x) => {
    const t = min(1, max(0, (x - from) / (to - from)));
    return t * t * (3 - 2 * t);
};

// Smooth noise of one, two or three numbers, -1 to 1.
function noise(x, y = 0, z = 0) {
    const at = (i, j, k) => {
        let h = Math.imul(i, 374761393) ^ Math.imul(j, 668265263) ^ Math.imul(k, 2147483647);
        h = Math.imul(h ^ (h >>> 13), 1274126177);
        return ((h ^ (h >>> 16)) >>> 0) / 2147483648 - 1;
    };
    const cell = [x, y, z].map(Math.floor), [u, v, w] = [x, y, z].map((c, i) => smooth(0, 1, c - cell[i]));
    const [i, j, k] = cell;
    const edge = (b, c) => mix(at(i, j + b, k + c), at(i + 1, j + b, k + c), u);
    return mix(mix(edge(0, 0), edge(1, 0), v), mix(edge(0, 1), edge(1, 1), v), w);
}

// Piecewise linear through rows of position and value, rounded at the rows by subdivision later.
function curve(rows, t) {
    let i = 0;
    while (i + 2 < rows.length && t > rows[i + 1][0]) ++i;
    const [a, b] = [rows[i], rows[i + 1]];
    return mix(a[1], b[1], smooth(0, 1, (t - a[0]) / (b[0] - a[0])));
}

class Mesh {
    points = [];
    coordinates = [];
    colors = [];
    faces = [];

    add(point, uv, color) {
        if (uv) this.coordinates.push(uv);
        if (color) this.colors.push(color);
        return this.points.push(point) - 1;
    }

    // Rows of points; neighbours become quads. Closed ones join the last point of a row with its first.
    net(rows, {closed = false, turned = false} = {}) {
        const n = rows[0].length;
        for (let i = 0; i + 1 < rows.length; ++i)
            for (let j = 0; j < (closed ? n : n - 1); ++j) {
                const k = (j + 1) % n, quad = [rows[i][j], rows[i + 1][j], rows[i + 1][k], rows[i][k]];
                this.faces.push(turned ? quad.reverse() : quad);
            }
    }

    save(name) {
        const columns = ["x", "y", "z"];
        if (this.coordinates.length) columns.push("s", "t");
        if (this.colors.length) columns.push("red", "green", "blue");
        const rows = this.points.map((p, i) => [...p, ...(this.coordinates[i] ?? []), ...(this.colors[i] ?? [])]);
        const lines = [
            "ply", "format ascii 1.0", "comment made by scenes/hero/model.mjs", `element vertex ${rows.length}`,
            ...columns.map(c => `property float ${c}`), `element face ${this.faces.length}`,
            "property list uchar int vertex_indices", "end_header", ...rows.map(r => r.map(x => +x.toFixed(3)).join(" ")),
            ...this.faces.map(f => [f.length, ...f].join(" "))];
        fs.writeFileSync(path.join(folder, name), lines.join("\n") + "\n");
    }
}

// A body of revolution from its profile [radius, height], which goes round anticlockwise from the axis below to the axis above or,
// for hollow things, back to the axis inside.
function turned(name, profile, sides = 24) {
    const mesh = new Mesh();
    const rows = profile.map(([r, y]) => Array.from({length: sides}, (_, k) => {
        const a = 2 * PI * k / sides;
        return mesh.add([r * sin(a), y, r * cos(a)]);
    }));
    mesh.net(rows, {closed: true, turned: true});
    mesh.faces.push([...rows[0]].reverse(), rows.at(-1));
    mesh.save(name);
}

// A sheet of some thickness between two nets of points of the same size.
function slab(mesh, outer, inner) {
    mesh.net(outer);
    mesh.net(inner, {turned: true});
    const rim = rows => [...rows[0].slice(0, -1), ...rows.slice(0, -1).map(r => r.at(-1)), ...[...rows.at(-1)].reverse().slice(0, -1),
        ...[...rows].reverse().slice(0, -1).map(r => r[0])];
    mesh.net([rim(outer), rim(inner)], {closed: true, turned: true});
}

function teaGlass() {
    // The wall is 2 mm thick, the bottom 8 mm; the side of the tea lies inside the wall.
    const outer = [[0.05, 0], [1.6, 0], [2.1, 0.06], [2.3, 0.35], [2.75, 1.2], [3.0, 2.2], [2.85, 3.4], [2.45, 4.6], [2.25, 5.6], [2.35, 6.8],
        [2.65, 8.2], [2.98, 9.7], [3.05, 10.1]];
    const rim = [[3.06, 10.22], [2.98, 10.27], [2.9, 10.22]];
    const inner = [[2.86, 10.1], [2.78, 9.7], [2.45, 8.2], [2.15, 6.8], [2.05, 5.6], [2.25, 4.6], [2.65, 3.4], [2.79, 2.2], [2.5, 1.35],
        [1.9, 0.92], [1.0, 0.82], [0.05, 0.8]];
    turned("glass.ply", [...outer, ...rim, ...inner], 32);
    const side = [[1.3, 0.7], [1.95, 0.76], [2.6, 1.25], [2.89, 2.2], [2.75, 3.4], [2.35, 4.6], [2.15, 5.6], [2.25, 6.8], [2.51, 8.0]];
    const top = [[2.535, 8.22], [2.5, 8.2], [2.38, 8.08], [2.15, 8.03], [1.0, 8.02], [0.05, 8.02]];
    turned("tea.ply", [[0.05, 0.68], ...side, ...top], 32);
}

function brassJug() {
    turned("jug.ply", [[0.05, 0], [2.9, 0], [3.1, 0.1], [3.1, 0.5], [2.7, 0.75], [3.0, 1.3], [4.3, 3.2], [4.7, 5.2], [4.3, 7.2], [3.1, 8.9],
        [2.35, 10], [2.25, 11], [2.6, 12.2], [3.0, 12.7], [3.1, 12.85], [3.0, 12.95], [2.85, 12.85], [2.4, 12.2], [2.05, 11], [2.15, 10],
        [2.9, 8.9], [4.1, 7.2], [4.5, 5.2], [4.1, 3.2], [2.5, 1.4], [0.05, 1.1]], 24);
}

function bowl() {
    turned("bowl.ply", [[0.05, 0.35], [3.2, 0.35], [3.35, 0], [3.75, 0], [3.9, 0.6], [5.6, 1.6], [7.6, 3.6], [8.6, 6.1], [8.75, 6.75], [8.6, 6.95],
        [8.4, 6.8], [8.2, 6.1], [7.2, 3.9], [5.3, 2.1], [3.2, 1.25], [0.05, 1.0]], 28);
}

// A fruit as a cube whose points are drawn onto a sphere, with a dent where the stalk was.
function orange(name, radius, seed) {
    const mesh = new Mesh(), n = 8, known = new Map();
    const corner = c => {
        const key = c.join(" ");
        if (!known.has(key)) {
            const d = c.map(x => Math.tan(x * PI / 4)), l = hypot(...d), [x, y, z] = d.map(v => v / l);
            const dent = 0.13 * exp(-((1 - y) / 0.012)) + 0.05 * exp(-((1 + y) / 0.01));
            const r = radius * (1 - dent + 0.012 * noise(x * 1.7 + seed, y * 1.7, z * 1.7));
            known.set(key, mesh.add([x * r, 0.955 * y * r, z * r]));
        }
        return known.get(key);
    };
    for (let axis = 0; axis < 3; ++axis)
        for (const side of [-1, 1]) {
            const at = (i, j) => {
                const c = [0, 0, 0];
                c[axis] = side, c[(axis + 1) % 3] = 2 * i / n - 1, c[(axis + 2) % 3] = 2 * j / n - 1;
                return corner(c);
            };
            const rows = Array.from({length: n + 1}, (_, i) => Array.from({length: n + 1}, (_, j) => at(i, j)));
            mesh.net(rows, {turned: side < 0});
        }
    mesh.save(name);
}

// One of ten segments of a peeled orange, about the z axis: a rounded wedge, plump outside.
function segment(mesh, turn, {radius = 3.05, half = 17.4, seed = 0, place = p => p} = {}) {
    const outline = [[0.1, 0], [0.38, 0.92], [0.7, 0.97], [0.9, 0.9], [0.985, 0.62], [1.0, 0.22], [1.0, -0.22], [0.985, -0.62], [0.9, -0.9],
        [0.7, -0.97], [0.38, -0.92]];
    const rows = [];
    for (let i = 0; i <= 14; ++i) {
        const t = mix(5, 175, i / 14) * PI / 180;
        rows.push(outline.map(([r, a], j) => {
            const wobble = 1 + 0.018 * noise(i * 0.9 + seed * 7.3, j * 1.3 + turn);
            const angle = turn * PI / 180 + a * half * PI / 180, rho = r * radius * sin(t) ** 0.9 * wobble;
            return mesh.add(place([rho * sin(angle), 0.9 * radius * cos(t) * (0.84 + 0.16 * r) * wobble, rho * cos(angle)]));
        }));
    }
    mesh.net(rows, {closed: true, turned: true});
    mesh.faces.push([...rows[0]].reverse(), rows.at(-1));
}

function peeledOrange() {
    // Eight of ten segments are still together, and lean apart a little around the gap.
    const whole = new Mesh();
    for (let k = 0; k < 9; ++k)
        segment(whole, 36 * k + 62 + (k === 0 ? 3 : k === 8 ? -3 : 0), {seed: k, half: 17.6 - 0.3 * noise(k * 3.1)});
    whole.save("segments.ply");
    const single = new Mesh();
    segment(single, 0, {seed: 21, half: 19});
    single.save("segment.ply");
}

const peelOutside = [0.85, 0.27, 0.012], peelInside = [0.86, 0.74, 0.48];

// The peel, opened like a flower: five flaps that start under the fruit and still curl as they grew.
function peel() {
    const mesh = new Mesh();
    for (let k = 0; k < 5; ++k) {
        const about = 2 * PI * (k + 0.12 * noise(k * 5.3)) / 5 + 0.35, length = 7.0 + 1.0 * noise(k * 2.7 + 0.4), bend = 0.2 + 0.035 * noise(k * 1.9);
        const outer = [], inner = [];
        for (let i = 0; i <= 14; ++i) {
            const v = i / 14, width = 2.35 * smooth(-0.25, 0.45, v) * sqrt(max(0, 1 - v ** 3.2)) + 0.12;
            const rows = [[], []];
            for (let j = 0; j <= 6; ++j) {
                const u = j / 3 - 1, s = v * length, across = u * width * (1 + 0.12 * noise(v * 4 + k * 9, u * 2));
                const lift = 0.05 + (k % 2) * 0.04, angle = lift + bend * s * 0.85;
                // Along the middle line: an arc. Across: the fruit's own curvature.
                const r = (sin(angle) - sin(lift)) / (bend * 0.85), y = (cos(lift) - cos(angle)) / (bend * 0.85);
                const up = across * across / 6.5, tilt = across / 3.4;
                const n = [-sin(angle), cos(angle)];
                const thick = 0.3 + 0.06 * noise(u * 3 + k * 4, v * 8);
                for (const [which, h] of [[0, 0], [1, thick]]) {
                    const out = r + n[0] * (up + h * cos(tilt)), height = y + n[1] * (up + h * cos(tilt)) + 0.12, side = across - h * sin(tilt);
                    const p = [out * sin(about) + side * cos(about), height, out * cos(about) - side * sin(about)];
                    rows[which].push(mesh.add(p, null, which ? mixed(peelInside, [0.9, 0.62, 0.25], 0.25 + 0.25 * noise(u * 4, v * 9, k)) : peelOutside));
                }
            }
            outer.push(rows[0]), inner.push(rows[1]);
        }
        slab(mesh, outer.map(r => [...r].reverse()), inner.map(r => [...r].reverse()));
    }
    mesh.save("peel.ply");
}

// A tulip: three petals inside three others. Without thickness; the colour runs from green at the base to a blush at the rim.
function tulip(name, open, seed) {
    const mesh = new Mesh();
    for (let k = 0; k < 6; ++k) {
        const inside = k < 3 ? 0.86 : 1, about = 2 * PI * (k % 3) / 3 + (k < 3 ? PI / 3 : 0) + 0.15 * noise(k * 3.7 + seed);
        const flare = open * (1 + 0.5 * noise(k * 2.3 + seed * 5)), tall = 5.4 * (1 + 0.06 * noise(k * 7.1 + seed));
        const rows = [];
        for (let i = 0; i <= 18; ++i) {
            const v = i / 18;
            const r = inside * (curve([[0, 0.25], [0.12, 1.05], [0.42, 1.78], [0.75, 1.62], [1, 1.35]], v) + flare * v * v);
            const width = 1.75 * smooth(-0.2, 0.5, v) * max(0, 1 - v ** 5) ** 0.7 + 0.03;
            rows.push(Array.from({length: 13}, (_, j) => {
                const u = j / 6 - 1, a = about + u * width / max(r, 0.9);
                const fold = -0.1 * exp(-((u / 0.2) ** 2)) + 0.16 * u * u * v + 0.09 * noise(u * 2.5 + k * 11 + seed, v * 4) * v;
                const streak = noise(u * 9 + k * 5, v * 0.8 + seed), rim = smooth(0.35, 1.05, v * 0.75 + 0.35 * abs(u) + 0.12 * streak);
                const color = mixed(mixed([0.5, 0.56, 0.16], [0.84, 0.74, 0.55], smooth(0.05, 0.35, v)), [0.86, 0.36, 0.32], 0.85 * rim);
                return mesh.add([(r + fold) * sin(a), tall * (v - 0.06 * u * u * v), (r + fold) * cos(a)], null, color);
            }));
        }
        mesh.net(rows);
    }
    mesh.save(name);
}

// A lanceolate leaf that rises along +z and bends over.
function leaf(name, length, width, bend, seed) {
    const mesh = new Mesh(), rows = [];
    let y = 0, z = 0;
    for (let i = 0; i <= 20; ++i) {
        const v = i / 20, angle = mix(1.35, 1.35 - bend, v * v);
        y += sin(angle) * length / 20, z += cos(angle) * length / 20;
        const w = width * smooth(-0.15, 0.35, v) * max(0, 1 - v ** 2.6) ** 0.9 + 0.02;
        rows.push(Array.from({length: 7}, (_, j) => {
            const u = j / 3 - 1, up = 0.55 * w * u * u + 0.25 * noise(v * 3 + seed, u) * v, side = 0.3 * noise(v * 2 + seed * 3) * v;
            const vein = 0.5 + 0.5 * noise(u * 6 + seed, v * 0.7);
            const color = mixed([0.16, 0.3, 0.07], [0.3, 0.42, 0.14], vein * 0.7 + 0.3 * (1 - v));
            return mesh.add([u * w + side, y + up * cos(angle), z - up * sin(angle)], null, color);
        }));
    }
    mesh.net(rows);
    mesh.save(name);
}

// A teaspoon along x: a bowl, a neck and a handle that widens towards its end.
function spoon() {
    const mesh = new Mesh(), rows = [], length = 12.5;
    const wide = [[0, 0.25], [0.04, 0.85], [0.15, 1.42], [0.27, 1.1], [0.36, 0.32], [0.5, 0.24], [0.85, 0.42], [0.97, 0.5], [1, 0.3]];
    const dish = [[0, 0.02], [0.05, 0.3], [0.15, 0.62], [0.28, 0.35], [0.36, 0.02], [1, 0]];
    const rise = [[0, 0.75], [0.2, 0.72], [0.36, 0.85], [0.55, 1.15], [0.85, 0.5], [1, 0.16]];
    for (let i = 0; i <= 40; ++i) {
        const t = i / 40, w = curve(wide, t), d = curve(dish, t), y = curve(rise, t), h = 0.16;
        const top = [-1, -0.6, 0, 0.6, 1].map(s => [s * w, y - d * (1 - s * s)]);
        const below = [0.95, 0.55, 0, -0.55, -0.95].map(s => [s * w, y - d * (1 - s * s) - h]);
        rows.push([...top, ...below].map(([z, up]) => mesh.add([(t - 0.5) * length, up, z])));
    }
    mesh.net(rows, {closed: true, turned: true});
    mesh.faces.push([...rows[0]].reverse(), rows.at(-1));
    mesh.save("spoon.ply");
}

// Cloth: points with springs to their neighbours, laid down in loose folds, then pulled by gravity. It slides where it touches.
function cloth() {
    const nu = 96, nv = 66, step = 0.45, count = nu * nv;
    const p = new Float64Array(3 * count), q = new Float64Array(3 * count), at = (i, j) => 3 * (i + nu * j);
    for (let j = 0; j < nv; ++j)
        for (let i = 0; i < nu; ++i) {
            const u = i * step, v = j * step, k = at(i, j);
            const crest = 1.1 * noise(u * 0.16 + 0.4 * v * 0.16, v * 0.07 + 3) + 0.8 * noise(u * 0.33 - v * 0.1 + 9, v * 0.14) +
                0.35 * noise(u * 0.6 + v * 0.4, v * 0.5 - u * 0.2 + 20);
            p[k] = u * (0.89 + 0.015 * sin(v * 0.3)), p[k + 1] = 0.75 + 0.8 * crest, p[k + 2] = v * 0.93 + 0.8 * noise(u * 0.1, v * 0.1 + 7);
        }
    q.set(p);
    const springs = [];
    const join = (i, j, di, dj, stiff) => {
        if (i + di >= 0 && i + di < nu && j + dj < nv) springs.push([at(i, j), at(i + di, j + dj), step * hypot(di, dj), stiff]);
    };
    for (let j = 0; j < nv; ++j)
        for (let i = 0; i < nu; ++i)
            for (const [di, dj, stiff] of [[1, 0, 1], [0, 1, 1], [1, 1, 0.35], [-1, 1, 0.35], [3, 0, 0.12], [0, 3, 0.12], [6, 0, 0.1], [0, 6, 0.1]])
                join(i, j, di, dj, stiff);
    const ground = 0.12;
    for (let time = 0; time < 70; ++time) {
        for (let k = 0; k < 3 * count; k += 3) {
            const touching = p[k + 1] <= ground + 1e-3;
            for (let c = 0; c < 3; ++c) {
                const old = p[k + c];
                p[k + c] += (p[k + c] - q[k + c]) * (touching && c !== 1 ? 0.1 : 0.93) - (c === 1 ? 0.003 : 0);
                q[k + c] = old;
            }
        }
        for (let round = 0; round < 12; ++round) {
            for (const [a, b, rest, stiff] of springs) {
                const x = p[b] - p[a], y = p[b + 1] - p[a + 1], z = p[b + 2] - p[a + 2], l = sqrt(x * x + y * y + z * z);
                const f = 0.5 * stiff * (l - rest) / l;
                p[a] += f * x, p[a + 1] += f * y, p[a + 2] += f * z, p[b] -= f * x, p[b + 1] -= f * y, p[b + 2] -= f * z;
            }
            for (let k = 1; k < 3 * count; k += 3) p[k] = max(p[k], ground);
        }
    }
    const mesh = new Mesh(), rows = [];
    for (let j = 0; j < nv; ++j)
        rows.push(Array.from({length: nu}, (_, i) => mesh.add([...p.subarray(at(i, j), at(i, j) + 3)], [i / (nu - 1), j / (nv - 1)])));
    mesh.net(rows);
    mesh.save("cloth.ply");
    return mesh;
}

// What the window looks out on: a bright hazy sky over dark trees, towards -x; black everywhere else, which the room hides.
function sky() {
    const w = 256, h = 128, bytes = [];
    for (let j = 0; j < h; ++j)
        for (let i = 0; i < w; ++i) {
            const elevation = 90 - 180 * (j + 0.5) / h, side = abs(i + 0.5 - w / 4) / (w / 4);
            const trees = smooth(-2, 4, elevation - 6 - 4 * noise(i * 0.12) - 2 * noise(i * 0.45));
            const air = mixed([1.0, 0.93, 0.82], [0.62, 0.74, 0.95], smooth(0, 50, elevation));
            const ground = mixed([0.1, 0.12, 0.05], [0.05, 0.075, 0.03], smooth(-30, 0, elevation));
            const rgb = mixed(ground, air, trees).map(x => x * (side < 1 ? 1 : 0));
            const most = max(...rgb, 1e-9), e = most > 1e-6 ? Math.ceil(Math.log2(most)) : -128;
            bytes.push(...(e === -128 ? [0, 0, 0, 0] : [...rgb.map(x => min(255, Math.floor(x / 2 ** e * 256))), e + 128]));
        }
    fs.writeFileSync(path.join(folder, "sky.hdr"),
        Buffer.concat([Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${h} +X ${w}\n`), Buffer.from(bytes)]));
}

teaGlass(), brassJug(), bowl(), peeledOrange(), peel(), spoon(), cloth(), sky();
orange("orange.ply", 3.7, 0);
tulip("tulip.ply", 0.35, 1), tulip("tulip-open.ply", 1.3, 4);
leaf("leaf.ply", 17, 1.7, 1.5, 2), leaf("leaf-long.ply", 21, 1.4, 0.8, 6);
