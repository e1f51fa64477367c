#!/usr/bin/env node
// Draws docs/images/folders.svg: the libraries of CMakeLists.txt, one for each folder, from the commands down to what everything stands on.
// An arrow says which library uses which; where another way leads there, too, it is left out.
//   tools/make_folder_graph.mjs            writes the picture
//   tools/make_folder_graph.mjs --check    says whether the picture is that of CMakeLists.txt
import {existsSync, readFileSync, readdirSync, writeFileSync} from "node:fs";
import {dirname, join} from "node:path";
import {fileURLToPath} from "node:url";

const root = dirname(dirname(fileURLToPath(import.meta.url)));
const target = join(root, "docs/images/folders.svg");

// Colours by the part of the program; a library that no part names is drawn grey.
const parts = [
    {title: "commands and reports", fill: "#e3ebf7", line: "#5b7db1", folders: ["commands", "command_line", "render_run", "reports", "checkpoints", "pages", "pictures", "language_server", "app"]},
    {title: "measurements", fill: "#efe6f5", line: "#8a64a8", folders: ["study", "verify", "doctor", "denoise"]},
    {title: "the scene and what it is made of", fill: "#e4f1e4", line: "#5a955a", folders: ["scene", "geometry", "lights", "cameras", "film", "media", "materials", "textures"]},
    {title: "light transport", fill: "#fbe9dc", line: "#c07a3e", folders: ["rendering", "path_tracing", "caustics", "transport", "light_sampling"]},
    {title: "language, files, foundation", fill: "#f4f0dc", line: "#9c8b3a", folders: ["parser", "schema", "render", "io", "volumes", "spectrum", "math", "base"]},
];

// --- the graph

