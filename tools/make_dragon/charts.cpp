#include "charts.h"

#include <deque>
#include <set>

namespace dragon {
namespace {

struct Chart {
    int axis = 0;
    std::vector<int> faces;
    Vec2 low{1e9, 1e9}, high{-1e9, -1e9}, place;
    Vec2 size() const { return high + low * -1; }
};

class Charter {
  public:
    explicit Charter(Cage& cage)
        : cage_(cage), near_(cage.faces.size()), normals_(cage.faces.size()), axis_(cage.faces.size()) {
        for (const auto& [e, beside] : edgeFaces(cage))
            for (int i = 0; i < 2; ++i) near_[beside[i]].push_back(beside[1 - i]);
        for (std::size_t f = 0; f < cage.faces.size(); ++f) {
            const Quad& q = cage.faces[f];
            normals_[f] = unit(cross(cage.points[q[2]] - cage.points[q[0]], cage.points[q[3]] - cage.points[q[1]]));
        }
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z)
                    if (std::abs(x) + std::abs(y) + std::abs(z) == 1)
                        directions_.push_back(unit({x + 0.02 * y, y + 0.3 * z, z - 0.3 * y}));
    }

    std::vector<Chart> charts() {
        for (int round = 0; round < 20; ++round) chooseAxes(0.2);
        std::vector<Chart> out;
        for (int round = 0; round < 16; ++round) {
            out = grow();
            for (const Chart& c : out)
                if (c.faces.size() < 25) dissolve(c);
        }
        out = grow();
        for (int round = 0; round < 6; ++round) absorb(out);
        std::erase_if(out, [](const Chart& c) { return c.faces.empty(); });
        return out;
    }

    Vec2 project(int axis, int point) const {
        const Vec n = directions_[axis], x = unit(cross(std::abs(n.y) > 0.8 ? Vec{0, 0, -1} : Vec{0, 1, 0}, n)),
                  y = cross(n, x);
        return {dot(cage_.points[point], x), dot(cage_.points[point], y)};
    }

  private:
    using Taken = std::map<std::array<int, 2>, int>; // small squares of the plane, and the face there

    // Faces turn to the direction that suits them and their neighbours.
    void chooseAxes(double bonus) {
        std::vector<int> next(axis_.size());
        for (std::size_t f = 0; f < axis_.size(); ++f) {
            double best = -1e9;
            for (std::size_t a = 0; a < directions_.size(); ++a) {
                double score = dot(normals_[f], directions_[a]);
                for (int n : near_[f]) score += bonus * (axis_[n] == int(a));
                if (score > best) best = score, next[f] = int(a);
            }
        }
        axis_ = next;
    }

    // A face fits into a chart when it is not turned away and lies on no other face.
    bool fits(int axis, int face, Taken& taken, double tilt) const {
        if (dot(normals_[face], directions_[axis]) < tilt) return false;
        std::array<Vec2, 4> c;
        for (int i = 0; i < 4; ++i) c[i] = project(axis, cage_.faces[face][i]);
        for (int i = 0; i < 4; ++i) {
            const Vec2 a = c[(i + 1) % 4] + c[i] * -1, b = c[(i + 3) % 4] + c[i] * -1;
            if (a.u * b.v - a.v * b.u < 0.1 * tilt) return false;
        }
        std::vector<std::array<int, 2>> cells;
        for (int i = 0; i < 400; ++i) {
            const double s = (i % 20 + 0.5) / 20, t = (i / 20 + 0.5) / 20;
            const Vec2 p = (c[0] * (1 - s) + c[1] * s) * (1 - t) + (c[3] * (1 - s) + c[2] * s) * t;
            cells.push_back({int(std::floor(p.u * 20)), int(std::floor(p.v * 20))});
            const auto found = taken.find(cells.back());
            if (found != taken.end() && !touch(found->second, face)) return false;
        }
        for (const auto& cell : cells) taken[cell] = face;
        return true;
    }

    bool touch(int a, int b) const {
        for (int p : cage_.faces[a])
            for (int q : cage_.faces[b])
                if (p == q) return true;
        return false;
    }

