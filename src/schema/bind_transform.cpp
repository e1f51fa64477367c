#include "schema/binding.h"
#include "schema/definition_reader.h"
#include "schema/expression.h"
#include "schema/measure.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

constexpr std::array kPlainNumber = {Dimension::none};
constexpr std::array kLength = {Dimension::length};
constexpr std::array kAngle = {Dimension::angle};
constexpr std::array kTime = {Dimension::time};

class StepReader {
  public:
    StepReader(const Node& step, const Header& header, Diagnostics& diagnostics)
        : entry_(step), header_(header), diagnostics_(diagnostics) {}

    // Nothing after a diagnostic.
    std::optional<TransformStep> read() {
        if (!isTransformStep(entry_.name())) {
            unknown();
            return std::nullopt;
        }
        if (entry_.name() == "matrix") return whole(matrix());
        if (entry_.hasBlock() || !entry_.keys().empty()) {
            report(diagnostics_, entry_.span(), "E0214", fmt::format("`{}` takes numbers only", entry_.name()),
                   "remove the block or key");
            return std::nullopt;
        }
        if (entry_.name() == "translate") return translate();
        if (entry_.name() == "rotate") return rotate();
        if (entry_.name() == "scale") return scale();
        return whole(lookAt());
    }

  private:
    std::optional<Row> row(std::span<const Dimension> dimensions, std::size_t first, std::size_t count,
                           std::string_view example) {
        return MeasureReader({entry_.name(), dimensions, -HUGE_VAL, HUGE_VAL, {}, example}, header_, diagnostics_)
            .row(entry_, first, count);
    }

    static std::optional<TransformStep> whole(const std::optional<Transform>& map) {
        if (!map) return std::nullopt;
        return TransformStep{TransformStep::Kind::matrix, {}, 0, *map};
    }

    std::nullopt_t fault(std::string message, std::string label) {
        report(diagnostics_, entry_.span(), "E0313", std::move(message), std::move(label));
        return std::nullopt;
    }

    void unknown() {
        const std::string_view name = entry_.name();
        const auto meant = nearest(name, {transformSteps().begin(), transformSteps().end()});
        report(diagnostics_, entry_.node()->nameSpan(), "E0313", fmt::format("`transform` has no step `{}`", name),
               meant.empty() ? "unknown step" : didYouMean(meant))
            .help = "the steps are " + quotedList(transformSteps());
    }

    std::optional<TransformStep> translate() {
        const auto r = row(kLength, 0, 3, "translate 0 1 0");
        if (!r) return std::nullopt;
        return TransformStep{TransformStep::Kind::translate, {r->values[0], r->values[1], r->values[2]}, 0, {}};
    }

    static TransformStep turn(Vec3d axis, double angle) { return {TransformStep::Kind::rotate, axis, angle, {}}; }

    std::optional<TransformStep> rotate() {
        const std::string_view example = "rotate y 45 deg";
        if (entry_.count() > 0 && entry_.value(0).isText() && !isComputed(entry_.value(0))) {
            const Value axis = entry_.value(0);
            if (axis.text != "x" && axis.text != "y" && axis.text != "z") {
                reportAt(diagnostics_, axis, "E0313", "`rotate` needs an axis", "write `x`, `y`, `z` or three numbers");
                return std::nullopt;
            }
            const auto r = row(kAngle, 1, 1, example);
            if (!r) return std::nullopt;
            const Vec3d direction{axis.text == "x" ? 1. : 0., axis.text == "y" ? 1. : 0., axis.text == "z" ? 1. : 0.};
            return turn(direction, r->values[0]);
        }
        // Three numbers without a unit, then an angle: read as four in the unit of the angle, and the axis has no size.
        const auto r = row(kAngle, 0, 4, "rotate 0 1 0 45 deg");
        if (!r) return std::nullopt;
        const double factor = r->scale.factor;
        const Vec3d axis{r->values[0] / factor, r->values[1] / factor, r->values[2] / factor};
        const double size = maxComponent(abs(axis));
        if (!(size > 0)) return fault("the axis of a rotation cannot be 0 0 0", "has no direction");
        return turn(axis / size, r->values[3]); // scaled: squares of tiny components would vanish
    }

    std::optional<TransformStep> scale() {
        const bool three = entry_.count() > 2; // one number and a wrong unit are two values
        const auto r = row(kPlainNumber, 0, three ? 3 : 1, three ? "scale 1 2 1" : "scale 2");
        if (!r) return std::nullopt;
        const auto& v = r->values;
        const Vec3d factors = three ? Vec3d{v[0], v[1], v[2]} : Vec3d{v[0], v[0], v[0]};
        return TransformStep{TransformStep::Kind::scale, factors, 0, {}};
    }

    // `look-at from(3) to(3) [up(3)]`: +z, the side to which quads and disks face, turns to the target.
    std::optional<Transform> lookAt() {
        const bool hasUp = entry_.count() > 7; // six numbers and a unit are seven
        const auto r = row(kLength, 0, hasUp ? 9 : 6, "look-at 0 1 4  0 0 0");
        if (!r) return std::nullopt;
        const auto& v = r->values;
        const Vec3d up = hasUp ? Vec3d{v[6], v[7], v[8]} : header_.zUp ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
        const Vec3d from{v[0], v[1], v[2]}, to{v[3], v[4], v[5]};
        const auto transform = Transform::lookAt(from, from * 2 - to, up); // which turns -z to its target
        if (!transform)
            return fault("`look-at` needs two different points and an up that is not between them", "has no direction");
        return transform;
    }