function librariesOf(cmake) {
    const libraries = new Map();
    for (const [, name, folder, rest] of cmake.replace(/#.*/g, "").matchAll(/^abbe_library\((\w+)\s+([\w/]+)([^)]*)\)/gm)) {
        const below = [...rest.matchAll(/abbe::(\w+)/g)].map(m => m[1]);
        const path = join(root, folder);
        const inner = readdirSync(path, {withFileTypes: true}).filter(e => e.isDirectory() && readdirSync(join(path, e.name)).some(f => f.endsWith(".h")))
            .map(e => e.name).filter(n => n !== "data").sort();
        libraries.set(name, {name, folder, inner, below});
    }
    // Folders inside of one that is drawn are named there, whether or not they are libraries of their own.
    const all = [...libraries.values()];
    const drawn = l => all.find(other => l.folder.startsWith(`${other.folder}/`)) ?? l;
    for (const l of all) drawn(l).below.push(...l.below);
    for (const l of all) if (drawn(l) !== l) libraries.delete(l.name);
    const nameDrawn = new Map(all.map(l => [l.name, drawn(l).name]));
    for (const l of libraries.values()) l.below = [...new Set(l.below.map(b => nameDrawn.get(b) ?? b))].filter(b => b !== l.name);
    return libraries;
}

function reduce(libraries) {
    const reaches = new Map();
    const reach = name => {
        if (!reaches.has(name)) {
            const all = new Set();
            for (const b of libraries.get(name).below) for (const r of [b, ...reach(b)]) all.add(r);
            reaches.set(name, all);
        }
        return reaches.get(name);
    };
    for (const l of libraries.values()) l.below = l.below.filter(b => !l.below.some(other => other !== b && reach(other).has(b)));
}

// --- the layout: rows by distance from the bottom, orders in which few lines cross

function rowsOf(libraries) {
    const height = new Map();
    const heightOf = name => {
        if (!height.has(name)) height.set(name, 1 + Math.max(-1, ...libraries.get(name).below.map(heightOf)));
        return height.get(name);
    };
    const rows = [];
    const nodes = new Map();
    const place = (id, row, below, library) => {
        const node = {id, row, below, above: [], library};
        nodes.set(id, node);
        (rows[row] ??= []).push(node);
        return node;
    };
    for (const l of libraries.values()) place(l.name, heightOf(l.name), [], l);
    for (const l of libraries.values())
        for (const b of l.below) { // long lines go through a point in each row
            let from = nodes.get(l.name);
            for (let row = from.row - 1; row > nodes.get(b).row; --row) {
                const way = place(`${l.name}>${b}:${row}`, row, [], null);
                from.below.push(way);
                way.above.push(from);
                from = way;
            }
            from.below.push(nodes.get(b));
            nodes.get(b).above.push(from);
        }
    return rows;
}

const widthOf = node => node.library ? Math.max(66, 8.2 * Math.max(node.library.folder.replace(/^src\//, "").length, node.library.inner.join(" ").length * 0.78) + 22) : 14;
const kGap = 14, kRow = 66, kBox = 32;

function spread(row) { // as near to where they want to be as there is room
    for (const n of row) n.width = widthOf(n);
    for (let pass = 0; pass < 60; ++pass)
        for (let i = 0; i + 1 < row.length; ++i) {
            const gap = (row[i].width + row[i + 1].width) / 2 + kGap - (row[i + 1].x - row[i].x);
            if (gap > 0) { row[i].x -= gap / 2; row[i + 1].x += gap / 2; }
        }
}

function crossings(rows) {
    let count = 0;
    for (const row of rows) {
        const lines = row.flatMap((n, i) => n.below.map(b => [i, b.index]));
        for (let a = 0; a < lines.length; ++a)
            for (let b = a + 1; b < lines.length; ++b) count += (lines[a][0] - lines[b][0]) * (lines[a][1] - lines[b][1]) < 0;
    }
    return count;
}

function order(rows) {
    const number = () => rows.forEach(row => row.forEach((n, i) => { n.index = i; }));
    number();
    let best = rows.map(r => [...r]), least = crossings(rows);
    for (let sweep = 0; sweep < 200; ++sweep) {
        const down = sweep % 2 === 0;
        for (const row of down ? [...rows].reverse() : rows) {
            const wish = n => {
                const near = down ? n.above : n.below;
                return near.length ? near.reduce((s, o) => s + o.index, 0) / near.length : n.index;
            };
            const wishes = new Map(row.map(n => [n, wish(n) + (sweep > 50 ? ((n.index * 7919 + sweep * 104729) % 17) / 40 : 0)]));
            row.sort((a, b) => wishes.get(a) - wishes.get(b));
            row.forEach((n, i) => { n.index = i; });
        }
        const now = crossings(rows);
        if (now < least) { least = now; best = rows.map(r => [...r]); }
    }
    best.forEach((r, i) => { rows[i] = r; });
    number();
}

function position(rows) {
    for (const row of rows) row.forEach((n, i) => { n.x = (i - (row.length - 1) / 2) * 100; });
    for (const row of rows) spread(row);
    for (let sweep = 0; sweep < 300; ++sweep)
        for (const row of sweep % 2 ? rows : [...rows].reverse()) {
            for (const n of row) {
                const near = [...n.above, ...n.below];
                if (near.length) n.x += (near.reduce((s, o) => s + o.x, 0) / near.length - n.x) * (n.library ? 0.5 : 0.8);
            }
            spread(row);
        }
    const all = rows.flat();
    const left = Math.min(...all.map(n => n.x - n.width / 2));
    for (const n of all) n.x += 24 - left;
    rows.forEach((row, i) => row.forEach(n => { n.y = 40 + (rows.length - 1 - i) * kRow; }));
    return {width: Math.max(...all.map(n => n.x + n.width / 2)) + 24, height: rows.length * kRow + 40};
}

// --- the picture

const round = v => Math.round(v * 10) / 10;

function curve(points) { // smooth through the points, upright at both ends
    const slope = i => {
        if (i === 0 || i === points.length - 1) return 0;
        return (points[i + 1].x - points[i - 1].x) / (points[i + 1].y - points[i - 1].y);
    };
    let d = `M${round(points[0].x)} ${round(points[0].y)}`;
    for (let i = 1; i < points.length; ++i) {
        const a = points[i - 1], b = points[i], third = (b.y - a.y) * 0.4;
        d += `C${round(a.x + slope(i - 1) * third)} ${round(a.y + third)} ${round(b.x - slope(i) * third)} ${round(b.y - third)} ${round(b.x)} ${round(b.y)}`;
    }
    return d;
}

function svgOf(libraries) {
    reduce(libraries);
    const rows = rowsOf(libraries);
    order(rows);
    const size = position(rows);
    const lines = [], boxes = [];
    for (const node of rows.flat().filter(n => n.library)) {
        const part = parts.find(p => p.folders.includes(node.library.name)) ?? {fill: "#eeeeee", line: "#777777"};
        for (let next of node.below) {
            const points = [{x: node.x, y: node.y + kBox / 2}];
            while (!next.library) {
                points.push({x: next.x, y: next.y});
                [next] = next.below;
            }
            points.push({x: next.x, y: next.y - kBox / 2 - 5});
            lines.push(`<path d="${curve(points)}" stroke="${part.line}"/>`);
        }
        const name = node.library.folder.replace(/^src\//, ""), inner = node.library.inner.join(" ");
        boxes.push(`<rect x="${round(node.x - node.width / 2)}" y="${round(node.y - kBox / 2)}" width="${round(node.width)}" height="${kBox}" rx="5" fill="${part.fill}" stroke="${part.line}"/>`);
        boxes.push(`<text x="${round(node.x)}" y="${round(node.y + (inner ? -1 : 4.5))}">${name}</text>`);
        if (inner) boxes.push(`<text class="inner" x="${round(node.x)}" y="${round(node.y + 11)}">${inner}</text>`);
    }
    const legend = parts.map((p, i) => `<rect x="24" y="${14 + i * 19}" width="12" height="12" rx="2" fill="${p.fill}" stroke="${p.line}"/><text class="legend" x="42" y="${24 + i * 19}">${p.title}</text>`);
    const width = Math.ceil(size.width), height = Math.ceil(size.height);
    return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}" role="img" aria-label="The folders of Abbe and which uses which">
<!-- made by tools/make_folder_graph.mjs -->
<style>text{font:13px system-ui,"Segoe UI",Helvetica,Arial,sans-serif;text-anchor:middle;fill:#222}.inner{font-size:10px;fill:#555}.legend{font-size:12px;text-anchor:start}path{fill:none;stroke-width:1.3;marker-end:url(#tip)}</style>
<defs><marker id="tip" viewBox="0 0 8 8" refX="4" refY="4" markerWidth="7" markerHeight="7" orient="auto"><path d="M0 0L8 4L0 8z" style="fill:#666;stroke:none;marker-end:none"/></marker></defs>
<rect width="100%" height="100%" fill="#ffffff"/>
${legend.join("\n")}
${lines.join("\n")}
${boxes.join("\n")}
</svg>
`;
}

const svg = svgOf(librariesOf(readFileSync(join(root, "CMakeLists.txt"), "utf8")));
if (process.argv[2] === "--check") {
    if (!existsSync(target) || readFileSync(target, "utf8") !== svg) {
        console.error("docs/images/folders.svg is not that of CMakeLists.txt: run tools/make_folder_graph.mjs");
        process.exit(1);
    }
} else {
    writeFileSync(target, svg);
}
