// A client of the language server, as an editor has one: messages in frames, answers by their ids, notifications kept.
import { spawn } from 'node:child_process';

export class Client {
    constructor(program, words = ['lsp']) {
        this.child = spawn(program, words, { stdio: ['pipe', 'pipe', 'inherit'] });
        this.waiting = new Map();
        this.notifications = [];
        this.unasked = []; // answers without an id
        this.listeners = [];
        this.nextId = 1;
        this.buffer = Buffer.alloc(0);
        this.ended = new Promise((resolve) => this.child.on('exit', (code, signal) => resolve(signal ?? code)));
        this.child.stdin.on('error', () => {});
        this.child.stdout.on('data', (bytes) => this.#read(bytes));
    }

    #read(bytes) {
        this.buffer = Buffer.concat([this.buffer, bytes]);
        for (;;) {
            const header = this.buffer.indexOf('\r\n\r\n');
            if (header < 0) return;
            const length = Number(/^Content-Length: (\d+)$/m.exec(this.buffer.subarray(0, header).toString())[1]);
            if (this.buffer.length < header + 4 + length) return;
            const message = JSON.parse(this.buffer.subarray(header + 4, header + 4 + length).toString());
            this.buffer = this.buffer.subarray(header + 4 + length);
            this.#take(message);
        }
    }

    #take(message) {
        if (message.method) this.notifications.push(message);
        else if (this.waiting.has(message.id)) {
            this.waiting.get(message.id)(message);
            this.waiting.delete(message.id);
        } else this.unasked.push(message);
        for (const listener of [...this.listeners]) listener();
    }

    raw(bytes) { this.child.stdin.write(bytes); }
    static frame(message) {
        const body = Buffer.from(JSON.stringify(message));
        return Buffer.concat([Buffer.from(`Content-Length: ${body.length}\r\n\r\n`), body]);
    }
    send(message) { this.raw(Client.frame({ jsonrpc: '2.0', ...message })); }
    notify(method, params) { this.send({ method, params }); }

    // The whole answer, with `result` or `error`.
    ask(method, params, id = this.nextId++) {
        return new Promise((resolve, reject) => {
            const timer = setTimeout(() => reject(new Error(`no answer to ${method}`)), 60000);
            this.waiting.set(id, (message) => { clearTimeout(timer); resolve(message); });
            this.send({ id, method, params });
        });
    }
    async result(method, params) {
        const answer = await this.ask(method, params);
        if (answer.error) throw new Error(`${method}: ${answer.error.message}`);
        return answer.result;
    }

    // Until something holds; it is looked at after each message.
    until(holds, what) {
        return new Promise((resolve, reject) => {
            const done = () => {
                const value = holds();
                if (!value) return;
                clearTimeout(timer);
                this.listeners.splice(this.listeners.indexOf(done), 1);
                resolve(value);
            };
            const timer = setTimeout(() => reject(new Error(`never: ${what}`)), 60000);
            this.listeners.push(done);
            done();
        });
    }

    // The last list for a version of a text, once it is whole.
    diagnostics(uri, version, whole = () => true) {
        const ofThis = (m) => m.method === 'textDocument/publishDiagnostics' && m.params.uri === uri &&
            (version === undefined || m.params.version === version);
        const list = () => this.notifications.findLast(ofThis)?.params.diagnostics;
        return this.until(() => list() && whole(list()) && list(), `diagnostics of ${uri}, ${version}`);
    }

    async initialize(capabilities = {}) {
        const result = await this.result('initialize', { processId: process.pid, rootUri: null, capabilities });
        this.notify('initialized', {});
        return result;
    }

    async end() {
        await this.result('shutdown', null);
        this.notify('exit');
        return this.ended;
    }
}

// The place of the offset, as editors count: units of UTF-16.
export function place(text, offset) {
    const before = text.slice(0, offset).split('\n');
    return { line: before.length - 1, character: before.at(-1).length };
}

export function offsetOf(text, { line, character }) {
    const lines = text.split('\n').slice(0, line);
    return lines.reduce((sum, l) => sum + l.length + 1, 0) + character;
}

// What editors do with a list of edits.
export function apply(text, edits) {
    const sorted = [...edits].sort((a, b) => offsetOf(text, b.range.start) - offsetOf(text, a.range.start));
    for (const { range, newText } of sorted)
        text = text.slice(0, offsetOf(text, range.start)) + newText + text.slice(offsetOf(text, range.end));
    return text;
}
