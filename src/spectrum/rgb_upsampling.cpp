#include "spectrum/rgb_upsampling.h"

#include "base/check.h"
#include "spectrum/color_space.h"
#include "spectrum/curve.h"
#include "spectrum/named_spectra.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>

namespace abbe {

namespace {

using Double4 = double __attribute__((vector_size(32)));

struct Symmetric3 { // normal equations of three unknowns
    double a[3][3] = {};
    double b[3] = {};
};

// Solves (A + damping diag A) δ = b by elimination; A is positive semidefinite.
Vec3d solve(const Symmetric3& n, double damping) {
    Matrix3 m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m.m[i][j] = n.a[i][j] * (i == j ? 1 + damping : 1);
    for (int i = 0; i < 3; ++i) m.m[i][i] += 1e-30;
    return m.inverse().apply<Vec3d>(Vec3d(n.b[0], n.b[1], n.b[2]));
}

double labSlope(double t) {
    constexpr double d = 6.0 / 29;
    return t > d * d * d ? 1 / (3 * std::cbrt(t) * std::cbrt(t)) : 1 / (3 * d * d);
}

// d Lab / d XYZ.
Matrix3 labGradient(const Xyz& c, const Xyz& white) {
    const double x = labSlope(c.x / white.x) / white.x, y = labSlope(c.y / white.y) / white.y,
                 z = labSlope(c.z / white.z) / white.z;
    return {{{0, 116 * y, 0}, {500 * x, -500 * y, 0}, {0, 200 * y, -200 * z}}};
}

// Beyond this a curve switches between 0 and 1 within a tenth of a nanometre and gains nothing by being steeper.
constexpr double kSteepest = 2000;

bool tooSteep(const SigmoidCurve& c) { return std::max({std::abs(c.c0), std::abs(c.c1), std::abs(c.c2)}) > kSteepest; }

constexpr double kGoodFit = 1e-3; // CIEDE2000

bool isGrey(const Vec3d& rgb) { return rgb.x == rgb.y && rgb.y == rgb.z; }

double luminance(const Matrix3& toXyz, const Vec3d& rgb) { return toXyz.apply<Xyz>(rgb).y; }

} // namespace

SigmoidCurve SigmoidCurve::flat(double value) {
    if (value <= 0) return {0, 0, -HUGE_VAL};
    if (value >= 1) return {0, 0, HUGE_VAL};
    return {0, 0, (value - 0.5) / std::sqrt(value * (1 - value))};
}

ReflectanceFitter::ReflectanceFitter(const RgbSpace& space, int stepNm)
    : toXyz_(space.toXyz()), white_(whiteXyz(space.white)) {
    ABBE_CHECK(stepNm == 1 || stepNm == 5);
    const auto named = findIlluminant(space.illuminant);
    ABBE_CHECK(named.has_value());
    const auto light = illuminantCurve(*named);
    const Matrix3 fromXyz = space.fromXyz();
    nodes_ = static_cast<std::size_t>(470 / stepNm + 1);
    double total[3] = {};
    for (std::size_t i = 0; i < nodes_; ++i) {
        const double node = kMinWavelength + static_cast<double>(i) * stepNm;
        t_[i] = (node - 595) / 235;
        // The node's weight is the colour of its hat function under the illuminant.
        Xyz sum;
        for (int j = -stepNm; j <= stepNm; ++j) {
            const double nm = node + j;
            if (nm < kMinWavelength || nm > kMaxWavelength) continue;
            const Wavelengths w = Wavelengths::single(static_cast<float>(nm));
            const double hat = (1 - std::abs(j) / static_cast<double>(stepNm)) * light->at(nm);
            sum += Xyz{xbar(w)[0], ybar(w)[0], zbar(w)[0]} * (hat / kYIntegral);
        }
        const Vec3d rgb = fromXyz.apply<Vec3d>(sum);
        for (int c = 0; c < 3; ++c) total[c] += weight_[c][i] = rgb[c];
    }
    for (int c = 0; c < 3; ++c)
        for (double& w : weight_[c]) w /= total[c];
}

ReflectanceFitter::Moments ReflectanceFitter::moments(const SigmoidCurve& curve) const {
    const auto load = [](const double* p) { return Double4(_mm256_load_pd(p)); };
    Double4 value[3] = {}, gradient[3][3] = {};
    for (std::size_t i = 0; i < nodes_; i += 4) { // padding nodes weigh nothing
        const Double4 t = load(&t_[i]);
        const Double4 x = (curve.c0 * t + curve.c1) * t + curve.c2;
        const Double4 inverse = 1.0 / Double4(_mm256_sqrt_pd(x * x + 1.0));
        const Double4 reflectance = 0.5 + 0.5 * x * inverse;
        const Double4 slope = 0.5 * inverse * inverse * inverse;
        for (int c = 0; c < 3; ++c) {
            const Double4 w = load(&weight_[c][i]);
            value[c] += w * reflectance;
            const Double4 d = w * slope;
            gradient[c][2] += d;
            gradient[c][1] += d * t;
            gradient[c][0] += d * t * t;
        }
    }
    const auto total = [](Double4 v) { return (v[0] + v[1]) + (v[2] + v[3]); };
    Moments m;
    m.rgb = {total(value[0]), total(value[1]), total(value[2])};
    for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k) m.gradient[c][k] = total(gradient[c][k]);
    return m;
}

