// What an edit costs in a live view, by the clock:  node bench/first_pixels.mjs PROGRAM [TIMES] SCENE…
// Starts `abbe view` on a copy beside each scene, edits a roughness or reflectance of it (a comment where it states none)
// TIMES times, 5 without, and prints seconds from a save to the first pixels: the first time, and the median of the edits.
import {spawn} from "node:child_process";
import {readFileSync, renameSync, rmSync, writeFileSync} from "node:fs";
import {basename, dirname, join} from "node:path";

const [, , program, ...rest] = process.argv;
const times = /^\d+$/.test(rest[0] ?? "") ? Number(rest.shift()) : 5;
const sleep = ms => new Promise(done => setTimeout(done, ms));
const median = list => [...list].sort((a, b) => a - b)[list.length >> 1];

// Another value of the same kind each time.
function edited(text, i) {
    const found = text.match(/\b(roughness|reflectance) (0\.\d+)/);
    return found ? text.replace(found[0], `${found[1]} ${(0.2 + 0.05 * i).toFixed(2)}`) : `${text}\n// edit ${i}\n`;
}

async function measure(scene) {
    const copy = join(dirname(scene), `first-pixels-${process.pid}-${basename(scene)}`), text = readFileSync(scene, "utf8");
    const save = content => { writeFileSync(`${copy}~`, content); renameSync(`${copy}~`, copy); };
    save(text);
    const child = spawn(program, ["view", copy, "--size", "640x360"], {stdio: ["ignore", "pipe", "inherit"]});
    try {
        const url = await new Promise(done => child.stdout.once("data", data => done(new URL(String(data).trim()))));
        const state = async () => (await fetch(`${url.origin}/api/state`, {headers: {"X-Abbe-Token": url.searchParams.get("token")}})).json();
        const shown = async save => {
            for (;;) {
                const now = await state();
                if (now.status === "error") throw new Error(JSON.stringify(now.diagnostics));
                if (now.save >= save && now.reuse.seconds.first_pixels) return now;
                await sleep(20);
            }
        };
        const first = await shown(1), edits = [], buildings = [], cells = [];
        for (let i = 0; i < times; ++i) {
            await sleep(2500); // into the samples of the picture, as it is when somebody edits
            const before = (await state()).save;
            save(edited(text, i));
            const now = await shown(before + 1);
            edits.push(now.reuse.seconds.first_pixels);
            buildings.push(now.reuse.seconds.build + now.reuse.seconds.commit);
            cells.push(now.picture.cell);
        }
        const s = first.reuse.seconds;
        console.log(`| ${basename(dirname(scene))}/${basename(scene, ".scene")} | ${(s.build + s.commit).toFixed(2)} | ${s.first_pixels.toFixed(2)} | ${median(buildings).toFixed(3)} | ${median(edits).toFixed(2)} | ${Math.max(...edits).toFixed(2)} |`);
    } finally {
        child.kill("SIGINT");
        rmSync(copy, {force: true});
    }
}

console.log("| scene | building, first | first pixels, first | building after an edit | first pixels after an edit | the slowest of them |\n|---|---|---|---|---|---|");
for (const scene of rest) await measure(scene);
