#include "cage.h"

#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <unordered_map>

namespace dragon {
namespace {

// Lattice lines are denser where the form has detail: at the feet and at the head.
std::vector<double> lines(double from, double to, double (*step)(double)) {
    std::vector<double> out{from};
    while (out.back() < to) out.push_back(out.back() + step(out.back()));
    return out;
}

// Corner c of a cell lies at the bits of c: x 1, y 2, z 4. Edge 4a + i runs along axis a.
constexpr std::array<std::array<int, 2>, 12> kEdges{
    {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

int edgeOf(int a, int b) {
    for (int e = 0; e < 12; ++e)
        if ((kEdges[e][0] == a && kEdges[e][1] == b) || (kEdges[e][0] == b && kEdges[e][1] == a)) return e;
    return -1;
}

// Surface nets with a point for every sheet of the surface in a cell [Gibson1998; Nielson2004].
class Net {
  public:
    Net(const Form& form, Vec shift) : form_(form) {
        for (double& x : axis_[0]) x += shift.x;
        for (double& y : axis_[1]) y += shift.y;
        for (double& z : axis_[2]) z += shift.z;
        const std::array<double, 3> dims{double(axis_[0].size()), double(axis_[1].size()), double(axis_[2].size())};
        value_.resize(std::size_t(dims[0] * dims[1] * dims[2]));
        for (int i = 0; i < size(0); ++i)
            for (int j = 0; j < size(1); ++j)
                for (int k = 0; k < size(2); ++k) value_[index(i, j, k)] = form(at(i, j, k));
    }

    Cage cage() {
        for (int i = 0; i + 1 < size(0); ++i)
            for (int j = 0; j + 1 < size(1); ++j)
                for (int k = 0; k + 1 < size(2); ++k) addCell(i, j, k);
        for (int a = 0; a < 3; ++a)
            for (int i = 1; i + 1 < size(0); ++i)
                for (int j = 1; j + 1 < size(1); ++j)
                    for (int k = 1; k + 1 < size(2); ++k) addFace(a, {i, j, k});
        return std::move(cage_);
    }

  private:
    int size(int a) const { return static_cast<int>(axis_[a].size()); }
    std::size_t index(int i, int j, int k) const { return (std::size_t(i) * size(1) + j) * size(2) + k; }
    Vec at(int i, int j, int k) const { return {axis_[0][i], axis_[1][j], axis_[2][k]}; }
    bool inside(int i, int j, int k) const { return value_[index(i, j, k)] < 0; }

    Vec crossing(Vec a, Vec b) const {
        const bool start = form_(a) < 0;
        for (int n = 0; n < 24; ++n) {
            const Vec m = mix(a, b, 0.5);
            ((form_(m) < 0) == start ? a : b) = m;
        }
        return mix(a, b, 0.5);
    }

    void addCell(int i, int j, int k) {
        std::array<bool, 8> in{};
        std::array<Vec, 8> corner;
        for (int c = 0; c < 8; ++c) {
            in[c] = inside(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
            corner[c] = at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
        }
        std::array<int, 12> sheet;
        std::iota(sheet.begin(), sheet.end(), 0);
        const auto join = [&](int a, int b) {
            const int from = sheet[b], to = sheet[a];
            for (int& s : sheet)
                if (s == from) s = to;
        };
        for (int a = 0; a < 3; ++a)
            for (int side = 0; side < 2; ++side) {
                const int u = 1 << (a + 1) % 3, v = 1 << (a + 2) % 3, o = side << a;
                const std::array<int, 4> ring{o, o + u, o + u + v, o + v};
                std::vector<int> cut;
                for (int n = 0; n < 4; ++n)
                    if (in[ring[n]] != in[ring[(n + 1) % 4]]) cut.push_back(edgeOf(ring[n], ring[(n + 1) % 4]));
                if (cut.size() == 2) join(cut[0], cut[1]);
                if (cut.size() == 4) // around the inner corners
                    for (int n = 0; n < 4; ++n)
                        if (in[ring[n]]) join(edgeOf(ring[n], ring[(n + 1) % 4]), edgeOf(ring[(n + 3) % 4], ring[n]));
            }
        std::array<int, 12> point;
        point.fill(-1);
        for (int s = 0; s < 12; ++s) {
            Vec sum;
            int count = 0;
            for (int e = 0; e < 12; ++e)
                if (sheet[e] == s && in[kEdges[e][0]] != in[kEdges[e][1]]) {
                    sum = sum + crossing(corner[kEdges[e][0]], corner[kEdges[e][1]]);
                    ++count;
                    point[e] = static_cast<int>(cage_.points.size());
                }
            if (count > 0) cage_.points.push_back(sum * (1.0 / count));
        }
        cells_.emplace(index(i, j, k), point);
    }

    // The face that crosses the lattice edge from `p` along axis a.
    void addFace(int a, std::array<int, 3> p) {
        std::array<int, 3> q = p;
        ++q[a];
        const bool in = inside(p[0], p[1], p[2]);
        if (in == inside(q[0], q[1], q[2])) return;
        const int u = (a + 1) % 3, v = (a + 2) % 3;
        Quad quad{};
        constexpr std::array<std::array<int, 2>, 4> around{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
        for (int n = 0; n < 4; ++n) {
            std::array<int, 3> cell = p;
            cell[u] -= around[n][0];
            cell[v] -= around[n][1];
            const int low = around[n][0] << u | around[n][1] << v;
            quad[n] = cells_.at(index(cell[0], cell[1], cell[2]))[edgeOf(low, low + (1 << a))];
        }
        if (!in) std::swap(quad[1], quad[3]);
        cage_.faces.push_back(quad);
        cage_.parts.push_back(form_.part(crossing(at(p[0], p[1], p[2]), at(q[0], q[1], q[2]))));
    }

    const Form& form_;
    std::array<std::vector<double>, 3> axis_{
        lines(-16, 16, [](double x) { return std::abs(x) < 8.8 ? 0.8 : 1.1; }),
        lines(-1.5, 27.5, [](double y) { return y < 2.5  ? 0.66
                                                : y < 14 ? 0.98
                                                         : 0.75; }),
        lines(-14, 15, [](double z) { return z < 2.5 ? 1.05 : 0.72; })};
    std::vector<double> value_;
    std::unordered_map<std::size_t, std::array<int, 12>> cells_;
    Cage cage_;
};

// Moves the points of a cage until its limit surface lies on the form.
class Fit {
  public:
    Fit(Cage& cage, const Form& form) : cage_(cage), form_(form), star_(cage.points.size()) {
        for (std::size_t f = 0; f < cage.faces.size(); ++f)
            for (int c = 0; c < 4; ++c) {
                Star& s = star_[cage.faces[f][c]];
                s.next.push_back(cage.faces[f][(c + 1) % 4]);
                s.across.push_back(cage.faces[f][(c + 2) % 4]);
            }
        for (const auto& [e, sharpness] : cage.creases)
            for (int i = 0; i < 2; ++i) star_[e[i]].sharp.push_back(e[1 - i]);
        for (const auto& [e, faces] : edgeFaces(cage))
            if (cage.creases.contains(e))
                for (int p : e) star_[p].parts = {cage.parts[faces[0]], cage.parts[faces[1]]};
    }

    void step(double relax, double pull) {
        const std::vector<Vec> old = cage_.points;
        for (std::size_t i = 0; i < old.size(); ++i) {
            const Star& s = star_[i];
            Vec mean;
            const auto& ring = s.sharp.size() == 2 ? s.sharp : s.next;
            for (int n : ring) mean = mean + old[n] * (1.0 / double(ring.size()));
            Vec move = mean - old[i];
            if (s.sharp.size() != 2) {
                const Vec n = form_.normal(old[i]);
                move = move - n * dot(move, n);
            }
            if (s.sharp.size() < 3) cage_.points[i] = old[i] + move * relax;
        }
        const std::vector<Vec> relaxed = cage_.points;
        for (std::size_t i = 0; i < old.size(); ++i) {
            const Star& s = star_[i];
            const Vec l = limit(relaxed, int(i));
            const Vec target = s.sharp.size() >= 2 ? form_.project(l, s.parts[0], s.parts[1]) : form_.project(l);
            cage_.points[i] = relaxed[i] + (target - l) * pull;
        }
    }

  private:
    struct Star {
        std::vector<int> next, across, sharp;
        std::array<Part, 2> parts{};
    };

    Vec limit(const std::vector<Vec>& p, int i) const {
        const Star& s = star_[i];
        if (s.sharp.size() >= 3) return p[i];
        if (s.sharp.size() == 2) return p[i] * (2.0 / 3) + (p[s.sharp[0]] + p[s.sharp[1]]) * (1.0 / 6);
        const double n = double(s.next.size());
        Vec sum = p[i] * (n * n);
        for (int k : s.next) sum = sum + p[k] * 4;
        for (int k : s.across) sum = sum + p[k];
        return sum * (1 / (n * (n + 5)));
    }

    Cage& cage_;
    const Form& form_;
    std::vector<Star> star_;
};

int sharpness(Part a, Part b) {
    if (a == b) return 0;
    if (a == kSocket || b == kSocket) return 2;
    if (a == kJaw || b == kJaw) return 3;
    return 0;
}

} // namespace

std::map<Edge, std::array<int, 2>> edgeFaces(const Cage& cage) {
    std::map<Edge, std::array<int, 2>> out;
    for (std::size_t f = 0; f < cage.faces.size(); ++f)
        for (int c = 0; c < 4; ++c) {
            const int a = cage.faces[f][c], b = cage.faces[f][(c + 1) % 4];
            auto& beside = out.try_emplace(edge(a, b), std::array{-1, -1}).first->second[a < b ? 0 : 1];
            if (a == b || beside >= 0) throw std::runtime_error("the cage is not manifold");
            beside = int(f);
        }
    for (const auto& [e, faces] : out)
        if (faces[0] < 0 || faces[1] < 0) throw std::runtime_error("the cage is not closed");
    return out;
}

// A lattice now and then meets the form so that two sheets share an edge; another place of the lattice helps.
Cage closedNet(const Form& form) {
    for (int n = 0; n < 20; ++n) {
        Cage cage = Net(form, {0.05 * n, 0.03 * n, 0.07 * n}).cage();
        try {
            edgeFaces(cage);
            return cage;
        } catch (const std::runtime_error&) {
        }
    }
    throw std::runtime_error("no lattice gives a manifold cage");
}

Cage makeCage() {
    Cage cage = closedNet(Form(0.2));
    for (const auto& [e, faces] : edgeFaces(cage))
        if (const int s = sharpness(cage.parts[faces[0]], cage.parts[faces[1]])) cage.creases[e] = s;
    const Form form;
    Fit fit(cage, form);
    for (int i = 0; i < 40; ++i) fit.step(i < 30 ? 0.3 : 0.1, 0.6);
    for (int i = 0; i < 10; ++i) fit.step(0, 0.5);
    return cage;
}

Cage subdivide(const Cage& cage) {
    Cage out;
    const int corners = int(cage.points.size()), middles = corners, rims = middles + int(cage.faces.size());
    out.points.resize(rims);
    std::vector<Vec> faceSum(corners), edgeSum(corners), sharpSum(corners);
    std::vector<int> valence(corners), sharp(corners);
    for (std::size_t f = 0; f < cage.faces.size(); ++f) {
        Vec m;
        for (int p : cage.faces[f]) m = m + cage.points[p] * 0.25;
        out.points[middles + f] = m;
        for (int p : cage.faces[f]) faceSum[p] = faceSum[p] + m;
    }
    std::map<Edge, int> rim;
    for (const auto& [e, faces] : edgeFaces(cage)) {
        const Vec a = cage.points[e[0]], b = cage.points[e[1]], mid = mix(a, b, 0.5);
        const auto crease = cage.creases.find(e);
        const int s = crease == cage.creases.end() ? 0 : crease->second, n = int(out.points.size());
        rim[e] = n;
        out.points.push_back(
            s > 0 ? mid : mix(mid, mix(out.points[middles + faces[0]], out.points[middles + faces[1]], 0.5), 0.5));
        for (int i = 0; i < 2; ++i) {
            ++valence[e[i]];
            edgeSum[e[i]] = edgeSum[e[i]] + mid;
            sharp[e[i]] += s > 0;
            if (s > 0) sharpSum[e[i]] = sharpSum[e[i]] + cage.points[e[1 - i]];
            if (s > 1) out.creases[edge(e[i], n)] = s - 1;
        }
    }
    for (int i = 0; i < corners; ++i) {
        const double n = valence[i];
        if (sharp[i] >= 3)
            out.points[i] = cage.points[i];
        else if (sharp[i] == 2)
            out.points[i] = cage.points[i] * 0.75 + sharpSum[i] * 0.125;
        else
            out.points[i] = (faceSum[i] * (1 / n) + edgeSum[i] * (2 / n) + cage.points[i] * (n - 3)) * (1 / n);
    }
    for (std::size_t f = 0; f < cage.faces.size(); ++f) {
        const Quad& q = cage.faces[f];
        for (int c = 0; c < 4; ++c) {
            const int next = (c + 1) % 4, last = (c + 3) % 4;
            out.faces.push_back({q[c], rim[edge(q[c], q[next])], middles + int(f), rim[edge(q[last], q[c])]});
            out.parts.push_back(cage.parts[f]);
            if (cage.uvs.empty()) continue;
            const auto& t = cage.uvs[f];
            out.uvs.push_back(
                {t[c], (t[c] + t[next]) * 0.5, (t[0] + t[1] + t[2] + t[3]) * 0.25, (t[last] + t[c]) * 0.5});
        }
    }
    return out;
}

} // namespace dragon