Vec3d ReflectanceFitter::rgb(const SigmoidCurve& curve) const {
    if (std::isinf(curve.c2)) return curve.c2 > 0 ? Vec3d(1, 1, 1) : Vec3d();
    return moments(curve).rgb;
}

// Levenberg's damped Gauss-Newton in CIELAB, where dark and light colours weigh alike.
ReflectanceFit ReflectanceFitter::descend(const Vec3d& wanted, SigmoidCurve curve) const {
    const Lab goal = toLab(toXyz_.apply<Xyz>(wanted), white_);
    const auto labOf = [&](const Vec3d& rgb) { return toLab(toXyz_.apply<Xyz>(rgb), white_); };
    Moments now = moments(curve);
    double error = deltaE76(labOf(now.rgb), goal), damping = 1e-3;
    for (int iteration = 0; iteration < 200 && error > 1e-7 && damping < 1e12; ++iteration) {
        const Matrix3 slope = labGradient(toXyz_.apply<Xyz>(now.rgb), white_) * toXyz_;
        Matrix3 jacobian;
        for (int c = 0; c < 3; ++c)
            for (int k = 0; k < 3; ++k) jacobian.m[c][k] = now.gradient[c][k];
        jacobian = slope * jacobian;
        const Lab have = labOf(now.rgb);
        const double residual[3] = {goal.l - have.l, goal.a - have.a, goal.b - have.b};
        Symmetric3 normal;
        for (int i = 0; i < 3; ++i)
            for (int c = 0; c < 3; ++c) {
                normal.b[i] += jacobian.m[c][i] * residual[c];
                for (int j = 0; j < 3; ++j) normal.a[i][j] += jacobian.m[c][i] * jacobian.m[c][j];
            }
        const double before = error;
        for (; damping < 1e12; damping *= 8) {
            const Vec3d step = solve(normal, damping);
            const SigmoidCurve next{curve.c0 + step.x, curve.c1 + step.y, curve.c2 + step.z};
            const Moments then = moments(next);
            const double thenError = deltaE76(labOf(then.rgb), goal);
            if (!(thenError < error) || tooSteep(next)) continue;
            curve = next;
            now = then;
            error = thenError;
            damping = std::max(1e-12, damping * 0.1);
            break;
        }
        if (error > before * (1 - 1e-6)) break; // a minimum that is not zero
    }
    return {curve, now.rgb, deltaE2000(labOf(now.rgb), goal)};
}

