// The page of `abbe view` against a made-up program (view_mock.mjs): what hands and keys do, and how it looks in every state.
import {mkdirSync, writeFileSync} from "node:fs";
import {apart, hands, pause, troubles} from "./hands.mjs";
import {complaints} from "./looks.mjs";
import {startMock} from "./view_mock.mjs";

const shots = process.env.ABBE_SCREENSHOTS; // a folder to leave pictures in, for looking at
export async function keep(page, name) {
    if (!shots) return;
    mkdirSync(shots, {recursive: true});
    writeFileSync(`${shots}/view-${name}.png`, await page.screenshot(false));
}
const picture = "document.getElementById('empty').hidden", ready = "document.documentElement.dataset.ready === 'true'";

export async function clean(page, what, check, narrow = false) {
    for (const fault of page.faults) check(what, false, fault);
    for (const complaint of [...await page.evaluate(`(${complaints})()`), ...await page.evaluate(`(${troubles})(${narrow})`)].slice(0, 12)) check(what, false, complaint);
    check(what, true);
}
async function opened(browser, variant, options, task) {
    const mock = await startMock(variant), page = await browser.open(mock.url + (options.fragment ?? ""), options), h = hands(page);
    try {
        await h.until(ready);
        await task({mock, page, h, sent: (path, name) => mock.posts.filter(([p, body]) => p === `/api/${path}` && (!name || name in body)).map(([, body]) => body)});
    } finally {
        await page.close();
        await mock.stop();
    }
}

async function everyState(browser, check) {
    for (const variant of ["ordinary", "empty", "tiny", "huge", "broken", "crowded"])
        for (const [width, scheme] of [[1280, "light"], [400, "dark"], ...["ordinary", "broken"].includes(variant) ? [[1280, "dark"], [400, "light"]] : []])
            await opened(browser, variant, {width, height: width > 500 ? 860 : 800, scheme}, async ({page, h}) => {
                const what = `${variant}, ${width} pixels, ${scheme}`, seen = variant !== "empty";
                check(`${what}: a picture`, await h.until(`Boolean(document.getElementById("empty").hidden) === ${seen}`, 20000));
                await page.evaluate("document.querySelectorAll('details').forEach(d => { d.open = true; })");
                if (seen) { await h.press("Enter"); check(`${what}: the probe`, await h.until("document.querySelectorAll('.values tr').length === 3")); }
                await page.settled();
                const sum = (await page.evaluate("getComputedStyle(document.body).backgroundColor")).match(/\d+/g).map(Number).reduce((a, b) => a + b);
                check(`${what}: background`, scheme === "dark" ? sum < 150 : sum > 690, sum);
                await clean(page, what, check, width < 500);
                await keep(page, `${variant}-${width}-${scheme}`);
                if (variant !== "ordinary") return;
                await page.click("#help-button");
                await clean(page, `${what}, keys`, check);
                await keep(page, `keys-${width}-${scheme}`);
            });
}

