// Makes the tumbler of scenes/milk-and-juice and what it holds:
//
//     g++ -std=c++20 -O2 tools/make_glass.cpp -o make_glass && ./make_glass scenes/milk-and-juice
//
// Writes glass.obj and drink.obj, turned about the y axis, in centimetres. Glass and drink share the surface where they
// touch, once: it belongs to the drink (group `contact`; the rest of it is the group `top`). The glass is the rest of
// its own surface.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

namespace {

constexpr int kSegments = 96;

struct Point {
    double r, y;
};
using Profile = std::vector<Point>;

// Adds a quarter of an ellipse from `from` to `to` that leaves along r or along y.
void bend(Profile& p, Point from, Point to, bool alongR, int steps) {
    const bool joined = !p.empty() && p.back().r == from.r && p.back().y == from.y;
    for (int i = joined ? 1 : 0; i <= steps; ++i) {
        const double a = i * std::numbers::pi / 2 / steps, s = std::sin(a), c = 1 - std::cos(a);
        p.push_back({from.r + (to.r - from.r) * (alongR ? s : c), from.y + (to.y - from.y) * (alongR ? c : s)});
    }
}

class Obj {
  public:
    explicit Obj(const std::string& path) : out_(path) { out_ << "# made by tools/make_glass.cpp\n"; }

    void group(const char* name) { out_ << "g " << name << '\n'; }

    // The outer side is to the right of the profile as it goes (r to the right, y upwards). A profile that starts where
    // the last one ended shares its points.
    void turn(const Profile& p) {
        std::vector<int> rows;
        for (const Point& q : p) {
            if (rows.empty() && !ends_.empty() && q.r == last_.r && q.y == last_.y)
                rows.push_back(ends_.back());
            else
                rows.push_back(addPoints(q));
        }
        const int firstNormal = normals_ + 1;
        for (std::size_t i = 0; i < p.size(); ++i) addNormals(p[i > 0 ? i - 1 : i], p[i + 1 < p.size() ? i + 1 : i]);
        for (std::size_t i = 0; i + 1 < p.size(); ++i)
            for (int k = 0; k < kSegments; ++k) {
                const int next = (k + 1) % kSegments, normal = firstNormal + static_cast<int>(i) * kSegments;
                out_ << 'f';
                corner(rows[i], p[i], k, normal + k);
                corner(rows[i + 1], p[i + 1], k, normal + kSegments + k);
                if (p[i + 1].r > 0) corner(rows[i + 1], p[i + 1], next, normal + kSegments + next);
                if (p[i].r > 0) corner(rows[i], p[i], next, normal + next);
                out_ << '\n';
            }
        last_ = p.back();
        ends_ = rows;
    }

  private:
    void write(const char* what, double a, double b, double c) {
        char line[128];
        std::snprintf(line, sizeof line, "%s %.4f %.4f %.4f\n", what, a, b, c);
        out_ << line;
    }

    // The number of the first; on the axis there is only one.
    int addPoints(Point p) {
        const int first = points_ + 1, n = p.r > 0 ? kSegments : 1;
        for (int k = 0; k < n; ++k) write("v", p.r * std::cos(angle(k)), p.y, p.r * std::sin(angle(k)));
        points_ += n;
        return first;
    }

    // Across the line from `a` to `b`.
    void addNormals(Point a, Point b) {
        const double length = std::hypot(b.r - a.r, b.y - a.y), nr = (b.y - a.y) / length, ny = -(b.r - a.r) / length;
        for (int k = 0; k < kSegments; ++k) write("vn", nr * std::cos(angle(k)), ny, nr * std::sin(angle(k)));
        normals_ += kSegments;
    }

    void corner(int row, Point p, int k, int normal) { out_ << ' ' << row + (p.r > 0 ? k : 0) << "//" << normal; }

    static double angle(int k) { return 2 * std::numbers::pi * k / kSegments; }

    std::ofstream out_;
    int points_ = 0, normals_ = 0;
    Point last_{};
    std::vector<int> ends_;
};

} // namespace

int main(int count, char** arguments) {
    if (count != 2) return std::fputs("usage: make_glass FOLDER\n", stderr), 2;
    const std::string folder = arguments[1];

    constexpr double kFill = 8.6; // height of the drink where it meets the glass, which it climbs by 0.12 cm
    Profile outside{{0, 0.15}};
    bend(outside, {2.5, 0.15}, {2.65, 0}, true, 4); // a hollow foot
    bend(outside, {2.75, 0}, {3.1, 0.35}, true, 6);
    outside.push_back({3.3, 6});
    outside.push_back({3.44, 10.9});
    bend(outside, {3.44, 11.0}, {3.37, 11.07}, false, 4); // the rim
    bend(outside, {3.37, 11.07}, {3.27, 11.0}, true, 4);
    outside.push_back({3.26, 10.9});
    outside.push_back({3.19, kFill});

    Profile contact{{0, 1.0}};
    bend(contact, {2.2, 1.0}, {2.93, 1.7}, true, 8);
    contact.push_back({3.1, 6});
    contact.push_back({3.19, kFill});
    Profile top;
    bend(top, {3.19, kFill}, {2.95, kFill - 0.12}, false, 6);
    top.push_back({0, kFill - 0.12});

    Obj glass(folder + "/glass.obj");
    glass.turn(outside);
    Obj drink(folder + "/drink.obj");
    drink.group("contact");
    drink.turn(contact);
    drink.group("top");
    drink.turn(top);
}
