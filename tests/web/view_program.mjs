// The page of `abbe view` with the program itself behind it: a file is edited and the picture follows. Times are told, not judged.
import {spawn} from "node:child_process";
import {copyFileSync, existsSync, readFileSync, renameSync, writeFileSync} from "node:fs";
import {apart, hands, pause} from "./hands.mjs";
import {clean, keep} from "./view_page.mjs";

const picture = "document.getElementById('empty').hidden", ms = since => `${Math.round(performance.now() - since)} ms`;

// The program on a copy of the scene; task({page, h, url, file, text, save, state}).
async function viewed(browser, program, scene, options, task) {
    const file = `${options.name ?? "shot"}.scene`;
    copyFileSync(scene, file);
    const child = spawn(program, ["view", file, ...options.flags ?? []], {stdio: ["ignore", "pipe", "pipe"]});
    let out = "", err = "";
    child.stderr.on("data", data => { err += data; });
    const ended = new Promise(done => child.on("exit", done));
    const url = await new Promise((done, refuse) => {
        child.stdout.on("data", data => { out += data; const found = out.match(/http:\/\/\S+/); if (found) done(found[0]); });
        child.on("exit", code => refuse(new Error(`abbe view ended with ${code}: ${err}`)));
    });
    const token = new URL(url).searchParams.get("token"), text = readFileSync(file, "utf8");
    const save = content => { writeFileSync(`${file}~`, content); renameSync(`${file}~`, file); }; // as editors do
    const state = async () => (await fetch(`${new URL(url).origin}/api/state`, {headers: {"X-Abbe-Token": token}})).json();
    const page = await browser.open(url, options.window ?? {}), h = hands(page);
    try {
        await task({page, h, url, file, text, save, state, child});
    } finally {
        await page.close();
        child.kill("SIGINT");
        await ended;
    }
}