async function progress(browser, check) {
    await opened(browser, "ordinary", {}, async ({mock, page, h}) => {
        await page.evaluate("window.told = []; new MutationObserver(() => told.push(document.getElementById('announce').textContent)).observe(document.getElementById('announce'), {childList: true}); window.lines = new Set(); setInterval(() => lines.add(document.getElementById('line').textContent), 20); undefined");
        mock.quick = true;
        check("it gets done", await h.until("document.getElementById('phase').textContent === 'Done'", 30000));
        check("the line counts", await page.evaluate("lines.size") >= 3, await page.evaluate("[...lines].join(' | ')"));
        const told = await page.evaluate("told");
        check("what is told is not chatty", told.length >= 1 && told.length <= 3 && told[told.length - 1].startsWith("Done: 256 samples"), told.join(" | "));
        check("noise and time", /noise 2\.5\u00a0% · after/.test(await h.text("#facts")), await h.text("#facts"));
        check("progress", await h.attribute("#progress", "aria-valuenow") === "256" && await h.attribute("#progress", "aria-valuemax") === "256");
        check("the curve of the noise", await page.evaluate("document.querySelectorAll('#section-noise .curve').length") === 1);
        check("pictures were asked for with their place", mock.requests.some(r => r.includes("/api/picture?source=live&layer=beauty&exposure=0&view=ACES+1.0+-+SDR+Video&denoise=0")), mock.requests.filter(r => r.includes("picture"))[0]);
        const before = mock.requests.length;
        await pause(400);
        check("nothing is polled", mock.requests.length === before, mock.requests.slice(before).join());
        check("the token is in no request but the first", mock.requests.every((r, i) => i === 0 || !r.includes("token=")));
        await h.press("p");
        check("pause", await h.until("document.getElementById('pause').getAttribute('aria-pressed') === 'true'") && await h.text("#phase") === "Paused");
        await page.click("#pause");
        check("goes on", await h.until("document.getElementById('phase').textContent === 'Done'"));
        await page.evaluate("(g => { g.value = 512; g.dispatchEvent(new Event('change')); })(document.getElementById('goal'))");
        check("another goal", await h.until("document.getElementById('facts').textContent.includes('512')"), await h.text("#facts"));
        await h.press("p", "Shift");
        check("render again", await h.until(() => mock.posts.some(([, b]) => b.restart)));
        await h.press("s");
        check("snapshot", await h.until("document.getElementById('toast').textContent.includes('shot.view-0001.exr')"), await h.text("#toast"));
        await clean(page, "progress", check);
    });
}

async function camera(browser, check) {
    await opened(browser, "still", {}, async ({mock, page, h, sent}) => {
        mock.quick = true;
        const {x, y} = await h.box("#stage"), lines = await h.text("#section-camera pre"), looks = await h.looks();
        await h.drag([x, y], [x + 120, y - 30], {steps: 40});
        check("orbit", await h.until(() => sent("camera", "orbit").length > 0));
        await pause(200);
        const turned = sent("camera", "orbit").reduce(([a, b], {orbit}) => [a + orbit[0], b + orbit[1]], [0, 0]);
        // The first steps, before it is a drag and no click, are part of it.
        check("orbit: the whole way", Math.abs(turned[0] - 120 * 0.007) < 0.03 && Math.abs(turned[1] + 30 * 0.007) < 0.03, turned.join());
        check("orbit: what waits is added up", sent("camera", "orbit").length <= 40);
        check("orbit: other lines", await h.text("#section-camera pre") !== lines, lines);
        check("orbit: another picture", await h.until(async () => apart(looks, await h.looks()) > 2));
        await h.drag([x, y], [x + 50, y + 20], {held: ["Shift"]});
        await h.drag([x, y], [x + 50, y + 20], {button: "right"});
        check("pan by Shift and by the right button", sent("camera", "pan").length >= 2 && sent("camera", "pan").every(({pan}) => pan[0] > 0 && pan[1] > 0));
        const heights = sent("camera", "pan").reduce((sum, {pan}) => sum + pan[1], 0), picture = await page.evaluate("document.getElementById('zoom').textContent"), high = 300 * parseFloat(picture) / 100;
        check("pan: in picture heights", Math.abs(heights - 40 / high) < 0.012, `${heights}, ${40 / high}`);
        await h.drag([x, y], [x, y + 40], {held: ["Control"]});
        await h.wheel(x, y, 120);
        await h.press("PageUp");
        await pause(100);
        const dollies = sent("camera", "dolly").map(b => b.dolly);
        check("dolly", dollies.filter(f => f > 1).length >= 2 && dollies.some(f => Math.abs(f - 0.9) < 1e-9), dollies.join());
        await h.press("ArrowLeft");
        await h.press("PageUp", "Shift");
        check("keys turn and fly", await h.until(() => sent("camera", "fly").length === 1 && sent("camera", "orbit").some(b => b.orbit[0] < 0 && b.orbit[1] === 0)));
        const moves = sent("camera").length;
        await h.drag([x, y], [x + 60, y], {button: "middle"});
        await h.keyDown(" ");
        await h.drag([x, y], [x + 60, y]);
        await h.keyUp(" ");
        await h.wheel(x, y, -120, "Alt");
        check("middle button, space and Alt are for the picture", sent("camera").length === moves && await h.attribute("#fit", "aria-pressed") === "false");
        await page.evaluate("navigator.clipboard.writeText = text => { window.copied = text; return Promise.resolve(); }; undefined");
        await h.press("c", "Shift");
        check("copy camera", (await page.evaluate("window.copied")).startsWith("from ") && (await page.evaluate("window.copied")).includes("\nlook-at "));
        await h.press("Home");
        check("as in the file", await h.until(`document.querySelector("#section-camera pre").textContent === ${JSON.stringify(lines)}`));
        await page.send("Emulation.setTouchEmulationEnabled", {enabled: true, maxTouchPoints: 2});
        const count = name => sent("camera", name).length, [orbits, pans, dolly] = ["orbit", "pan", "dolly"].map(count);
        await h.touch([[x, y], [x + 60, y]]);
        check("a finger orbits", await h.until(() => count("orbit") > orbits) && count("pan") === pans);
        await h.touch([[x - 50, y], [x - 90, y]], [[x + 50, y], [x + 90, y]]);
        check("two fingers pinch", await h.until(() => count("dolly") > dolly));
        check("spreading them goes nearer", await h.until(() => sent("camera", "dolly").slice(dolly).reduce((f, b) => f * b.dolly, 1) < 0.8));
        await h.touch([[x - 50, y], [x - 10, y]], [[x + 50, y], [x + 90, y]]);
        check("two fingers pan", await h.until(() => count("pan") > pans));
        await clean(page, "camera", check);
    });
    await opened(browser, "still", {}, async ({mock, page, h}) => {
        Object.assign(mock.state.camera, {movable: false});
        mock.touch();
        await h.until("document.getElementById('tool-camera').disabled");
        const {x, y} = await h.box("#stage");
        await h.drag([x, y], [x + 60, y]);
        check("a camera that cannot move", mock.posts.length === 0 && await h.attribute("#tool-look", "aria-checked") === "true" && await h.attribute("#fit", "aria-pressed") === "false");
        await clean(page, "a camera that cannot move", check);
    });
}

