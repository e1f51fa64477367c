// Numbers as people read them. Unknown ones (null) are a dash.
export const isNumber = v => typeof v === "number" && Number.isFinite(v);
const minus = text => text.replace("-", "−");

export function significant(v, digits = 3) {
    if (!isNumber(v)) return "–";
    if (v === 0) return "0";
    const size = Math.abs(v);
    if (size >= 1e6 || size < 1e-4) {
        const [mantissa, exponent] = v.toExponential(digits - 1).split("e");
        return minus(`${mantissa}·10${[...String(+exponent)].map(c => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻").join("")}`);
    }
    const places = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
    return minus(v.toFixed(Math.min(12, places)));
}
export const percent = (share, digits = 2) => isNumber(share) ? `${significant(100 * share, digits)}\u00a0%` : "–";
export const count = v => isNumber(v) ? String(Math.round(v)).replace(/\B(?=(\d{3})+$)/g, "\u202f") : "–";
export const signedStops = v => `${v > 0.049 ? "+" : v < -0.049 ? "−" : ""}${Math.abs(v).toFixed(1)}`;

// 0.213 ± 0.004: as many places as the error has, with one digit of it (two where it begins with 1).
export function withError(value, error) {
    if (!isNumber(value)) return {value: "–", error: ""};
    if (!isNumber(error) || error <= 0) return {value: significant(value, 4), error: ""};
    const exponent = Math.floor(Math.log10(error)), places = (error / 10 ** exponent < 2 ? 1 : 0) - exponent;
    if (Math.abs(value) >= 1e6 || places > 8) return {value: significant(value, 4), error: `± ${significant(error, 2)}`};
    return {value: minus(value.toFixed(Math.max(0, places))), error: `± ${error.toFixed(Math.max(0, places))}`};
}

// A point: the places of all are those of the largest coordinate.
export function point(position, digits = 4) {
    const size = Math.max(...position.map(Math.abs));
    if (!(size > 1e-4 && size < 1e6)) return position.map(v => significant(v, digits)).join(", ");
    const places = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
    return position.map(v => minus((Math.round(v * 10 ** places) / 10 ** places + 0).toFixed(places))).join(", ");
}

export function duration(seconds) {
    if (!isNumber(seconds)) return "–";
    if (seconds < 1) return `${significant(seconds, 2)}\u00a0s`;
    if (seconds < 60) return `${seconds < 10 && seconds % 1 ? seconds.toFixed(1) : Math.round(seconds)}\u00a0s`;
    const s = Math.round(seconds);
    if (s < 3600) return s < 600 && s % 60 ? `${Math.floor(s / 60)}\u00a0min\u00a0${s % 60}\u00a0s` : `${Math.round(s / 60)}\u00a0min`;
    const h = Math.floor(s / 3600);
    return h < 100 ? `${h}\u00a0h\u00a0${Math.round(s % 3600 / 60)}\u00a0min` : `${Math.round(h / 24)} days`;
}
export const counted = (n, one, many = `${one}s`) => `${count(n)} ${n === 1 ? one : many}`;
