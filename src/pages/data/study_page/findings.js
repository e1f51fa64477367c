// What a study found, in plain words. A sentence is a list of texts; every other one (odd index) is set in bold.
const timeToReach = (curve, error) => (curve.timeTo || []).find(t => Math.abs(t.error - error) < 1e-9) || null;
// Half of a slope of relMSE: that of its root.
const rootSlope = v => isNumber(v) ? v / 2 : null;
// A fitted line tells nothing of times ten thousand times as long as those that were measured.
const farthest = curve => 1e4 * Math.max(0, ...(curve.points || []).map(p => p.seconds).filter(positive));
const tooFar = (curve, time) => time.extrapolated && time.seconds > farthest(curve);
// {relMse, low, high, samples}: the floor of the fit where it has bounds, or else what the mean of all replicates is off at the last point.
function biasOf(curve) {
    if (curve.floor && isNumber(curve.floor.low) && isNumber(curve.floor.high)) return {...curve.floor, samples: null};
    const last = (curve.points || []).filter(p => isNumber(p.bias2Low) && isNumber(p.bias2High)).pop();
    return last ? {relMse: last.bias2, low: last.bias2Low, high: last.bias2High, samples: last.samples} : null;
}
// A number below and nothing above it: there is no upper bound.
const upperEnd = ({low, high}) => isNumber(low) && !isNumber(high) ? Infinity : high;
const between = (low, high, shown) => isNumber(low) ? `${shown(low)} … ${isNumber(high) ? shown(high) : "no upper bound"}` : "";
// An interval of a ratio; its low end is 0 and the high one infinite where there is no bound.
const hasInterval = e => isNumber(e.low) && (e.low > 0 || positive(e.high));
// Seconds of a render that more samples do not need.
const fixedOf = curve => curve.time && isNumber(curve.time.fixed) ? curve.time.fixed : 0;

function findingsOf(study) {
    const curves = study.curves || [], base = curves[0];
    if (!base) return (study.effects || []).length ? [...effectFindings(study), [`${study.effects.length} `, study.effects.length === 1 ? "effect" : "effects", " measured, each off and on with the same seeds."]] : [["Nothing was measured."]];
    const early = study.complete === false ? [["The time ran out ", "before all was measured", ": intervals are wider than they would be."]] : [];
    const advantage = study.reference && study.reference.advantage;
    if (positive(advantage) && advantage < 5)
        early.push(["The reference is hardly better than what it judges: the best image has ", `${significant(advantage, 2)} times`, " its mean square error, so that small errors are uncertain."]);
    const found = [...costFindings(base), ...changeFindings(curves), ...biasFindings(curves), ...effectFindings(study)];
    const last = (base.points || []).filter(p => positive(p.relMse) && positive(p.seconds)).pop();
    if (!found.length && last) found.push([`After ${countText(last.samples)} samples and ${timeText(last.seconds)} the error is `, errorText(last.relMse, 2), "; nothing was fitted."]);
    return [...early, ...(found.length ? found : [["No error could be measured."]])];
}

function costFindings(base) {
    const found = [], times = (base.timeTo || []).filter(t => positive(t.seconds) && !tooFar(base, t)).sort((a, b) => b.error - a.error);
    const far = t => t.extrapolated ? " (extrapolated)" : "", [first, last] = [times[0], times[times.length - 1]];
    if (times.length === 1) found.push([`An error of ${percent(first.error, 1)} takes `, timeText(first.seconds), `${far(first)}.`]);
    else if (times.length > 1)
        found.push([`An error of ${percent(first.error, 1)} takes `, timeText(first.seconds), `${far(first)}, one of ${percent(last.error, 1)} takes `, timeText(last.seconds), `${far(last)}.`]);
    const cost = base.fit && base.fit.halfNoiseCost;
    if (positive(cost)) {
        const low = base.fit.halfNoiseCostLow, high = upperEnd({low, high: base.fit.halfNoiseCostHigh}), known = isNumber(low);
        const law = (known ? low <= 4 && high >= 4 : Math.abs(Math.log(cost / 4)) < 0.12) ? "averaging promises 4×" : cost < 4 ? "less than the 4× of plain averaging" : "more than the 4× of plain averaging";
        found.push(["Halving the noise costs ", ratioText(cost), ` the time here (${known ? `95\u00a0%: ${between(low, high, factorText)}; ` : ""}${law}).`]);
    }
    const longest = (base.points || []).filter(p => positive(p.seconds)).pop();
    if (longest && fixedOf(base) > 0.1 * longest.seconds)
        found.push([`Of ${timeText(longest.seconds)} for ${countText(longest.samples)} samples `, timeText(fixedOf(base)), " are pilots and plans that more samples do not need; ratios of speed leave them out."]);
    const end = (base.points || []).filter(p => positive(p.relMse) && positive(p.trimmed)).pop();
    if (end && end.trimmed < 0.3 * end.relMse)
        found.push(["Few bright pixels dominate: without the worst 0.1\u00a0% of them the error after ", timeText(end.seconds), ` is ${errorText(end.trimmed, 2)} instead of ${errorText(end.relMse, 2)}.`]);
    return found;
}