async function look(browser, check) {
    await opened(browser, "still", {}, async ({mock, page, h, sent}) => {
        await h.until(picture, 20000);
        await h.press("v");
        const {x, y} = await h.box("#stage"), px = x + 130, py = y + 60;
        await h.move(px, py);
        const where = await h.text("#readout"), at = async () => (await h.text("#readout")).split("  ")[0].split(", ").map(Number), was = await at();
        for (let i = 0; i < 5; ++i) await h.wheel(px, py, -120);
        await h.move(px + 1, py);
        await h.move(px, py);
        check("the wheel zooms to the pointer", (await at()).every((v, i) => Math.abs(v - was[i]) <= 1), `${where} | ${await h.text("#readout")}`);
        check("it is larger", parseFloat(await h.text("#zoom")) > 300, await h.text("#zoom"));
        check("no camera moved", sent("camera").length === 0);
        await h.press("z");
        check("pixel by pixel", await h.text("#zoom") === "100 %" && await h.attribute("#one", "aria-pressed") === "true");
        const moved = await h.looks();
        await h.drag([x, y], [x + 80, y + 30]);
        check("dragging moves it", apart(moved, await h.looks()) > 2);
        await h.press("f");
        check("fit", await h.attribute("#fit", "aria-pressed") === "true");
        for (let i = 0; i < 14; ++i) await h.press("+");
        const zoom = parseFloat(await h.text("#zoom"));
        check("large pixels", zoom > 20, await h.text("#zoom"));
        // Along a row there is a line of the grid every `zoom` pixels.
        const rows = await page.evaluate(`(() => { const c = document.getElementById("canvas"), d = c.getContext("2d").getImageData(0, Math.floor(c.height / 2) + 3, c.width, 1).data, found = []; for (let i = 1; i < c.width - 1; ++i) if (Math.abs(d[4 * i] - d[4 * i - 4]) + Math.abs(d[4 * i + 1] - d[4 * i - 3]) > 12) found.push(i); return found.length; })()`);
        check("the grid of pixels", rows > 20, rows);
        await h.press("f");
        await h.press("r");
        check("the tool for regions", await h.attribute("#tool-region", "aria-checked") === "true");
        await h.drag([x - 100, y - 50], [x + 100, y + 50]);
        check("a region", await h.until(() => sent("region").length === 1));
        const {x0, y0, x1, y1} = sent("region")[0] ?? {};
        check("a region: its pixels", x0 > 150 && y0 > 90 && x1 < 330 && y1 < 210 && x1 - x0 > 80 && (x1 - x0) / (y1 - y0) > 1.9 && (x1 - x0) / (y1 - y0) < 2.1, JSON.stringify(sent("region")));
        check("the tool before is back", await h.attribute("#tool-look", "aria-checked") === "true");
        await h.press("r", "Shift");
        check("the whole frame", await h.until(() => sent("region").length === 2) && Object.keys(sent("region")[1]).length === 0);
        await clean(page, "look", check);
    });
}

