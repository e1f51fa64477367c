// Pictures and error maps at equal time, with one magnifier for all of them.
const lens = {zoom: 1, x: 0.5, y: 0.5, over: false};
const colourMaps = {
    viridis: ["#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725"],
    inferno: ["#000004", "#280b53", "#65156e", "#9f2a63", "#d44842", "#f57d15", "#fac228", "#fcffa4"],
    magma: ["#000004", "#221150", "#5f187f", "#982d80", "#d3436e", "#f8765c", "#febb81", "#fcfdbf"],
    heat: ["#08061e", "#5a146e", "#be325a", "#f58c28", "#fcfabe"],
    grey: ["#000", "#fff"],
};

function focusAll() {
    for (const view of document.querySelectorAll(".view")) {
        const image = view.firstChild, dot = view.lastChild;
        image.style.transformOrigin = `${100 * lens.x}% ${100 * lens.y}%`;
        image.style.transform = lens.zoom === 1 ? "" : `scale(${lens.zoom})`;
        view.classList.toggle("near", lens.zoom > 1);
        dot.hidden = !lens.over;
        dot.style.left = `${100 * lens.x}%`;
        dot.style.top = `${100 * lens.y}%`;
    }
    for (const button of document.querySelectorAll("[data-zoom]")) button.setAttribute("aria-pressed", +button.dataset.zoom === lens.zoom);
}
function view(png, alt) {
    const made = make("div", {class: "view", tabindex: "0", role: "img", "aria-label": `${alt}; arrow keys move, + and − magnify`}, make("img", {src: pngUrl(png), alt: "", draggable: "false"}), make("i", {hidden: ""}));
    const move = event => {
        const box = made.getBoundingClientRect(), clamp = v => Math.max(0, Math.min(1, v));
        Object.assign(lens, {x: clamp((event.clientX - box.left) / box.width), y: clamp((event.clientY - box.top) / box.height), over: true});
        focusAll();
    };
    made.addEventListener("pointermove", move);
    made.addEventListener("pointerleave", () => { lens.over = false; focusAll(); });
    made.addEventListener("click", event => { lens.zoom = lens.zoom === 1 ? 4 : 1; move(event); });
    made.addEventListener("keydown", event => {
        const step = 0.08 / lens.zoom, moves = {ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step]}[event.key];
        if (moves) { lens.x = Math.max(0, Math.min(1, lens.x + moves[0])); lens.y = Math.max(0, Math.min(1, lens.y + moves[1])); lens.over = true; }
        else if (event.key === "+" || event.key === "=") lens.zoom = Math.min(16, lens.zoom * 2);
        else if (event.key === "-") lens.zoom = Math.max(1, lens.zoom / 2);
        else if (event.key === "0") lens.zoom = 1;
        else return;
        event.preventDefault();
        focusAll();
    });
    return made;
}

function strips() {
    const all = (study.strips || []).filter(s => (s.images || []).length);
    if (!all.length) return;
    let chosen = all.length > 1 ? Math.floor(all.length / 2) : 0;
    const made = section("strips", "Pictures", "The same time, in pictures",
        "Every picture took the same time as the others in its row; below each, its error. The curves chosen above are shown. Point at a picture to look at the same place in all of them; a click magnifies.");
    const times = make("div", {class: "switches", role: "group", "aria-label": "Time"}, make("span", {class: "name"}, "after"),
        all.map((strip, i) => make("button", {type: "button", onclick: () => { chosen = i; draw(); }}, timeText(strip.seconds))));
    const zooms = make("div", {class: "switches", role: "group", "aria-label": "Magnification"}, make("span", {class: "name"}, "magnified"),
        [1, 2, 4, 8, 16].map(zoom => make("button", {type: "button", "data-zoom": zoom, onclick: () => { lens.zoom = zoom; focusAll(); }}, `${zoom}×`)));
    const grid = make("div", {class: "strips"});
    const draw = () => {
        [...times.querySelectorAll("button")].forEach((button, i) => button.setAttribute("aria-pressed", i === chosen));
        const cards = all[chosen].images.map(image => ({image, index: curves.findIndex(c => c.id === image.curve)})).filter(c => c.image.png && (c.index < 0 || inChoice(c.index) && !choice.hidden.has(c.index)));
        grid.replaceChildren(...(study.referencePng ? [make("figure", {}, view(study.referencePng, "Reference"), make("figcaption", {}, make("h3", {}, "reference")))] : []),
            ...cards.map(({image, index}) => {
                const label = index >= 0 ? curves[index].label : image.curve;
                return make("figure", {}, view(image.png, label), image.error ? view(image.error, `Error of ${label}`) : null,
                    make("figcaption", {}, make("h3", {}, label), make("small", {}, `error ${errorText(image.relMse)}`), make("small", {}, positive(image.samples) ? `${countText(image.samples)} samples` : "")));
            }), ...(cards.length ? [] : [make("p", {class: "soft"}, "None of the curves chosen above has a picture here.")]));
        focusAll();
    };
    made.append(times, zooms, grid);
    const scale = study.errorScale;
    if (scale) {
        const name = Object.keys(colourMaps).find(key => String(scale.name).toLowerCase().includes(key)), stops = Array.isArray(scale.stops) ? scale.stops.map(c => `rgb(${c.map(Number)})`) : colourMaps[name];
        made.append(make("div", {class: "ramp"}, stops ? make("div", {style: `background:linear-gradient(to right,${stops.join()})`}) : null,
            make("p", {}, make("span", {}, percentOr(scale.low, scale.unit)), make("span", {}, `error maps: ${scale.unit || "error"}`), make("span", {}, `${percentOr(scale.high, scale.unit)} and more`))));
    }
    choice.listeners.push(draw);
    draw();
}
const percentOr = (v, unit) => /relative/.test(unit || "") ? percent(v, 3) : significant(v, 3);
