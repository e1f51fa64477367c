// Packs as a program makes them and as somebody makes them who means harm.
//   nodejs packs.mjs make DIR      a pack DIR/NAME.abz for each case, and what is outside of them
//   nodejs packs.mjs gltf DIR      a glTF file with a buffer in a folder, whose name has a space
//   nodejs packs.mjs check DIR N   whether abz.json in DIR lists the N files that are there
//   nodejs packs.mjs corpus DIR    what tests/fuzz/corpus/pack holds
import { createHash } from 'node:crypto';
import { mkdirSync, readFileSync, readdirSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { deflateRawSync } from 'node:zlib';

const [task, folder, count] = process.argv.slice(2);
const number = (value, bytes) => {
    const text = Buffer.alloc(bytes);
    for (let i = 0; i < bytes; ++i) text[i] = Math.floor(value / 256 ** i) % 256;
    return text;
};
const crc32 = (bytes) => {
    let crc = 0xffffffff;
    for (const b of bytes) {
        crc ^= b;
        for (let i = 0; i < 8; ++i) crc = (crc >>> 1) ^ (0xedb88320 & -(crc & 1));
    }
    return ~crc >>> 0;
};
const sha256 = (bytes) => createHash('sha256').update(bytes).digest('hex');

// files: { name, bytes, mode, deflate, promised }
function archive(files) {
    const bodies = [], directory = [];
    let at = 0;
    for (const f of files) {
        const name = Buffer.from(f.name, f.encoding ?? 'utf8'), data = Buffer.from(f.bytes);
        const stored = f.deflate ? deflateRawSync(data) : data;
        const size = f.promised ?? data.length;
        const common = [number(20, 2), number(f.flags ?? 0x800, 2), number(f.deflate ? 8 : 0, 2), number(0x210000, 4),
            number(crc32(data), 4), number(f.promised !== undefined && !f.deflate ? size : stored.length, 4), number(size, 4),
            number(name.length, 2), number(0, 2)];
        directory.push(Buffer.from('PK\x01\x02', 'latin1'), number(0x314, 2), ...common, number(0, 6), number((f.mode ?? 0o100644) * 65536, 4),
            number(at, 4), name);
        const body = Buffer.concat([Buffer.from('PK\x03\x04', 'latin1'), ...common, name, stored]);
        bodies.push(body);
        at += body.length;
    }
    const list = Buffer.concat(directory);
    return Buffer.concat([...bodies, list, Buffer.from('PK\x05\x06', 'latin1'), number(0, 4), number(files.length, 2), number(files.length, 2),
        number(list.length, 4), number(at, 4), number(0, 2)]);
}

const manifest = (files) => JSON.stringify({ format: 'abbe pack', version: 1, program: '', scene: 'a.scene',
    files: files.map((f) => ({ name: f.name, bytes: f.bytes.length, sha256: sha256(f.bytes) })) });
const pack = (files, listed = files) => archive([{ name: 'abz.json', bytes: manifest(listed) }, ...files]);

const text = 'scene 1\ncamera { from 0 0 4; look-at 0 0 0; exposure auto }\nlight sky { luminance 5000 nits }\n';
const scene = { name: 'a.scene', bytes: text };
const file = (name, bytes = 'x', more = {}) => ({ name, bytes, ...more });
const sceneWith = (line) => ({ name: 'a.scene', bytes: `${text}${line}\n` });

const square = (uri) => JSON.stringify({ asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 4, type: 'VEC3' }, { bufferView: 1, componentType: 5123, count: 6, type: 'SCALAR' }],
    bufferViews: [{ buffer: 0, byteLength: 48 }, { buffer: 0, byteOffset: 48, byteLength: 12 }],
    buffers: [{ uri, byteLength: 60 }], images: [{ uri: 'no-such-picture.png' }] });
const squareBytes = Buffer.concat([Buffer.from(new Float32Array([-1, 0, -1, 1, 0, -1, 1, 0, 1, -1, 0, 1]).buffer),
    Buffer.from(new Uint16Array([0, 2, 1, 0, 3, 2]).buffer)]);