async function views(browser, check) {
    await opened(browser, "still", {}, async ({mock, page, h}) => {
        const last = () => mock.requests.filter(r => r.includes("/api/picture")).pop();
        await h.press("2");
        check("a layer by its number", await h.until(() => last().includes("layer=albedo")) && await page.evaluate("document.getElementById('layer').value") === "albedo");
        await h.press("]");
        check("the layer after", await h.until(() => last().includes("layer=depth")));
        await h.press("e");
        await h.press("e");
        await h.press("e", "Shift");
        check("exposure by keys", await h.until(() => last().includes("exposure=0.5&")) && await h.text("#stops") === "+0.5", last());
        await page.evaluate("(v => { v.value = 'Raw'; v.dispatchEvent(new Event('change')); })(document.getElementById('view'))");
        check("another view", await h.until(() => last().includes("view=Raw")));
        await h.press("d");
        check("denoised", await h.until(() => last().includes("denoise=oidn")) && await h.attribute("#denoise", "aria-pressed") === "true");
        check("it is in the address", await h.until("location.hash.includes('exposure=0.5') && location.hash.includes('layer=depth') && location.hash.includes('view=Raw')"), await page.evaluate("location.hash"));
        await page.evaluate("location.reload()");
        await pause(300);
        await h.until(ready);
        check("a reload shows the same", await h.until(() => last().includes("layer=depth&exposure=0.5&view=Raw&denoise=oidn")), last());
        const {x, y} = await h.box("#exposure");
        await h.clickAt(x + 20, y, {count: 2});
        check("a double click resets the exposure", await h.until("document.getElementById('stops').textContent === '0.0'"), await h.text("#stops"));
        await h.press("g");
        check("another grey", await h.attribute("html", "data-surround") === "light");
        await h.press("h");
        check("nothing but the picture", !await h.shown("#bar") && !await h.shown("#panel"));
        await h.press("Escape");
        check("and back", await h.shown("#bar"));
        await h.press("n");
        check("no panel", !await h.shown("#panel"));
        await h.press("?", "Shift");
        check("the sheet", await h.shown("#help") && (await h.text("#help")).includes("flip between A and B"));
        await h.press("Escape");
        check("the sheet is gone", !await h.shown("#help"));
        check("a field keeps its keys", await page.evaluate("(p => { p.open = true; document.querySelector('input[value=other]').click(); document.getElementById('panel-button').click(); document.getElementById('other-path').focus(); return true; })(document.getElementById('section-compare'))"));
        await h.press("w");
        check("a letter in a field is a letter", await page.evaluate("document.getElementById('other-path').value") === "w" && await h.attribute("#wipe", "aria-pressed") === "false");
        // Every control can be reached by Tab, and shows it.
        await page.evaluate("document.activeElement.blur()");
        const reached = new Set(), without = [];
        for (let i = 0; i < 60; ++i) {
            await h.press("Tab");
            const [id, width] = await page.evaluate("(e => [e.id || e.className || e.tagName, parseFloat(getComputedStyle(e).outlineWidth) * (getComputedStyle(e).outlineStyle !== 'none')])(document.activeElement)");
            reached.add(id);
            if (!width && id !== "BODY" && id !== "divider") without.push(id);
        }
        for (const id of ["tool-look", "fit", "layer", "view", "exposure", "wipe", "denoise", "pause", "snapshot", "stage", "help-button", "goal", "camera-copy"]) check(`Tab reaches ${id}`, reached.has(id), [...reached].join());
        check("focus is seen", without.length === 0, without.join());
        await clean(page, "views", check);
    });
}

