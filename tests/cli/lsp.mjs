// Conversations with `abbe lsp`, as an editor has them:  nodejs lsp.mjs PROGRAM SCENES BAD
// in an empty folder of its own. Ends with the number of faults.
import { Client, apply, offsetOf, place } from './lsp_client.mjs';
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [program, scenes, bad] = process.argv.slice(2);
let faults = 0;
const check = (good, what, seen) => {
    if (good) return;
    ++faults;
    console.log(`FAULT: ${what}${seen === undefined ? '' : `: ${JSON.stringify(seen).slice(0, 600)}`}`);
};

// An editor with one text. In texts for it, `|` marks the place that is asked about.
class Editor {
    constructor(client, name) {
        this.client = client;
        this.uri = pathToFileURL(join(process.cwd(), name)).href;
        this.version = 0;
    }
    show(marked) {
        const at = marked.indexOf('|');
        this.text = at < 0 ? marked : marked.slice(0, at) + marked.slice(at + 1);
        this.at = place(this.text, at < 0 ? 0 : at);
        if (++this.version === 1)
            this.client.notify('textDocument/didOpen', { textDocument: { uri: this.uri, languageId: 'abbe-scene', version: 1, text: this.text } });
        else
            this.client.notify('textDocument/didChange', { textDocument: { uri: this.uri, version: this.version }, contentChanges: [{ text: this.text }] });
    }
    // The place behind the nth occurrence of a word.
    behind(word, n = 1) {
        let at = -1;
        for (let i = 0; i < n; ++i) at = this.text.indexOf(word, at + 1);
        this.at = place(this.text, at + word.length);
    }
    ask(method, more = {}) { return this.client.ask(`textDocument/${method}`, { textDocument: { uri: this.uri }, position: this.at, ...more }); }
    async result(method, more) {
        const answer = await this.ask(method, more);
        if (answer.error) throw new Error(`${method}: ${answer.error.message}`);
        return answer.result;
    }
    async labels(marked) {
        this.show(marked);
        this.items = (await this.result('completion')).items;
        return this.items.map((i) => i.label);
    }
    // The text with an item of the last completion.
    accepted(label) { return apply(this.text, [this.items.find((i) => i.label === label).textEdit]); }
    async hover(marked) {
        this.show(marked);
        return (await this.result('hover'))?.contents.value ?? '';
    }
    textIn(range) { return this.text.slice(offsetOf(this.text, range.start), offsetOf(this.text, range.end)); }
    // Errors of syntax and names are told first, and all of them when files have been read: `whole` knows which it is.
    diagnostics(whole) { return this.client.diagnostics(this.uri, this.version, whole); }
}

// --- the life of a server

async function lifeOfServer() {
    let client = new Client(program);
    let answer = await client.ask('textDocument/hover', {});
    check(answer.error?.code === -32002, 'a request before initialize', answer);
    await client.initialize();
    answer = await client.ask('initialize', {});
    check(answer.error?.code === -32600, 'a second initialize', answer);
    answer = await client.ask('no/such', {});
    check(answer.error?.code === -32601, 'an unknown method', answer);
    answer = await client.ask('textDocument/hover', { textDocument: { uri: 'file:///nowhere' } });
    check(answer.error?.code === -32602, 'a text that is not open', answer);
    answer = await client.ask('textDocument/hover', [1]);
    check(answer.error?.code === -32602, 'parameters of another form', answer);
    client.notify('$/unknown', {});
    client.notify('textDocument/didChange', { textDocument: { uri: 'file:///nowhere' }, contentChanges: [] });
    client.notify('textDocument/didOpen', 7);

    // Garbage between messages is skipped and told once; batches are refused; what follows is understood.
    client.raw('hello\n\nContent-Length: x\r\n\r\n');
    client.raw('Content-Length: 3\r\n\r\n{,}');
    client.raw('Content-Length: 99999999999999999999999\r\n\r\n');
    client.raw(Client.frame([{ jsonrpc: '2.0', id: 1, method: 'shutdown' }]));
    const shut = Client.frame({ jsonrpc: '2.0', id: 'last', method: 'shutdown' });
    const last = client.ask('workspace/none', {}, 'probe');
    check((await last).error?.code === -32601, 'a request after garbage', await last);
    const codes = client.unasked.map((m) => m.error?.code);
    check(codes.filter((c) => c === -32700).length >= 2 && codes.includes(-32600), 'faults of messages', codes);

    // A request that a later message of the same piece cancels.
    client.raw(Buffer.concat([Client.frame({ jsonrpc: '2.0', id: 77, method: 'textDocument/hover', params: {} }),
        Client.frame({ jsonrpc: '2.0', method: '$/cancelRequest', params: { id: 77 } })]));
    const cancelled = await client.until(() => client.unasked.find((m) => m.id === 77), 'the cancelled request');
    check(cancelled.error?.code === -32800, 'a cancelled request', cancelled);

    client.raw(shut.subarray(0, 9)); // in pieces
    client.raw(shut.subarray(9));
    await client.until(() => client.unasked.find((m) => m.id === 'last'), 'shutdown');
    answer = await client.ask('textDocument/hover', {});
    check(answer.error?.code === -32600, 'a request after shutdown', answer);
    client.notify('exit');
    check(await client.ended === 0, 'the end after shutdown', await client.ended);

    client = new Client(program);
    await client.initialize();
    client.notify('exit');
    check(await client.ended === 1, 'the end without shutdown', await client.ended);
    client = new Client(program, ['lsp', '--stdio']);
    await client.initialize();
    client.child.stdin.end();
    check(await client.ended === 1, 'the end of the stream', await client.ended);
}

