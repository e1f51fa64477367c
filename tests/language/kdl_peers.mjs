// What @bgotink/kdl reads in documents: a document in JSON a line on standard input, its nodes a line each on standard
// output; null where it refuses the document. Called by kdl_peers.py with the folder of node_modules.
import { createRequire } from "node:module";
import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";

const require = createRequire(`${process.argv[2]}/`);
const kdl = await import(pathToFileURL(require.resolve("@bgotink/kdl")));

// As Python reads them; JSON has neither infinity nor -0.
const number = (v) => (Object.is(v, -0) ? "-0" : String(v).replace("Infinity", "inf").replace("NaN", "nan"));
const value = (v) => (typeof v === "number" ? { number: number(v) } : v);
const values = (list) => list.map(value);
// A list of pairs: `__proto__` may be a key.
const keys = (pairs) => [...new Map(pairs)].map(([name, v]) => [name, value(v)]);

const tree = (node) => {
    const list = node.entries;
    return [
        node.name.name,
        values(list.filter((e) => e.name === null).map((e) => e.value.value)),
        keys(list.filter((e) => e.name !== null).map((e) => [e.name.name, e.value.value])),
        (node.children?.nodes ?? []).map(tree),
    ];
};

function read(text) {
    try {
        return kdl.parse(text).nodes.map(tree);
    } catch {
        return null;
    }
}

for await (const line of createInterface({ input: process.stdin })) {
    process.stdout.write(`${JSON.stringify(read(JSON.parse(line).text))}\n`);
}
