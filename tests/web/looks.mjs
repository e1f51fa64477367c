// Runs inside a page (as text): what a reader would complain about. Returns a list of complaints.
export function complaints() {
    const found = [], say = text => found.push(text), seen = e => e.getClientRects().length > 0 && getComputedStyle(e).visibility !== "hidden" && getComputedStyle(e).clipPath === "none"; // clipped away: for screen readers
    const name = e => `${e.tagName.toLowerCase()}${e.id ? `#${e.id}` : ""}${e.getAttribute("class") ? `.${e.getAttribute("class")}` : ""} “${(e.textContent || "").trim().slice(0, 40)}”`;
    if (document.documentElement.scrollWidth > innerWidth) say(`the page is ${document.documentElement.scrollWidth} wide, the window ${innerWidth}`);
    for (const image of document.images) if (!image.complete || !image.naturalWidth) say(`no picture: ${image.src.slice(0, 60)}`);

    // Text that does not fit into its box and is neither shortened on purpose nor to be scrolled.
    for (const e of document.querySelectorAll("h1,h2,h3,p,li,dd,dt,td,th,button,figcaption,small,span,summary")) {
        const style = getComputedStyle(e);
        if (!seen(e) || style.display === "inline" || style.textOverflow === "ellipsis" || style.webkitLineClamp !== "none") continue;
        if (e.scrollWidth > e.clientWidth + 1 && e.clientWidth > 0) say(`clipped at the side: ${name(e)}, ${e.scrollWidth} in ${e.clientWidth}`);
        const box = e.getBoundingClientRect();
        if (!e.closest(".scroll") && !e.closest("nav") && box.right > innerWidth + 1) say(`beyond the window: ${name(e)}`);
    }
    // Labels of plots: inside the drawing, none over another.
    for (const svg of document.querySelectorAll("svg.plot")) {
        if (!seen(svg)) continue;
        if (/NaN|undefined|Infinity/.test(svg.innerHTML)) say(`a drawing with ${svg.innerHTML.match(/.{0,40}(NaN|undefined|Infinity)/)[0]}`);
        const frame = svg.getBoundingClientRect(), texts = [...svg.querySelectorAll("text")].map(e => ({e, box: e.getBoundingClientRect()}));
        for (const {e, box} of texts)
            if (box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 || box.bottom > frame.bottom + 1) say(`outside its plot: ${name(e)}`);
        texts.forEach((a, i) => texts.slice(i + 1).forEach(b => {
            const wide = Math.min(a.box.right, b.box.right) - Math.max(a.box.left, b.box.left), high = Math.min(a.box.bottom, b.box.bottom) - Math.max(a.box.top, b.box.top);
            if (wide > 1 && high > 3) say(`one over the other: ${name(a.e)}, ${name(b.e)}`);
        }));
    }
    // Contrast of text and background [WCAG 2.1, 1.4.3].
    const rgb = text => (text.match(/[\d.]+/g) || []).map(Number), linear = v => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
    const luminance = c => 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
    const sheet = document.documentElement.matches("svg") ? document.querySelector("svg > rect") : null; // of a drawing by itself
    const ground = e => {
        if (sheet) return rgb(getComputedStyle(sheet).fill);
        for (; e; e = e.parentElement) {
            const c = rgb(getComputedStyle(e).backgroundColor);
            if (c.length === 3 || c[3] > 0.99) return c;
        }
        return [255, 255, 255];
    };
    const judged = new Set();
    for (const e of document.querySelectorAll("h1,h2,h3,p,li,dd,dt,td,th,button,small,a,text")) {
        if (!seen(e) || !e.textContent.trim() || e.closest(":disabled")) continue;
        const style = getComputedStyle(e), ink = rgb(e.namespaceURI.endsWith("svg") ? style.fill : style.color), paper = ground(e), key = `${ink}/${paper}`;
        if (judged.has(key)) continue;
        judged.add(key);
        const [a, b] = [luminance(ink), luminance(paper)].sort((x, y) => y - x);
        if ((a + 0.05) / (b + 0.05) < 4.5) say(`contrast ${((a + 0.05) / (b + 0.05)).toFixed(2)}: ${name(e)}, ${ink} on ${paper}`);
    }
    return found;
}

// What the plots of error hold.
export function plotsHeld() {
    return [...document.querySelectorAll(".frame[data-axis]")].map(frame => ({
        axis: frame.dataset.axis, curves: frame.querySelectorAll(".curve").length, marks: frame.querySelectorAll(".mark").length, arrows: frame.querySelectorAll(".whisker").length,
        bands: frame.querySelectorAll(".band").length, lines: frame.querySelectorAll(".path").length, fits: frame.querySelectorAll(".fit").length, floors: frame.querySelectorAll(".floor").length,
        guides: frame.querySelectorAll(".guide").length, xticks: frame.querySelectorAll(".xtick").length, yticks: frame.querySelectorAll(".ytick").length, spots: frame.spots.length,
    }));
}
