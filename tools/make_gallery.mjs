#!/usr/bin/env node
// Builds docs/gallery: for each scene of the table below a picture with its cost report, a study, its report and its plot, and the page
// that shows them all.
//   tools/make_gallery.mjs [--abbe PROGRAM] [--out FOLDER] [--work FOLDER] [--threads N] [--study-time SECONDS] [--study-samples N]
//                          [--study-size PIXELS] [--seeds N] [--variants LIST] [--samples-scale X] [--size-scale X] [--only index] [NAME …]
// What WORK holds already with the same arguments and scene files is kept, and what was interrupted goes on: run it again to continue. Everything but
// times is the same in every run when --study-samples is given; without it a study takes as many samples as its time allows.
import {spawn} from "node:child_process";
import {createHash} from "node:crypto";
import {copyFileSync, existsSync, mkdirSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync} from "node:fs";
import {availableParallelism, cpus} from "node:os";
import {dirname, join, relative, resolve} from "node:path";
import {fileURLToPath} from "node:url";
import {parseArgs} from "node:util";

const root = dirname(dirname(fileURLToPath(import.meta.url)));
const kMaxPng = 300000; // bytes: pages with a dozen of them must open at once

// Samples are for about a minute on two cores or less.
const gallery = [
    {name: "glass-caustic", shows: "caustics: light gathered by a ball of glass", size: [400, 250], samples: 1024},
    {name: "prism", shows: "dispersion: a rainbow from a prism of flint", size: [320, 240], samples: 4096},
    {name: "color-bleeding", shows: "colour bleeding: light that takes the colour of walls", size: [400, 250], samples: 256},
    {name: "cornell-box", shows: "the Cornell box from its measured data", size: [320, 320], samples: 512},
    {name: "veach-mis", shows: "multiple importance sampling: plates from rough to smooth, lights from small to large", size: [400, 267], samples: 256},
    {name: "many-lights", shows: "many lights: a thousand of them over a square at night", size: [320, 320], samples: 256},
    {name: "light-shaft", shows: "volumes: sun through a window into haze, and smoke", size: [400, 250], samples: 256},
    {name: "milk-and-juice", shows: "dense media in glass: measured milk and juice", size: [400, 250], samples: 64},
    {name: "parametric-shapes", shows: "glass, gold and paint on box, cylinder, cone and torus", size: [400, 200], samples: 512},
    {name: "subdivision-still-life", shows: "subdivision: four cages and their limit surfaces", size: [400, 225], samples: 256},
    {name: "jade-dragon", shows: "subsurface scattering: a displaced dragon of jade, lit from behind", size: [320, 360], samples: 384},
    {name: "hair-ball", shows: "hair: 18 000 strands, coloured by melanin", size: [400, 300], samples: 64},
];

function fail(text) {
    console.error(`make_gallery: ${text}`);
    process.exit(1);
}
function readArguments() {
    const text = value => ({type: "string", default: value});
    let read;
    try {
        read = parseArgs({allowPositionals: true, options: {
            abbe: text(join(root, "build/release/abbe")), out: text(join(root, "docs/gallery")), work: text(join(root, "build/gallery")), threads: text("0"),
            "study-time": text("120"), "study-samples": text(""), "study-size": text("112"), seeds: text("8"), variants: text("no-nee,lights-only,random,denoised"),
            "samples-scale": text("1"), "size-scale": text("1"), only: text("")}});
    } catch (error) {
        fail(error.message);
    }
    const {values, positionals} = read;
    for (const key of ["threads", "study-time", "study-size", "seeds", "samples-scale", "size-scale"])
        if (!(Number(values[key]) >= 0)) fail(`--${key} ${values[key]} is no number`);
    if (!["", "index"].includes(values.only)) fail(`--only knows \`index\``);
    const unknown = positionals.filter(name => !gallery.some(entry => entry.name === name));
    if (unknown.length) fail(`no scene of the gallery is named ${unknown.join(", ")}; there are ${gallery.map(e => e.name).join(", ")}`);
    return {...values, scenes: gallery.filter(entry => !positionals.length || positionals.includes(entry.name))};
}
const options = readArguments();
// As seen from the source tree, where the program runs: headers and reports keep their command and should not tell of this machine.
const inTree = relative(root, resolve(options.work)), work = inTree.startsWith("..") ? resolve(options.work) : inTree;
const at = (entry, ending) => join(root, inTree, `${entry.name}${ending}`), typed = (entry, ending) => join(work, `${entry.name}${ending}`);
const sceneOf = entry => join("scenes", entry.name, `${entry.name}.scene`);

