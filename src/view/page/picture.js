// Pictures as the program makes them for the screen: exposure and view are applied there, by OpenColorIO, in the same way as
// in a PNG. One request a picture is under way at a time; when it has come, whatever is wanted by then is asked for.
import {get} from "./server.js";
import {notify} from "./dom.js";
import {app, denoiserNow, layerNow, on, otherNow, tell, viewNow} from "./store.js";

class Picture {
    constructor(source) {
        Object.assign(this, {source, bitmap: null, bytes: null, width: 0, height: 0, frameWidth: 0, frameHeight: 0, cell: 1, samples: null, version: "",
                             held: null, wanted: null, busy: false, late: false, fault: null, came: 0});
    }
    // `serial` tells apart pictures that are asked for in the same words.
    want(query, serial) {
        this.wanted = {query, key: `${query}#${serial}`};
        if (!this.busy) this.work();
    }
    drop() {
        this.wanted = null;
        this.held = null;
        this.show(null);
    }
    async work() {
        this.busy = true;
        while (this.wanted && this.wanted.key !== this.held) {
            const {query, key} = this.wanted;
            try {
                await this.load(query, key);
                this.fault = null;
            } catch (error) {
                // It is not asked for again until something else is wanted. Without an answer there is nothing to tell: the
                // banner says it.
                if (error.status !== 0 && this.fault !== error.message) notify(`No picture: ${error.message}`, error.help);
                this.fault = error.message;
            }
            this.held = key;
        }
        this.busy = false;
    }
    async load(query, key) {
        const slow = setTimeout(() => { this.late = true; tell("picture"); }, 700);
        let response;
        try {
            response = await get(`api/picture?${query}`);
        } finally {
            clearTimeout(slow);
            this.late = false;
        }
        if (response.status === 204) { this.show(null); return; }
        const number = name => Number(response.headers.get(name)) || 0;
        const width = number("X-Width"), height = number("X-Height"), bytes = new Uint8ClampedArray(await response.arrayBuffer());
        if (width < 1 || height < 1 || bytes.length !== 4 * width * height) throw new Error(`it has ${bytes.length} bytes for ${width} × ${height} pixels`);
        const bitmap = await createImageBitmap(new ImageData(bytes, width, height), {premultiplyAlpha: "none", colorSpaceConversion: "none"});
        if (!this.wanted) { bitmap.close(); return; }
        Object.assign(this, {width, height, bytes, frameWidth: number("X-Frame-Width") || width, frameHeight: number("X-Frame-Height") || height,
                             cell: number("X-Cell") || 1, samples: number("X-Samples"), version: response.headers.get("X-Version") ?? "", query, key});
        this.show(bitmap);
    }
    show(bitmap) {
        if (!bitmap && !this.bitmap) return;
        this.bitmap?.close();
        this.bitmap = bitmap;
        if (bitmap) ++this.came;
        else this.bytes = null;
        tell("picture");
    }
    // Codes of the screen at a pixel of the frame, or null.
    codesAt(x, y) {
        if (!this.bytes || !this.frameWidth) return null;
        const u = Math.floor(x * this.width / this.frameWidth), v = Math.floor(y * this.height / this.frameHeight);
        if (u < 0 || v < 0 || u >= this.width || v >= this.height) return null;
        return [...this.bytes.subarray(4 * (v * this.width + u), 4 * (v * this.width + u) + 3)];
    }
}

export const live = new Picture("live"), other = new Picture("other");

// The longest side that is worth having: whole numbers of pixels are averaged where several of them share one of the screen.
let shrink = 1;
export function setShrink(zoom) {
    const now = zoom > 0 && zoom < 0.5 ? Math.floor(1 / zoom) : 1;
    if (now === shrink) return;
    shrink = now;
    ask();
}

function queryOf(source) {
    const {look, state} = app, words = new URLSearchParams({source, layer: layerNow(), exposure: String(+look.exposure.toFixed(3)), view: viewNow()});
    words.set("denoise", source === "live" && look.denoise ? denoiserNow() ?? "0" : "0");
    const {width = 0, height = 0} = state.frame ?? {};
    if (shrink > 1) words.set("max", Math.ceil(Math.max(width, height) / shrink));
    return String(words);
}

// What was kept by hand, and pictures of a program that has started again, have new serials.
let kept = 0, starts = 0;
export const againFor = {saved() { ++kept; ask(); }, all() { ++starts; ask(); }};

export function ask() {
    const {state} = app;
    if (!state) return;
    // Weights of light groups make no other version of the picture: nothing is rendered for them.
    const weights = (state.groups ?? []).map(g => g.weight).join();
    live.want(queryOf("live"), `${state.picture?.version ?? 0}/${starts}/${weights}`);
    const b = otherNow();
    if (app.look.compare === "off" || !b) { if (other.wanted) other.drop(); return; }
    other.want(queryOf(b), `${b === "saved" ? state.save : state.other.path}/${kept}/${starts}`);
}
on("state look", ask);
