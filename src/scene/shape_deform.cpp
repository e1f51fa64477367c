#include "scene/shape_deform.h"

#include "geometry/mesh.h"
#include "scene/shape_builder.h"
#include "scene/shape_subdivision.h"

#include <fmt/format.h>

namespace abbe {

namespace {

bool wrongKey(const ShapeKey& key, Diagnostics& diagnostics, std::string message, std::string label) {
    diagnostics.error("E0681", key.span, std::move(message), std::move(label));
    return false;
}

template <typename F>
std::vector<Vec3> combine(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double fraction, F finish) {
    std::vector<Vec3> result(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        result[i] = Vec3(finish(Vec3d(a[i]) * (1 - fraction) + Vec3d(b[i]) * fraction));
    return result;
}

} // namespace

bool checkKeys(const ShapeParams& params, const std::vector<ShapeKey>& keys, bool hasOwnPoints, bool hasOwnRadius,
               Diagnostics& diagnostics) {
    if (hasOwnPoints)
        return wrongKey(keys[0], diagnostics, "a shape has points of its own, or keys with points",
                        "beside `file` or `points`");
    if (params.emits()) {
        diagnostics.error("E0682", keys[0].span, "a shape that deforms cannot emit light", "it deforms from here on")
            .help = "remove `emission`, or the keys; a `transform` with keys moves without a change of area";
        return false;
    }
    for (const ShapeKey& key : keys) {
        const bool file = !key.file.value.empty(), sized = key.radius || !key.radii.empty();
        if (file != key.points.empty())
            return wrongKey(key, diagnostics, "a key states either `file` or `points`",
                            file ? "states both" : "states neither");
        if (key.radius && !key.radii.empty())
            return wrongKey(key, diagnostics, "a key states either `radius` or `radii`", "states both");
        if (sized && hasOwnRadius)
            return wrongKey(key, diagnostics, "a shape has radii of its own, or keys with radii",
                            "beside `radius` or `radii`");
        if (file == keys[0].file.value.empty())
            return wrongKey(key, diagnostics, "all keys of a shape state the same properties",
                            file ? "`file` here, `points` in the first key" : "`points` here, `file` in the first key");
    }
    return true;
}

KeyGrid gridOf(std::span<const double> times, Interval shutter) { return makeKeyGrid(times, shutter, kMaxTimeSteps); }

std::vector<Vec3> stateOf(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double fraction) {
    return combine(a, b, fraction, [](Vec3d v) { return v; });
}

std::vector<Vec3> directionsOf(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double fraction) {
    return combine(a, b, fraction, [](Vec3d v) { return length(v) > 0 ? normalize(v) : v; });
}

std::vector<SizedPoint> stateOf(const std::vector<SizedPoint>& a, const std::vector<SizedPoint>& b, double fraction) {
    std::vector<SizedPoint> result(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        result[i] = {Vec3(Vec3d(a[i].position) * (1 - fraction) + Vec3d(b[i].position) * fraction),
                     static_cast<float>(static_cast<double>(a[i].radius) * (1 - fraction) +
                                        static_cast<double>(b[i].radius) * fraction)};
    return result;
}

double offGridDistance(const std::vector<Vec3>& key, const std::vector<Vec3>& instead, const Transform& place) {
    double largest = 0;
    for (std::size_t i = 0; i < key.size(); ++i)
        largest = std::max(largest, length(place.vector(Vec3d(key[i]) - Vec3d(instead[i]))));
    return largest;
}

double offGridDistance(const std::vector<SizedPoint>& key, const std::vector<SizedPoint>& instead,
                       const Transform& place) {
    double largest = 0;
    for (std::size_t i = 0; i < key.size(); ++i)
        largest = std::max(largest, length(place.vector(Vec3d(key[i].position) - Vec3d(instead[i].position))));
    return largest;
}

bool mismatch(Span span, Diagnostics& diagnostics, const std::string& message) {
    diagnostics.error("E0680", span, message, "not the points of the first key");
    return false;
}

void warnOffGrid(double distance, Span span, Diagnostics& diagnostics) {
    if (!(distance > 0)) return;
    diagnostics
        .warning("W0680", span,
                 fmt::format("the keys of this shape lie on no grid of at most {} equal parts of the exposure",
                             kMaxTimeSteps - 1),
                 fmt::format("points are up to {:.2g} m off the place of a key", distance))
        .help = "keys at equal fractions of the exposure are exact";
}

// Meshes and cages with keys.

namespace {

template <typename Faces> std::optional<std::size_t> firstDifference(const Faces& a, const Faces& b) {
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i] != b[i]) return i;
    return std::nullopt;
}

bool sameTopology(const MeshData& first, const MeshData& key, Span span, Diagnostics& diagnostics) {
    const auto faces = [](const MeshData& m) { return m.triangles.size() + m.quads.size(); };
    if (first.positions.size() != key.positions.size() || faces(first) != faces(key))
        return mismatch(span, diagnostics,
                        fmt::format("{} points and {} faces, but {} and {} in the first key", key.positions.size(),
                                    faces(key), first.positions.size(), faces(first)));
    if (first.quads.size() != key.quads.size())
        return mismatch(span, diagnostics,
                        fmt::format("{} triangles and {} quads, but {} and {} in the first key", key.triangles.size(),
                                    key.quads.size(), first.triangles.size(), first.quads.size()));
    if (const auto i = firstDifference(first.triangles, key.triangles))
        return mismatch(span, diagnostics, fmt::format("triangle {} has other corners than in the first key", *i));
    if (const auto i = firstDifference(first.quads, key.quads))
        return mismatch(span, diagnostics, fmt::format("quad {} has other corners than in the first key", *i));
    if (first.normals.size() != key.normals.size())
        return mismatch(span, diagnostics,
                        fmt::format("{} normals, but {} in the first key", key.normals.size(), first.normals.size()));
    return true;
}

bool moveTo(MeshStep& step, const Transform& place) {
    for (Vec3& p : step.positions) {
        const Vec3d q = place.point(Vec3d(p));
        if (!isFinite(q) || !(maxComponent(abs(q)) < kLargestCoordinate)) return false;
        p = Vec3(q);
    }
    for (Vec3& n : step.normals) {
        const Vec3d m = place.normal(Vec3d(n));
        n = length(m) > 0 ? Vec3(normalize(m)) : Vec3{};
    }
    return true;
}

} // namespace

std::optional<MeshKeys> loadMeshKeys(const MeshParams& params, double unit, bool zUp, FaceGroups* groups,
                                     Diagnostics& diagnostics) {
    MeshKeys keys;
    for (const ShapeKey& key : params.keys) {
        const bool first = keys.states.empty();
        auto mesh =
            statedMesh(key.file, unit, key.points, params.faces, key.span, diagnostics, zUp, first ? groups : nullptr);
        if (!mesh) return std::nullopt;
        MeshData checked = *mesh; // faces without area stay: at another time they have one
        if (const MeshCleanup cleanup = cleanMesh(checked); cleanup.error) {
            diagnostics.error("E0611", key.span, *cleanup.error, "damaged mesh");
            return std::nullopt;
        }
        if (!first) {
            if (!sameTopology(keys.states[0], *mesh, key.span, diagnostics)) return std::nullopt;
            *mesh = {std::move(mesh->positions), std::move(mesh->normals), {}, {}, {}};
        }
        keys.times.push_back(key.time);
        keys.states.push_back(std::move(*mesh));
    }
    return keys;
}

bool useFirstKey(SubdivisionParams& params, Diagnostics& diagnostics) {
    if (params.keys.empty()) return true;
    const bool ownPoints = !params.file.value.empty() || !params.points.empty();
    if (!checkKeys(params, params.keys, ownPoints, false, diagnostics)) return false;
    params.file = params.keys[0].file;
    params.points = params.keys[0].points;
    return true;
}

std::optional<CageKeys> loadCageKeys(const SubdivisionParams& params, const SubdivisionCage& first, double unit,
                                     Diagnostics& diagnostics) {
    if (params.keys.empty()) return CageKeys();
    CageKeys keys{{params.keys[0].time}, {first.positions}};
    for (const ShapeKey& key : std::span(params.keys).subspan(1)) {
        SubdivisionParams here = params;
        here.file = key.file;
        here.points = key.points;
        auto loaded = loadCage(here, unit, key.span, diagnostics);
        if (!loaded) return std::nullopt;
        const SubdivisionCage& cage = loaded->cage;
        if (cage.positions.size() != first.positions.size() || cage.faceSizes.size() != first.faceSizes.size()) {
            mismatch(key.span, diagnostics,
                     fmt::format("{} points and {} faces, but {} and {} in the first key", cage.positions.size(),
                                 cage.faceSizes.size(), first.positions.size(), first.faceSizes.size()));
            return std::nullopt;
        }
        if (cage.faceSizes != first.faceSizes || cage.corners != first.corners) {
            mismatch(key.span, diagnostics, "faces have other corners than in the first key");
            return std::nullopt;
        }
        keys.times.push_back(key.time);
        keys.states.push_back(std::move(loaded->cage.positions));
    }
    return keys;
}

std::unique_ptr<const Shape> placeMeshSteps(MeshData faces, std::vector<MeshStep> steps, const Transform& place,
                                            Span span, Diagnostics& diagnostics) {
    for (MeshStep& step : steps)
        if (!moveTo(step, place)) {
            diagnostics.error("E0605", span, "a shape reaches farther than 1e15 m from the camera", "too far away");
            return nullptr;
        }
    if (place.determinant() < 0) { // a mirror turns windings: turn them back, so that outside stays outside
        for (auto& t : faces.triangles) std::swap(t[1], t[2]);
        for (auto& q : faces.quads) std::swap(q[1], q[3]);
    }
    std::unique_ptr<const Shape> shape;
    if (steps.size() == 1) {
        faces.positions = std::move(steps[0].positions);
        faces.normals = std::move(steps[0].normals);
        shape = std::make_unique<const Mesh>(std::move(faces));
    } else {
        shape = std::make_unique<const DeformingMesh>(std::move(faces), std::move(steps));
    }
    if (shape->area() > 0) return shape;
    diagnostics.error("E0604", span, "this shape has no faces with an area", "nothing to see here");
    return nullptr;
}

std::unique_ptr<const Shape> placeMeshKeys(const MeshKeys& keys, Interval shutter, const Transform& place, Span span,
                                           Diagnostics& diagnostics) {
    const KeyGrid grid = gridOf(keys.times, shutter);
    const auto positions = [](const MeshData& m) -> const std::vector<Vec3>& { return m.positions; };
    std::vector<MeshStep> steps;
    for (const KeyPosition p : grid.steps)
        steps.push_back(
            {stateAt(keys, p, positions), directionsAt(
                                              keys, p, [](const MeshData& m) -> const auto& { return m.normals; })});
    warnOffGrid(
        grid, [&](std::size_t i) -> const auto& { return keys.states[i].positions; },
        [&](std::size_t i) -> const auto& { return steps[i].positions; }, place, span, diagnostics);
    MeshData faces;
    faces.triangles = keys.states[0].triangles;
    faces.quads = keys.states[0].quads;
    faces.uvs = keys.states[0].uvs;
    faces.attributes = keys.states[0].attributes;
    return placeMeshSteps(std::move(faces), std::move(steps), place, span, diagnostics);
}

void deformMesh(const MeshParams& params, ShapeBuilder& builder, LoadedShape& shape) {
    const ShapeContext context = builder.contextOf(*shape.definition);
    const bool ownPoints = !params.file.value.empty() || !params.points.empty();
    if (!checkKeys(params, params.keys, ownPoints, false, context.diagnostics)) return;
    struct Loaded {
        MeshKeys keys;
        FaceGroups groups;
    };
    const bool grouped = !params.groupMaterials.empty();
    const auto loaded = builder.data<Loaded>(shape, [&]() -> std::shared_ptr<const Loaded> {
        FaceGroups groups;
        auto keys = loadMeshKeys(params, context.unit, context.zUp, grouped ? &groups : nullptr, context.diagnostics);
        const bool ofFile = !params.keys[0].file.value.empty();
        if (!keys || !addPointData(params, ofFile, keys->states[0], context.span, context.diagnostics)) return nullptr;
        return std::make_shared<const Loaded>(Loaded{std::move(*keys), std::move(groups)});
    });
    if (!loaded) return;
    builder.noteFiles(params.keys);
    shape.mesh = {loaded, &loaded->keys.states[0]};
    shape.sound = true;
    shape.deforms = builder.motion.deforms(loaded->keys.times);
    if (grouped) builder.chooseFaceMaterials(shape, loaded->groups);
    shape.place = [loaded, context](const Transform& place) {
        return placeMeshKeys(loaded->keys, context.shutter, place, context.span, context.diagnostics);
    };
}

// Curves and points with keys.

namespace {

template <typename Params> Params withKey(const Params& params, const ShapeKey& key) {
    Params here = params;
    here.keys.clear();
    here.file = key.file;
    here.points = key.points;
    if (key.radius) here.radius = key.radius;
    if (!key.radii.empty()) here.radii = key.radii;
    return here;
}

bool ownPoints(const SizedPointsParams& p) { return !p.file.value.empty() || !p.points.empty(); }
bool ownRadius(const SizedPointsParams& p) { return p.radius || !p.radii.empty(); }

const auto kPointsOf = [](const auto& data) -> const std::vector<SizedPoint>& { return data.points; };

// The points of all steps; a warning if they are not exactly the keys.
template <typename T>
std::vector<std::vector<SizedPoint>> stepsOf(const Keys<T>& keys, const KeyGrid& grid, const Transform& place,
                                             Span span, Diagnostics& diagnostics) {
    std::vector<std::vector<SizedPoint>> steps;
    for (const KeyPosition p : grid.steps) steps.push_back(stateAt(keys, p, kPointsOf));
    warnOffGrid(
        grid, [&](std::size_t i) -> const auto& { return keys.states[i].points; },
        [&](std::size_t i) -> const auto& { return steps[i]; }, place, span, diagnostics);
    return steps;
}

} // namespace

std::optional<CurveKeys> loadCurveKeys(const CurvesParams& params, double unit, Diagnostics& diagnostics) {
    CurveKeys keys;
    for (const ShapeKey& key : params.keys) {
        auto data = loadCurveData(withKey(params, key), unit, key.span, diagnostics);
        if (!data) return std::nullopt;
        if (!keys.states.empty() && data->strandSizes != keys.states[0].strandSizes) {
            const CurveData& first = keys.states[0];
            mismatch(key.span, diagnostics,
                     data->points.size() == first.points.size() && data->strandSizes.size() == first.strandSizes.size()
                         ? std::string("strands have other numbers of points than in the first key")
                         : fmt::format("{} points in {} strands, but {} in {} in the first key", data->points.size(),
                                       data->strandSizes.size(), first.points.size(), first.strandSizes.size()));
            return std::nullopt;
        }
        keys.times.push_back(key.time);
        keys.states.push_back(std::move(*data));
    }
    return keys;
}

std::optional<PointKeys> loadPointKeys(const PointsParams& params, double unit, Diagnostics& diagnostics) {
    PointKeys keys;
    for (const ShapeKey& key : params.keys) {
        PointsParams here = withKey(params, key);
        if (!key.normals.empty()) here.normals = key.normals;
        auto data = loadPointData(here, unit, key.span, diagnostics);
        if (!data) return std::nullopt;
        if (!keys.states.empty() && data->points.size() != keys.states[0].points.size()) {
            mismatch(
                key.span, diagnostics,
                fmt::format("{} points, but {} in the first key", data->points.size(), keys.states[0].points.size()));
            return std::nullopt;
        }
        if (!keys.states.empty() && data->form != keys.states[0].form) {
            mismatch(key.span, diagnostics, "disks have normals in all keys or in none");
            return std::nullopt;
        }
        keys.times.push_back(key.time);
        keys.states.push_back(std::move(*data));
    }
    return keys;
}

std::unique_ptr<const Shape> placeCurveKeys(const CurveKeys& keys, Interval shutter, const Transform& place, Span span,
                                            Diagnostics& diagnostics) {
    auto steps = stepsOf(keys, gridOf(keys.times, shutter), place, span, diagnostics);
    const CurveData& first = keys.states[0];
    CurveData data{first.basis, first.form, std::move(steps[0]), first.strandSizes};
    data.later.assign(std::make_move_iterator(steps.begin() + 1), std::make_move_iterator(steps.end()));
    return placeCurves(std::move(data), place, span, diagnostics);
}

std::unique_ptr<const Shape> placePointKeys(const PointKeys& keys, Interval shutter, const Transform& place, Span span,
                                            Diagnostics& diagnostics) {
    const KeyGrid grid = gridOf(keys.times, shutter);
    auto steps = stepsOf(keys, grid, place, span, diagnostics);
    PointData data;
    data.form = keys.states[0].form;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        PointData::Step step{std::move(steps[i]),
                             directionsAt(
                                 keys, grid.steps[i], [](const PointData& p) -> const auto& { return p.normals; })};
        if (i > 0) {
            data.later.push_back(std::move(step));
            continue;
        }
        data.points = std::move(step.points);
        data.normals = std::move(step.normals);
    }
    return placePoints(std::move(data), place, span, diagnostics);
}

