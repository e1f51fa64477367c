// Studies that were never made: what `abbe study` writes (format abbe-study/1), from a seed, ordinary ones and odd ones.
import {deflateSync} from "node:zlib";

// Mulberry32: the same numbers in every run.
export function generator(seed) {
    let a = seed >>> 0;
    return () => {
        a = (a + 0x6d2b79f5) | 0;
        let t = Math.imul(a ^ (a >>> 15), 1 | a);
        t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
        return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
    };
}
const normal = random => Math.sqrt(-2 * Math.log(1 - random())) * Math.cos(2 * Math.PI * random());

function crc(bytes) {
    let c = ~0;
    for (const b of bytes) { c ^= b; for (let k = 0; k < 8; ++k) c = (c >>> 1) ^ (c & 1 ? 0xedb88320 : 0); }
    return ~c >>> 0;
}
// An RGB picture of 8 bits as base64; paint(x, y) gives 0 … 1.
export function png(width, height, paint) {
    const raw = Buffer.alloc(height * (3 * width + 1));
    for (let y = 0, at = 0; y < height; ++y) {
        raw[at++] = 0;
        for (let x = 0; x < width; ++x) for (const v of paint(x, y)) raw[at++] = Math.round(255 * Math.max(0, Math.min(1, v)));
    }
    const chunk = (type, data) => {
        const body = Buffer.concat([Buffer.from(type, "latin1"), data]), frame = Buffer.alloc(8);
        frame.writeUInt32BE(data.length, 0);
        frame.writeUInt32BE(crc(body), 4);
        return Buffer.concat([frame.subarray(0, 4), body, frame.subarray(4)]);
    };
    const header = Buffer.alloc(13);
    header.writeUInt32BE(width, 0);
    header.writeUInt32BE(height, 4);
    header.set([8, 2, 0, 0, 0], 8);
    return Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), chunk("IHDR", header), chunk("IDAT", deflateSync(raw)), chunk("IEND", Buffer.alloc(0))]).toString("base64");
}

// A room with a lamp and two balls; `noise` is the relative error of a pixel.
const [width, height] = [96, 96];
function room(x, y) {
    const u = x / width, v = y / height, ball = (a, b, r) => Math.max(0, 1 - ((u - a) ** 2 + (v - b) ** 2) / r ** 2);
    const light = 0.25 + 0.5 * Math.exp(-8 * ((u - 0.5) ** 2 + (v - 0.1) ** 2)), left = u < 0.14, right = u > 0.86;
    let c = left ? [0.6, 0.1, 0.08] : right ? [0.12, 0.45, 0.15] : [0.7, 0.68, 0.62];
    if (u > 0.38 && u < 0.62 && v > 0.03 && v < 0.1) return [1, 0.97, 0.88];
    const a = ball(0.35, 0.72, 0.17), b = ball(0.68, 0.62, 0.13);
    if (a > 0) c = [0.25 + 0.6 * a, 0.45 + 0.5 * a, 0.75 + 0.3 * a];
    else if (b > 0) c = [0.9 * b + 0.2, 0.7 * b + 0.1, 0.25 * b];
    return c.map(k => k * light * 1.35);
}
const noisy = (noise, random) => png(width, height, (x, y) => { const k = Math.exp(noise * normal(random)); return room(x, y).map(v => v * k); });
const heat = t => { const s = [[0, 0, 4], [87, 16, 110], [188, 55, 84], [249, 142, 9], [252, 255, 164]], at = Math.min(0.999, Math.max(0, t)) * 4, i = Math.floor(at);
                    return s[i].map((v, c) => (v + (at - i) * (s[i + 1][c] - v)) / 255); };
const errorMap = (noise, random) => png(width, height, () => heat(Math.abs(noise * normal(random)) / 0.5));

