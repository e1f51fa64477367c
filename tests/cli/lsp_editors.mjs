// Whether the files for editors hold together:  nodejs lsp_editors.mjs EDITORS REFERENCE.json
// The grammar is tried with JavaScript's regular expressions, which differ from those of editors in nothing that it uses.
import { existsSync, readFileSync } from 'node:fs';
import Module, { createRequire } from 'node:module';
import { join, resolve } from 'node:path';

const [editors, reference] = process.argv.slice(2).map((path) => resolve(path));
let faults = 0;
const check = (good, what) => {
    if (good) return;
    ++faults;
    console.log(`FAULT: ${what}`);
};
const read = (name) => JSON.parse(readFileSync(join(editors, name), 'utf8'));

// The extension names files that are there.
const extension = read('vscode/package.json');
const { languages, grammars } = extension.contributes;
for (const file of [extension.main, languages[0].configuration, grammars[0].path])
    check(existsSync(join(editors, 'vscode', file)), `${file} of the extension`);
read('vscode/language-configuration.json');
const grammar = read('vscode/syntaxes/abbe-scene.tmLanguage.json');
check(grammar.scopeName === grammars[0].scopeName, 'the name of the grammar');

// Rules in their order, at each place the first that matches there; as editors do.
const rules = grammar.patterns.map((r) => ({ ...r, expression: new RegExp(r.match ?? r.begin, 'gmd') }));
// Behind the end of what `m` begins: an inner rule that comes before the end takes its place.
function endOf(rule, m, line) {
    const end = new RegExp(rule.end.replace('\\1', m[1] ?? ''), 'gm');
    const inner = rule.patterns.filter((r) => r.match).map((r) => new RegExp(r.match, 'gm'));
    for (let at = m.index + m[0].length;;) {
        const next = [end, ...inner].map((e) => { e.lastIndex = at; return e.exec(line); });
        const stop = next[0], first = next.slice(1).filter(Boolean).sort((a, b) => a.index - b.index)[0];
        if (!stop) return line.length;
        if (!first || stop.index <= first.index) return stop.index + Math.max(stop[0].length, 1);
        at = first.index + first[0].length;
    }
}
function colours(line) {
    const found = {};
    for (let at = 0; at < line.length;) {
        let first;
        for (const rule of rules) {
            rule.expression.lastIndex = at;
            const m = rule.expression.exec(line);
            if (m && (!first || m.index < first.m.index)) first = { rule, m };
        }
        if (!first) break;
        const { rule, m } = first;
        if (rule.begin) {
            at = endOf(rule, m, line);
            found[line.slice(m.index, at)] = rule.name;
            continue;
        }
        for (const [group, { name }] of Object.entries(rule.captures)) if (m[group] !== undefined) found[m[group]] = name;
        at = m.index + Math.max(m[0].length, 1);
    }
    return found;
}
function coloured(line, wanted) {
    const found = colours(line);
    for (const [word, name] of Object.entries(wanted))
        check(name === null ? !(word in found) : found[word] === `${name}.abbe-scene`, `\`${word}\` in \`${line}\` is ${found[word]}`);
}
coloured('scene 1 length=mm', { scene: 'keyword.control', length: 'entity.other.attribute-name', 1: 'constant.numeric' });
coloured('shape ball sphere { radius 2.5 mm }', { shape: 'storage.type', ball: 'entity.name', sphere: 'entity.name.type', radius: 'support.type.property-name', '2.5': 'constant.numeric', mm: 'keyword.other.unit' });
coloured('shape sphere', { shape: 'storage.type', sphere: 'entity.name.type' });
coloured('camera { lense 35 mm; f-stop 2.8 }', { lense: null, 'f-stop': 'support.type.property-name' });
coloured('param turn -32.9 deg "of the prism" // why', { param: 'keyword.control', turn: 'variable.parameter', '-32.9': 'constant.numeric', deg: 'keyword.other.unit', '"of the prism"': 'string.quoted.double', '// why': 'comment.line.double-slash' });
coloured('transform { rotate y $turn }', { transform: 'support.type.property-name', rotate: 'support.type.property-name', $turn: 'variable.parameter' });
coloured('color blackbody 3200 K', { color: 'support.type.property-name', blackbody: 'support.function', 3200: 'constant.numeric', K: 'keyword.other.unit' });
coloured('output "a \\" b.exr" space=acescg', { '"a \\" b.exr"': 'string.quoted.double', space: 'entity.other.attribute-name' });
coloured('path #"C:\\a"# /* no */ #true', { '#"C:\\a"#': 'string.quoted.raw', '/* no */': 'comment.block', '#true': 'constant.language' });
coloured('- 0 1.5e-3 4', { '-': 'punctuation.definition.list', '1.5e-3': 'constant.numeric' });
coloured('sampler sobol', { sampler: 'support.type.property-name', sobol: 'support.constant' });

// The reference for other tools: every list is there, and what properties refer to is among them.
const language = JSON.parse(readFileSync(reference, 'utf8'));
for (const list of ['kinds', 'words', 'types', 'spectra', 'units', 'dimensions', 'presets', 'codes'])
    check(language[list]?.length > 0 && language[list].every((e) => e.name ?? e.code), `${list} of the reference`);
for (const list of ['illuminant', 'measured', 'glass', 'metal', 'rgb_space'])
    check(language.names[list]?.length > 4, `names of ${list}`);
const kinds = new Set(language.kinds.map((k) => k.name)), dimensions = new Set(language.dimensions.map((d) => d.name));
const fields = (list) => list.flatMap((f) => [f, ...fields(f.block ?? [])]);
for (const type of language.types) {
    check(kinds.has(type.kind) && type.doc && type.example, `the type ${type.kind} ${type.name}`);
    for (const field of fields(type.fields))
        check(field.doc && field.dimensions.every((d) => dimensions.has(d)), `${type.kind}.${type.name}.${field.name}`);
}

// The extension, in an editor that is not there.
const made = [], commands = {}, said = [];
let fails = false;
const stand = {
    vscode: {
        workspace: { getConfiguration: () => ({ get: () => '/opt/abbe' }), createFileSystemWatcher: (pattern) => pattern },
        window: { showErrorMessage: async (text) => { said.push(text); } },
        commands: { registerCommand: (name, action) => (commands[name] = action) },
    },
    'vscode-languageclient/node': {
        LanguageClient: class {
            constructor(id, name, server, client) { Object.assign(this, { server, client, runs: 0 }); made.push(this); }
            async start() { if (fails) throw new Error('no such file'); ++this.runs; }
            async stop() { --this.runs; }
            isRunning() { return this.runs > 0; }
        },
    },
};
const load = Module._load;
Module._load = (name, ...more) => stand[name] ?? load(name, ...more);
const { activate, deactivate } = createRequire(import.meta.url)(join(editors, 'vscode', extension.main));
await activate({ subscriptions: [] });
check(made[0].server.command === '/opt/abbe' && made[0].server.args.join() === 'lsp', 'what the extension starts');
check(made[0].client.documentSelector[0].language === languages[0].id && made[0].runs === 1, 'what the server is for');
for (const { command } of extension.contributes.commands) check(command in commands, `the command ${command}`);
await commands['abbe.restart']();
check(made.length === 2 && made[0].runs === 0 && made[1].runs === 1, 'starting again');
await deactivate();
check(made[1].runs === 0, 'the end of the extension');
fails = true;
await activate({ subscriptions: [] });
check(said.length === 1 && said[0].includes('/opt/abbe lsp'), 'a program that cannot be started');
process.exit(faults > 0 ? 1 : 0);