export function programChecks(program, scene) {
    const flags = ["--samples", "64", "--threads", "2"];
    async function editing(browser, check) {
        await viewed(browser, program, scene, {flags}, async ({page, h, text, save, state}) => {
            let since = performance.now();
            check("the program: a picture", await h.until(picture, 60000));
            console.log(`  first picture in the page after ${ms(since)}`);
            await h.done();
            const red = await h.looks();
            since = performance.now();
            save(text.replace("rgb 0.6 0.1 0.1", "rgb 0.05 0.1 0.7"));
            check("an edit changes the picture", await h.until(async () => apart(red, await h.looks()) > 2, 30000));
            console.log(`  another picture in the page ${ms(since)} after the save, by the program ${Math.round(1000 * ((await state()).reuse.seconds.first_pixels ?? 0))} ms`);
            check("what was kept is told", (await state()).save < 2 || await h.until("document.getElementById('facts').textContent.includes('first pixels after')"), await h.text("#facts"));
            await h.done();
            const blue = await h.looks();
            await h.press("w");
            check("A/B with the last save", await h.until("!document.getElementById('divider').hidden") && await h.until(async () => apart(red.slice(0), await h.looks(0, 1)) > 0));
            await h.press("b");
            check("B is the picture before the save", await h.until(async () => apart(red, await h.looks()) < 2, 20000), apart(red, await h.looks()));
            await h.press("b");
            since = performance.now();
            save(text.replace("material white diffuse", "material white difuse"));
            check("a mistake is shown", await h.until("document.querySelectorAll('#errors .message').length > 0", 20000));
            console.log(`  errors in the page ${ms(since)} after the save`);
            check("with its place and a suggestion", /shot\.scene:8:\d+/.test(await h.text("#errors")) && (await h.text("#errors")).includes("diffuse"), await h.text("#errors"));
            check("above the last good picture", apart(blue, await h.looks()) < 2 && await h.text("#tags") === "last good picture", `${apart(blue, await h.looks())}, ${await h.text("#tags")}`);
            await keep(page, "program-errors");
            save(text);
            check("mended", await h.until("document.getElementById('errors').hidden", 20000) && await h.until(async () => apart(red, await h.looks()) < 2, 30000));
            await clean(page, "the program: editing", check);
        });
    }
    async function using(browser, check) {
        await viewed(browser, program, scene, {flags}, async ({page, h, file, state, text, save}) => {
            await h.until(picture, 60000);
            await h.done();
            const {x, y} = await h.box("#stage"), lines = await h.text("#section-camera pre"), looks = await h.looks();
            await h.clickAt(x + 60, y + 120);
            check("the probe of the program", await h.until("document.querySelectorAll('#section-probe .plot .curve').length === 1", 20000), await h.text("#section-probe"));
            const probe = await h.text("#section-probe");
            for (const word of ["±", "cd/m²", "ball", "white", "wavelength in nm"]) check(`the probe of the program: ${word}`, probe.includes(word), probe);
            await keep(page, "program-probe");
            await h.press("Escape");
            const since = performance.now();
            await h.drag([x, y], [x + 80, y - 20]);
            check("orbit: lines and picture", await h.until(`document.querySelector("#section-camera pre").textContent !== ${JSON.stringify(lines)}`) && await h.until(async () => apart(looks, await h.looks()) > 2, 20000));
            console.log(`  the picture followed the hand after ${ms(since)}`);
            const moved = await h.text("#section-camera pre");
            // The lines are those of a scene file: with them the picture is the same.
            await h.done();
            const turned = await h.looks();
            await page.click("#camera-reset");
            check("as in the file", await h.until(`document.querySelector("#section-camera pre").textContent === ${JSON.stringify(lines)}`, 10000));
            save(text.replace("from 0 1 3.4; look-at 0 1 0;", moved.replaceAll("\n", "; ") + ";"));
            check("the lines in the file give the picture", await h.until(async () => apart(turned, await h.looks()) < 2, 30000), `${moved} ${apart(turned, await h.looks())}`);
            save(text.replace("light lamp quad", "light glow sphere { center 0 1.2 0.6; radius 0.1; luminance 20000 nits }\nlight lamp quad"));
            check("light groups", await h.until("document.querySelectorAll('.light').length >= 2", 30000), JSON.stringify((await state()).groups));
            await h.done();
            const both = await h.looks(), {done} = (await state()).samples, slide = place => page.evaluate(`(s => { s.value = ${place}; s.dispatchEvent(new Event('input')); })(document.querySelector('[aria-label="Light group lamp"]'))`);
            await slide(0);
            check("re-weighed", await h.until(async () => apart(both, await h.looks()) > 2));
            check("without a sample", (await state()).samples.done === done);
            await slide(0.5);
            check("weighed as before", await h.until(async () => apart(both, await h.looks()) === 0), apart(both, await h.looks()));
            await h.press("d");
            check("denoised", await h.until("document.getElementById('denoise').getAttribute('aria-pressed') === 'true'") && await h.until(async () => apart(both, await h.looks()) > 0, 60000), apart(both, await h.looks()));
            check("but not another picture", apart(both, await h.looks()) < 5, apart(both, await h.looks()));
            await h.press("d");
            check("and as it was", await h.until(async () => apart(both, await h.looks()) === 0, 20000), apart(both, await h.looks()));
            await h.press("2");
            check("a layer", await h.until(async () => apart(both, await h.looks()) > 3));
            await h.press("1");
            await h.press("e");
            check("a brighter picture", await h.until(async () => (await h.looks()).reduce((a, b) => a + b) > both.reduce((a, b) => a + b) + 500));
            await h.press("x");
            await h.press("s");
            check("a snapshot", await h.until("document.getElementById('toast').textContent.includes('Snapshot written')", 20000) && existsSync(file.replace(".scene", ".view-0001.exr")), await h.text("#toast"));
            await page.evaluate("document.querySelector('input[value=other]').click(); document.getElementById('other-path').value = 'shot.view-0001.exr'; document.querySelector('#section-compare form').requestSubmit()");
            check("the snapshot as B", await h.until("[...document.querySelectorAll('.tag')].some(t => t.textContent === 'B: shot.view-0001.exr')", 10000) && await h.until(async () => apart(both, await h.looks()) < 3), `${await h.text("#tags")} ${apart(both, await h.looks())}`);
            await page.evaluate("document.activeElement.blur()");
            await h.press("Escape");
            await h.press("r");
            await h.drag([x - 60, y - 60], [x + 60, y + 60]);
            check("a region", await h.until(async () => (await state()).frame.region?.length === 4), JSON.stringify((await state()).frame));
            await h.press("p");
            await clean(page, "the program in use", check);
        });
    }
    async function access(browser, check) {
        await viewed(browser, program, scene, {flags}, async ({page, h, url, child}) => {
            const {origin, port} = new URL(url), status = async path => (await fetch(origin + path)).status;
            for (const path of ["/", "/?token=wrong", "/api/state", "/api/picture?source=live", "/page/wrong/view.js"]) check(`403 without the token: ${path}`, await status(path) === 403, await status(path));
            check("no token in what the page loads but its address", await page.evaluate("performance.getEntriesByType('resource').every(r => !r.name.includes('token='))"));
            // A page of somebody else cannot read it, even with the token.
            writeFileSync("foreign.html", "<!doctype html><title>x</title>");
            const foreign = await browser.open("foreign.html");
            const heard = await foreign.evaluate(`fetch("http://127.0.0.1:${port}/api/state${new URL(url).search}").then(r => r.status, () => "refused")`);
            check("a foreign origin is refused", heard === "refused" || heard === 403, heard);
            await foreign.close();
            await clean(page, "access", check);
            child.kill("SIGINT");
            check("when the program ends the page says so", await h.until("!document.getElementById('banner').hidden", 10000));
        });
    }
    return {editing, using, access};
}
