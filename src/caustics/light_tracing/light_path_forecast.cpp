#include "caustics/light_tracing/light_path_forecast.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace abbe {

namespace {

void add(LightPathShare& to, const LightPathShare& s) {
    to.share += s.share;
    to.before += s.before;
    to.after += s.after;
}

// Those of the same names, as of a light that is placed many times.
std::vector<LightPathShare> byName(const std::vector<LightPathShare>& shares) {
    std::vector<LightPathShare> result;
    std::map<std::pair<std::string, std::string>, std::size_t> places;
    for (const LightPathShare& s : shares) {
        const auto [place, isNew] = places.emplace(std::pair(s.light, s.target), result.size());
        if (isNew)
            result.push_back(s);
        else
            add(result[place->second], s);
    }
    return result;
}

} // namespace

std::vector<LightPathShare> largestShares(const std::vector<LightPathShare>& all) {
    constexpr std::size_t kMostShares = LightPathFindings::kShares;
    std::vector<LightPathShare> shares = byName(all);
    std::erase_if(shares, [](const LightPathShare& s) { return !(s.share > 0); });
    std::ranges::stable_sort(shares, std::ranges::greater(), &LightPathShare::share);
    if (shares.size() <= kMostShares) return shares;
    LightPathShare others;
    for (std::size_t i = kMostShares - 1; i < shares.size(); ++i) add(others, shares[i]);
    shares.resize(kMostShares - 1);
    shares.push_back(others);
    return shares;
}

LightPathForecast::LightPathForecast(std::span<const LightDeposit> deposits, PixelBounds frame,
                                     const NoiseMeasure& measure) {
    const auto pixels = static_cast<double>(frame.area());
    terms_.reserve(deposits.size());
    for (const LightDeposit& d : deposits) {
        const double rho = std::max(d.rho, 1e-12); // no camera path may find it
        const double u = d.luminance * std::sqrt(measure.weight(d.x, d.y));
        terms_.push_back({u * u * d.stands / pixels, rho, u / rho});
    }
    limitOutliers();
    std::ranges::stable_sort(terms_, std::ranges::greater(), &Term::brightness);
}

// A few deposits that camera paths would hit once in millions would say all of a second moment, and next to nothing of
// what renders show: the largest count as the ninth.
void LightPathForecast::limitOutliers() {
    constexpr std::size_t kFew = 8;
    if (terms_.size() <= kFew) return;
    const auto largest = [](const Term& a, const Term& b) { return a.ofCamera(0) > b.ofCamera(0); };
    const auto ninth = terms_.begin() + kFew;
    std::ranges::nth_element(terms_, ninth, largest);
    const double most = ninth->ofCamera(0);
    for (auto t = terms_.begin(); t != ninth; ++t) {
        t->brightness *= most * t->rho / t->u2;
        t->rho = t->u2 / most;
    }
}

double LightPathForecast::fireflies() const {
    double sum = 0;
    for (const Term& t : terms_)
        if (t.isFirefly()) sum += t.ofCamera(0);
    return sum;
}

LightPathForecast::CameraPart LightPathForecast::cameraPart(double share, const CameraNoise& camera) const {
    double missed = fireflies() - (camera.alone.all.secondMoment - camera.alone.quiet.secondMoment);
    CameraPart result;
    for (const Term& t : terms_) {
        if (!t.isFirefly()) {
            result.quiet.add(t, share);
            continue;
        }
        if (missed > 0)
            result.missed += t.ofCamera(share);
        else
            result.loud.add(t, share);
        missed -= t.ofCamera(0);
    }
    return result;
}

namespace {

// Of variance `alone`, what is left with as many light paths as `left` is forecast for, where `besideLeft` is forecast
// for those of a look, which saw `measured` of it left: the look is right, and the forecast tells how it goes on from
// there.
double leftOf(double alone, double left, double besideLeft, double measured) {
    measured = std::clamp(measured, 0.0, 1.0);
    if (!(besideLeft > 0 && besideLeft < 1)) return alone * measured;
    return alone * std::pow(left, std::log(std::max(measured, 1e-6)) / std::log(besideLeft));
}

double ratio(double a, double b) { return b > 0 ? a / b : 1; }

} // namespace

// The second moment of fireflies that light paths tell and a look at some pixels has not seen is that of the brightest,
// which are the rarest; a mean of samples has all of it, stratified or not. Those that were seen are as noisy as they
// were seen to be. So is the rest, which is far less than its second moment: most of it is light that camera paths find
// with next to no noise. The two stay apart, or one firefly that a look happens to see would count as noise that no
// light path takes away.
//
// Terms tell what light paths take from the camera's noise in the mean over all that they see. Where the noise is light
// that they hardly ever show, such as what a dull mirror sees in itself, it stays, and only a look at camera paths
// beside light paths knows.
double LightPathForecast::variance(double share, const CameraNoise& camera) const {
    const double quiet = camera.alone.quiet.planned;
    const double seenLoud = std::max(0.0, camera.alone.all.planned - quiet);
    const double loud = std::min(seenLoud, fireflies()); // no variance is above the second moment
    double variance = 0;
    for (const Term& t : terms_) variance += t.ofLight(share);
    const CameraPart part = cameraPart(share, camera);
    variance += part.missed;
    if (!(camera.besideShare > 0) || !(share > 0))
        return variance + part.loud.left() * loud + part.quiet.left() * quiet;
    const CameraPart beside = cameraPart(camera.besideShare, camera);
    const double quietBeside = camera.beside.quiet.planned;
    const double loudBeside = std::max(0.0, camera.beside.all.planned - quietBeside);
    return variance + leftOf(loud, part.loud.left(), beside.loud.left(), ratio(loudBeside, seenLoud)) +
           leftOf(quiet, part.quiet.left(), beside.quiet.left(), ratio(quietBeside, quiet));
}

} // namespace abbe