// --- diagnostics and repairs

async function findings(client) {
    const editor = new Editor(client, 'faulty.scene');
    editor.show(readFileSync(join(bad, 'nine_mistakes.scene'), 'utf8'));
    let list = await editor.diagnostics((l) => l.length === 9);
    check(list.every((d) => d.source === 'abbe' && /^[EW]\d{4}$/.test(d.code)), 'codes', list);
    check(list.some((d) => d.relatedInformation?.[0].location.uri === editor.uri), 'related places', list);
    const twice = list.find((d) => d.code === 'E0105');
    check(twice && editor.textIn(twice.range) === '2m', 'the range of E0105', twice);

    editor.show('scene 1\n// µ𝄞 and more\ncamera { lense 85mm; from 0 1 4, look-at 0 0 0 }\nlight sky\nmaterial spare diffuse\nshape sphere\n');
    list = await editor.diagnostics((l) => l.some((d) => d.code === 'E0201'));
    const unused = list.find((d) => d.code === 'W0201');
    check(list.some((d) => d.code === 'E0201') && list.some((d) => d.code === 'E0105'), 'two mistakes', list);
    check(!unused, 'warnings of names wait for the errors', unused);
    const unit = list.find((d) => d.code === 'E0105');
    let actions = await editor.result('codeAction', { range: unit.range, context: { diagnostics: [unit] } });
    const fix = actions.find((a) => a.kind === 'quickfix' && a.diagnostics[0].code === 'E0105');
    check(fix && apply(editor.text, fix.edit.changes[editor.uri]).includes('lense 85 mm'), 'a repair', actions);
    const all = actions.find((a) => a.kind === 'source.fixAll');
    const repaired = all ? apply(editor.text, all.edit.changes[editor.uri]) : '';
    check(repaired.includes('lens 85 mm; from 0 1 4; look-at') || repaired.includes('lens 85 mm; from 0 1 4 look-at'), 'all repairs', repaired);

    editor.show('scene 1\ncamera\nlight sky\nmaterial spare diffuse\nparam none 3\nshape sphere\n');
    list = await editor.diagnostics();
    const tagged = list.filter((d) => d.tags?.includes(1)).map((d) => d.code).sort();
    check(tagged.join() === 'W0201,W0205', 'unused definitions are marked', list);

    // A change within a text, in units of UTF-16 behind a character of two of them.
    editor.show('scene 1\ncamera\nlight sky /* 𝄞 */ { luminance 10 nits }\nshape sphere\n');
    check((await editor.diagnostics()).length === 0, 'a good scene', await editor.diagnostics());
    const start = place(editor.text, editor.text.indexOf('nits'));
    ++editor.version;
    client.notify('textDocument/didChange', { textDocument: { uri: editor.uri, version: editor.version },
        contentChanges: [{ range: { start, end: { line: start.line, character: start.character + 4 } }, text: 'lm' }] });
    editor.text = editor.text.replace('nits', 'lm');
    list = await editor.diagnostics();
    check(list.length === 1 && editor.textIn(list[0].range) === 'lm', 'after a change', list);
    editor.at = list[0].range.start;
    const text = (await editor.result('hover')).contents.value;
    check(text.includes(list[0].code), 'hover explains a diagnostic', text);

    // Faults of a file beside the scene stand at that file, and go when the text does.
    writeFileSync('paint.csv', '400 0.2\nred 3\n700 0.6\n');
    editor.show('scene 1\ncamera\nlight sky\nshape sphere { material diffuse { reflectance table "paint.csv" } }\n');
    list = await editor.diagnostics();
    const paint = pathToFileURL(join(process.cwd(), 'paint.csv')).href;
    const other = client.notifications.filter((n) => n.params?.uri === paint);
    check(list.length + (other.at(-1)?.params.diagnostics.length ?? 0) > 0, 'a fault in a file', list);

    client.notify('textDocument/didClose', { textDocument: { uri: editor.uri } });
    await client.until(() => client.notifications.findLast((n) => n.params?.uri === editor.uri)?.params.diagnostics.length === 0, 'nothing is left of a closed text');
}