// Runs the program in the source tree, so that commands in headers and reports are those that a reader can type.
// It saves what it has when it is told to end, and so is told what this one is told; at a terminal it hears of Ctrl-C by itself.
let running = null;
process.on("SIGINT", () => {});
process.on("SIGTERM", () => running?.kill("SIGTERM"));
async function abbe(...words) {
    running = spawn(resolve(options.abbe), words, {cwd: root, stdio: ["ignore", "pipe", "inherit"], env: {...process.env, NO_COLOR: "1"}});
    let text = "";
    running.stdout.on("data", data => { text += data; });
    const status = await new Promise(done => running.on("error", error => fail(`${options.abbe}: ${error.message}`)).on("close", (code, signal) => done(code ?? signal)));
    if (status !== 0) fail(`abbe ${words.join(" ")} ended with ${status}; run this again to go on`);
    return text;
}
// A step is done when what it leaves was made with these words from this scene.
async function step(entry, name, results, words, run) {
    const hash = createHash("sha256");
    for (const file of readdirSync(join(root, "scenes", entry.name)).filter(f => !/\.(md|png)$/.test(f)).sort()) hash.update(readFileSync(join(root, "scenes", entry.name, file)));
    const key = JSON.stringify([words, hash.digest("hex")]), mark = at(entry, `.${name}.done`);
    if (existsSync(mark) && readFileSync(mark, "utf8") === key && results.every(existsSync)) return 0;
    const started = Date.now(), begun = at(entry, `.${name}.begun`), goesOn = existsSync(begun) && readFileSync(begun, "utf8") === key;
    writeFileSync(begun, key);
    await run(goesOn);
    rmSync(begun);
    writeFileSync(mark, key);
    return (Date.now() - started) / 1000;
}

function renderPicture(entry) {
    const size = entry.size.map(v => Math.max(8, Math.round(v * options["size-scale"]))).join("x"), samples = Math.max(8, Math.round(entry.samples * options["samples-scale"]));
    const words = ["render", sceneOf(entry), "--size", size, "--samples", String(samples), "-o", typed(entry, ".exr"), `--png=${typed(entry, ".png")}`, "-q", ...(options.threads > 0 ? ["-t", options.threads] : [])];
    return step(entry, "picture", [at(entry, ".exr"), at(entry, ".png"), at(entry, ".info.json")], words, async goesOn => {
        await abbe(...words, ...(goesOn ? ["--resume"] : []));
        writeFileSync(at(entry, ".info.json"), await abbe("info", at(entry, ".exr"), "--json"));
    });
}
function study(entry) {
    const [w, h] = entry.size, side = Number(options["study-size"]), size = [w, h].map(v => Math.max(8, Math.round(v * side / Math.max(w, h)))).join("x");
    const effort = options["study-samples"] ? ["--samples", options["study-samples"]] : ["--time", options["study-time"]];
    const words = ["study", sceneOf(entry), "--size", size, ...effort, "--seeds", options.seeds, "--variants", options.variants, "-o", typed(entry, ".study"), "-q", ...(options.threads > 0 ? ["-t", options.threads] : [])];
    return step(entry, "study", [at(entry, ".study.json"), at(entry, ".study.html")], words, goesOn => abbe(...words, ...(goesOn ? ["--resume"] : [])));
}

// The very scripts of the report write its sentences and draw its plot here.
const page = (() => {
    const folder = join(root, "src/pages/data/study_page"), script = ["plot.js", "findings.js"].map(name => readFileSync(join(folder, name), "utf8")).join("");
    return new Function(`"use strict";${script}return {errorPlot, findingsOf, timeText, percent, errorText, significant, countText, isNumber, positive};`)();
})();

