// Makes the shapes of the scenes that show caustics:
//
//     g++ -std=c++20 -O2 tools/make_caustic_shapes.cpp -o make_caustic_shapes && ./make_caustic_shapes scenes
//
// Writes, in the folders of the scenes, ring.obj, glass.obj and wine.obj (cages of subdivision surfaces, turned about
// the y axis), lens.obj (a mesh with normals) and brilliant.obj (a cut stone with flat faces). Units are those of the
// scenes.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

namespace {

constexpr double kPi = std::numbers::pi;

struct Point {
    double r, y;
};
using Profile = std::vector<Point>;

class Obj {
  public:
    explicit Obj(const std::string& path) : out_(path) { out_ << "# made by tools/make_caustic_shapes.cpp\n"; }
    int point(double x, double y, double z) {
        write("v", x, y, z);
        return ++points_;
    }
    void normal(double x, double y, double z) { write("vn", x, y, z); }
    void face(const std::vector<int>& corners, bool normals = false) {
        out_ << 'f';
        for (const int c : corners) {
            out_ << ' ' << c;
            if (normals) out_ << "//" << c;
        }
        out_ << '\n';
    }
    // OpenSubdiv's tag: infinitely sharp along the rows' ring.
    void crease(int a, int b) { out_ << "t crease 2/1/0 " << a - 1 << ' ' << b - 1 << " 10.0\n"; }

  private:
    void write(const char* what, double x, double y, double z) {
        char line[128];
        std::snprintf(line, sizeof line, "%s %.5g %.5g %.5g\n", what, x, y, z);
        out_ << line;
    }
    std::ofstream out_;
    int points_ = 0;
};

// A cage around the y axis. The limit of a regular polygon of n points is a curve of radius (2 + cos(2π/n)) / 3 of its
// own, which is made up for. The outer side is to the right of the profile as it goes (r to the right, y upwards).
// `closed`: the last point is joined to the first; else both ends are closed by fans on the axis.
void turnCage(Obj& obj, const Profile& p, bool closed, int around, int sharpRow = -1) {
    const double wider = 3 / (2 + std::cos(2 * kPi / around));
    std::vector<std::vector<int>> rows;
    for (const Point& q : p) {
        auto& row = rows.emplace_back();
        for (int k = 0; k < around; ++k) {
            const double a = 2 * kPi * k / around;
            row.push_back(obj.point(wider * q.r * std::cos(a), q.y, wider * q.r * std::sin(a)));
        }
    }
    const auto band = [&](const std::vector<int>& a, const std::vector<int>& b) {
        for (std::size_t k = 0; k < a.size(); ++k) {
            const std::size_t n = (k + 1) % a.size();
            obj.face({a[k], b[k], b[n], a[n]});
        }
    };
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) band(rows[i], rows[i + 1]);
    if (closed) {
        band(rows.back(), rows.front());
        return;
    }
    const int first = obj.point(0, p.front().y, 0), last = obj.point(0, p.back().y, 0);
    for (std::size_t k = 0; k < rows[0].size(); ++k) {
        const std::size_t n = (k + 1) % rows[0].size();
        obj.face({first, rows.front()[k], rows.front()[n]});
        obj.face({rows.back()[k], last, rows.back()[n]});
        if (sharpRow >= 0)
            obj.crease(rows[static_cast<std::size_t>(sharpRow)][k], rows[static_cast<std::size_t>(sharpRow)][n]);
    }
}

// A wedding band: upright inside, vaulted outside, mm.
void makeRing(const std::string& folder) {
    Obj obj(folder + "/gold-ring/ring.obj");
    Profile p;
    for (const double y : {4.0, 3.2, 2.4, 1.6, 0.8, 0.0}) p.push_back({9.25, y});
    for (const double y : {0.0, 0.8, 1.6, 2.4, 3.2, 4.0}) p.push_back({10.5 + 0.5 * std::sin(kPi * y / 4), y});
    turnCage(obj, p, true, 32);
}

// A glass for red wine and the wine in it, cm. The side of the wine lies in the wall of the glass, which is the
// stronger.
void makeWineGlass(const std::string& folder) {
    const Profile outside = {{0.05, 0.15}, {1.5, 0.12}, {3.0, 0.03},  {3.6, 0.0},   {3.75, 0.12}, {3.3, 0.28},
                             {1.8, 0.42},  {0.7, 0.75}, {0.40, 1.5},  {0.36, 3.0},  {0.36, 5.5},  {0.40, 7.6},
                             {0.75, 8.6},  {1.9, 9.2},  {3.2, 10.2},  {4.05, 11.8}, {4.3, 13.6},  {4.1, 15.6},
                             {3.65, 17.6}, {3.3, 19.0}, {3.24, 19.25}};
    const Profile inside = {{3.15, 19.3},  {3.10, 19.15}, {3.48, 17.6}, {3.93, 15.6}, {4.12, 13.6},
                            {3.87, 11.88}, {3.02, 10.38}, {1.8, 9.42},  {0.8, 9.02},  {0.05, 8.95}};
    Profile glass = outside;
    glass.insert(glass.end(), inside.begin(), inside.end());
    Obj glassObj(folder + "/wine-glass/glass.obj");
    turnCage(glassObj, glass, false, 16);
    const Profile wine = {{0.05, 8.87}, {0.8, 8.92},   {1.84, 9.32}, {3.1, 10.29}, {3.92, 11.84}, {3.99, 12.4},
                          {4.02, 12.6}, {4.02, 12.61}, {3.9, 12.61}, {2.0, 12.61}, {0.05, 12.61}};
    Obj wineObj(folder + "/wine-glass/wine.obj");
    turnCage(wineObj, wine, false, 16, 7);
}