void deformCurves(const CurvesParams& params, ShapeBuilder& builder, LoadedShape& shape) {
    const ShapeContext context = builder.contextOf(*shape.definition);
    if (!checkKeys(params, params.keys, ownPoints(params), ownRadius(params), context.diagnostics)) return;
    const auto keys = builder.data<CurveKeys>(shape, [&]() -> std::shared_ptr<const CurveKeys> {
        auto made = loadCurveKeys(params, context.unit, context.diagnostics);
        return made ? std::make_shared<const CurveKeys>(std::move(*made)) : nullptr;
    });
    if (!keys) return;
    builder.noteFiles(params.keys);
    const CurveData& first = keys->states[0];
    for (const std::uint32_t size : first.strandSizes)
        shape.segments += (size - leastPoints(first.basis)) / pointStep(first.basis) + 1;
    shape.strands = first.strandSizes.size();
    shape.sound = true;
    shape.deforms = builder.motion.deforms(keys->times);
    shape.place = [keys, context](const Transform& place) {
        return placeCurveKeys(*keys, context.shutter, place, context.span, context.diagnostics);
    };
}

void deformPoints(const PointsParams& params, ShapeBuilder& builder, LoadedShape& shape) {
    const ShapeContext context = builder.contextOf(*shape.definition);
    if (!checkKeys(params, params.keys, ownPoints(params), ownRadius(params), context.diagnostics)) return;
    const auto keys = builder.data<PointKeys>(shape, [&]() -> std::shared_ptr<const PointKeys> {
        auto made = loadPointKeys(params, context.unit, context.diagnostics);
        return made ? std::make_shared<const PointKeys>(std::move(*made)) : nullptr;
    });
    if (!keys) return;
    builder.noteFiles(params.keys);
    shape.points = keys->states[0].points.size();
    shape.sound = true;
    shape.deforms = builder.motion.deforms(keys->times);
    shape.place = [keys, context](const Transform& place) {
        return placePointKeys(*keys, context.shutter, place, context.span, context.diagnostics);
    };
}