async function probe(browser, check) {
    await opened(browser, "still", {}, async ({mock, page, h}) => {
        await h.until(picture, 20000);
        const {x, y} = await h.box("#stage");
        await h.move(x - 140, y + 40);
        check("hovering reads", await h.until("/^\\d+, \\d+  0\\.\\d+  .*apple$/.test(document.getElementById('readout').textContent)"), await h.text("#readout"));
        check("no spectrum for hovering", !mock.requests.some(r => r.includes("spectrum=1")));
        await h.clickAt(x - 140, y + 40);
        check("a click pins", await h.until("document.querySelectorAll('#section-probe .plot .curve').length === 1"));
        const text = await h.text("#section-probe");
        for (const word of ["apple", "lacquer", "±", "cd/m²", "ACEScg", "wavelength in nm", "600", "W·m⁻²"]) check(`the probe: ${word}`, text.includes(word), text);
        check("an error band", (await page.evaluate("document.querySelector('#section-probe .band').getAttribute('d')")).split("L").length > 100);
        const plot = await h.box("#section-probe .plot");
        await h.move(plot.x, plot.y);
        check("a point of the spectrum", /^\d{3} nm: 0\.0\d+ ± /.test(await h.text("#section-probe .caption")), await h.text("#section-probe .caption"));
        const place = await h.text("#section-probe .name");
        await page.evaluate("document.getElementById('stage').focus()");
        await h.press("ArrowRight", "Alt");
        check("Alt moves the pin", await h.text("#section-probe .name") === place.replace(/^\d+/, d => +d + 1), await h.text("#section-probe .name"));
        await clean(page, "probe", check);
        await keep(page, "probe-1280-light");
        await h.press("Escape");
        check("no pin", !await h.shown("#section-probe .values"));
        await h.move(x, 60);
        check("nothing outside the picture", await h.text("#readout") === "");
    });
}

async function lights(browser, check) {
    await opened(browser, "still", {}, async ({mock, page, h, sent}) => {
        await h.until(picture, 20000);
        const before = await h.looks(), slide = (name, place) => page.evaluate(`(s => { s.value = ${place}; s.dispatchEvent(new Event('input')); })(document.querySelector('[aria-label="Light group ${name}"]'))`);
        const weights = () => mock.state.groups.map(g => +g.weight.toFixed(3)).join();
        await slide("key", 0.75);
        check("a slider", await h.until(() => weights() === "2.25,1,1"), weights());
        check("it is told as a factor", (await h.text(".light output")) === "2.25×");
        check("another picture", await h.until(async () => apart(before, await h.looks()) > 3));
        await page.click("#lights-stops");
        check("in stops", (await h.text(".light output")) === "+1.17", await h.text(".light output"));
        const {x, y} = await h.box("[aria-label='Light group key']");
        await h.clickAt(x, y, {count: 2});
        check("a double click resets", await h.until(() => weights() === "1,1,1"), weights());
        await page.click(".light:nth-child(2) .group");
        check("off", await h.until(() => weights() === "1,0,1"), weights());
        await page.click(".light:nth-child(2) .group");
        await page.click(".light:nth-child(3) .solo");
        check("alone", await h.until(() => weights() === "0,0,1"), weights());
        await page.click(".light:nth-child(3) .solo");
        check("all again", await h.until(() => weights() === "1,1,1"), weights());
        await slide("fill", 0);
        await page.click("#lights-reset");
        check("all as rendered", await h.until(async () => weights() === "1,1,1" && await page.evaluate("document.getElementById('lights-reset').disabled && document.querySelectorAll('.light output')[1].textContent === '0.00'")), weights());
        check("nothing was rendered for it", sent("control").length === 0);
        await clean(page, "lights", check);
    });
}

