// The gallery's page and plots, from made-up measurements of two scenes:  node gallery.mjs STUDY_PAGE_OF
import {execFileSync, spawnSync} from "node:child_process";
import {existsSync, mkdirSync, readFileSync, readdirSync, writeFileSync} from "node:fs";
import {dirname, join} from "node:path";
import {fileURLToPath} from "node:url";
import {Browser} from "./browser.mjs";
import {complaints} from "./looks.mjs";
import {generator, ordinary, png} from "./studies.mjs";

const tool = join(dirname(fileURLToPath(import.meta.url)), "../../tools/make_gallery.mjs"), [studyPageOf] = process.argv.slice(2);
let faults = 0;
const check = (what, right, more = "") => { if (!right) { ++faults; console.log(`FAULT: ${what}${more ? `: ${more}` : ""}`); } };
const make = (...words) => spawnSync(process.execPath, [tool, "--work", "work", "--out", "gallery", "--only", "index", ...words], {encoding: "utf8"});

function prepare(name, seed, cost, side = 64) {
    const study = ordinary(seed), random = generator(seed);
    study.curves = study.curves.slice(0, 5);
    Object.assign(study.scene, {name, path: `scenes/${name}/${name}.scene`});
    writeFileSync(`work/${name}.study.json`, JSON.stringify(study));
    execFileSync(studyPageOf, [`work/${name}.study.json`, `work/${name}.study.html`]);
    writeFileSync(`work/${name}.png`, Buffer.from(png(side, side, () => [random(), random(), random()]), "base64"));
    writeFileSync(`work/${name}.info.json`, JSON.stringify({cost, error: {relative: {value: 0.0213}},
        attributes: {"abbe.seconds": 12.3, "abbe.samples": 256, "abbe.command": `abbe render scenes/${name}/${name}.scene -o x.exr`}}));
    return study;
}

mkdirSync("work");
check("nothing is done: a fault", make().status !== 0);
check("an unknown scene is a fault", make("no-such-scene").status !== 0 && make("no-such-scene").stderr.includes("cornell-box"));
check("an unknown option is a fault", make("--sizes", "3").status !== 0);
prepare("prism", 1, {seconds: 10, rows: [{id: "embree", label: "Embree | rays", seconds: 6, rays: 123456}, {id: "film", label: "film", seconds: 4, rays: 0}, {id: "motion", label: "motion", seconds: 0, rays: 0}]});
const study = prepare("cornell-box", 2, null);
delete study.cost;
const {status, stderr} = make();
check("the gallery is made", status === 0, stderr);
const index = readFileSync("gallery/README.md", "utf8"), once = readdirSync("gallery").map(name => [name, readFileSync(`gallery/${name}`, "utf8")]);
check("a line of the table", /\| \[prism\]\(#prism\) \| dispersion: .* \| 12 s \| 256 \| 2\.1.% \| −0\.\d+ \| \[report\]\(prism\.html\) \|/.test(index), index.slice(0, 1500));
check("where the time went", index.includes("| cost | seconds |") && index.includes("| Embree \\| rays | 6.00 | 60\u00a0% |  | 123\u202f456 |") && !index.includes("motion"), index);
check("findings", index.includes("- Halving the noise costs **"));
// what it mentions is there, and what is there is mentioned
const links = [...index.matchAll(/\]\(([^)#]+)\)|src="([^"]+)"/g)].map(m => m[1] ?? m[2]), files = links.filter(link => !link.startsWith("..") && !link.includes("scenes/"));
check("links", files.length === 8, files.join());
for (const file of files) check("a file that is mentioned", existsSync(join("gallery", file)), file);
for (const file of readdirSync("gallery")) check("a file that is not mentioned", file === "README.md" || files.includes(file), file);
make();
check("twice the same", JSON.stringify(once) === JSON.stringify(readdirSync("gallery").map(name => [name, readFileSync(`gallery/${name}`, "utf8")])));

const browser = await Browser.start();
try {
    for (const scheme of ["light", "dark"]) {
        // As in a page of Markdown: the drawing alone, as a picture.
        const page = await browser.open("gallery/prism.svg", {width: 700, height: 500, scheme});
        for (const fault of [...page.faults, ...await page.evaluate(`(${complaints})()`)]) check(`the plot, ${scheme}`, false, fault);
        const [curves, labels, fill] = await page.evaluate("[document.querySelectorAll('.curve').length, document.querySelectorAll('.label').length, getComputedStyle(document.querySelector('rect')).fill]");
        check(`the plot, ${scheme}: curves and names`, curves === 5 && labels === 5, `${curves}, ${labels}`);
        const sum = fill.match(/\d+/g).map(Number).reduce((a, b) => a + b);
        check(`the plot, ${scheme}: its ground`, scheme === "dark" ? sum < 120 : sum > 690, fill);
        if (process.env.ABBE_SCREENSHOTS) writeFileSync(`${process.env.ABBE_SCREENSHOTS}/gallery-${scheme}.png`, await page.screenshot(false));
        await page.close();
    }
} finally {
    await browser.close();
}
prepare("cornell-box", 2, null, 400); // noise that no compression makes smaller
check("a picture that is too large is a fault", make().status !== 0 && make().stderr.includes("more than"));
console.log(`${faults} faults`);
process.exit(faults > 0 ? 1 : 0);
