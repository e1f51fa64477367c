// Whether a contact sheet, or the raw frames of a clip, show what the PNGs of the frames show:
//   node overview.mjs SHEET.png TILE GAP STRIP COLUMNS COUNT PNG…     a PNG -: a gap with a cross; .: nothing was there
//   node overview.mjs FRAMES.raw SIZE PNG…
// Ends with 1 after faults.
import {readFileSync} from "node:fs";
import {inflateSync} from "node:zlib";

const [, , file, size, ...rest] = process.argv;
let faults = 0;
function check(right, what) {
    if (right) return;
    console.log(`FAULT: ${what}`);
    ++faults;
}

// Eight bits of red, green and blue.
function readPng(path) {
    const bytes = readFileSync(path), parts = [];
    let width = 0, height = 0;
    for (let at = 8; at < bytes.length;) {
        const length = bytes.readUInt32BE(at), kind = bytes.toString("latin1", at + 4, at + 8), body = bytes.subarray(at + 8, at + 8 + length);
        if (kind === "IHDR") {
            width = body.readUInt32BE(0);
            height = body.readUInt32BE(4);
            if (body[8] !== 8 || body[9] !== 2 || body[12] !== 0) throw new Error(`${path} is no plain RGB`);
        }
        if (kind === "IDAT") parts.push(body);
        at += length + 12;
    }
    const raw = inflateSync(Buffer.concat(parts)), stride = 3 * width, rgb = Buffer.alloc(stride * height);
    for (let y = 0; y < height; ++y) {
        const filter = raw[y * (stride + 1)];
        for (let i = 0; i < stride; ++i) {
            const a = i >= 3 ? rgb[y * stride + i - 3] : 0, b = y > 0 ? rgb[(y - 1) * stride + i] : 0, c = i >= 3 && y > 0 ? rgb[(y - 1) * stride + i - 3] : 0;
            const p = a + b - c, [pa, pb, pc] = [Math.abs(p - a), Math.abs(p - b), Math.abs(p - c)];
            const guess = [0, a, b, (a + b) >> 1, pa <= pb && pa <= pc ? a : pb <= pc ? b : c][filter];
            rgb[y * stride + i] = raw[y * (stride + 1) + 1 + i] + guess;
        }
    }
    return {width, height, at: (x, y, k) => rgb[y * stride + 3 * x + k]};
}

// A tile, by means of squares of pixels.
function differences(frame, width, height, shown) {
    const step = frame.width / width;
    if (step !== Math.round(step) || frame.height !== height * step) throw new Error("tiles of another shape");
    let most = 0, sum = 0;
    for (let y = 0; y < height; ++y)
        for (let x = 0; x < width; ++x)
            for (let k = 0; k < 3; ++k) {
                let mean = 0;
                for (let v = 0; v < step; ++v) for (let u = 0; u < step; ++u) mean += frame.at(x * step + u, y * step + v, k);
                const apart = Math.abs(Math.round(mean / step ** 2) - shown(x, y, k));
                most = Math.max(most, apart);
                sum += apart;
            }
    return {most, mean: sum / (3 * width * height)};
}

const [width, height] = size.split("x").map(Number);
if (file.endsWith(".raw")) {
    const bytes = readFileSync(file), area = 3 * width * height;
    check(bytes.length === rest.length * area, `${bytes.length / area} frames instead of ${rest.length}`);
    rest.forEach((png, i) => { // lossy, and of a quarter of the colours
        const found = differences(readPng(png), width, height, (x, y, k) => bytes[i * area + 3 * (y * width + x) + k]);
        check(found.mean < 4, `frame ${i} of the clip differs from ${png} by ${found.mean} on average`);
    });
} else {
    const [gap, strip, columns, count] = rest.slice(0, 4).map(Number), frames = rest.slice(4), sheet = readPng(file), rows = Math.ceil(count / columns);
    check(sheet.width === columns * (width + gap) + gap && sheet.height === rows * (height + strip + gap) + gap, `the sheet has ${sheet.width}x${sheet.height} pixels`);
    check(frames.length === count, "a PNG for each frame");
    frames.forEach((png, i) => {
        const left = gap + (i % columns) * (width + gap), top = gap + Math.floor(i / columns) * (height + strip + gap);
        const shown = (x, y, k) => sheet.at(left + x, top + y, k);
        if (png === "-" || png === ".") {
            const crossed = shown(0, 0, 0) > 150 && shown(width - 1, 0, 0) > 150 && shown(0, 0, 2) < 100;
            check(crossed === (png === "-"), `the gap at ${i}`);
            check(shown(Math.floor(width / 2), 1, 0) < 80, `something is in the gap at ${i}`);
        } else {
            const found = differences(readPng(png), width, height, shown);
            check(found.most === 0, `tile ${i} differs from ${png} by ${found.most}`);
        }
        let ink = 0; // of the number
        for (let y = height; y < height + strip; ++y) for (let x = 0; x < width; ++x) ink += shown(x, y, 0) > 150;
        check(strip === 0 || ink > 20, `no number below tile ${i}`);
    });
}
process.exit(faults > 0 ? 1 : 0);