// Text from outside in Markdown, where it may stand in a table.
const inMarkdown = text => String(text).replace(/[\\`*_{}\[\]<>|#]/g, c => `\\${c}`).replace(/\s+/g, " ");
function facts(entry) {
    const info = JSON.parse(readFileSync(at(entry, ".info.json"), "utf8")), measured = JSON.parse(readFileSync(at(entry, ".study.json"), "utf8"));
    return {...entry, info, attributes: info.attributes, study: measured, fit: (measured.curves[0] || {}).fit || {}};
}
function costRows(f) {
    const cost = f.info.cost || f.study.cost || f.info.bill || f.study.bill || {}; // `bill` in files of before November 2026
    const rows = (cost.rows || []).filter(r => r.seconds > 0 || r.elsewhere > 0).sort((a, b) => b.seconds - a.seconds);
    if (!rows.length) return [];
    const total = cost.seconds > 0 ? cost.seconds : rows.reduce((sum, r) => sum + r.seconds, 0);
    const small = rows.filter(r => r.seconds < 0.005 * total && !(r.elsewhere > 0));
    if (small.length > 1) rows.splice(0, rows.length, ...rows.filter(r => !small.includes(r)), {label: `${small.length} smaller rows`, seconds: small.reduce((sum, r) => sum + r.seconds, 0)});
    return ["", "| cost | seconds | share | in other rows | rays |", "|---|--:|--:|--:|--:|",
            ...rows.map(r => `| ${inMarkdown(r.label)} | ${r.seconds.toFixed(2)} | ${page.percent(r.seconds / total, 2)} | ${r.elsewhere > 0 ? r.elsewhere.toFixed(2) : ""} | ${r.rays > 0 ? page.countText(r.rays) : ""} |`)];
}
function sectionOf(f) {
    const findings = page.findingsOf(f.study).map(words => `- ${words.map((text, i) => i % 2 ? `**${inMarkdown(text)}**` : inMarkdown(text)).join("")}`);
    return [`## ${f.name}`, "", `${f.shows[0].toUpperCase()}${f.shows.slice(1)}. [Scene](${relativeTo(join(root, "scenes", f.name))}) · [report](${f.name}.html)`, "",
            `<img src="${f.name}.png" alt="${f.name}" height="260"> <img src="${f.name}.svg" alt="Error against time of ${f.name}" height="260">`, "", ...findings, ...costRows(f), "",
            "    " + (f.attributes["abbe.command"] || "").replaceAll(`${work}/`, "").replace(/\s+/g, " "), ""];
}
const relativeTo = path => relative(resolve(options.out), path);
function lineOf(f) {
    const a = f.attributes, error = f.info.error && f.info.error.relative, slope = f.fit.slope;
    return `| [${f.name}](#${f.name}) | ${f.shows} | ${page.timeText(a["abbe.seconds"])} | ${a["abbe.samples"]} | ${error ? page.percent(error.value, 2) : "–"} | ` +
        `${page.isNumber(slope) ? page.significant(slope / 2, 2) : "–"} | [report](${f.name}.html) |`;
}
function writeIndex(entries) {
    const all = entries.map(facts), machine = all[0].study.machine || {};
    const lines = ["# Gallery", "", `${all.length} scenes, each with its picture, its error, where its time went, and what accuracy costs on it.`, "",
        "* **error** is the relative error that the header of the picture states.",
        "* **slope** is the power of the number of samples with which the relative error falls; averaging gives −0.5.",
        "* **report** is a single file that needs no network: save it and open it in a browser.",
        "* **in other rows** are seconds that an effect caused and other rows count.", "",
        `Times are of ${inMarkdown(machine.cpu || cpus()[0].model)} with ${machine.threads || availableParallelism()} threads, in one run. \`tools/make_gallery.mjs\` makes this page; edits by hand are lost.`, "",
        "| scene | shows | time | samples | error | slope | report |", "|---|---|--:|--:|--:|--:|---|", ...all.map(lineOf), "", ...all.flatMap(sectionOf)];
    mkdirSync(options.out, {recursive: true});
    const written = new Set(["README.md"]);
    for (const f of all) {
        for (const [from, to] of [[".png", ".png"], [".study.html", ".html"]]) {
            copyFileSync(at(f, from), join(options.out, f.name + to));
            written.add(f.name + to);
        }
        const bytes = statSync(at(f, ".png")).size;
        if (bytes > kMaxPng) fail(`${f.name}.png has ${bytes} bytes, more than ${kMaxPng}: give it fewer pixels in the table`);
        writeFileSync(join(options.out, `${f.name}.svg`), page.errorPlot(f.study, {axis: "seconds", width: 600, height: 400, id: "plot", labels: true, runs: false, standalone: true, title: `${f.name}: error against time`}).svg + "\n");
        written.add(`${f.name}.svg`);
    }
    writeFileSync(join(options.out, "README.md"), lines.join("\n"));
    for (const name of readdirSync(options.out)) if (/\.(png|svg|html)$/.test(name) && !written.has(name)) rmSync(join(options.out, name)); // of scenes that are gone
    const bytes = [...written].reduce((sum, name) => sum + statSync(join(options.out, name)).size, 0);
    console.log(`${join(options.out, "README.md")}: ${all.length} scenes, ${(bytes / 1e6).toFixed(1)} MB`);
}

mkdirSync(join(root, inTree), {recursive: true});
if (options.only !== "index") {
    if (!existsSync(options.abbe)) fail(`no program ${options.abbe}: cmake --preset release && cmake --build build/release --target abbe, or --abbe`);
    for (const entry of options.scenes) {
        const picture = await renderPicture(entry), measured = await study(entry);
        console.log(`${entry.name}: picture ${picture.toFixed(0)} s, study ${measured.toFixed(0)} s`);
    }
}
// Scenes of earlier runs stay.
const whole = gallery.filter(entry => [".png", ".info.json", ".study.json", ".study.html"].every(ending => existsSync(at(entry, ending))));
if (!whole.length) fail(`${join(root, inTree)} holds no scene that is done`);
writeIndex(whole);