// --- completion

async function completions(client) {
    const editor = new Editor(client, 'new.scene');
    const has = async (marked, wanted, unwanted = []) => {
        const labels = await editor.labels(marked);
        for (const w of wanted) check(labels.includes(w), `\`${w}\` for \`${marked}\``, labels.slice(0, 40));
        for (const u of unwanted) check(!labels.includes(u), `no \`${u}\` for \`${marked}\``, labels.slice(0, 40));
        return labels;
    };
    const names = 'scene 1\nmaterial gold conductor\nmaterial "dark wood" diffuse\ntexture grain noise\nspectrum paint 0.5\nmedium fog homogeneous\nobject seat { shape sphere }\nshape hill sphere\nparam turn 30 deg "of the table"\n';
    await has('|', ['scene', 'camera', 'shape', 'param']);
    await has('scene 1\nli|', ['light'], ['camera']);
    check(editor.accepted('light') === 'scene 1\nlight', 'an accepted kind', editor.accepted('light'));
    await has('scene 1 length=|', ['mm', 'cm'], ['deg']);
    await has('scene 1 rgb=ace|', ['acescg'], ['rec709']);
    await has('scene 1\nshape |', ['sphere', 'mesh', 'quad'], ['diffuse']);
    await has('scene 1\nshape ball sp|', ['sphere'], ['quad']);
    const camera = await has('scene 1\ncamera {\n    f-stop 2.8\n    |\n}\nlight sky\n', ['lens', 'fov', 'exposure', 'f-stop'], ['radius', 'sphere']);
    const rank = (label) => editor.items[camera.indexOf(label)].sortText;
    check(rank('lens') < rank('f-stop'), 'what is given already comes last', [rank('lens'), rank('f-stop')]);
    check(editor.items[camera.indexOf('lens')].documentation.value.includes('```kdl\nlens '), 'an example of a property');
    await has('scene 1\ncamera { le|', ['lens', 'lens-shift'].slice(0, 1), ['fov']); // the brace is to come
    await has('scene 1\ncamera {\n    lens 35 mm\n    f|\n', ['fov'], ['lens']);
    await has('scene 1\ncamera { lens 35 | }', ['mm', 'm'], ['deg']);
    await has('scene 1\ncamera { lens 35 m|', ['mm', 'm'], ['cm']);
    await has('scene 1\ncamera { f-stop 2.8 { | } }', ['blades'], ['lens']);
    await has('scene 1\nrender { sampler | }', ['sobol', 'random'], ['on']);
    await has('scene 1\nshape sphere { transform { | } }', ['translate', 'rotate', 'scale', 'at'], ['radius']);
    await has('scene 1\nshape sphere { transform { rotate | } }', ['x', 'y', 'z']);
    await has('scene 1\nshape sphere { transform { rotate y 30 | } }', ['deg', 'rad'], ['mm']);
    await has(`${names}shape sphere { material | }`, ['gold', 'dark wood', 'diffuse', '$turn'], ['grain', 'fog']);
    check(editor.accepted('dark wood').includes('material "dark wood" }'), 'a name in quotes', editor.accepted('dark wood'));
    await has(`${names}shape sphere { material diffuse { reflectance | } }`, ['rgb', 'measured', 'paint', 'grain', 'image'], ['blackbody', 'gold', 'glass']);
    await has(`${names}shape sphere { material diffuse { reflectance measured cornell| } }`, ['cornell-white'], ['macbeth-13']);
    await has(`${names}shape sphere { material dielectric { ior glass | } }`, ['N-BK7'], ['Au']);
    await has(`${names}shape sphere { material conductor { index metal A| } }`, ['Au', 'Ag'], ['Cu']);
    await has('scene 1\nlight sky { color illuminant D| }', ['D65'], ['A']);
    await has('scene 1\nlight sky { color blackbody 3200 | }', ['K'], ['mm']);
    await has(`${names}shape sphere { material preset g|`, ['gold'], ['silver']);
    await has(`${names}instance |`, ['seat'], ['hill']);
    await has(`${names}atmosphere |`, ['fog'], ['gold']);
    await has(`${names}instances seat { scatter 5; over | }`, ['hill'], ['gold']);
    await has(`${names}camera { focus on=| }`, ['hill'], ['gold']);
    await has(`${names}shape box { transform { rotate y $| } }`, ['$turn']);
    check(editor.accepted('$turn').includes('rotate y $turn }'), 'a parameter', editor.accepted('$turn'));
    await has('scene 1\ngroup {\n    |\n}\n', ['shape', 'light', 'transform', 'visible-to'], ['film', 'camera']);
    await has('scene 1\nmedium milk homogeneous { phase henyey-greenstein | }', ['g=']);
    await has('scene 1\nfilm { output "a.exr" space=| }', ['acescg'], []);

    mkdirSync('maps', { recursive: true });
    for (const file of ['maps/wood.png', 'maps/wood 2.png', 'ball.ply']) writeFileSync(file, '');
    await has('scene 1\nshape mesh | ', ['"ball.ply"', 'ball.ply'].slice(1), []);
    check(editor.accepted('ball.ply').includes('mesh "ball.ply"'), 'a file in quotes', editor.accepted('ball.ply'));
    await has('scene 1\ntexture t image "m|', ['maps/'], ['ball.ply']);
    await has('scene 1\ntexture t image "maps/w|"', ['maps/wood.png', 'maps/wood 2.png']);
    check(editor.accepted('maps/wood 2.png').includes('image "maps/wood 2.png"'), 'a file in a folder', editor.accepted('maps/wood 2.png'));
    await has('scene 1\ntexture t image "../../../../../../../../|', []);
    await has('scene 1\nx-tool { | }', [], ['shape']);
    editor.show('scene 1\n    |');
    const indent = await editor.result('completion', { context: { triggerKind: 2, triggerCharacter: ' ' } });
    check(indent.items.length === 0, 'indentation is no question', indent.items.length);
}