ReflectanceFit ReflectanceFitter::fit(const Vec3d& wanted, const SigmoidCurve& start) const {
    if (isGrey(wanted)) {
        const double value = std::clamp(wanted.x, 0.0, 1.0);
        const Vec3d achieved(value, value, value);
        const double error = value == wanted.x ? 0
                                               : deltaE2000(toLab(toXyz_.apply<Xyz>(achieved), white_),
                                                            toLab(toXyz_.apply<Xyz>(wanted), white_));
        return {SigmoidCurve::flat(value), achieved, error};
    }
    return descend(wanted, start);
}

ReflectanceFit ReflectanceFitter::fit(const Vec3d& wanted) const {
    const double y = std::clamp(luminance(toXyz_, wanted), 1e-6, 0.999);
    ReflectanceFit best = fit(wanted, SigmoidCurve::flat(y));
    if (isGrey(wanted) || best.deltaE < kGoodFit) return best;
    // The nearest curve of a colour that none has: walk there from its grey, which avoids most of the poor minima.
    constexpr int steps = 12;
    ReflectanceFit walk{SigmoidCurve::flat(y), {}, 0};
    for (int i = 1; i <= steps; ++i)
        walk = descend(Vec3d(y, y, y) + (wanted - Vec3d(y, y, y)) * (static_cast<double>(i) / steps), walk.curve);
    return walk.deltaE < best.deltaE ? walk : best;
}

namespace {

// Of the space that was asked for last: scenes have thousands of colours in one, and its tables take longer than a fit.
const ReflectanceFitter& fitterOf(const RgbSpace& space) {
    struct Last {
        std::array<double, 8> primaries{};
        std::string illuminant;
        std::unique_ptr<const ReflectanceFitter> fitter; // 15 kB: a library has little room for what is each thread's
    };
    thread_local Last last;
    const std::array<double, 8> primaries = {space.red.x,  space.red.y,  space.green.x, space.green.y,
                                             space.blue.x, space.blue.y, space.white.x, space.white.y};
    if (!last.fitter || last.primaries != primaries || last.illuminant != space.illuminant) {
        last.fitter = std::make_unique<const ReflectanceFitter>(space);
        last.primaries = primaries;
        last.illuminant = space.illuminant;
    }
    return *last.fitter;
}

} // namespace

ReflectanceFit fitReflectance(const Vec3d& rgb, const RgbSpace& space) { return fitterOf(space).fit(rgb); }

namespace {

// scale × reflectance, and × the illuminant where one is given.
UpsampledCurve scaledCurve(const Vec3d& rgb, const RgbSpace& space, double scale, const Curve* light) {
    const ReflectanceFit fit = fitReflectance(rgb / scale, space);
    return {std::make_unique<SampledCurve>(
                [&](double nm) { return scale * fit.curve.at(nm) * (light != nullptr ? light->at(nm) : 1); }),
            fit.deltaE};
}

} // namespace

UpsampledCurve reflectanceFromRgb(const Vec3d& rgb, const RgbSpace& space) {
    if (!isGrey(rgb) || rgb.x < 0 || rgb.x > 1) return scaledCurve(rgb, space, 1, nullptr);
    return {std::make_unique<ConstantCurve>(rgb.x), 0};
}

UpsampledCurve unboundedFromRgb(const Vec3d& rgb, const RgbSpace& space) {
    if (isGrey(rgb) && rgb.x >= 0) return {std::make_unique<ConstantCurve>(rgb.x), 0};
    const double largest = maxComponent(rgb);
    return scaledCurve(rgb, space, largest > 0 ? 2 * largest : 1, nullptr);
}

UpsampledCurve emissionFromRgb(const Vec3d& rgb, const RgbSpace& space) {
    const auto light = illuminantCurve(*findIlluminant(space.illuminant));
    if (isGrey(rgb) && rgb.x >= 0)
        return {std::make_unique<SampledCurve>([&](double nm) { return rgb.x * light->at(nm); }), 0};
    const double largest = maxComponent(rgb);
    return scaledCurve(rgb, space, largest > 0 ? 2 * largest : 1, light.get());
}

} // namespace abbe
