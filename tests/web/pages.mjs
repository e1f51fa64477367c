// Opens pages in a headless Chromium and fails on whatever a reader would mind:  node pages.mjs STUDY_PAGE_OF COMPARE.html
import {execFileSync} from "node:child_process";
import {existsSync, mkdirSync, readFileSync, writeFileSync} from "node:fs";
import {resolve} from "node:path";
import {Browser} from "./browser.mjs";
import {complaints, plotsHeld} from "./looks.mjs";
import {oddities, ordinary} from "./studies.mjs";

const [studyPageOf, comparePage] = process.argv.slice(2);
const shots = process.env.ABBE_SCREENSHOTS; // a folder to leave pictures in, for looking at
let faults = 0, checks = 0;
function check(what, right, more = "") {
    ++checks;
    if (right) return;
    ++faults;
    console.log(`FAULT: ${what}${more ? `: ${more}` : ""}`);
}
const same = (what, value, wanted) => check(what, JSON.stringify(value) === JSON.stringify(wanted), `${JSON.stringify(value)} instead of ${JSON.stringify(wanted)}`);
const run = (page, f) => page.evaluate(`(${f})()`);

async function clean(page, what) {
    for (const fault of page.faults) check(what, false, fault);
    for (const complaint of (await run(page, complaints)).slice(0, 12)) check(what, false, complaint);
    ++checks;
}
async function keep(page, name) {
    if (!shots) return;
    mkdirSync(shots, {recursive: true});
    writeFileSync(`${shots}/${name}.png`, await page.screenshot());
}
// A browser that minds nothing would pass everything.
async function mindsFaults(browser) {
    writeFileSync("bad.html", `<!doctype html><title>x</title><body style="width:3000px;background:#777"><p style="color:#888">grey on grey</p><svg class="plot" width="90" height="40"><text x="10" y="20">first</text>
<text x="12" y="20">second</text><text x="80" y="20">outside it</text><path d="MNaN,1"/></svg><div style="width:40px;white-space:nowrap"><p>much too long for its place</p></div><img src="none.png">
<script>console.error("told"); new Image().src = "http://127.0.0.1:9/far.png"; setTimeout(() => { throw new Error("thrown"); });</script>`);
    const page = await browser.open("bad.html"), told = [...page.faults, ...await run(page, complaints)];
    for (const word of ["console: told", "request: http://127.0.0.1:9", "exception: Error: thrown", "none.png", "the page is 3", "clipped", "one over the other", "outside its plot", "NaN", "contrast"])
        check("a bad page", told.some(text => text.includes(word)), `nothing was said of ${word}; heard: ${told.join(" | ")}`);
    await page.close();
}

const shownAtFirst = study => study.curves.filter(c => c.group === study.curves[0].group || c.group === (study.curves.find(d => d.group !== study.curves[0].group) || c).group);
function expectedPlot(curves, axis) {
    const points = curves.flatMap(c => c.points).filter(p => (axis === "samples" ? p.samples : p.seconds) > 0);
    return {curves: curves.length, marks: points.filter(p => p.relMse > 0).length, arrows: points.filter(p => !(p.relMse > 0) && p.high > 0).length, floors: curves.filter(c => c.floor && c.floor.low > 0).length,
            lines: curves.filter(c => c.points.filter(p => p.relMse > 0 && p.seconds > 0).length > 1).length, bands: curves.filter(c => c.points.filter(p => p.high > 0).length > 1).length,
            fits: curves.filter(c => c.fit && c.points.filter(p => p.relMse > 0).length > 1).length};
}
async function plotsAre(page, what, curves) {
    const held = await run(page, plotsHeld);
    same(`${what}: axes`, held.map(h => h.axis), ["seconds", "samples"]);
    for (const h of held) {
        const wanted = expectedPlot(curves, h.axis), got = Object.fromEntries(Object.keys(wanted).map(key => [key, h[key]]));
        same(`${what}: against ${h.axis}`, got, wanted);
        same(`${what}: points to find against ${h.axis}`, h.spots, wanted.marks + wanted.arrows);
        check(`${what}: ticks`, h.xticks >= 3 && h.yticks >= 3 && h.guides >= 2, JSON.stringify(h));
    }
}

async function studyPage(browser, name, study, sizes) {
    writeFileSync(`${name}.json`, JSON.stringify(study));
    execFileSync(studyPageOf, [`${name}.json`, `${name}.html`]);
    for (const [width, scheme] of sizes) {
        const what = `${name}, ${width} pixels, ${scheme}`, page = await browser.open(`${name}.html`, {width, scheme});
        same(what, await page.evaluate("document.documentElement.dataset.ready"), "true");
        const [r, g, b] = (await page.evaluate("getComputedStyle(document.body).backgroundColor")).match(/\d+/g).map(Number);
        check(`${what}: background`, scheme === "dark" ? r + g + b < 120 : r + g + b > 690, `${r} ${g} ${b}`);
        if (study.curves.length) await plotsAre(page, what, shownAtFirst(study));
        check(`${what}: findings`, await page.evaluate("document.querySelectorAll('.findings li').length") >= 1);
        const sections = ["convergence", "time", "efficiency", "strips", "cost", "effects", "data"].filter(id => ({convergence: study.curves.length, time: study.curves.length, efficiency: study.curves.filter(c => c.efficiency.ratio > 0).length > 1,
            strips: (study.strips || []).some(s => s.images.length), cost: study.cost, effects: study.effects, data: true})[id]);
        same(`${what}: sections`, await page.evaluate("[...document.querySelectorAll('section')].map(s => s.id)"), sections);
        await clean(page, what);
        await keep(page, `${name}-${width}-${scheme}`);
        await page.close();
    }
}

