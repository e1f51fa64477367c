// What somebody sees who opens a PNG: node histogram.mjs PICTURE.png prints "black", "white", "flat" or "picture", and
// the shares behind that. Reads PNGs of 8 bits as Abbe writes them, grey or RGB, with the libraries of node alone.
import {readFileSync} from "node:fs";
import {inflateSync} from "node:zlib";

function decode(file) {
    const bytes = readFileSync(file), data = [];
    if (bytes.toString("latin1", 1, 4) !== "PNG") throw new Error(`${file} is no PNG`);
    let width, height, channels;
    for (let at = 8; at < bytes.length;) {
        const size = bytes.readUInt32BE(at), type = bytes.toString("latin1", at + 4, at + 8), chunk = bytes.subarray(at + 8, at + 8 + size);
        if (type === "IHDR") {
            [width, height] = [chunk.readUInt32BE(0), chunk.readUInt32BE(4)];
            channels = {0: 1, 2: 3}[chunk[9]];
            if (chunk[8] !== 8 || !channels || chunk[12] !== 0) throw new Error(`${file}: neither grey nor RGB of 8 bits`);
        }
        if (type === "IDAT") data.push(chunk);
        at += size + 12;
    }
    const raw = inflateSync(Buffer.concat(data)), stride = width * channels, rows = Buffer.alloc(stride * height);
    const paeth = (a, b, c) => { const p = a + b - c, [x, y, z] = [a, b, c].map(v => Math.abs(p - v)); return x <= y && x <= z ? a : y <= z ? b : c; };
    for (let y = 0; y < height; ++y)
        for (let x = 0; x < stride; ++x) {
            const left = x >= channels ? rows[y * stride + x - channels] : 0, up = y > 0 ? rows[(y - 1) * stride + x] : 0;
            const corner = x >= channels && y > 0 ? rows[(y - 1) * stride + x - channels] : 0;
            const predicted = [0, left, up, (left + up) >> 1, paeth(left, up, corner)][raw[y * (stride + 1)]];
            rows[y * stride + x] = raw[y * (stride + 1) + 1 + x] + predicted;
        }
    return Array.from({length: width * height}, (_, i) => Math.max(...rows.subarray(i * channels, (i + 1) * channels)));
}

const brightest = decode(process.argv[2]).sort((a, b) => a - b), at = share => brightest[Math.floor(share * (brightest.length - 1))];
const share = test => brightest.filter(test).length / brightest.length, black = share(v => v <= 12), white = share(v => v >= 254);
const verdict = black > 0.95 ? "black" : white > 0.95 ? "white" : at(0.99) - at(0.01) < 8 ? "flat" : "picture";
console.log(`${verdict}  ${(100 * black).toFixed(0)} % black, ${(100 * white).toFixed(0)} % white, from ${at(0.01)} to ${at(0.99)} of 255`);
