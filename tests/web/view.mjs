// The page of `abbe view` in a headless Chromium:  node view.mjs [PROGRAM SCENE]. Without a program only against a made-up one.
// ABBE_ONLY=camera,probe runs some of the checks; ABBE_SCREENSHOTS=FOLDER keeps pictures.
import {Browser} from "./browser.mjs";
import {pageChecks} from "./view_page.mjs";

const [program, scene] = process.argv.slice(2), only = process.env.ABBE_ONLY?.split(",");
let faults = 0, checks = 0;
function check(what, right, more = "") {
    ++checks;
    if (right) return;
    ++faults;
    console.log(`FAULT: ${what}${more !== "" ? `: ${more}` : ""}`);
}

const browser = await Browser.start();
try {
    const programChecks = program ? (await import("./view_program.mjs")).programChecks(program, scene) : {};
    for (const [name, run] of Object.entries({...pageChecks, ...programChecks})) {
        if (only && !only.includes(name)) continue;
        const before = performance.now();
        try {
            await run(browser, check);
        } catch (error) {
            check(name, false, error.stack);
        }
        console.log(`${name}: ${((performance.now() - before) / 1000).toFixed(1)} s`);
    }
} finally {
    await browser.close();
}
console.log(`${checks} checks, ${faults} faults`);
process.exit(faults > 0 || (!only && checks < 200) ? 1 : 0);
