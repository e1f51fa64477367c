#include "exchange/pbrt/pbrt_view.h"

#include "exchange/pbrt/pbrt_scanner.h"
#include "io/file.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <vector>

namespace abbe::exchange {

namespace {

constexpr double kPbrtSensorWidth = 0.036; // m, of our cameras when they state none

// The length of the middle one of the axes, as cameras keep their scale.
double pbrtAxisLength(const Transform& t, int axis) { return length(Vec3d{t.a[0][axis], t.a[1][axis], t.a[2][axis]}); }

void pbrtCameraPlace(SceneNode& node, const Transform& worldFromCamera, double distance, Vec3d sideways) {
    const Vec3d from = worldFromCamera.point(sideways);
    node.child("from").vector(from);
    node.child("look-at").vector(from + normalize(worldFromCamera.vector({0, 0, 1})) * distance);
    node.child("up").vector(normalize(worldFromCamera.vector({0, 1, 0})));
}

// The lens files of pbrt's realistic camera, from the scene to the film, lengths in mm; a radius of 0 is the stop.
struct PbrtLensSurface {
    double radius = 0, thickness = 0, index = 1, diameter = 0;
};

// Four numbers a line: radius, thickness, index behind (0 for air), diameter. Nothing where it is no such table.
std::optional<std::vector<PbrtLensSurface>> pbrtLens(std::string_view text) {
    PbrtScanner scanner(text, FileId::none);
    std::vector<double> numbers;
    scanner.numbers(numbers);
    constexpr std::size_t kMostSurfaces = 256;
    if (numbers.empty() || numbers.size() % 4 != 0 || numbers.size() > 4 * kMostSurfaces ||
        scanner.next().kind != PbrtToken::Kind::end)
        return std::nullopt;
    std::vector<PbrtLensSurface> lens;
    for (std::size_t i = 0; i < numbers.size(); i += 4) {
        const double index = numbers[i + 2];
        if (numbers[i + 3] <= 0 || index < 0 || numbers[i + 1] < 0) return std::nullopt;
        lens.push_back({numbers[i], numbers[i + 1], index == 0 ? 1 : index, numbers[i + 3]});
    }
    return lens;
}

// The stop closed to a diameter, if it is wider.
void pbrtCloseStop(std::vector<PbrtLensSurface>& lens, double diameter) {
    for (PbrtLensSurface& surface : lens)
        if (surface.radius == 0 && diameter > 0) surface.diameter = std::min(surface.diameter, diameter);
}

// The slope at the film of the ray that comes from far away along the axis and passes the rim of the stop; 0 for none.
// Paraxial refraction, n' u' = n u - h (n' - n) / r.
double pbrtImageSlope(const std::vector<PbrtLensSurface>& lens) {
    double h = 1, slope = 0, index = 1, atStop = 0, stop = 0;
    for (const PbrtLensSurface& s : lens) {
        if (s.radius == 0) {
            atStop = h;
            stop = s.diameter / 2;
        } else {
            slope = (index * slope - h * (s.index - index) / s.radius) / s.index;
            index = s.index;
        }
        h += slope * s.thickness;
    }
    return atStop != 0 ? std::abs(slope * stop / atStop) : 0;
}

void pbrtWriteLens(SceneNode& camera, const std::vector<PbrtLensSurface>& lens) {
    SceneNode& rows = camera.child("surfaces").word("mm");
    for (const PbrtLensSurface& s : lens) {
        SceneNode& row = rows.child("-");
        if (s.radius == 0)
            row.word("stop");
        else
            row.number(s.radius);
        row.number(s.thickness);
        if (s.index == 1 || s.radius == 0)
            row.word("air");
        else
            row.number(s.index);
        row.number(s.diameter / 2);
    }
}

} // namespace

PbrtView::PbrtView(PbrtShared& shared) : shared_(shared) {
    camera_.type = "perspective";
    film.type = "rgb";
    filter.type = "gaussian";
    sampler.type = "zsobol";
    integrator.type = "volpath";
}

void PbrtView::camera(Said said, const PbrtState& state) {
    camera_ = std::move(said);
    medium_ = state.outside;
    for (int i = 0; i < 2; ++i) {
        const auto inverse = state.place.at[i].inverse();
        if (!inverse) {
            shared_.faults().error("E0802", camera_.params.directive, "the camera's transform has no inverse");
            return;
        }
        worldFromCamera_.at[i] = *inverse;
    }
    shared_.mirrored = worldFromCamera_.at[0].determinant() > 0;
    // A panorama of pbrt's runs to the left, as the sky seen from outside: it needs the other hand.
    if (camera_.type == "spherical") shared_.mirrored = !shared_.mirrored;
}

double PbrtView::cameraScale() { return pbrtAxisLength(worldFromCamera_.at[0], 2); }

void PbrtView::size() {
    Diagnostics& faults = shared_.faults();
    const int x = film.params.integer("xresolution", 1280, faults), y = film.params.integer("yresolution", 720, faults);
    if (x < 1 || y < 1 || x > 65536 || y > 65536)
        return void(faults.error("E0802", film.params.directive, fmt::format("a film of {} × {} pixels", x, y)));
    width_ = x;
    height_ = y;
}

// The window on the plane at distance 1 of a camera of 90°, 1 from the middle to the nearer edge [Pharr2023, sec. 5.2].
PbrtView::Frame PbrtView::screen() {
    Diagnostics& faults = shared_.faults();
    const double shape = static_cast<double>(width_) / height_;
    double aspect = camera_.params.number("frameaspectratio", shape, faults);
    if (aspect <= 0) aspect = shape;
    Frame frame = aspect > 1 ? Frame{-aspect, aspect, -1, 1} : Frame{-1, 1, -1 / aspect, 1 / aspect};
    const auto window = camera_.params.numbers("screenwindow");
    if (window.size() == 4 && window[0] < window[1] && window[2] < window[3])
        frame = {window[0], window[1], window[2], window[3]};
    else if (camera_.params.has("screenwindow"))
        faults.error("E0802", camera_.params.spanOf("screenwindow"),
                     "`screenwindow` takes left, right, bottom and top");
    const double wanted = (frame.right - frame.left) / (frame.top - frame.bottom);
    if (std::abs(wanted / shape - 1) > 1e-3)
        shared_.out.approximated(nullptr, camera_.params.directive, "a frame of another shape than the film",
                                 "pixels are square: the width is kept");
    return frame;
}

// Focal lengths are those of our sensor of 36 mm; only blur depends on them, by the aperture that is given as a length.
void PbrtView::lens(SceneNode& node) {
    Diagnostics& faults = shared_.faults();
    const double radius = camera_.params.number("lensradius", 0, faults) * cameraScale();
    const double focus = camera_.params.number("focaldistance", 1e6, faults) * cameraScale();
    if (radius <= 0) return;
    node.child("aperture").number(2 * radius).word("m");
    node.child("focus").number(focus).word("m");
}

void PbrtView::perspective(SceneNode& node) {
    Diagnostics& faults = shared_.faults();
    const Frame frame = screen();
    double fov = camera_.params.number("fov", 90, faults);
    if (fov <= 0 || fov >= 180) {
        faults.error("E0802", camera_.params.spanOf("fov"), "`fov` is between 0 and 180 degrees");
        fov = 90;
    }
    const double tangent = std::tan(fov / 2 * kDegree);
    // pbrt's angle is that of the shorter side, ours that of the width.
    const double half = (frame.right - frame.left) / 2 * tangent;
    const Vec2d middle{(frame.left + frame.right) / 2 * tangent, (frame.bottom + frame.top) / 2 * tangent};
    node.child("fov").number(2 * std::atan(half) / kDegree).word("deg");
    const double focalLength = kPbrtSensorWidth / (2 * half);
    if (middle.x != 0 || middle.y != 0)
        node.child("shift").number(middle.x * focalLength * 1000).number(middle.y * focalLength * 1000).word("mm");
    lens(node);
}

void PbrtView::orthographic(SceneNode& node) {
    const Frame frame = screen();
    node.word("orthographic");
    node.child("width").number((frame.right - frame.left) * pbrtAxisLength(worldFromCamera_.at[0], 0)).word("m");
    camera_.params.find("focaldistance");
    if (camera_.params.number("lensradius", 0, shared_.faults()) > 0)
        shared_.out.leftOut(&node, camera_.params.spanOf("lensradius"), "the lens of an orthographic camera",
                            "it has none here: all is sharp");
}

void PbrtView::spherical(SceneNode& node) {
    node.word("spherical");
    for (const char* lens : {"lensradius", "focaldistance", "fov"}) camera_.params.find(lens);
    const std::string mapping = camera_.params.text("mapping", "equalarea", shared_.faults());
    if (mapping != "equirectangular")
        shared_.out.approximated(&node, camera_.params.directive, "the equal-area layout of a spherical camera",
                                 "the picture has latitude and longitude");
}

void PbrtView::realistic(SceneNode& node) {
    Diagnostics& faults = shared_.faults();
    const std::string file = camera_.params.text("lensfile", "", faults);
    const double stop = camera_.params.number("aperturediameter", 1, faults);
    const double focus = camera_.params.number("focusdistance", 10, faults) * cameraScale();
    const std::string shape = camera_.params.text("aperture", "circular", faults);
    std::optional<std::vector<PbrtLensSurface>> lens;
    try {
        lens = pbrtLens(pbrtReadFile(shared_.file(file)));
    } catch (const IoError& error) {
        faults.error("E0802", camera_.params.spanOf("lensfile"), error.what());
        return;
    }
    if (!lens) {
        faults.error("E0802", camera_.params.spanOf("lensfile"), fmt::format("`{}` is no table of a lens", file));
        return;
    }
    pbrtCloseStop(*lens, stop);
    node.word("lens-system");
    pbrtWriteLens(node, *lens);
    const double diagonal = film.params.number("diagonal", 35, faults), shapeOf = static_cast<double>(width_) / height_;
    const double height = diagonal / std::sqrt(1 + shapeOf * shapeOf);
    node.child("sensor").number(height * shapeOf).number(height).word("mm");
    node.child("focus").number(std::max(focus, 1e-6)).word("m");
    if (shape != "circular")
        shared_.out.leftOut(&node, camera_.params.spanOf("aperture"), fmt::format("the aperture `{}`", shape),
                            "it is round; `f-stop` has `blades`");
    shared_.out.approximated(
        &node, camera_.params.directive, "a realistic camera",
        "its focus is measured from the pupil, in pbrt from the film, and its brightness is that of "
        "paraxial rays");
    exposure_ *= kPiD * square(pbrtImageSlope(*lens)); // pbrt's pixel is an irradiance, ours a radiance
}

void PbrtView::place(SceneNode& node, double firstTime, double lastTime) {
    Diagnostics& faults = shared_.faults();
    const double open = camera_.params.number("shutteropen", 0, faults);
    const double close = camera_.params.number("shutterclose", 1, faults);
    if (close <= open)
        return void(faults.error("E0802", camera_.params.directive, "the shutter closes before it opens"));
    const Transform ours = shared_.toOurs();
    const bool isOrtho = camera_.type == "orthographic";
    Vec3d sideways;
    if (isOrtho) {
        const Frame frame = screen();
        sideways = {(frame.left + frame.right) / 2, (frame.bottom + frame.top) / 2, 0};
    }
    const auto oursFromCamera = [&](int i) {
        Transform t = worldFromCamera_.at[i].then(ours);
        if (camera_.type != "spherical") return t;
        // The middle of pbrt's panorama is towards -x of the camera, whose z is ours here.
        Transform turn;
        turn.a[0][0] = turn.a[2][2] = 0;
        turn.a[0][2] = -1;
        turn.a[2][0] = 1;
        return turn.then(t);
    };
    const double distance = camera_.params.number("focaldistance", 1, faults) * cameraScale();
    const double ahead = distance > 0 && distance < 1e5 ? distance : 1;
    if (worldFromCamera_.moves()) {
        pbrtCameraPlace(node.child("at").number(firstTime).word("s"), oursFromCamera(0), ahead, sideways);
        pbrtCameraPlace(node.child("at").number(lastTime).word("s"), oursFromCamera(1), ahead, sideways);
    } else {
        pbrtCameraPlace(node, oursFromCamera(0), ahead, sideways);
    }
    if (shared_.moves || worldFromCamera_.moves()) {
        node.child("time").number(open).word("s");
        node.child("shutter").number(close - open).word("s");
    }
    // imagingRatio = exposure time · ISO / 100 [Pharr2023, sec. 5.4.2]
    exposure_ *= (close - open) * film.params.number("iso", 100, faults) / 100;
    if (exposure_ <= 0) return void(faults.error("E0802", film.params.spanOf("iso"), "`iso` is not above 0"));
    if (std::abs(exposure_ - 1) > 1e-9) node.child("exposure").number(std::log2(exposure_)).word("stops");
}

void PbrtView::finish(double firstTime, double lastTime) {
    size();
    SceneNode camera("camera");
    if (camera_.type == "perspective")
        perspective(camera);
    else if (camera_.type == "orthographic")
        orthographic(camera);
    else if (camera_.type == "spherical")
        spherical(camera);
    else if (camera_.type == "realistic")
        realistic(camera);
    else if (camera_.type == "environment")
        throw PbrtOldScene{camera_.params.directive, "the camera `environment`"};
    else
        shared_.faults().error("E0802", camera_.params.directive, fmt::format("there is no camera `{}`", camera_.type));
    place(camera, firstTime, lastTime);
    camera_.params.reportUnused(fmt::format("the camera `{}`", camera_.type), shared_.faults());
    SceneNode filmOf("film");
    filmNode(filmOf);
    shared_.settings.push_back(std::move(filmOf));
    shared_.settings.push_back(std::move(camera));
    renderNode();
}

} // namespace abbe::exchange
