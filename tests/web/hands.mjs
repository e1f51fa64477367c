// Mouse, keys and fingers for a page of browser.mjs, and looks at what it shows.
const modifiers = {Alt: 1, Control: 2, Meta: 4, Shift: 8}, bits = {left: 1, right: 2, middle: 4};
const mask = held => held.reduce((sum, name) => sum | modifiers[name], 0);
export const pause = ms => new Promise(done => setTimeout(done, ms));

export function hands(page) {
    const mouse = (type, x, y, more = {}) => page.send("Input.dispatchMouseEvent", {type, x, y, ...more});
    const finger = (type, points) => page.send("Input.dispatchTouchEvent", {type, touchPoints: points.map(([x, y], id) => ({x, y, id}))});
    const names = {" ": "Space", "?": "Slash", "[": "BracketLeft", "]": "BracketRight"}, codes = {Enter: 13, Tab: 9, Escape: 27, " ": 32, PageUp: 33, PageDown: 34, End: 35, Home: 36, ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40};
    const key = (type, name, held = []) => page.send("Input.dispatchKeyEvent", {type: type === "keyDown" && name.length > 1 && name !== "Enter" ? "rawKeyDown" : type, key: held.includes("Shift") && name.length === 1 ? name.toUpperCase() : name, code: names[name] ?? (name.length === 1 ? `Key${name.toUpperCase()}` : name),
        windowsVirtualKeyCode: codes[name] ?? name.toUpperCase().charCodeAt(0), modifiers: mask(held), ...type === "keyDown" && name.length === 1 ? {text: name} : name === "Enter" && type === "keyDown" ? {text: "\r"} : {}});
    return {
        async press(name, ...held) { await key("keyDown", name, held); await key("keyUp", name, held); await page.settled(); },
        keyDown: (name, ...held) => key("keyDown", name, held),
        keyUp: (name, ...held) => key("keyUp", name, held),
        async move(x, y) { await mouse("mouseMoved", x, y); await page.settled(); },
        async clickAt(x, y, {button = "left", count = 1} = {}) {
            for (let i = 1; i <= count; ++i) { await mouse("mousePressed", x, y, {button, buttons: bits[button], clickCount: i}); await mouse("mouseReleased", x, y, {button, clickCount: i}); }
            await page.settled();
        },
        // From one place to another in `steps` small ones.
        async drag([x0, y0], [x1, y1], {button = "left", held = [], steps = 8} = {}) {
            const more = {button, buttons: bits[button], modifiers: mask(held)};
            await mouse("mousePressed", x0, y0, {...more, clickCount: 1});
            for (let i = 1; i <= steps; ++i) await mouse("mouseMoved", x0 + (x1 - x0) * i / steps, y0 + (y1 - y0) * i / steps, more);
            await mouse("mouseReleased", x1, y1, {...more, clickCount: 1});
            await page.settled();
        },
        async wheel(x, y, deltaY, ...held) { await mouse("mouseWheel", x, y, {deltaX: 0, deltaY, modifiers: mask(held)}); await page.settled(); },
        async touch(...ways) { // each: [from, to] of a finger
            const at = t => ways.map(([a, b]) => [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]);
            await finger("touchStart", at(0));
            for (let i = 1; i <= 8; ++i) await finger("touchMove", at(i / 8));
            await finger("touchEnd", []);
            await page.settled();
        },
        text: selector => page.evaluate(`document.querySelector(${JSON.stringify(selector)})?.textContent ?? null`),
        shown: selector => page.evaluate(`(e => Boolean(e && e.getClientRects().length))(document.querySelector(${JSON.stringify(selector)}))`),
        attribute: (selector, name) => page.evaluate(`document.querySelector(${JSON.stringify(selector)})?.getAttribute(${JSON.stringify(name)}) ?? null`),
        box: selector => page.evaluate(`(b => ({left: b.left, top: b.top, width: b.width, height: b.height, x: b.left + b.width / 2, y: b.top + b.height / 2}))(document.querySelector(${JSON.stringify(selector)}).getBoundingClientRect())`),
        // Something like the picture in few numbers: mean codes of 8 × 6 blocks of the canvas between two shares of its width.
        looks: (from = 0, to = 1) => page.evaluate(`(() => { const c = document.getElementById("canvas"), k = document.createElement("canvas"); k.width = 8; k.height = 6; const g = k.getContext("2d", {willReadFrequently: true});
            g.imageSmoothingQuality = "high"; g.drawImage(c, c.width * ${from}, 0, c.width * ${to - from}, c.height, 0, 0, 8, 6); return [...g.getImageData(0, 0, 8, 6).data]; })()`),
        pixel: (x, y) => page.evaluate(`(() => { const c = document.getElementById("canvas"), b = c.getBoundingClientRect(), s = c.width / b.width; return [...c.getContext("2d").getImageData(Math.floor((${x} - b.left) * s), Math.floor((${y} - b.top) * s), 1, 1).data]; })()`),
        async until(what, ms = 20000) { // whether an expression became true, or a function here
            for (const end = performance.now() + ms; performance.now() < end; await pause(25)) if (typeof what === "function" ? await what() : await page.evaluate(what)) return true;
            return false;
        },
        // Waits until the render is done and its last picture is shown: a page that says `Done` may be about to ask for that, and draws it
        // with the next frame of the screen.
        async done(ms = 60000) {
            const came = await this.until(`import(document.querySelector("script[type=module]").src.replace("view.js", "picture.js")).then(({live}) => document.getElementById("phase").textContent === "Done" && !live.busy)`, ms);
            await page.settled();
            return came;
        },
    };
}
// How much two such pictures differ, in codes.
export const apart = (a, b) => a.reduce((sum, v, i) => sum + Math.abs(v - b[i]), 0) / a.length;