// variance: relMSE of one sample; cost: seconds of one sample; bias2: squared relative bias.
function curve(random, {id, label, group, change, bias = "exact", variance, cost, bias2 = 0, exponent = 1, note = "", runs = 8}, base) {
    const reference = 2e-8, points = [];
    for (let samples = 4; samples <= 4096; samples *= 4) {
        const spread = 0.06, clean = variance / samples ** exponent + bias2, relMse = clean * (1 + spread * normal(random)) + reference * normal(random);
        const seconds = (0.02 + samples * cost) * (1 + 0.01 * normal(random));
        points.push({samples, seconds, coreSeconds: 1.95 * seconds, rays: Math.round(9216 * samples * 8.3), relMse, low: relMse - 2.1 * spread * clean - reference,
                     high: relMse + 2.1 * spread * clean + reference, trimmed: relMse * 0.8, bias2: bias2 + 0.02 * clean * normal(random), bias2Low: bias2 - 0.04 * clean,
                     bias2High: bias2 + 0.04 * clean, runs: Array.from({length: runs}, (_, seed) => ({seed, relMse: clean * (1 + 0.17 * normal(random)), seconds: seconds * (1 + 0.02 * normal(random))}))});
    }
    const ratio = base ? base.variance * base.cost / (variance * cost) : 1, slope = -exponent + 0.012 * normal(random);
    const timeTo = [0.01, 0.003, 0.001].map(error => {
        const left = error ** 2 - bias2;
        if (left <= 0) return {error, seconds: null, low: null, high: null, samples: null, extrapolated: false, reachable: false};
        const samples = (variance / left) ** (1 / exponent), seconds = 0.02 + samples * cost;
        return {error, seconds, low: seconds * 0.93, high: seconds * 1.08, samples: Math.round(samples), extrapolated: samples > 4096};
    });
    return {id, label, group, change, bias, note, points, fit: {slope, low: slope - 0.03, high: slope + 0.03, halfNoiseCost: 2 ** (2 / exponent), halfNoiseCostLow: 2 ** (2 / exponent) - 0.1, halfNoiseCostHigh: 2 ** (2 / exponent) + 0.12},
            floor: bias2 ? {relMse: bias2, low: bias2 * 0.8, high: bias2 * 1.2} : {relMse: 1e-9, low: -3e-8, high: 4e-8},
            efficiency: {ratio, low: ratio * (base ? 0.9 : 1), high: ratio * (base ? 1.11 : 1)}, timeTo};
}

const base = {id: "abbe", label: "as rendered", group: "main", change: "nothing changed", variance: 0.09, cost: 2.6e-4};
const changes = [
    {id: "denoised", label: "denoised", group: "main", change: "denoised afterwards", bias: "biased", variance: 0.011, cost: 3.1e-4, bias2: 6e-6, exponent: 0.9},
    {id: "no-nee", label: "no light sampling", group: "light sampling", change: "strategy bsdf", variance: 8.2, cost: 1.7e-4},
    {id: "no-mis", label: "no MIS", group: "light sampling", change: "weights equal", variance: 0.9, cost: 2.5e-4},
    {id: "nee-only", label: "light sampling alone", group: "light sampling", change: "strategy lights", variance: 0.13, cost: 2.2e-4, bias: "biased", bias2: 2.4e-5, note: "cannot see lamps in mirrors"},
    {id: "power", label: "power heuristic", group: "light sampling", change: "weights power", variance: 0.088, cost: 2.6e-4},
    {id: "uniform", label: "uniform directions", group: "directions", change: "directions uniform", variance: 0.52, cost: 2.4e-4},
    {id: "random", label: "independent samples", group: "numbers", change: "numbers random", variance: 0.15, cost: 2.5e-4},
    {id: "stratified", label: "stratified samples", group: "numbers", change: "numbers stratified", variance: 0.11, cost: 2.5e-4},
    {id: "w1", label: "1 wavelength", group: "wavelengths", change: "wavelengths 1", variance: 0.44, cost: 1.9e-4},
    {id: "w2", label: "2 wavelengths", group: "wavelengths", change: "wavelengths 2", variance: 0.22, cost: 2.0e-4},
    {id: "w4", label: "4 wavelengths", group: "wavelengths", change: "wavelengths 4", variance: 0.13, cost: 2.2e-4},
    {id: "no-roulette", label: "no roulette", group: "roulette", change: "roulette off", variance: 0.085, cost: 4.4e-4},
    {id: "old-roulette", label: "roulette by throughput", group: "roulette", change: "roulette throughput", variance: 0.1, cost: 2.5e-4},
    {id: "no-tree", label: "lights by power", group: "light choice", change: "light-choice power", variance: 0.12, cost: 2.5e-4},
    {id: "even", label: "lights evenly", group: "light choice", change: "light-choice uniform", variance: 0.18, cost: 2.5e-4},
];