// A lens whose faces are spheres of the radii `upper` and `lower` (0: flat) and whose rim is `edge` thick, with
// normals.
void makeLens(const std::string& path, double radius, double upper, double lower, double edge, int rows, int around) {
    Obj obj(path);
    const auto ring = [&](double r, double y, double nr, double ny) {
        std::vector<int> row;
        for (int k = 0; k < around; ++k) {
            const double a = 2 * kPi * k / around;
            row.push_back(obj.point(r * std::cos(a), y, r * std::sin(a)));
            obj.normal(nr * std::cos(a), ny, nr * std::sin(a));
        }
        return row;
    };
    const auto band = [&](const std::vector<int>& a, const std::vector<int>& b) {
        for (std::size_t k = 0; k < a.size(); ++k) {
            const std::size_t n = (k + 1) % a.size();
            obj.face({a[k], b[k], b[n], a[n]}, true);
        }
    };
    // `side` 1: the upper face, from the axis to the rim.
    const auto cap = [&](double curvature, double side) {
        std::vector<int> before;
        const auto height = [&](double r) { return curvature > 0 ? std::sqrt(curvature * curvature - r * r) : 0; };
        const int middle = obj.point(0, side * (edge / 2 + height(0) - height(radius)), 0);
        obj.normal(0, side, 0);
        for (int i = 1; i <= rows; ++i) {
            const double r = radius * i / rows, slope = curvature > 0 ? r / curvature : 0;
            const auto row =
                ring(r, side * (edge / 2 + height(r) - height(radius)), slope, side * std::sqrt(1 - slope * slope));
            if (i == 1)
                for (std::size_t k = 0; k < row.size(); ++k) {
                    const int a = row[k], b = row[(k + 1) % row.size()];
                    side > 0 ? obj.face({middle, b, a}, true) : obj.face({middle, a, b}, true);
                }
            else
                side > 0 ? band(row, before) : band(before, row);
            before = row;
        }
    };
    cap(upper, 1);
    cap(lower, -1);
    band(ring(radius, -edge / 2, 1, 0), ring(radius, edge / 2, 1, 0));
}

// The round brilliant after Tolkowsky: crown 34.5°, pavilion 40.75°, table 53 %, for a girdle of radius 1
// [Tolkowsky1919].
void makeBrilliant(const std::string& folder) {
    Obj obj(folder + "/diamond/brilliant.obj");
    const double crown = std::tan(34.5 * kPi / 180), pavilion = std::tan(40.75 * kPi / 180), girdle = 0.03;
    const auto ring = [&](double r, double y, int count, double turn) {
        std::vector<int> row;
        for (int i = 0; i < count; ++i) {
            const double a = 2 * kPi * (i + turn) / count;
            row.push_back(obj.point(r * std::cos(a), y, -r * std::sin(a)));
        }
        return row;
    };
    // Kites are flat: their side corners lie in the plane of the main facet, between two of them.
    const double between = std::cos(kPi / 8), star = 0.78, lower = 0.25;
    const auto table = ring(0.53, girdle + crown * 0.47, 8, 0);
    const auto side = ring(star, girdle + crown * (1 - star * between), 8, 0.5);
    const auto top = ring(1, girdle, 16, 0), bottom = ring(1, -girdle, 16, 0);
    const auto low = ring(lower, -girdle - pavilion * (1 - lower * between), 8, 0.5);
    const int culet = obj.point(0, -girdle - pavilion, 0);
    obj.face(table);
    for (std::size_t i = 0; i < 8; ++i) {
        const std::size_t n = (i + 1) % 8, g = 2 * i, h = 2 * i + 1, j = (2 * i + 2) % 16;
        obj.face({table[i], side[i], table[n]});
        obj.face({table[n], side[i], top[j], side[n]});
        obj.face({side[i], top[g], top[h]});
        obj.face({side[i], top[h], top[j]});
        obj.face({top[g], bottom[g], bottom[h], top[h]});
        obj.face({top[h], bottom[h], bottom[j], top[j]});
        obj.face({bottom[g], low[i], bottom[h]});
        obj.face({bottom[h], low[i], bottom[j]});
        obj.face({culet, low[n], bottom[j], low[i]});
    }
}

} // namespace

int main(int count, char** arguments) {
    if (count != 2) return std::fputs("usage: make_caustic_shapes FOLDER\n", stderr), 2;
    const std::string folder = arguments[1];
    makeRing(folder);
    makeWineGlass(folder);
    makeBrilliant(folder);
    makeLens(folder + "/magnifier/lens.obj", 40, 155, 155, 2, 16, 64); // mm
    makeLens(folder + "/lens-array/lens.obj", 12, 30, 0, 1.5, 12, 48); // mm
}