async function compare(browser, check) {
    await opened(browser, "still", {}, async ({mock, page, h}) => {
        await h.until(picture, 20000);
        await h.press("w");
        check("without a B there is no wipe", (await h.text("#toast")).includes("There is no B yet") && !await h.shown("#divider"));
        const old = await h.looks(0, 0.5), right = await h.looks(0.5, 1);
        mock.save(state => { state.camera.from = [-3.5, -4.2, 1.4]; });
        check("another picture after the save", await h.until(async () => apart(old, await h.looks(0, 0.5)) > 3));
        check("what was kept is told", (await h.text("#facts")).includes("kept shapes, textures, lights"), await h.text("#facts"));
        const fresh = await h.looks(0, 0.5);
        await h.press("w");
        check("the wipe", await h.until("!document.getElementById('divider').hidden && document.querySelectorAll('.tag').length === 2"));
        check("A on the left, B on the right", await h.until(async () => apart(right, await h.looks(0.5, 1)) < 4) && apart(fresh, await h.looks(0, 0.5)) < 4, `${apart(right, await h.looks(0.5, 1))} ${apart(fresh, await h.looks(0, 0.5))}`);
        const {x, y} = await h.box("#divider"), stage = await h.box("#stage");
        await h.drag([x, y], [stage.left + stage.width * 0.25, y]);
        check("the line moves", Math.abs(+await h.attribute("#divider", "aria-valuenow") - 25) <= 2, await h.attribute("#divider", "aria-valuenow"));
        await h.press("ArrowRight");
        check("by keys, too", Math.abs(+await h.attribute("#divider", "aria-valuenow") - 27) <= 2);
        await keep(page, "wipe-1280-light");
        await h.press("b");
        check("flip", await h.until(async () => apart(old, await h.looks(0, 0.5)) < 4) && !await h.shown("#divider"));
        await h.press("b");
        check("flip back", await h.until(async () => apart(fresh, await h.looks(0, 0.5)) < 4));
        await page.evaluate("document.querySelector('input[value=other]').click()");
        const load = async name => { await page.evaluate(`document.getElementById('other-path').value = ${JSON.stringify(name)}; document.querySelector('#section-compare form').requestSubmit()`); await page.settled(); };
        await load("notes.png");
        check("a wrong file is explained", await h.until("document.querySelector('#section-compare .trouble').textContent.includes('is no EXR – Only files below')"), await h.text("#section-compare .trouble"));
        page.faults = page.faults.filter(f => !f.includes("400")); // the browser itself tells of the answer
        await load("ref/hero.exr");
        check("an EXR as B", await h.until("[...document.querySelectorAll('.tag')].some(t => t.textContent === 'B: hero.exr')") && mock.requests.some(r => r.includes("source=other")));
        await page.click("#keep");
        check("kept by hand", await h.until(() => mock.posts.some(([, b]) => b.save)));
        await page.evaluate("document.activeElement.blur()");
        await h.press("Escape");
        check("no comparison", await h.attribute("#wipe", "aria-pressed") === "false");
        await clean(page, "compare", check);
    });
}

