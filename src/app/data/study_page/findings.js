// What a study found, in plain words. A sentence is a list of texts; every other one (odd index) is set in bold.
const timeToReach = (curve, error) => (curve.timeTo || []).find(t => Math.abs(t.error - error) < 1e-9) || null;
const between = (low, high, shown) => isNumber(low) && isNumber(high) ? `${shown(low)} … ${shown(high)}` : "";

function findingsOf(study) {
    const curves = study.curves || [], base = curves[0];
    if (!base) return [["Nothing was measured."]];
    return [...costFindings(base), ...changeFindings(curves), ...biasFindings(curves), ...effectFindings(study)];
}

function costFindings(base) {
    const found = [], one = timeToReach(base, 0.01), tenth = timeToReach(base, 0.001);
    if (one && positive(one.seconds)) {
        const words = ["An error of 1 % takes ", timeText(one.seconds), one.extrapolated ? " (extrapolated)" : ""];
        if (tenth && positive(tenth.seconds))
            words.push("; 0.1 % takes ", "", "", timeText(tenth.seconds), tenth.extrapolated ? " (extrapolated)." : ".");
        else words[2] += ".";
        found.push(joined(words));
    }
    const cost = base.fit && base.fit.halfNoiseCost;
    if (positive(cost)) {
        const law = Math.abs(Math.log(cost / 4)) < 0.12 ? "as averaging promises: 4×" : cost < 4 ? "less than the 4× of plain averaging" : "more than the 4× of plain averaging";
        found.push(["Halving the noise costs ", ratioText(cost), ` the time here (${law}).`]);
    }
    return found;
}
// Texts between bold ones run together.
function joined(words) {
    const merged = [words[0]];
    for (let i = 1; i < words.length; i += 2) {
        if (words[i] === "") merged[merged.length - 1] += words[i + 1] ?? "";
        else merged.push(words[i], words[i + 1] ?? "");
    }
    return merged;
}

// The changes that matter most: those whose interval does not contain 1.
function changeFindings(curves) {
    const changes = curves.slice(1).filter(c => c.efficiency && positive(c.efficiency.ratio)).map(curve => {
        const {ratio, low, high} = curve.efficiency, sure = !isNumber(low) || !isNumber(high) || low > 1 || high < 1;
        return {curve, ratio, low, high, sure};
    }).filter(c => c.sure).sort((a, b) => a.ratio - b.ratio);
    const told = c => {
        const slower = c.ratio < 1, factor = slower ? 1 / c.ratio : c.ratio;
        const interval = positive(c.low) && positive(c.high) ? slower ? ` (95 %: ${between(1 / c.high, 1 / c.low, ratioText)})` : ` (95 %: ${between(c.low, c.high, ratioText)})` : "";
        return slower ? [`With “${c.curve.label}” the same error takes `, ratioText(factor), ` as long${interval}.`]
            : [`“${c.curve.label}” reaches the same error in `, `1/${significant(factor, 2)}`, ` of the time${interval}.`];
    };
    const slow = changes.filter(c => c.ratio < 0.9).slice(0, 3), fast = changes.filter(c => c.ratio > 1.1).slice(-2).reverse();
    return [...slow, ...fast].map(told);
}

function biasFindings(curves) {
    const found = [], base = curves[0].floor;
    if (base && isNumber(base.low)) {
        if (base.low > 0) found.push(["As rendered, the error does not fall below ", errorText(base.relMse, 2), ": a bias, or an error of the reference."]);
        else if (positive(base.high)) found.push(["No bias was found down to ", errorText(base.high, 2), "."]);
    }
    const biased = curves.slice(1).filter(c => c.floor && positive(c.floor.low)).sort((a, b) => b.floor.relMse - a.floor.relMse).slice(0, 2);
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