const press = (page, key) => page.send("Input.dispatchKeyEvent", {type: "keyDown", key, code: key}).then(() => page.send("Input.dispatchKeyEvent", {type: "keyUp", key, code: key}));
async function studyInUse(browser, study) {
    const page = await browser.open("ordinary.html"), text = selector => page.evaluate(`document.querySelector(${JSON.stringify(selector)}).textContent`);
    // groups and single curves
    await page.click('[data-group="wavelengths"]');
    await plotsAre(page, "another group", study.curves.filter(c => ["main", "wavelengths"].includes(c.group)));
    await page.click('.chips [data-curve="1"]');
    await plotsAre(page, "without one curve", study.curves.filter(c => ["abbe", "w1", "w2", "w4"].includes(c.id)));
    same("pictures follow", await page.evaluate("document.querySelectorAll('.strips figure').length"), 5);
    await page.click('.chips [data-curve="1"]');
    await page.click('[data-group="all"]');
    await plotsAre(page, "all curves", study.curves);
    await page.click('[data-group="all"]');
    await plotsAre(page, "the main group alone", study.curves.filter(c => c.group === "main"));
    // without the worst pixels: lines and points alone
    await page.click('[data-trimmed="yes"]');
    await plotsAre(page, "trimmed", study.curves.filter(c => c.group === "main").map(c => ({...c, fit: null, floor: null, points: c.points.map(p => ({...p, relMse: p.trimmed, high: null}))})));
    await page.click('[data-trimmed="no"]');
    // the tip by keys and by the pointer
    await page.evaluate("document.querySelector('.frame').focus()");
    await press(page, "ArrowRight");
    await press(page, "ArrowDown");
    const name = await text("#tip b");
    check("keys go to another curve", study.curves.some(c => c.label === name), name);
    const at = await page.evaluate(`(() => { const f = document.querySelectorAll(".frame")[1], s = f.spots.find(s => s.curve === 0 && s.point === 3); f.scrollIntoView(); const b = f.getBoundingClientRect();
        return {x: b.left + s.x, y: b.top + s.y}; })()`);
    await page.send("Input.dispatchMouseEvent", {type: "mouseMoved", ...at});
    await page.settled();
    const tip = await text("#tip"), point = study.curves[0].points[3];
    check("the tip tells the point", tip.includes("as rendered") && tip.includes(String(point.samples)) && tip.includes((100 * Math.sqrt(point.relMse)).toPrecision(3)), tip);
    check("the curve stands out", await page.evaluate("document.querySelector('.hot .curve.on').dataset.curve") === "0");
    // the magnifier
    await page.click('[data-zoom="8"]');
    same("all pictures are magnified", await page.evaluate("[...document.querySelectorAll('.view')].every(v => v.matches('.near') && v.firstChild.style.transform === 'scale(8)')"), true);
    // what is saved is what was measured
    await browser.send("Browser.setDownloadBehavior", {behavior: "allow", downloadPath: resolve(".")});
    const saved = async (button, file) => {
        await page.evaluate(`[...document.querySelectorAll("button")].find(b => b.textContent === ${JSON.stringify(button)}).click()`);
        for (let i = 0; i < 100 && !existsSync(file); ++i) await page.settled();
        return existsSync(file) ? readFileSync(file, "utf8") : "";
    };
    check("saved JSON", await saved("Save JSON", "cornell-box.study.json") === JSON.stringify(study));
    same("saved CSV", (await saved("Save CSV", "cornell-box.study.csv")).trim().split("\n").length, 1 + study.curves.flatMap(c => c.points).length);
    // colours by the button, whatever the system says
    const paper = () => page.evaluate("getComputedStyle(document.body).backgroundColor"), light = await paper();
    await page.click("#theme");
    const dark = await paper();
    check("the button darkens", light !== dark, dark);
    await clean(page, "dark by the button");
    check("it prints", (await page.print()).subarray(0, 5).toString() === "%PDF-");
    await page.close();
}

async function hostileText(browser, study) {
    const page = await browser.open("hostile.html");
    check("a title is a text", (await page.evaluate("document.title")).startsWith("</script>"));
    same("no text became an element", await page.evaluate("document.querySelectorAll('img[onerror], section script, main script, h1 *, td b').length"), 0);
    check("it is shown as it is", (await page.evaluate("document.body.textContent")).includes(study.curves[2].label));
    await page.close();
}