export function ordinary(seed = 1, chosen = changes) {
    const random = generator(seed), curves = [base, ...chosen].map(c => curve(random, c, base));
    const strips = [0.2, 1, 5].map(seconds => ({seconds, images: curves.map((c, i) => {
        const {variance, cost, bias2 = 0} = [base, ...chosen][i], samples = Math.max(1, Math.round((seconds - 0.02) / cost)), relMse = variance / samples + bias2, noise = Math.sqrt(relMse);
        return {curve: c.id, samples, relMse, png: noisy(noise, random), error: errorMap(noise, random)};
    })}));
    return {
        format: "abbe-study/1", program: {version: "0.1.0", command: "abbe study scenes/cornell-box/cornell-box.scene --size 96x96 --replicates 8 -o cornell-box.html"},
        machine: {cpu: "Example CPU at 2.7 GHz", threads: 2}, scene: {path: "scenes/cornell-box/cornell-box.scene", name: "cornell-box", width, height, effects: "dispersion + absorption"},
        replicates: 8, complete: true, seed: 0, leftOut: [{id: "light-tree", label: "light tree", reason: "there is one light, so there is no choice"}], measure: "relMSE = mean of (x − a)(x − b)/(r² + 0.01 mean(r)²) over the pixels in linear Rec. 709; a and b are the two halves of the reference, r their mean.",
        reference: {samplesPerHalf: 16384, seconds: 61.2, relMse: 5.1e-8}, curves, strips, errorScale: {name: "inferno", low: 0, high: 0.5, unit: "relative error"},
        referencePng: png(width, height, room),
        effects: [
            {name: "dispersion", place: "prism.scene:12:3", secondsOn: 1.2, secondsOff: 1.0, deltaTime: 0.167, low: 0.15, high: 0.19, flip: 0.062, relMse: 1e-3, png: noisy(0.02, random), note: "", reason: null},
            {name: "motion", place: "prism.scene:31:5", secondsOn: 1.2, secondsOff: 1.16, deltaTime: 0.033, low: 0.02, high: 0.05, flip: 0.004, relMse: 2e-5, png: noisy(0.02, random), note: "keys of two objects", reason: null},
            {name: "volume haze", place: "prism.scene:40:1", secondsOn: 1.2, secondsOff: 0.7, deltaTime: 0.417, low: 0.4, high: 0.43, flip: 0.11, relMse: 3e-2, png: noisy(0.1, random), note: "", reason: null},
            {name: "subsurface", place: "prism.scene:44:9", secondsOn: 1.2, secondsOff: 1.19, deltaTime: 0.008, low: -0.01, high: 0.02, flip: 0.021, relMse: 4e-4, png: noisy(0.05, random), note: "", reason: null},
            {name: "depth of field", place: "prism.scene:3:9", secondsOn: 1.2, secondsOff: 1.18, deltaTime: 0.016, low: 0.0, high: 0.03, flip: 0.019, relMse: 5e-4, png: noisy(0.05, random), note: "", reason: null},
            {name: "textures", place: "prism.scene:50:1", secondsOn: null, secondsOff: null, deltaTime: null, low: null, high: null, flip: null, relMse: null, png: null, note: "", reason: "without its texture the lamp has no power"}],
        cost: {seconds: 2.0, threads: 2, accounted: 0.985, rows: [["embree", "Embree", 0.9, 5.1e6, {note: "all rays of the rows below and above"}], ["surface", "surfaces", 0.42, 2.2e6, {}], ["lights", "light sampling", 0.31, 2.9e6, {}],
            ["camera", "camera", 0.11, 6e5, {}], ["film", "film", 0.09, 0, {count: 64000, counted: "samples"}], ["volume-haze", "volume haze", 0.08, 3e5, {elsewhere: 0.5, count: 4e5, counted: "densities"}],
            ["textures", "textures", 0.04, 0, {count: 198000, counted: "lookups"}], ["dispersion", "dispersion", 0, 48000, {elsewhere: 0.12}], ["motion", "motion", 0, 0, {count: 0, counted: "hits of what moves"}],
            ["rest", "the rest", 0.02, 0, {}]].map(([id, label, seconds, rays, more]) => ({id, label, seconds, uncertainty: 0.07 * seconds, share: seconds / 2, elsewhere: 0, rays, ...more}))},
    };
}