// Runs inside a page: contrast of every text with what is behind it [WCAG 2.1, 1.4.3], names of controls, sizes of targets.
export function troubles(narrow) {
    const found = [], numbers = text => (text.match(/[\d.]+/g) || []).map(Number), linear = v => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
    const luminance = c => 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]), seen = e => e.getClientRects().length > 0 && getComputedStyle(e).visibility !== "hidden";
    const name = e => `${e.tagName.toLowerCase()}${e.id ? `#${e.id}` : ""}${e.getAttribute("class") ? `.${e.getAttribute("class")}` : ""} “${(e.textContent || "").trim().slice(0, 30)}”`;
    const over = (c, under) => c.length < 4 ? c : c.slice(0, 3).map((v, i) => v * c[3] + under[i] * (1 - c[3]));
    const ground = e => {
        if (!e) return [255, 255, 255];
        const c = numbers(getComputedStyle(e).backgroundColor);
        return c.length === 3 || c[3] > 0.99 ? c.slice(0, 3) : c[3] > 0 ? over(c, ground(e.parentElement)) : ground(e.parentElement);
    };
    let texts = 0;
    for (const e of document.body.querySelectorAll("*")) {
        const own = [...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim()) || e.matches("input[type=text], input[type=number], select");
        if (!own || !seen(e) || e.matches("option, script, noscript") || e.closest(":disabled, .unseen, .skip")) continue;
        ++texts;
        const style = getComputedStyle(e), svg = e.namespaceURI.endsWith("svg"), paper = ground(svg ? e.closest("svg").parentElement : e), ink = over(numbers(svg ? style.fill : style.color), paper);
        const [a, b] = [luminance(ink), luminance(paper)].sort((x, y) => y - x), ratio = (a + 0.05) / (b + 0.05);
        if (ratio < 4.5) found.push(`contrast ${ratio.toFixed(2)}: ${name(e)}, ${ink} on ${paper}`);
    }
    if (texts < 12) found.push(`only ${texts} texts were looked at`);
    for (const e of document.querySelectorAll("button, input, select, summary, [role=slider]")) {
        if (!seen(e)) continue;
        const label = e.getAttribute("aria-label") || e.textContent.trim() || e.labels?.[0]?.textContent.trim() || e.title;
        if (!label) found.push(`a control without a name: ${name(e)}`);
        const box = (e.closest("label") && e.matches("[type=radio]") ? e.closest("label") : e).getBoundingClientRect();
        if (narrow && (box.height < 39.5 || (box.width < 39.5 && !e.matches(".code")))) found.push(`a target of ${box.width.toFixed(0)} × ${box.height.toFixed(0)}: ${name(e)}`);
    }
    for (const [a, b] of [["#bar", "#work"], ["#work", "#status"]]) {
        const above = document.querySelector(a).getBoundingClientRect(), below = document.querySelector(b).getBoundingClientRect();
        if (above.height && above.bottom > below.top + 1) found.push(`${a} reaches into ${b}`);
    }
    const panel = document.getElementById("panel");
    if (panel.scrollWidth > panel.clientWidth + 1) found.push(`the panel is ${panel.scrollWidth} wide in ${panel.clientWidth}`);
    if (document.getElementById("status").getBoundingClientRect().bottom > innerHeight + 1) found.push("the status line is below the window");
    return found;
}