// --- explanations

async function hovers(client) {
    const editor = new Editor(client, 'words.scene');
    const says = async (marked, ...facts) => {
        const text = await editor.hover(marked);
        for (const fact of facts) check(text.includes(fact), `hover on \`${marked}\` says \`${fact}\``, text);
    };
    await says('scene 1\ncamera { f-st|op 2.8 }', 'f-stop', 'camera perspective', '```kdl');
    await says('scene 1\nmaterial m openpbr { base_co|lor 0.5 }', '');
    await says('scene 1\nlight quad { power 60 |W; size 1 1 }', 'a power');
    await says('scene 1\nmaterial gold condu|ctor { index metal Au }', 'material conductor');
    await says('scene 1\nmaterial gold conductor { index metal A|u }', 'metal Au', 'wavelengths');
    await says('scene 1\nmaterial g glass', '');
    await says('scene 1\nmaterial gold conductor\nshape sphere { material go|ld }', 'defined on line 2', 'used 1 times');
    await says('scene 1\nparam turn 30 deg "of the table"\nshape box { transform { rotate y $tu|rn } }', 'of the table', '30 deg', '-D turn');
    await says('scene 1\nsha|pe sphere', 'A surface with a material');
    await says('sce|ne 1 length=mm', 'edition');
    await says('scene 1 len|gth=mm', 'length');
    await says('scene 1\nshape sphere { transform { rot|ate y 30 deg } }', 'Turns about an axis');
    await says('scene 1\nlight sky { color blackb|ody 5000 K }', 'Thermal radiation');
    await says('scene 1\nmaterial ring preset go|ld', 'preset gold');
    await says('scene 1\nshape mesh "nowh|ere.ply"', 'there is no such file');
    await says('scene 1\nrender { sampler so|bol }', 'sampler');
    editor.show('scene 1\n\n|\n');
    check(await editor.result('hover') === null, 'nothing to say');
}

// --- names

