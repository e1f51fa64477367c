// The language server beside the libraries on which Visual Studio Code's clients are built:
//   nodejs lsp_peer.mjs PROGRAM MODULES GRAMMAR
// MODULES is a node_modules with vscode-jsonrpc, vscode-languageserver-protocol, vscode-textmate and vscode-oniguruma.
import { spawn } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';

const [program, modules, grammarFile] = process.argv.slice(2);
const require = createRequire(join(modules, 'any.js'));
const { createMessageConnection, StreamMessageReader, StreamMessageWriter } = require('vscode-jsonrpc/node');
const types = require('vscode-languageserver-types');
let faults = 0;
const check = (good, what, seen) => {
    if (good) return;
    ++faults;
    console.log(`FAULT: ${what}: ${JSON.stringify(seen)?.slice(0, 400)}`);
};

const child = spawn(program, ['lsp'], { stdio: ['pipe', 'pipe', 'inherit'] });
const connection = createMessageConnection(new StreamMessageReader(child.stdout), new StreamMessageWriter(child.stdin));
const uri = 'file:///nowhere/a.scene';
const found = new Promise((resolve) => connection.onNotification('textDocument/publishDiagnostics', resolve));
connection.onError(([error]) => check(false, 'the connection', String(error)));
connection.listen();

const all = (list, is, what) => check(Array.isArray(list) && list.length > 0 && list.every(is), what, list);
const { capabilities } = await connection.sendRequest('initialize', { processId: process.pid, rootUri: null, capabilities: {} });
check(capabilities.textDocumentSync.change === 2, 'capabilities', capabilities);
await connection.sendNotification('initialized', {});
const text = 'scene 1\nmaterial gold conductor { index metal Au }\nshape a sphere { material gold; radius 1mm }\ngroup {\n    shape quad\n}\n';
await connection.sendNotification('textDocument/didOpen', { textDocument: types.TextDocumentItem.create(uri, 'abbe-scene', 1, text) });
const told = await found;
all(told.diagnostics, types.Diagnostic.is, 'diagnostics');
const textDocument = { uri }, position = types.Position.create(2, 28);
const ask = (method, more) => connection.sendRequest(`textDocument/${method}`, { textDocument, position, ...more });
const list = await ask('completion');
all(list.items, (i) => typeof i.label === 'string' && types.TextEdit.is(i.textEdit), 'completions');
check(types.Hover.is(await ask('hover')), 'hover', await ask('hover'));
all(await ask('definition'), types.Location.is, 'definitions');
all(await ask('references', { context: { includeDeclaration: true } }), types.Location.is, 'references');
all(await ask('documentHighlight'), (h) => types.Range.is(h.range), 'highlights');
all(await ask('documentSymbol'), types.DocumentSymbol.is, 'symbols');
all(await ask('foldingRange'), types.FoldingRange.is, 'foldings');
all(await ask('codeAction', { range: told.diagnostics[0].range, context: { diagnostics: told.diagnostics } }), types.CodeAction.is, 'code actions');
check(types.WorkspaceEdit.is(await ask('rename', { newName: 'brass' })), 'rename', await ask('rename', { newName: 'brass' }));
check(types.SemanticTokens?.is?.(await ask('semanticTokens/full')) ?? true, 'semantic tokens');
await connection.sendRequest('shutdown');
await connection.sendNotification('exit');
const code = await new Promise((resolve) => child.on('exit', resolve));
check(code === 0, 'the end', code);

// The grammar by the engine of the editor.
const oniguruma = require('vscode-oniguruma');
const { Registry, INITIAL, parseRawGrammar } = require('vscode-textmate');
await oniguruma.loadWASM(readFileSync(join(modules, 'vscode-oniguruma/release/onig.wasm')).buffer);
const registry = new Registry({
    onigLib: Promise.resolve({ createOnigScanner: (p) => new oniguruma.OnigScanner(p), createOnigString: (s) => new oniguruma.OnigString(s) }),
    loadGrammar: async () => parseRawGrammar(readFileSync(grammarFile, 'utf8'), 'grammar.json'),
});
const grammar = await registry.loadGrammar('source.abbe-scene');
let stack = INITIAL;
function scopes(line) {
    const result = grammar.tokenizeLine(line, stack);
    stack = result.ruleStack;
    return Object.fromEntries(result.tokens.map((t) => [line.slice(t.startIndex, t.endIndex), t.scopes.at(-1)]));
}
function coloured(line, wanted) {
    const seen = scopes(line);
    for (const [word, scope] of Object.entries(wanted)) check(seen[word] === `${scope}.abbe-scene`, `\`${word}\` in \`${line}\``, seen);
}
coloured('scene 1 length=mm', { scene: 'keyword.control', length: 'entity.other.attribute-name', mm: 'keyword.other.unit' });
coloured('shape ball sphere { radius 2.5 mm; material gold }', { shape: 'storage.type', ball: 'entity.name', sphere: 'entity.name.type', radius: 'support.type.property-name', 2.5: 'constant.numeric', mm: 'keyword.other.unit' });
coloured('    transform { rotate y $turn } // why', { transform: 'support.type.property-name', rotate: 'support.type.property-name', $turn: 'variable.parameter', '// why': 'comment.line.double-slash' });
coloured('/* one', { '/*': 'comment.block', ' one': 'comment.block' });
coloured('/* two */ three */ camera { lens 35 mm }', { ' three ': 'comment.block' });
coloured('light sky { color blackbody 3200 K }', { light: 'storage.type', sky: 'entity.name.type', color: 'support.type.property-name', blackbody: 'support.function', K: 'keyword.other.unit' });
coloured('film { output "a\\n.exr" space=acescg }', { '\\n': 'constant.character.escape', space: 'entity.other.attribute-name' });
process.exit(faults > 0 ? 1 : 0);