async function errors(browser, check) {
    await opened(browser, "still", {}, async ({mock, page, h}) => {
        await h.until(picture, 20000);
        await page.settled(); // it is drawn with the next frame
        await page.evaluate("navigator.clipboard.writeText = text => { window.copied = text; return Promise.resolve(); }; undefined");
        const good = await h.looks(), list = n => Array.from({length: n}, (_, i) => ({severity: "error", code: `E0${100 + i}`, file: "shot.scene", line: i + 1, column: 4, message: `wrong ${i} <img src=x onerror=alert(1)>`, label: "here", help: "mend it"}));
        mock.save(s => Object.assign(s, {status: "error", diagnostics: list(1), picture: {...s.picture, stale: true}}));
        check("errors come", await h.until("!document.getElementById('errors').hidden"));
        check("the last good picture stays", apart(good, await h.looks()) < 1);
        check("it is said to be old", (await h.text("#tags")) === "last good picture");
        check("the error is told", (await h.text("#announce")).includes("1 error in the scene. wrong 0"), await h.text("#announce"));
        const text = await h.text("#errors .message");
        for (const word of ["E0100", "shot.scene:1:4", "wrong 0 <img", "here", "mend it"]) check(`an error: ${word}`, text.includes(word), text);
        check("no text became an element", await page.evaluate("document.querySelectorAll('#errors img').length") === 0);
        await page.click("#errors .place");
        check("a click copies the place", await page.evaluate("window.copied") === "shot.scene:1");
        const {height} = await h.box("#errors"), stage = await h.box("#stage");
        check("the picture is not hidden", height < 0.5 * stage.height);
        await h.press("i");
        check("folded", !await h.shown("#errors .message") && await h.shown("#errors h2"));
        mock.save(s => Object.assign(s, {status: "error", diagnostics: list(200)}));
        check("new ones unfold", await h.until("document.querySelectorAll('#errors .message').length === 40"));
        await page.click("#errors .more button");
        check("all of them", await page.evaluate("document.querySelectorAll('#errors .message').length") === 200);
        mock.save(s => Object.assign(s, {status: "rendering", diagnostics: list(2).map(d => ({...d, severity: "warning"}))}));
        check("errors go", await h.until("document.getElementById('errors').hidden && document.getElementById('tags').textContent === ''"));
        check("warnings wait", !await h.shown("#drawer") && await h.text("#messages-button") === "2 warnings");
        await page.click("#messages-button");
        check("the drawer", await h.shown("#drawer .message") && await h.attribute("#messages-button", "aria-expanded") === "true");
        await clean(page, "errors", check);
        await h.press("Escape");
        check("the drawer closes", !await h.shown("#drawer"));
    });
}

async function connection(browser, check) {
    let mock = await startMock("still");
    const page = await browser.open(mock.url), h = hands(page), {port, token} = mock;
    await h.until(picture, 20000);
    await mock.stop();
    check("it is told that the program has gone", await h.until("!document.getElementById('banner').hidden && document.getElementById('phase').textContent === 'Not connected'"), await h.text("#banner"));
    check("the picture stays", await page.evaluate("document.getElementById('empty').hidden"));
    await keep(page, "gone-1280-light");
    for (const again of ["the same token", "another token"]) {
        mock = await startMock("ordinary", port, again === "the same token" ? token : undefined);
        if (again === "the same token") {
            check("it goes on", await h.until("document.getElementById('banner').hidden && document.getElementById('phase').textContent !== 'Not connected'", 9000));
            check("with a picture of the new program", await h.until(() => mock.requests.some(r => r.includes("/api/picture"))));
        } else check("another token is refused", await h.until("document.getElementById('banner').textContent.includes('refuses')", 9000), await h.text("#banner"));
        await mock.stop();
        if (again === "the same token") await h.until("!document.getElementById('banner').hidden");
    }
    for (const fault of page.faults) if (!/ERR_|403|Failed to load/.test(fault)) check("connection", false, fault);
    await page.close();
}

async function lessMotion(browser, check) {
    for (const still of [false, true])
        await opened(browser, "still", {still}, async ({page}) => {
            const duration = await page.evaluate("getComputedStyle(document.querySelector('#progress i')).transitionDuration");
            check(`motion, ${still ? "less" : "as always"}`, (parseFloat(duration) === 0) === still, duration);
        });
}

export const pageChecks = {everyState, progress, camera, look, views, probe, lights, compare, errors, connection, lessMotion};