const kNames = `scene 1
param shade "1/2" "of the floor"
param metal gold
camera
light sky
material gold conductor { index metal Au }
material floor diffuse { reflectance $shade }
shape ball sphere { material gold }
shape cube box { material $metal }
group { shape plane { material floor } }
spectrum gold 0.5
shape quad { material diffuse { reflectance gold } }
`;

async function names(client) {
    const editor = new Editor(client, 'names.scene');
    editor.show(kNames);
    editor.behind('ball sphere { material go');
    const lines = (locations) => locations.map((l) => l.range.start.line).join();
    let found = await editor.result('definition');
    check(lines(found) === '5' && editor.textIn(found[0].range) === 'gold', 'the definition of a material', found);
    found = await editor.result('references', { context: { includeDeclaration: true } });
    check(lines(found) === '2,5,7', 'all uses of a material, but not of the spectrum', found);
    found = await editor.result('references', { context: { includeDeclaration: false } });
    check(lines(found) === '2,7', 'uses alone', found);
    const kinds = (await editor.result('documentHighlight')).map((h) => h.kind).join();
    check(kinds === '2,3,2', 'highlights', kinds);
    editor.behind('$sha');
    found = await editor.result('definition');
    check(lines(found) === '1', 'the definition of a parameter', found);

    const renamed = async (word, name) => {
        editor.behind(word);
        const answer = await editor.ask('rename', { newName: name });
        return answer.error ? answer.error.message : apply(editor.text, answer.result.changes[editor.uri]);
    };
    let text = await renamed('ball sphere { material go', 'brass');
    check(text.includes('param metal brass') && text.includes('material brass conductor') && text.includes('sphere { material brass }') &&
        text.includes('spectrum gold') && text.includes('reflectance gold'), 'a new name', text);
    text = await renamed('ball sphere { material go', 'old brass');
    check(text.includes('material "old brass" conductor') && text.includes('{ material "old brass" }'), 'a name in quotes', text);
    text = await renamed('$sha', 'grey');
    check(text.includes('param grey "1/2"') && text.includes('reflectance $grey }'), 'another parameter', text);
    text = await renamed('ball sphere { material go', 'floor');
    check(text.includes('the name of another material'), 'a name that is taken', text);
    text = await renamed('ball sphere { material go', 'diffuse');
    check(text.includes('a type of material'), 'the name of a type', text);
    text = await renamed('$sha', 'two words');
    check(text.includes('the name of a parameter'), 'a parameter needs a plain word', text);
    text = await renamed('ball sphere { material go', '');
    check(text.includes('not empty'), 'no name', text);
    text = await renamed('shape ba', 'sphere');
    check(text.includes('a type of shape'), 'a shape like its type', text);
    text = await renamed('cam', 'x');
    check(text.includes('only the names'), 'what has no name', text);
    editor.behind('$sha');
    const range = await editor.result('prepareRename');
    check(range.placeholder === 'shade' && editor.textIn(range.range) === 'shade', 'what is to be renamed', range);

    // Names of other programs stand in quotes.
    editor.show('scene 1\nmaterial "Cube.001 \\"a\\"" diffuse\nshape sphere { material "Cube.001 \\"a\\"" }\n');
    text = await renamed('{ material "Cu', 'cube');
    check(text.includes('material cube diffuse') && text.includes('{ material cube }'), 'quotes that are not needed', text);
}

// --- names in the files of a scene, and in the scenes of a workspace

