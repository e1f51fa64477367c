// Starts `abbe lsp` and connects it to the editor.
const vscode = require('vscode');
const { LanguageClient } = require('vscode-languageclient/node');

let client;

async function start() {
    const command = vscode.workspace.getConfiguration('abbe').get('path') || 'abbe';
    client = new LanguageClient(
        'abbe', 'Abbe',
        { command, args: ['lsp'] },
        {
            documentSelector: [{ language: 'abbe-scene' }],
            // Meshes, pictures and tables that scenes name: what is wrong with them may have changed.
            synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher('**/*.{ply,obj,mtl,gltf,glb,exr,hdr,png,jpg,tif,tiff,vdb,spd,csv,ies,scene}') },
        });
    try {
        await client.start();
    } catch (error) {
        const choice = await vscode.window.showErrorMessage(`\`${command} lsp\` cannot be started: ${error.message}`, 'Where is abbe?');
        if (choice) vscode.commands.executeCommand('workbench.action.openSettings', 'abbe.path');
    }
}

async function stop() {
    const running = client;
    client = undefined;
    if (running?.isRunning()) await running.stop();
}

exports.activate = async (context) => {
    context.subscriptions.push(vscode.commands.registerCommand('abbe.restart', async () => { await stop(); await start(); }));
    await start();
};
exports.deactivate = stop;