    // 16 numbers, in one line or four rows; the last row is 0 0 0 1, and the last column a translation in lengths.
    std::optional<Transform> matrix() {
        std::vector<double> m;
        const MeasureReader reader({"matrix", kPlainNumber, -HUGE_VAL, HUGE_VAL, {}, {}}, header_, diagnostics_);
        if (!reader.append(entry_, 0, m)) return std::nullopt;
        if (entry_.hasBlock())
            for (const Node child : entry_.node()->children()) {
                if (child.name() != "-") return fault("`matrix` holds rows of numbers", "a row begins with `-`");
                if (!reader.append(Entry(child), 0, m)) return std::nullopt;
            }
        if (m.size() != 16) return fault("`matrix` takes 16 numbers", fmt::format("has {}", m.size()));
        if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
            return fault("the last row of a matrix must be 0 0 0 1",
                         "rows are written one after another, with column vectors");
        Transform t;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) t.a[i][j] = m[4 * i + j];
        t.t = Vec3d{m[3], m[7], m[11]} * header_.length;
        return t;
    }

    Entry entry_;
    const Header& header_;
    Diagnostics& diagnostics_;
};

// The time of a key `at TIME { … }`, which comes after another; nothing after a diagnostic.
std::optional<double> keyTime(const Node& node, double after, const Header& header, Diagnostics& diagnostics) {
    const Measure measure{"at", kTime, -HUGE_VAL, HUGE_VAL, {}, "at 0.5 s { … }"};
    const auto time = MeasureReader(measure, header, diagnostics).row(Entry(node), 0, 1);
    if (!time) return std::nullopt;
    if (time->values[0] > after) return time->values[0];
    report(diagnostics, node.headSpan(), "E0313", "keys must follow each other in time",
           fmt::format("not after {} s", plain(after)));
    return std::nullopt;
}

// A block of steps, or of keys `at TIME { steps }` in the order of time.
class MotionReader {
  public:
    MotionReader(const Header& header, Diagnostics& diagnostics) : header_(header), diagnostics_(diagnostics) {}

    // Nothing after a diagnostic.
    std::optional<KeyedTransform> read(const Node& block) {
        std::vector<KeyedTransform::Key> keys;
        if (!hasKeys(block)) {
            auto steps = readSteps(block);
            if (!steps) return std::nullopt;
            keys.push_back({0, std::move(*steps)});
            return KeyedTransform(std::move(keys));
        }
        bool good = true;
        for (const Node child : block.children()) {
            if (child.name().starts_with("x-")) continue;
            auto key = readKey(child, keys.empty() ? -HUGE_VAL : keys.back().time);
            good = good && key;
            if (good) keys.push_back(std::move(*key));
        }
        if (!good) return std::nullopt;
        return KeyedTransform(std::move(keys));
    }

  private:
    std::optional<KeyedTransform::Key> readKey(const Node& node, double after) {
        if (node.damaged()) return std::nullopt;
        if (node.name() != "at") {
            report(diagnostics_, node.nameSpan(), "E0313", "a transform stands still or has keys, not both",
                   fmt::format("put `{}` into the `at` blocks", node.name()));
            return std::nullopt;
        }
        const auto time = keyTime(node, after, header_, diagnostics_);
        if (!time) return std::nullopt;
        auto steps = readSteps(node);
        if (!steps) return std::nullopt;
        return KeyedTransform::Key{*time, std::move(*steps)};
    }

    std::optional<std::vector<TransformStep>> readSteps(const Node& block) {
        std::vector<TransformStep> steps;
        Transform whole;
        bool good = true;
        for (const Node child : block.children()) {
            if (child.name().starts_with("x-")) continue;
            const auto step = child.damaged() ? std::nullopt : StepReader(child, header_, diagnostics_).read();
            good = good && step;
            if (!good) continue;
            const Transform map = step->transform();
            if (!map.inverse()) {
                report(diagnostics_, child.headSpan(), "E0313", fmt::format("`{}` flattens the object", child.name()),
                       "cannot be undone: its determinant is 0");
                good = false;
                continue;
            }
            whole = whole.then(map);
            steps.push_back(*step);
        }
        if (!good) return std::nullopt;
        if (whole.isFinite() && whole.inverse()) return steps;
        report(diagnostics_, block.headSpan(), "E0313", "the transform has no inverse in floating point",
               "its steps are too large or too small together");
        return std::nullopt;
    }

    const Header& header_;
    Diagnostics& diagnostics_;
};

} // namespace

std::optional<double> bindMoment(const FieldInfo& field, const Node& node, std::map<const FieldInfo*, double>& last,
                                 const Header& header, Diagnostics& diagnostics) {
    const auto [previous, first] = last.emplace(&field, -HUGE_VAL);
    const auto time = keyTime(node, previous->second, header, diagnostics);
    if (time) previous->second = *time;
    return time;
}

bool hasKeys(const Node& block) {
    for (const Node child : block.children())
        if (child.name() == "at") return true;
    return false;
}

KeyedTransform bindMotion(const Node& block, const Header& header, Diagnostics& diagnostics) {
    return MotionReader(header, diagnostics).read(block).value_or(KeyedTransform());
}

Transform bindTransform(const Node& block, const Header& header, Diagnostics& diagnostics) {
    for (const Node child : block.children())
        if (child.name() == "at") {
            report(diagnostics, child.nameSpan(), "E0313", "this transform cannot have keys", "does not move");
            return {};
        }
    return bindMotion(block, header, diagnostics).at(0);
}

} // namespace abbe::schema