async function includes() {
    mkdirSync('set/props', { recursive: true });
    const uriOf = (name) => `${pathToFileURL(join(process.cwd(), 'set')).href}/${name}`;
    const texts = {
        'props/paints.scene': 'scene 1\nparam tone 0.5\nparam dark "$tone / 2"\nmaterial gold diffuse { reflectance $tone }\nmaterial soot diffuse { reflectance "$dark" }\n',
        'room.scene': 'scene 1\ncamera\nlight sky\ninclude "props/paints.scene"\nshape floor plane { material gold }\n',
        'shot.scene': 'scene 1\ninclude "room.scene"\ninclude "props/paints.scene" as=l { param tone 0.2 }\noverride material gold { reflectance 0.1 }\nshape ball sphere { material l:gold }\nshape cube box { material "l:soot" }\n',
        'alone.scene': 'scene 1\nmaterial gold diffuse\nshape sphere { material gold }\n',
    };
    for (const [name, text] of Object.entries(texts)) writeFileSync(join('set', name), text);
    const client = new Client(program);
    await client.result('initialize', { processId: process.pid, rootUri: uriOf(''), capabilities: { workspace: { workspaceEdit: { documentChanges: true } } } });
    const editor = new Editor(client, 'set/shot.scene');
    const opened = [editor];
    editor.show(texts['shot.scene']);

    // Definitions and uses are where they are, whichever file that is.
    const found = async (word, method = 'definition', more) => {
        editor.behind(word);
        return (await editor.result(method, more)).map((l) => `${l.uri.slice(uriOf('').length)}:${l.range.start.line}`).sort().join(' ');
    };
    let places = await found('material gol');
    check(places === 'props/paints.scene:3', 'a definition two files away', places);
    places = await found('material l:go');
    check(places === 'props/paints.scene:3', 'a definition in a file with a prefix', places);
    places = await found('material gol', 'references', { context: { includeDeclaration: true } });
    check(places === 'props/paints.scene:3 room.scene:4 shot.scene:3', 'uses in all files', places);
    places = await found('param ton', 'references', { context: { includeDeclaration: true } });
    check(places === 'props/paints.scene:1 props/paints.scene:2 props/paints.scene:3 shot.scene:2', 'uses of a parameter, in texts too', places);
    check((await editor.labels(texts['shot.scene'].replace('material l:gold', 'material |'))).join().includes('l:gold'), 'materials of an included file');
    check(editor.items.some((i) => i.label === 'gold') && editor.items.some((i) => i.label === 'l:soot'), 'with and without a prefix');
    editor.show(texts['shot.scene']);

    // The file is edited once, and so are all that use the name: by its own prefix, by another one, in another scene.
    const renamed = async (editor, word, name) => {
        editor.behind(word);
        const answer = await editor.ask('rename', { newName: name });
        if (answer.error) return answer.error.message;
        const after = {};
        for (const { textDocument, edits } of answer.result.documentChanges) {
            const file = textDocument.uri.slice(uriOf('').length);
            const open = opened.find((e) => e.uri === textDocument.uri);
            check(textDocument.version === (open ? open.version : null), `the version of ${file}`, textDocument);
            after[file] = apply(open ? open.text : texts[file], edits);
        }
        return after;
    };
    const brass = (after) => Object.keys(after).sort().join() === 'props/paints.scene,room.scene,shot.scene' &&
        after['props/paints.scene'] === texts['props/paints.scene'].replace('gold', 'brass') &&
        after['room.scene'] === texts['room.scene'].replace('gold', 'brass') &&
        after['shot.scene'] === texts['shot.scene'].replaceAll('gold', 'brass');
    let after = await renamed(editor, 'material gol', 'brass');
    check(brass(after), 'a material of an included file', after);
    after = await renamed(editor, 'material l:go', 'l:brass');
    check(brass(after), 'by its prefix', after);
    after = await renamed(editor, 'material l:go', 'brass');
    check(String(after).includes('begins with `l:`'), 'a name without its prefix', after);
    after = await renamed(editor, 'material gol', 'soot');
    check(String(after).includes('the name of another material'), 'a name that is taken in an included file', after);
    const paints = new Editor(client, 'set/props/paints.scene');
    paints.show(texts['props/paints.scene']);
    opened.push(paints);
    after = await renamed(paints, 'material gol', 'brass');
    check(brass(after), 'from the library to the scenes that include it', after);
    after = await renamed(paints, 'param ton', 'grey');
    check(after['props/paints.scene'] === texts['props/paints.scene'].replaceAll('tone', 'grey') &&
        after['shot.scene'] === texts['shot.scene'].replace('tone', 'grey') && Object.keys(after).length === 2, 'a parameter, in texts too', after);
    after = await renamed(paints, 'material gol', 'sphere');
    check(typeof after === 'object', 'a material may be called like a type of shape', after);

    // What an editor holds of a file counts, and not what is on the disk.
    paints.show('// new\n' + texts['props/paints.scene'].replace('gold', 'silver'));
    places = await found('material gol');
    check(places === '', 'a name that is not there any more', places);
    editor.show(texts['shot.scene'].replaceAll('gold', 'silver'));
    places = await found('material l:sil');
    check(places === 'props/paints.scene:4', 'a name in a text that is not saved', places);
    client.notify('textDocument/didClose', { textDocument: { uri: paints.uri } });
    editor.show(texts['shot.scene']);
    places = await found('material gol');
    check(places === 'props/paints.scene:3', 'as it is on the disk again', places);
    // And what another program writes.
    writeFileSync('set/props/paints.scene', '\n\n' + texts['props/paints.scene']);
    places = await found('material gol');
    check(places === 'props/paints.scene:5', 'a file that was changed', places);
    check(await client.end() === 0, 'the end of a conversation about files');
}

