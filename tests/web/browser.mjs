// A headless Chromium, spoken to over a pipe (file descriptors 3 and 4) in its own protocol: no package is needed.
// Everything that a page may not do is collected in `faults`: errors and warnings of the console, exceptions, requests
// of anything but the file itself and data that is part of it, or, for a page of a server, but that server.
import {spawn} from "node:child_process";
import {mkdtempSync, rmSync} from "node:fs";
import {tmpdir} from "node:os";
import {join} from "node:path";
import {pathToFileURL} from "node:url";

export class Browser {
    static async start() {
        const browser = new Browser();
        browser.profile = mkdtempSync(join(tmpdir(), "abbe-browser-"));
        const flags = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars", "--no-first-run", "--mute-audio",
                       "--disable-background-networking", "--disable-component-update", "--disable-sync", "--remote-debugging-pipe",
                       `--user-data-dir=${browser.profile}`, "about:blank"];
        browser.child = spawn(process.env.CHROMIUM || "chromium", flags, {stdio: ["ignore", "ignore", "pipe", "pipe", "pipe"]});
        browser.noise = "";
        browser.child.stderr.on("data", data => { browser.noise = (browser.noise + data).slice(-4000); });
        browser.ended = new Promise(done => {
            browser.child.on("error", error => { browser.fail(new Error(`chromium cannot be started: ${error.message}`)); done(); });
            browser.child.on("exit", code => { browser.fail(new Error(`chromium ended with ${code}:\n${browser.noise}`)); done(); });
        });
        for (const pipe of [3, 4]) browser.child.stdio[pipe].on("error", error => browser.fail(error));
        let rest = Buffer.alloc(0);
        browser.child.stdio[4].on("data", data => {
            rest = Buffer.concat([rest, data]);
            for (let end; (end = rest.indexOf(0)) >= 0; rest = rest.subarray(end + 1)) browser.heard(JSON.parse(rest.subarray(0, end).toString()));
        });
        await browser.send("Browser.getVersion");
        return browser;
    }
    constructor() { this.next = 0; this.waiting = new Map(); this.listeners = new Map(); this.broken = null; }
    fail(error) {
        this.broken ??= error;
        for (const {refuse, timer} of this.waiting.values()) { clearTimeout(timer); refuse(error); }
        this.waiting.clear();
    }
    heard(message) {
        const waiting = this.waiting.get(message.id);
        if (!waiting) { this.listeners.get(message.sessionId)?.(message.method, message.params); return; }
        this.waiting.delete(message.id);
        clearTimeout(waiting.timer);
        if (message.error) waiting.refuse(new Error(`${waiting.method}: ${message.error.message}`));
        else waiting.done(message.result);
    }
    send(method, params = {}, sessionId = undefined) {
        if (this.broken) return Promise.reject(this.broken);
        const id = ++this.next;
        return new Promise((done, refuse) => {
            const timer = setTimeout(() => { this.waiting.delete(id); refuse(new Error(`${method}: no answer in 60 s`)); }, 60000);
            this.waiting.set(id, {done, refuse, method, timer});
            this.child.stdio[3].write(JSON.stringify({id, method, params, sessionId}) + "\0");
        });
    }
    // A tab that shows the file, or the page at an http address. options: width, height, scheme "light" or "dark", still:
    // as for people who ask for less motion.
    async open(path, {width = 1280, height = 900, scheme = "light", still = false} = {}) {
        const {targetId} = await this.send("Target.createTarget", {url: "about:blank"});
        const {sessionId} = await this.send("Target.attachToTarget", {targetId, flatten: true});
        const page = new Page(this, sessionId, targetId, /^https?:/.test(path) ? path : pathToFileURL(path).href);
        for (const domain of ["Runtime", "Log", "Network", "Page"]) await page.send(`${domain}.enable`);
        await page.send("Emulation.setDeviceMetricsOverride", {width, height, deviceScaleFactor: 1, mobile: false});
        await page.send("Emulation.setEmulatedMedia", {features: [{name: "prefers-color-scheme", value: scheme}, {name: "prefers-reduced-motion", value: still ? "reduce" : ""}]});
        const loaded = new Promise(done => { page.loaded = done; });
        const {errorText} = await page.send("Page.navigate", {url: page.url});
        if (errorText) throw new Error(`${path}: ${errorText}`);
        const slow = setTimeout(() => { page.faults.push("not loaded after 30 s"); page.loaded(); }, 30000);
        await loaded;
        clearTimeout(slow);
        await page.settled();
        return page;
    }
    async close() {
        await this.send("Browser.close").catch(() => {});
        const killer = setTimeout(() => this.child.kill("SIGKILL"), 5000);
        await this.ended;
        clearTimeout(killer);
        rmSync(this.profile, {recursive: true, force: true, maxRetries: 5, retryDelay: 200});
    }
}

class Page {
    constructor(browser, sessionId, targetId, url) {
        Object.assign(this, {browser, sessionId, targetId, url, faults: [], home: /^https?:/.test(url) ? `${new URL(url).origin}/` : url});
        browser.listeners.set(sessionId, (method, params) => this.heard(method, params));
    }
    send(method, params) { return this.browser.send(method, params, this.sessionId); }
    heard(method, p) {
        if (method === "Page.loadEventFired") this.loaded?.();
        else if (method === "Runtime.exceptionThrown") this.faults.push(`exception: ${p.exceptionDetails.exception?.description ?? p.exceptionDetails.text}`);
        else if (method === "Runtime.consoleAPICalled" && ["error", "warning", "assert"].includes(p.type)) this.faults.push(`console: ${p.args.map(a => a.value ?? a.description).join(" ")}`);
        else if (method === "Log.entryAdded" && ["error", "warning"].includes(p.entry.level)) this.faults.push(`log: ${p.entry.text}`);
        else if (method === "Network.requestWillBeSent") {
            const {url} = p.request;
            const mine = this.home.endsWith("/") ? url.startsWith(this.home) : url.split("#")[0] === this.url;
            if (url !== this.url && !mine && !/^(data|blob):/.test(url)) this.faults.push(`request: ${url.slice(0, 200)}`);
        } else if (method === "Network.webSocketCreated") this.faults.push(`request: ${p.url}`);
    }
    // The value of an expression, which may be a promise.
    async evaluate(expression) {
        const {result, exceptionDetails} = await this.send("Runtime.evaluate", {expression, returnByValue: true, awaitPromise: true});
        if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
        return result.value;
    }
    // Until what observers and frames have to do is done.
    settled() { return this.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50))))"); }
    async click(selector) {
        await this.evaluate(`document.querySelector(${JSON.stringify(selector)}).click()`);
        await this.settled();
    }
    async screenshot(whole = true) {
        const options = {format: "png", captureBeyondViewport: whole};
        if (whole) {
            const {cssContentSize: size} = await this.send("Page.getLayoutMetrics");
            options.clip = {x: 0, y: 0, width: size.width, height: Math.min(size.height, 12000), scale: 1};
        }
        return Buffer.from((await this.send("Page.captureScreenshot", options)).data, "base64");
    }
    async print() { return Buffer.from((await this.send("Page.printToPDF", {printBackground: true})).data, "base64"); }
    async close() {
        this.browser.listeners.delete(this.sessionId);
        await this.browser.send("Target.closeTarget", {targetId: this.targetId});
    }
}