// Every odd study that a page has to bear, by name.
export function oddities() {
    const one = ordinary(2, []), twenty = ordinary(3, [...changes, ...Array.from({length: 4}, (_, i) => ({...changes[1], id: `more${i}`, label: `variation ${i + 1} of the light sampling`, variance: 2 + i}))]);
    for (const key of ["effects", "cost", "errorScale", "referencePng"]) delete one[key];
    one.strips = [];
    const empty = {format: "abbe-study/1", program: null, machine: null, scene: {}, replicates: null, seed: null, measure: null, reference: null, curves: [], strips: null, errorScale: null, referencePng: null};
    const nulls = ordinary(4, changes.slice(0, 4));
    for (const c of nulls.curves) {
        Object.assign(c, {fit: null, floor: null, efficiency: {ratio: null, low: null, high: null}, timeTo: [{error: 0.01, seconds: null, low: null, high: null, samples: null, extrapolated: null}], note: null, change: null});
        for (const p of c.points) Object.assign(p, {coreSeconds: null, rays: null, low: null, high: null, trimmed: null, bias2: null, bias2Low: null, bias2High: null, runs: null});
        c.points.push({samples: 16384, seconds: null, relMse: null, low: null, high: null});
    }
    nulls.curves[0].fit = {slope: -1.02, low: null, high: null, halfNoiseCost: 3.9, halfNoiseCostLow: null, halfNoiseCostHigh: null};
    nulls.curves[1].efficiency.ratio = 0.1; // without an interval
    Object.assign(nulls.curves[0].timeTo[0], {seconds: 1e9, extrapolated: true});
    Object.assign(nulls, {machine: {}, effects: null, cost: null, strips: [{seconds: null, images: []}, {seconds: 1, images: [{curve: "abbe", samples: null, relMse: null, png: nulls.referencePng, error: null}]}]});
    const noise = ordinary(5, changes.slice(0, 3)); // negative: below the noise of the reference
    for (const c of noise.curves) c.points.slice(-2).forEach(p => Object.assign(p, {relMse: -1e-8, low: -9e-8, high: 6e-8}));
    noise.curves[1].points.forEach(p => Object.assign(p, {relMse: -1e-9, low: -2e-9, high: -1e-10}));
    const hostile = ordinary(6, changes.slice(0, 5)), evil = "</script><script>document.title='taken'; throw 1</script><img src=x onerror=alert(1)> & \"quotes\" 'too' <!-- ";
    hostile.scene.name = evil + "a scene with a name that goes on and on, ".repeat(6) + "withoutanyspaces".repeat(12);
    hostile.scene.path = "/" + "very-long-folder/".repeat(20) + "x.scene";
    Object.assign(hostile.curves[2], {label: evil, group: evil, change: evil, note: evil});
    hostile.curves[3].label = "anotherverylongnamewithoutspaces".repeat(5);
    hostile.curves[0].label = "as <b>rendered</b>";
    hostile.effects[0].name = evil;
    hostile.effects[0].place = evil;
    hostile.cost.rows[0].label = evil;
    hostile.program.command = `abbe study ${evil}`;
    hostile.measure = evil;
    hostile.leftOut[0].reason = evil;
    Object.assign(noise.curves[1], {time: {fixed: 0.9, perSample: 1e-3}, efficiency: {ratio: 14, low: 3, high: null}}); // without an upper bound
    Object.assign(noise.curves[0], {time: {fixed: 1.4, perSample: 1e-3}});
    Object.assign(noise.curves[0].fit, {halfNoiseCostHigh: null});
    noise.complete = false;
    noise.reference.advantage = 2.1;
    const effectsAlone = {...empty, scene: one.scene, effects: ordinary(7, []).effects};
    return {effectsAlone, one, twenty, empty, nulls, noise, hostile};
}