// The changes that matter most: those whose interval does not contain 1, by the end of it that is nearer to 1.
function changeFindings(curves) {
    const changes = curves.slice(1).filter(c => c.efficiency && positive(c.efficiency.ratio)).map(curve => {
        const {ratio, low} = curve.efficiency, high = upperEnd(curve.efficiency), known = hasInterval(curve.efficiency);
        return {curve, ratio, low, high, known, sure: known ? low > 1 || high < 1 : ratio < 0.5 || ratio > 2};
    }).filter(c => c.sure);
    const sureOf = c => c.known ? c.ratio < 1 ? c.high : c.low : c.ratio;
    const told = c => {
        const apart = Math.abs(fixedOf(c.curve) - fixedOf(curves[0])) > 0.02 ? `; ${timeText(fixedOf(c.curve))} of fixed time apart, against ${timeText(fixedOf(curves[0]))}` : "";
        const slower = c.ratio < 1, factor = slower ? 1 / c.ratio : c.ratio;
        const ends = slower ? [1 / c.high, 1 / c.low] : [c.low, c.high];
        const interval = c.known ? ` (95\u00a0%: ${between(...ends, factorText)})` : "";
        return slower ? [`With “${c.curve.label}” the same error takes ${c.known ? "" : "about "}`, ratioText(factor), ` as long${interval}${apart}.`]
            : [`With “${c.curve.label}” the same error comes ${c.known ? "" : "about "}`, ratioText(factor), ` sooner${interval}${apart}.`];
    };
    changes.sort((a, b) => sureOf(a) - sureOf(b));
    const slow = changes.filter(c => sureOf(c) < 0.9).slice(0, 2), fast = changes.filter(c => sureOf(c) > 1.1).slice(-1);
    return [...slow, ...fast].map(told);
}

// A bound that is larger than what was measured says nothing.
const leastError = curve => Math.min(...(curve.points || []).map(p => p.relMse).filter(positive));
function biasFindings(curves) {
    const found = [], base = biasOf(curves[0]);
    if (base) {
        if (base.low > 0 && base.samples === null) found.push(["As rendered, the error does not fall below ", errorText(base.relMse, 2), ": a bias, or an error of the reference."]);
        else if (base.low <= 0 && base.high > 0 && base.high < Math.min(0.09, 0.5 * leastError(curves[0]))) found.push(["No bias was found down to ", errorText(base.high, 2), "."]);
    }
    const biased = curves.slice(1).filter(c => c.floor && positive(c.floor.low)).sort((a, b) => b.floor.relMse - a.floor.relMse).slice(0, 1);
    for (const c of biased) found.push([`“${c.label}” settles at an error of `, errorText(c.floor.relMse, 2), ", however long it runs."]);
    return found;
}

function effectFindings(study) {
    const found = [], effects = (study.effects || []).filter(e => isNumber(e.deltaTime) && isNumber(e.flip));
    const dear = [...effects].sort((a, b) => b.deltaTime - a.deltaTime)[0];
    if (dear && dear.deltaTime > 0.02)
        found.push([`${capital(dear.name)} takes `, percent(dear.deltaTime, 2), ` of the time and ${seen(dear.flip)}.`]);
    return found;
}
const capital = text => String(text).charAt(0).toUpperCase() + String(text).slice(1);
// HDR-FLIP: the mean of what an observer sees when the two pictures alternate.
const seen = flip => flip < 0.005 ? "changes next to nothing that can be seen" : flip < 0.03 ? "changes the picture a little" : "changes the picture plainly";