// --- the text as a whole

async function outlines(client) {
    const editor = new Editor(client, 'ring/gold-ring.scene');
    mkdirSync('ring', { recursive: true });
    copyFileSync(join(scenes, 'gold-ring/ring.obj'), 'ring/ring.obj');
    editor.show(readFileSync(join(scenes, 'gold-ring/gold-ring.scene'), 'utf8'));
    check((await editor.diagnostics()).length === 0, 'a shipped scene has no faults', await editor.diagnostics());
    const symbols = await editor.result('documentSymbol');
    const found = symbols.map((s) => s.name);
    for (const name of ['camera', 'film', 'gold conductor', 'ring subdivision', '$lamp-radius'])
        check(found.includes(name), `\`${name}\` in the outline`, found);
    const ring = symbols.find((s) => s.name === 'ring subdivision');
    check(editor.textIn(ring.selectionRange) === 'ring' && editor.textIn(ring.range).startsWith('shape ring'), 'the places of a symbol', ring);
    const links = await editor.result('documentLink');
    check(links.length === 1 && links[0].target.endsWith('/ring/ring.obj'), 'links to files', links);
    editor.behind('"ring');
    check((await editor.result('definition')).uri === links[0].target, 'the definition of a file is the file');

    editor.show('scene 1\n// one\n// two\ngroup g {\n    shape a sphere {\n        radius 1\n    }\n}\n');
    const folds = (await editor.result('foldingRange')).map((f) => `${f.startLine}-${f.endLine}`).sort().join();
    check(folds === '1-2,3-6,4-5', 'foldings', folds);
    const group = (await editor.result('documentSymbol')).find((s) => s.name === 'g');
    check(group?.children[0]?.name === 'a sphere', 'what is in a group', group);
    const tokens = (await editor.result('semanticTokens/full')).data;
    check(tokens.length % 5 === 0 && tokens.length > 25, 'semantic tokens', tokens);

    // The layout of `abbe fmt`, and nothing for what has syntax errors.
    editor.show('scene 1\ncamera {\nfov 40 deg\n}\n\n\n\nlight sky\nshape sphere\n');
    const laidOut = apply(editor.text, await editor.result('formatting', { options: { tabSize: 4, insertSpaces: true } }));
    check(laidOut === 'scene 1\ncamera {\n    fov 40 deg\n}\n\nlight sky\nshape sphere\n', 'a text that is laid out', laidOut);
    editor.show(laidOut);
    check((await editor.result('formatting', { options: {} })).length === 0, 'what is laid out stays so');
    editor.show('scene 1\nlight sky { luminance 100 cd-per-m2 }\n');
    const respelt = apply(editor.text, await editor.result('formatting', { options: {} }));
    check(respelt === 'scene 1\nlight sky { luminance 100 nits }\n', 'units as `abbe fmt` spells them', respelt);
    editor.show('scene 1\ncamera {\nfov 40deg\n}\n');
    check((await editor.result('formatting', { options: {} })).length === 0, 'a text with syntax errors stays as it is');

    // Whatever is being written, everything answers.
    for (const text of ['', '\n', '{', '}', 'shape', 'shape {', 'shape sphere { material', 'material "', 'a\\', '/*', '#"', '"""\n', '$', 'x=', 'x=$', '/-', '\u0000', '\ufeffscene 1', 'scene 1\r\ncamera {\r\n\r\n']) {
        editor.show(text);
        for (let at = 0; at <= text.length; ++at) {
            editor.at = place(text, at);
            for (const method of ['completion', 'hover', 'definition', 'references', 'documentHighlight'])
                check(!(await editor.ask(method)).error, `${method} in ${JSON.stringify(text)}`);
        }
        for (const method of ['documentSymbol', 'foldingRange', 'documentLink', 'semanticTokens/full'])
            check(!(await editor.ask(method)).error, `${method} of ${JSON.stringify(text)}`);
    }
}

// --- columns in bytes, names with escapes, large texts