    std::vector<Chart> grow() {
        std::vector<Chart> out;
        taken_.clear();
        chart_.assign(axis_.size(), -1);
        for (std::size_t seed = 0; seed < axis_.size(); ++seed) {
            if (chart_[seed] >= 0) continue;
            Chart chart;
            chart.axis = axis_[seed];
            auto& taken = taken_.emplace_back();
            std::deque<int> queue{int(seed)};
            while (!queue.empty()) {
                const int f = queue.front();
                queue.pop_front();
                if (chart_[f] >= 0 || axis_[f] != chart.axis) continue;
                if (!fits(chart.axis, f, taken, 0.15) && f != int(seed)) continue;
                chart_[f] = int(out.size());
                chart.faces.push_back(f);
                queue.insert(queue.end(), near_[f].begin(), near_[f].end());
            }
            out.push_back(chart);
        }
        return out;
    }

    // Faces of a small chart follow their neighbours outside it.
    void dissolve(const Chart& c) {
        for (int f : c.faces)
            for (int n : near_[f])
                if (chart_[n] != chart_[f] && dot(normals_[f], directions_[axis_[n]]) > 0.2) axis_[f] = axis_[n];
    }

    // Faces of small charts go over to any larger one beside them where they fit.
    void absorb(std::vector<Chart>& charts) {
        for (std::size_t from = 0; from < charts.size(); ++from)
            if (charts[from].faces.size() < 12)
                std::erase_if(charts[from].faces, [&](int f) {
                    for (int n : near_[f]) {
                        const int to = chart_[n];
                        if (to == int(from) || charts[to].faces.size() < charts[from].faces.size()) continue;
                        if (!fits(charts[to].axis, f, taken_[to], 0.06)) continue;
                        charts[to].faces.push_back(f);
                        chart_[f] = to;
                        return true;
                    }
                    return false;
                });
    }

    Cage& cage_;
    std::vector<std::vector<int>> near_;
    std::vector<Vec> normals_;
    std::vector<Vec> directions_;
    std::vector<int> axis_, chart_; // per face
    std::vector<Taken> taken_;      // per chart
};

// Every chart, the high ones first, goes where it comes to rest lowest. Returns whether all fit.
bool pack(std::vector<Chart>& charts, double scale, double margin) {
    constexpr int kColumns = 1024;
    std::vector<double> top(kColumns, 0.0);
    for (Chart& c : charts) {
        const Vec2 size = c.size() * scale + Vec2{2 * margin, 2 * margin};
        const int columns = int(std::ceil(size.u * kColumns));
        double best = 1e9;
        int at = -1;
        for (int x = 0; x + columns <= kColumns; ++x) {
            const double y = *std::max_element(top.begin() + x, top.begin() + x + columns);
            if (y < best) best = y, at = x;
        }
        if (at < 0 || best + size.v > 1) return false;
        c.place = {double(at) / kColumns + margin, best + margin};
        std::fill(top.begin() + at, top.begin() + at + columns, best + size.v);
    }
    return true;
}

} // namespace

int makeCharts(Cage& cage, double margin) {
    Charter charter(cage);
    std::vector<Chart> charts = charter.charts();
    for (Chart& c : charts)
        for (int f : c.faces)
            for (int p : cage.faces[f]) {
                const Vec2 t = charter.project(c.axis, p);
                c.low = {std::min(c.low.u, t.u), std::min(c.low.v, t.v)};
                c.high = {std::max(c.high.u, t.u), std::max(c.high.v, t.v)};
            }
    std::stable_sort(charts.begin(), charts.end(),
                     [](const Chart& a, const Chart& b) { return a.size().v > b.size().v; });
    double scale = 0.2;
    while (!pack(charts, scale, margin)) scale *= 0.99;
    cage.uvs.assign(cage.faces.size(), {});
    for (const Chart& c : charts)
        for (int f : c.faces)
            for (int i = 0; i < 4; ++i) {
                const Vec2 t = (charter.project(c.axis, cage.faces[f][i]) + c.low * -1) * scale + c.place;
                // As the file will have them.
                cage.uvs[f][i] = {std::round(t.u * 1e5) * 1e-5, std::round(t.v * 1e5) * 1e-5};
            }
    return int(charts.size());
}

} // namespace dragon