// Subdivision surfaces with keys: one plan dices the cage at every step.

namespace {

// What a further step adds to a triangle, vertices and acceleration structure (docs/performance.md).
constexpr double kBytesPerStep = 70;

// The share of the memory that is left for what a still surface takes.
double stillMemory(double memory, std::size_t steps) {
    const double still = static_cast<double>(SubdivisionSurface::kBytesPerTriangle);
    return std::max(1.0, memory * still / (still + kBytesPerStep * static_cast<double>(steps - 1)));
}

} // namespace

std::unique_ptr<const Shape> placeCageKeys(SubdivisionCage cage, const CageKeys& keys, Interval shutter,
                                           const Displacement* displacement, Dicing dicing, double memory,
                                           const Transform& place, Span span, Diagnostics& diagnostics,
                                           std::vector<DicedSurface::Face>* faces) {
    const KeyGrid grid = gridOf(keys.times, shutter);
    const auto pointsAt = [&](std::size_t step) {
        return stateAt(
            keys, grid.steps[step], [](const std::vector<Vec3>& p) -> const auto& { return p; });
    };
    warnOffGrid(
        grid, [&](std::size_t i) -> const auto& { return keys.states[i]; }, pointsAt, place, span, diagnostics);
    cage.positions = pointsAt(0); // which chooses the rates, for all times
    dicing.place = place;
    const SubdivisionSurface surface(cage);
    const double least = stillMemory(memory, grid.steps.size());
    const DicingPlan plan = surface.plan(dicing, static_cast<std::uint64_t>(least * (1 << 20)), displacement);
    if (plan.coarser > 1) warnOfBudget(surface, dicing, plan, least, span, diagnostics, displacement);
    try {
        std::vector<MeshStep> steps;
        MeshData mesh;
        for (std::size_t i = 0; i < grid.steps.size(); ++i) {
            DicedSurface diced = surface.dice(plan, pointsAt(i), displacement);
            steps.push_back({std::move(diced.mesh.positions), std::move(diced.mesh.normals)});
            if (i > 0) continue;
            mesh = std::move(diced.mesh);
            *faces = std::move(diced.faces);
        }
        return placeMeshSteps(std::move(mesh), std::move(steps), place, span, diagnostics);
    } catch (const std::bad_alloc&) {
        diagnostics.error("E0404", span, "the diced surface does not fit into memory",
                          fmt::format("{} at {} steps of time", describe(plan), grid.steps.size()));
        return nullptr;
    }
}

} // namespace abbe
