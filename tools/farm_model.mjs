// A shot on a large cluster, simulated from measured figures: where its time goes, for docs/farm.md.
//   node tools/farm_model.mjs [NODES [SAMPLES [WIDTHxHEIGHT [SECONDS_OF_A_SAMPLE]]]]
// One event after the other: tasks are started one by one at the rate of the scheduler, nodes die and their tasks are taken up
// again at their last checkpoint, parts are written to and read from one shared file system. Random numbers are fixed.
const [nodes, samples, size] = [Number(process.argv[2] ?? 10000), Number(process.argv[3] ?? 16384), process.argv[4] ?? '3840x2160'];
const [width, height] = size.split('x').map(Number);

// Measured (docs/farm.md says how), but for what is marked as assumed.
const measured = {
    sampleSeconds: Number(process.argv[5] ?? 100e-6), // of a core, of one sample of one pixel: a cloud at noon
    cores: 16,             // of a node; assumed
    loadSeconds: 5,        // reading and building the scene, pilots
    partBytes: 36,         // of a pixel, packed
    mergeRate: 0.55e9,     // packed bytes that one core reads and adds in a second
    startsPerSecond: 50,   // tasks that slurmctld starts; assumed for a loaded cluster
    diskRate: 20e9,        // bytes a second of the shared file system; assumed
    nodeLinkRate: 1.2e9,   // bytes a second of one node; assumed (10 Gbit/s)
    hoursBetweenFaults: 2000, // of one node; assumed
    downSeconds: 120,      // until a task of a dead node runs elsewhere
    checkpointSeconds: 25,
    chunkSeconds: 600,
    mostParts: 1000,       // of one array (MaxArraySize 1001)
};

let state = 0x9e3779b97f4a7c15n;
function random() { // SplitMix64, in [0, 1)
    state = (state + 0x9e3779b97f4a7c15n) & 0xffffffffffffffffn;
    let z = state;
    z = ((z ^ (z >> 30n)) * 0xbf58476d1ce4e5b9n) & 0xffffffffffffffffn;
    z = ((z ^ (z >> 27n)) * 0x94d049bb133111ebn) & 0xffffffffffffffffn;
    return Number((z ^ (z >> 31n)) >> 11n) / 2 ** 53;
}

// Tasks on nodes: each begins when the scheduler has started it and a node is free. Returns when all have ended.
function run(count, seconds, begin) {
    const free = new Array(Math.min(nodes, count)).fill(begin);
    let started = begin, end = begin, faults = 0, lost = 0;
    for (let i = 0; i < count; ++i) {
        let k = i; // every task has its own node, if there are enough
        if (count > nodes) {
            k = 0;
            for (let j = 1; j < free.length; ++j) if (free[j] < free[k]) k = j;
        }
        started = Math.max(started + 1 / measured.startsPerSecond, free[k]);
        let at = started, left = seconds;
        for (;;) {
            const until = -Math.log(1 - random()) * measured.hoursBetweenFaults * 3600;
            if (until >= left) break;
            ++faults;
            const again = (until % measured.checkpointSeconds) + measured.downSeconds + measured.loadSeconds;
            lost += again;
            at += until + again;
            left -= until - (until % measured.checkpointSeconds);
        }
        free[k] = at + left;
        end = Math.max(end, free[k]);
    }
    return {end, faults, lost};
}

const pixels = width * height, bytes = pixels * measured.partBytes;
const coreSeconds = pixels * samples * measured.sampleSeconds;
const ideal = coreSeconds / measured.cores / nodes;
const replicateSamples = samples / 2;
const rows = [];
for (const parts of [250, 500, 1000, 2000, 4096, 8192]) {
    if (parts > replicateSamples) continue;
    const partSeconds = coreSeconds / measured.cores / parts;
    const writing = Math.max(bytes / measured.nodeLinkRate, bytes * Math.min(parts, nodes) / measured.diskRate);
    const rendering = run(parts, measured.loadSeconds + partSeconds + writing, 0);
    const group = Math.ceil(Math.sqrt(parts)), groups = Math.ceil(parts / group);
    const reading = files => Math.max(files * bytes / measured.mergeRate, files * bytes / measured.nodeLinkRate);
    const gather = Math.max(reading(group), parts * bytes / measured.diskRate) + measured.loadSeconds;
    const gathered = run(groups, gather, rendering.end);
    const merged = gathered.end + reading(groups) + measured.loadSeconds + 10; // and writing the image
    rows.push([parts, partSeconds, rendering.end, rendering.faults, gathered.end - rendering.end, merged - gathered.end, merged,
               100 * coreSeconds / measured.cores / (merged * Math.min(parts, nodes)), parts * bytes / 1e9]);
}
console.log(`${width}x${height}, ${samples} samples: ${(coreSeconds / 3600).toFixed(0)} core hours, on ${nodes} nodes of ${measured.cores} cores at best ${ideal.toFixed(0)} s`);
console.log('| parts | a part, s | rendered after, s | faults | gathering, s | merging, s | picture after, s | nodes at work, % | parts, GB |');
console.log('|---|---|---|---|---|---|---|---|---|');
for (const r of rows) console.log(`| ${r[0]} | ${r.slice(1, 9).map((v, i) => i === 2 ? v : v.toPrecision(3)).join(' | ')} |`);