async function others() {
    const client = new Client(program);
    const result = await client.initialize({ general: { positionEncodings: ['utf-8', 'utf-16'] } });
    check(result.capabilities.positionEncoding === 'utf-8', 'columns in bytes', result.capabilities);
    const uri = 'untitled:Untitled-1';
    const text = 'scene 1\ncamera\nlight sky\n/* ä𝄞 */ shape sphere { radius 1 lm }\n';
    client.notify('textDocument/didOpen', { textDocument: { uri, languageId: 'abbe-scene', version: 1, text } });
    const list = await client.diagnostics(uri, 1);
    const column = Buffer.from(text.split('\n')[3]).indexOf('lm');
    check(list.length === 1 && list[0].range.start.character === column, 'a column in bytes', list);

    const odd = pathToFileURL(join(process.cwd(), 'ä & b.scene')).href;
    client.notify('textDocument/didOpen', { textDocument: { uri: odd, languageId: 'abbe-scene', version: 1, text: 'scene 1\ncamera\nlight sky\nshape mesh "ball.obj"\n' } });
    writeFileSync('ball.obj', 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n');
    const faulty = await client.diagnostics(odd, 1);
    client.notify('textDocument/didSave', { textDocument: { uri: odd } }); // the file is there by now, if it was not
    await client.until(() => client.notifications.findLast((n) => n.params?.uri === odd)?.params.diagnostics.length === 0, 'no fault in ä & b.scene');
    check(faulty.every((d) => d.code === 'E0401'), 'a file that comes late', faulty);
    check(await client.end() === 0, 'the end');
}

async function large() {
    let text = 'scene 1\ncamera { from 0 1 4; look-at 0 0 0 }\nlight sky { luminance 1000 nits }\n';
    for (let i = 0; i < 200; ++i) text += `material m${i} diffuse { reflectance rgb 0.${i % 9 + 1} 0.3 0.2 }\n`;
    for (let i = 0; text.length < 5e6; ++i)
        text += `shape ball${i} sphere { center ${i % 100} ${Math.floor(i / 100)} 0; radius 0.${i % 9 + 1}; material m${i % 200} }\n`;
    const client = new Client(program);
    await client.initialize();
    const editor = new Editor(client, 'large.scene');
    // Processor time, which other work on the machine does not change much; in ticks of 10 ms.
    const spent = () => {
        const fields = readFileSync(`/proc/${client.child.pid}/stat`, 'utf8').split(') ')[1].split(' ');
        return 10 * (Number(fields[11]) + Number(fields[12]));
    };
    const slowness = /asan|tsan/.test(program) ? 60 : 10; // what takes longer on slow machines is not linear
    const timed = async (what, limit, action) => {
        const start = performance.now(), before = spent();
        await action();
        const ms = spent() - before;
        console.log(`${what}: ${ms} ms of processor time, ${(performance.now() - start).toFixed(0)} ms in all`);
        check(ms <= slowness * limit, `${what} takes ${ms} ms`);
    };
    const at = text.lastIndexOf('material m') + 'material m'.length;
    await timed('diagnostics of 5 MB', 1000, async () => {
        editor.show(text);
        check((await editor.diagnostics()).length === 0, 'no faults in a large scene');
    });
    editor.at = place(text, at);
    await timed('the first completion', 500, () => editor.result('completion'));
    await timed('another completion', 50, () => editor.result('completion'));
    await timed('hover', 500, () => editor.result('hover'));
    await timed('all uses of a name', 200, async () => {
        const found = await editor.result('references', { context: { includeDeclaration: true } });
        check(found.length > 300, 'uses in a large scene', found.length);
    });
    await timed('completion after a change', 500, async () => {
        ++editor.version;
        client.notify('textDocument/didChange', { textDocument: { uri: editor.uri, version: editor.version },
            contentChanges: [{ range: { start: editor.at, end: editor.at }, text: '1' }] });
        await editor.result('completion');
    });
    await timed('diagnostics after a change', 1500, () => editor.diagnostics());
    await timed('outline', 2000, () => editor.result('documentSymbol'));
    check(await client.end() === 0, 'the end of a large conversation');
}

const client = new Client(program);
const told = await client.initialize();
check(told.capabilities.positionEncoding === 'utf-16' && told.capabilities.textDocumentSync.change === 2, 'capabilities', told);
const parts = { lifeOfServer, findings, completions, hovers, names, includes, outlines, others, large };
for (const [name, part] of Object.entries(parts)) {
    if (process.env.ABBE_LSP_PART && process.env.ABBE_LSP_PART !== name) continue;
    try {
        await part(client);
    } catch (error) {
        check(false, `${name}: ${error.stack}`);
    }
}
check(await client.end() === 0, 'the end of the conversation');
process.exit(faults > 0 ? 1 : 0);