// Exit code, what the message says, the archive.
const cases = {
    good: [0, 'no errors', pack([scene])],
    deflated: [0, 'no errors', pack([{ ...scene, deflate: true }])],
    folders: [0, 'no errors', archive([{ name: 'abz.json', bytes: manifest([scene, file('b/c')]) }, file('b/', '', { mode: 0o40755 }), file('b/c'), scene])],
    link: [3, 'it is a link', pack([scene, file('evil', '/etc/passwd', { mode: 0o120777 })])],
    device: [3, 'no regular file', pack([scene, file('evil', '', { mode: 0o20666 })])],
    twice: [3, 'it is there twice', pack([scene, file('b'), file('b')], [scene, file('b')])],
    unlisted: [3, 'it is not in abz.json', pack([scene, file('b')], [scene])],
    missing: [3, 'but not there', pack([scene], [scene, file('b')])],
    'other-bytes': [3, 'its SHA-256 is not', pack([scene, file('b', 'evil')], [scene, file('b', 'good')])],
    bomb: [3, 'E0414', pack([file('a.scene', Buffer.alloc(50_000_000, ' '), { deflate: true })], [scene])],
    lies: [3, 'E0414', pack([file('a.scene', '// lies\n' + ' '.repeat(5_000_000), { deflate: true, promised: 8 })], [file('a.scene', '// lies\n')])],
    'stored-lies': [3, 'E0414', pack([scene, file('b', 'more', { promised: 2 })], [scene, file('b', 'mo')])],
    'no-manifest': [3, 'without abz.json', archive([scene])],
    'no-json': [3, 'abz.json', archive([{ name: 'abz.json', bytes: '{' }, scene])],
    newer: [3, 'version 2', archive([{ name: 'abz.json', bytes: manifest([scene]).replace('"version":1', '"version":2') }, scene])],
    outside: [1, 'E0415', pack([sceneWith('material m diffuse { reflectance image "/etc/hostname" }')])],
    above: [1, 'E0415', pack([sceneWith('material m diffuse { reflectance image "../../../../outside.png" }')])],
    spectrum: [1, 'E0415', pack([sceneWith('spectrum m table "../../../../outside.png"')])],
    gltf: [1, 'E0402', pack([sceneWith('shape mesh "g.gltf"'), file('g.gltf', square('../../../../outside.bin'))])],
    'gltf-inside': [0, 'no errors', pack([sceneWith('shape mesh "m/g.gltf"'), file('m/g.gltf', square('../b.bin')), file('b.bin', squareBytes)])],
};
for (const name of ['../evil', '../../evil', 'a/../../evil', '/tmp/evil', './evil', 'a//b', 'C:evil', 'a\\evil', '..']) {
    const id = name.replace(/[^a-z.]/g, '_');
    cases[`name-${id}`] = [3, 'E0414', pack([scene, file(name)], [scene])];
    cases[`listed-${id}`] = [3, 'E0414', pack([scene], [scene, file(name)])];
    cases[`both-${id}`] = [3, 'E0414', pack([scene, file(name)])];
}

if (task === 'make') {
    writeFileSync(join(folder, 'outside.bin'), squareBytes);
    writeFileSync(join(folder, 'outside.png'), '400 0.1\n700 0.2\n');
    for (const [name, [code, says, bytes]] of Object.entries(cases)) {
        writeFileSync(join(folder, `made-${name}.abz`), bytes);
        console.log(`${code} made-${name}.abz ${says}`);
    }
} else if (task === 'gltf') {
    mkdirSync(join(folder, 'buffers'), { recursive: true });
    writeFileSync(join(folder, 'square.gltf'), square('buffers/my%20square.bin'));
    writeFileSync(join(folder, 'buffers/my square.bin'), squareBytes);
} else if (task === 'check') {
    const { format, version, scene: name, files } = JSON.parse(readFileSync(join(folder, 'abz.json')));
    const all = (at) => readdirSync(join(folder, at)).flatMap((n) => {
        const path = at ? `${at}/${n}` : n;
        return statSync(join(folder, path)).isDirectory() ? all(path) : [path];
    });
    const there = all('').filter((n) => n !== 'abz.json').sort().join();
    const good = format === 'abbe pack' && version === 1 && files.some((f) => f.name === name) && files.length === Number(count) &&
        files.map((f) => f.name).sort().join() === there &&
        files.every((f) => readFileSync(join(folder, f.name)).length === f.bytes && sha256(readFileSync(join(folder, f.name))) === f.sha256);
    if (!good) console.log(there);
    process.exit(good ? 0 : 1);
} else {
    for (const name of ['good', 'deflated', 'folders', 'link', 'lies', 'twice', 'name-.._evil'].filter((n) => cases[n]))
        writeFileSync(join(folder, `${name.replace('.._', 'up-')}.abz`), cases[name][2]);
    writeFileSync(join(folder, 'manifest.json'), manifest([scene, file('b/c')]));
    const zip64 = Buffer.concat([Buffer.from('PK\x06\x06', 'latin1'), number(44, 8), number(45, 2), number(45, 2), number(0, 8), number(1, 8), number(1, 8)]);
    const whole = pack([scene]), end = whole.length - 22;
    const list = [whole.readUInt32LE(end + 12), whole.readUInt32LE(end + 16)];
    writeFileSync(join(folder, 'zip64.abz'), Buffer.concat([whole.subarray(0, end), zip64.subarray(0, 24), number(2, 8), number(2, 8), number(list[0], 8), number(list[1], 8),
        Buffer.from('PK\x06\x07', 'latin1'), number(0, 4), number(end, 8), number(1, 4), Buffer.from('PK\x05\x06', 'latin1'), number(0, 4),
        number(0xffffffff, 4), number(0xffffffff, 4), number(0xffffffff, 4), number(0, 2)]));
}
