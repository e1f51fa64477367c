// The page of `abbe view`: puts its parts together and listens to the program. Pictures are made there; the page shows them,
// and tells what hands and keys want.
import {startCamera} from "./camera.js";
import {startCompare} from "./compare.js";
import {startKeys} from "./keys.js";
import {startLights} from "./lights.js";
import {startMessages} from "./messages.js";
import {startNoise} from "./noise.js";
import {startPanels} from "./panels.js";
import {againFor} from "./picture.js";
import {startPointer} from "./pointer.js";
import {startProbe} from "./probe.js";
import {listen} from "./server.js";
import {startStage} from "./stage.js";
import {startStatus} from "./status.js";
import {app, readLook, tell} from "./store.js";
import {startToolbar} from "./toolbar.js";

readLook();
// On small windows the picture has the room at first.
if (!location.hash.includes("panel") && innerWidth < 480 && innerHeight < 600) app.look.panel = false;
startPanels([startProbe, startLights, startCompare, startNoise, startCamera]);
startToolbar();
startStatus();
startMessages();
startPointer();
startKeys();
startStage();
tell("look");

let lost = false;
listen(state => {
    app.state = state;
    tell("state");
    document.documentElement.dataset.ready = "true";
}, link => {
    if (link === app.link) return;
    if (link === "gone") lost = true;
    app.link = link;
    tell("link");
    // A program that has started again counts its pictures from one.
    if (link === "here" && lost) { lost = false; againFor.all(); }
});