// What is null is not zero, and a line is not followed for years.
// Intervals without an upper end, and times that more samples do not need.
async function withoutBounds(browser) {
    const page = await browser.open("noise.html"), text = await page.evaluate("document.querySelector('main').textContent");
    for (const right of ["3.0 … no upper bound", "of fixed time apart, against", "are pilots and plans that more samples do not need"]) check(`noise: “${right}”`, text.includes(right), text.slice(0, 900));
    check("noise: no number without end", !/Infinity|NaN|e\+/.test(text), text.slice(0, 900));
    await page.close();
}

async function unknownFigures(browser) {
    const page = await browser.open("nulls.html"), text = await page.evaluate("document.querySelector('main').textContent");
    for (const wrong of ["0 … 0", "NaN", "null", "undefined", "years", "(95\u00a0%: )"]) check(`nulls: “${wrong}”`, !text.includes(wrong), text.slice(Math.max(0, text.indexOf(wrong) - 80), text.indexOf(wrong) + 40));
    for (const right of ["−0.510", "> 3 h", "With “denoised” the same error takes about 10× as long."]) check(`nulls: “${right}”`, text.includes(right), text.slice(0, 600));
    await page.close();
}

// Rows of the cost report in which nothing was spent or counted are left out; what is spent elsewhere is no time of the row.
async function costOf(browser) {
    const page = await browser.open("ordinary.html"), rows = await page.evaluate("[...document.querySelectorAll('#cost tbody tr')].map(r => [...r.cells].map(c => c.textContent))");
    same("rows of the cost report", rows.length, 9);
    same("a row of the cost report", rows[5], ["volume haze", "80 ms± 6 ms".replace("80", "80.0"), "4.00\u00a0%", "0.500 s", "300\u202f000", "400\u202f000 densities"]);
    await page.close();
}

// Findings that warn.
async function warnings(browser) {
    const page = await browser.open("noise.html"), text = await page.evaluate("document.querySelector('.findings').textContent");
    for (const right of ["The time ran out before all was measured", "the best image has 2.1 times its mean square error"]) check(`noise: “${right}”`, text.includes(right), text);
    await page.close();
}

async function compare(browser) {
    for (const [width, scheme] of [[1280, "light"], [1280, "dark"]]) {
        const page = await browser.open(comparePage, {width, scheme}), what = `compare, ${width} pixels, ${scheme}`;
        const colours = () => page.evaluate(`(() => { const c = document.getElementById("canvas"), k = document.createElement("canvas").getContext("2d", {willReadFrequently: true});
            k.canvas.width = c.width; k.canvas.height = c.height; k.drawImage(c, 0, 0); const d = k.getImageData(0, 0, c.width, c.height).data, s = new Set();
            for (let i = 0; i < d.length; i += 4) if (d[i + 3]) s.add(d[i] << 16 | d[i + 1] << 8 | d[i + 2]); return s.size; })()`);
        check(`${what}: a picture`, await colours() > 20, `${await colours()} colours`);
        same(`${what}: views`, await page.evaluate("document.querySelectorAll('#views button').length"), 7);
        const labels = new Set();
        for (const key of ["a", "b", "w", "d", "s", "f"]) {
            await page.evaluate(`window.dispatchEvent(new KeyboardEvent("keydown", {key: "${key}"}))`);
            await page.settled();
            labels.add(`${await page.evaluate("document.getElementById('label').textContent")}`);
            check(`${what}: view ${key}`, await colours() > 1);
        }
        same(`${what}: names of views`, labels.size, 6);
        await page.evaluate(`canvas.dispatchEvent(new PointerEvent("pointermove", {clientX: canvas.getBoundingClientRect().left + canvas.clientWidth / 2, clientY: canvas.getBoundingClientRect().top + canvas.clientHeight / 2}))`);
        await page.settled();
        check(`${what}: the probe`, await page.evaluate("document.querySelectorAll('#probe tr').length") >= 6);
        check(`${what}: figures`, await page.evaluate("document.querySelectorAll('#figures tr').length") >= 5);
        await clean(page, what);
        await keep(page, `compare-${width}-${scheme}`);
        await page.close();
    }
}

const browser = await Browser.start();
try {
    await mindsFaults(browser);
    const study = ordinary(), odd = oddities(), both = [[1280, "light"], [400, "dark"]];
    await studyPage(browser, "ordinary", study, [...both, [1280, "dark"], [400, "light"]]);
    for (const [name, each] of Object.entries(odd)) await studyPage(browser, name, each, both);
    await studyInUse(browser, study);
    await hostileText(browser, odd.hostile);
    await unknownFigures(browser);
    await withoutBounds(browser);
    await costOf(browser);
    await warnings(browser);
    await compare(browser);
} finally {
    await browser.close();
}
console.log(`${checks} checks, ${faults} faults`);
process.exit(faults > 0 || checks < 100 ? 1 : 0);
