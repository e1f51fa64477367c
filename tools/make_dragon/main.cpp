// Makes the geometry of scenes/displaced-dragon:
//
//     g++ -std=c++20 -O2 tools/make_dragon/*.cpp $(pkg-config --cflags --libs OpenEXR) -o make_dragon
//     ./make_dragon scenes/displaced-dragon
//
// dragon.obj is one closed cage of quads with creases, texture coordinates in charts and groups; horns.obj has the
// cages of horns, claws and spines; skin.exr is the relief of the skin. All are the same on every run.
#include "bake.h"
#include "charts.h"
#include "horns.h"

#include <cstdio>
#include <stdexcept>

namespace {

using namespace dragon;

constexpr int kSize = 1280;             // texels
constexpr double kRange = 0.7;          // cm from black to white
constexpr double kMargin = 5.0 / kSize; // around each chart

// An OBJ file, in hundredths of a centimetre.
class Obj {
  public:
    explicit Obj(const std::string& path) : file_(std::fopen(path.c_str(), "w")) {
        if (!file_) throw std::runtime_error("cannot write " + path);
        std::fputs("# Made by tools/make_dragon. Lengths are centimetres.\n", file_);
    }
    Obj(const Obj&) = delete;
    Obj& operator=(const Obj&) = delete;
    ~Obj() { std::fclose(file_); }

    void points(const Cage& cage) {
        for (Vec p : cage.points) std::fprintf(file_, "v %.2f %.2f %.2f\n", p.x, p.y, p.z);
        for (const auto& corners : cage.uvs)
            for (Vec2 t : corners)
                if (texture_.try_emplace({t.u, t.v}, int(texture_.size()) + 1).second)
                    std::fprintf(file_, "vt %.5f %.5f\n", t.u, t.v);
    }
    void faces(const Cage& cage, const std::string& group, int part) {
        std::fprintf(file_, "g %s\n", group.c_str());
        for (std::size_t f = 0; f < cage.faces.size(); ++f) {
            if (part != kParts && cage.parts[f] != part) continue;
            std::fputc('f', file_);
            for (int c = 0; c < 4; ++c) {
                std::fprintf(file_, " %d", cage.faces[f][c] + first_ + 1);
                if (!cage.uvs.empty()) std::fprintf(file_, "/%d", texture_.at({cage.uvs[f][c].u, cage.uvs[f][c].v}));
            }
            std::fputc('\n', file_);
        }
    }
    void creases(const Cage& cage) {
        for (const auto& [e, sharpness] : cage.creases)
            std::fprintf(file_, "t crease 2/1/0 %d %d %d\n", e[0] + first_, e[1] + first_, sharpness);
        first_ += int(cage.points.size());
    }

  private:
    std::FILE* file_;
    std::map<std::array<double, 2>, int> texture_;
    int first_ = 0;
};

void round(Cage& cage) {
    for (Vec& p : cage.points)
        p = {std::round(p.x * 100) / 100, std::round(p.y * 100) / 100, std::round(p.z * 100) / 100};
}

void make(const std::string& folder) {
    Cage cage = makeCage();
    round(cage);
    const int charts = makeCharts(cage, kMargin);
    std::printf("%zu points, %zu faces, %zu creases, %d charts\n", cage.points.size(), cage.faces.size(),
                cage.creases.size(), charts);
    Obj body(folder + "/dragon.obj");
    body.points(cage);
    const char* const names[kParts] = {"skin", "jaw", "lids", "wings"};
    for (int part = 0; part < kParts; ++part) body.faces(cage, names[part], part);
    body.creases(cage);

    Obj horns(folder + "/horns.obj");
    for (const Group& g : makeHorns()) {
        horns.points(g.cage);
        horns.faces(g.cage, g.name, kParts);
        horns.creases(g.cage);
    }
    for (double s : {-1.0, 1.0}) {
        const Vec eye = fromHead({s * kEye.x, kEye.y, kEye.z});
        std::printf("eye at %.3f %.3f %.3f\n", eye.x, eye.y, eye.z);
    }
    for (int i = 0; i < 3; ++i) cage = subdivide(cage);
    writeExr((folder + "/skin.exr").c_str(), bake(cage, Skin(cage), kSize, kRange), kSize);
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 2) return std::fputs("usage: make_dragon FOLDER\n", stderr), 2;
    try {
        make(argv[1]);
    } catch (const std::exception& e) {
        return std::fprintf(stderr, "%s\n", e.what()), 1;
    }
}
