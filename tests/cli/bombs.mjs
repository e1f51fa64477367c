// Pictures of 16384 by 16384 pixels in files of a few megabytes, as large as their compression lets them be:
//     nodejs bombs.mjs FOLDER        writes bomb.exr (three channels of floats, zip) and bomb.png (RGB of 8 bits)
// Every block is the same and made once, so that writing them takes no time.
import fs from "node:fs";
import zlib from "node:zlib";

const side = 16384;
const folder = process.argv[2];

const ints = (...numbers) => {
    const bytes = Buffer.alloc(4 * numbers.length);
    numbers.forEach((n, i) => bytes.writeUInt32LE(n >>> 0, 4 * i));
    return bytes;
};
const floats = (...numbers) => {
    const bytes = Buffer.alloc(4 * numbers.length);
    numbers.forEach((n, i) => bytes.writeFloatLE(n, 4 * i));
    return bytes;
};
const text = string => Buffer.from(string + "\0", "latin1");

function writeExr(path) {
    const attribute = (name, type, value) => Buffer.concat([text(name), text(type), ints(value.length), value]);
    const window = ints(0, 0, side - 1, side - 1);
    const channels = ["B", "G", "R"].map(name => Buffer.concat([text(name), ints(2, 0, 1, 1)]));
    const header = Buffer.concat([
        ints(20000630, 2),
        attribute("channels", "chlist", Buffer.concat([...channels, Buffer.from([0])])),
        attribute("compression", "compression", Buffer.from([3])),
        attribute("dataWindow", "box2i", window),
        attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", Buffer.from([0])),
        attribute("pixelAspectRatio", "float", floats(1)),
        attribute("screenWindowCenter", "v2f", floats(0, 0)),
        attribute("screenWindowWidth", "float", floats(1)),
        Buffer.from([0]),
    ]);
    // Zeros as the predictor of zip leaves them: differences of 0, which are stored as 128, behind the first byte.
    const lines = 16, raw = Buffer.alloc(lines * side * 3 * 4, 128);
    raw[0] = 0;
    const packed = zlib.deflateSync(raw, {level: 9});
    const chunks = side / lines, chunk = 8 + packed.length, begin = header.length + 8 * chunks;
    const offsets = Buffer.alloc(8 * chunks);
    const file = fs.openSync(path, "w");
    for (let i = 0; i < chunks; ++i) offsets.writeBigUInt64LE(BigInt(begin + i * chunk), 8 * i);
    fs.writeSync(file, header);
    fs.writeSync(file, offsets);
    for (let i = 0; i < chunks; ++i) fs.writeSync(file, Buffer.concat([ints(lines * i, packed.length), packed]));
    fs.closeSync(file);
}

function writePng(path) {
    const table = Array.from({length: 256}, (_, n) => {
        for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
        return n >>> 0;
    });
    const big = n => Buffer.from([n >>> 24, (n >>> 16) & 255, (n >>> 8) & 255, n & 255]);
    const chunk = (type, data) => {
        const body = Buffer.concat([Buffer.from(type, "latin1"), data]);
        let crc = 0xffffffff;
        for (const byte of body) crc = table[(crc ^ byte) & 255] ^ (crc >>> 8);
        return Buffer.concat([big(data.length), body, big((crc ^ 0xffffffff) >>> 0)]);
    };
    // Black rows without a filter are zeros. A full flush ends each block at a byte, without looking back.
    const rows = 64, row = 1 + 3 * side, count = side * row;
    const block = zlib.deflateRawSync(Buffer.alloc(rows * row), {level: 9, finishFlush: zlib.constants.Z_FULL_FLUSH});
    const adler = big((((count % 65521) << 16) | 1) >>> 0);
    const data = Buffer.concat([
        Buffer.from([0x78, 0xda]),
        ...Array(side / rows).fill(block),
        Buffer.from([3, 0]), // a last block of nothing
        adler,
    ]);
    fs.writeFileSync(path, Buffer.concat([
        Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]),
        chunk("IHDR", Buffer.concat([big(side), big(side), Buffer.from([8, 2, 0, 0, 0])])),
        chunk("IDAT", data),
        chunk("IEND", Buffer.alloc(0)),
    ]));
}

writeExr(folder + "/bomb.exr");
writePng(folder + "/bomb.png");
