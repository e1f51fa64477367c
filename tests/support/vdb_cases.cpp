// Writes files of grids for the tests of volumes:  vdb_cases OUT.vdb   awkward ones
//                                                 vdb_cases OUT.nvdb  NanoVDB, the segments packed in three ways
#include <cmath>
#include <fstream>
#include <limits>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/openvdb.h>
#include <string_view>
#include <vector>

#define NANOVDB_USE_BLOSC
#define NANOVDB_USE_ZIP
#include <nanovdb/util/IO.h>

namespace {

using namespace openvdb;

template <typename GridType> typename GridType::Ptr named(const char* name, GridClass c = GRID_FOG_VOLUME) {
    auto grid = GridType::create();
    grid->setName(name);
    grid->setGridClass(c);
    return grid;
}

// 4³ active voxels of the given value.
template <typename GridType> typename GridType::Ptr block(const char* name, typename GridType::ValueType value) {
    auto grid = named<GridType>(name);
    grid->fill(CoordBBox(Coord(0), Coord(3)), value);
    return grid;
}

FloatGrid::Ptr spoilt() {
    auto grid = block<FloatGrid>("spoilt", 1.f);
    auto a = grid->getAccessor();
    a.setValue(Coord(0, 0, 0), std::numeric_limits<float>::quiet_NaN());
    a.setValue(Coord(1, 0, 0), std::numeric_limits<float>::infinity());
    a.setValue(Coord(2, 0, 0), -2.f);
    a.setValueOff(Coord(50, 0, 0), 7.f);
    return grid;
}

// Tiles of 8³, 128³ and 4096³ voxels, one of them sound.
FloatGrid::Ptr spoiltTiles() {
    auto grid = named<FloatGrid>("spoilt-tiles");
    grid->tree().addTile(1, Coord(0, 0, 0), std::numeric_limits<float>::quiet_NaN(), true);
    grid->tree().addTile(1, Coord(8, 0, 0), 2.f, true);
    grid->tree().addTile(2, Coord(128, 0, 0), -2.f, true);
    grid->tree().addTile(3, Coord(4096, 0, 0), std::numeric_limits<float>::infinity(), true);
    return grid;
}

// A tile and a voxel of vectors.
Vec3DGrid::Ptr gale() {
    auto grid = named<Vec3DGrid>("gale");
    grid->tree().addTile(1, Coord(0, 0, 0), Vec3d(1, 2, 3), true);
    grid->getAccessor().setValue(Coord(20, 0, 0), Vec3d(4, 5, 6));
    return grid;
}

FloatGrid::Ptr withBackground() {
    auto grid = FloatGrid::create(0.5f);
    grid->setName("background");
    grid->fill(CoordBBox(Coord(0), Coord(3)), 1.f);
    return grid;
}

FloatGrid::Ptr farApart(const char* name, int distance) {
    auto grid = named<FloatGrid>(name);
    auto a = grid->getAccessor();
    a.setValue(Coord(0, 0, 0), 1.f);
    a.setValue(Coord(distance, 0, 0), 2.f);
    a.setValue(Coord(-5, distance, -distance), 3.f);
    return grid;
}

// Active tiles of the root, each 4096³ voxels.
FloatGrid::Ptr vast() {
    auto grid = named<FloatGrid>("vast");
    for (int i = 0; i < 20; ++i) grid->tree().addTile(3, Coord(4096 * i, 0, 0), 1.f, true);
    return grid;
}

FloatGrid::Ptr placed(const char* name, const math::MapBase::Ptr& map) {
    auto grid = block<FloatGrid>(name, 1.f);
    grid->setTransform(std::make_shared<math::Transform>(map));
    return grid;
}

GridBase::Ptr turned() {
    auto grid = block<FloatGrid>("turned", 1.f);
    auto transform = math::Transform::createLinearTransform(0.5);
    transform->postRotate(M_PI / 2, math::Z_AXIS);
    transform->postTranslate(Vec3d(10, 20, 30));
    grid->setTransform(transform);
    return grid;
}

// What differs from voxel to voxel, beside a tile of 8³ and one of 128³, far from them a single voxel, half a metre a
// voxel and turned.
FloatGrid::Ptr varied() {
    auto grid = named<FloatGrid>("density");
    auto a = grid->getAccessor();
    for (int i = 0; i < 20; ++i) a.setValue(Coord(i - 3, 2 * i, i % 3), 0.125f + 0.25f * static_cast<float>(i));
    grid->tree().addTile(1, Coord(64, 0, 0), 2.f, true);
    grid->tree().addTile(2, Coord(256, 0, 0), 3.f, true);
    a.setValue(Coord(-5000, 9000, 12000), 4.f);
    grid->setTransform(turned()->transformPtr());
    return grid;
}

template <typename Build, typename GridType> auto nano(const GridType& grid, const char* name) {
    auto copy = grid.deepCopy();
    copy->setName(name);
    nanovdb::OpenToNanoVDB<typename GridType::ValueType, Build> convert;
    return convert(*copy);
}

int writeNano(const char* path) {
    using nanovdb::io::Codec;
    using Handles = std::vector<nanovdb::GridHandle<nanovdb::HostBuffer>>;
    std::ofstream file(path, std::ios::binary);
    const auto density = varied();
    Handles plain, zipped, blosc;
    plain.push_back(nano<float>(*density, "density"));
    plain.push_back(nano<nanovdb::Fp16>(*density, "half"));
    plain.push_back(nano<nanovdb::Vec3f>(*block<Vec3SGrid>("wind", Vec3s(1, 2, 3)), "wind"));
    zipped.push_back(nano<float>(*density, "zipped"));
    blosc.push_back(nano<float>(*density, "blosc"));
    blosc.push_back(nano<nanovdb::FpN>(*density, "packed"));
    nanovdb::io::writeGrids(file, plain, Codec::NONE);
    nanovdb::io::writeGrids(file, zipped, Codec::ZIP);
    nanovdb::io::writeGrids(file, blosc, Codec::BLOSC);
    return file ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    initialize();
    if (std::string_view(argv[1]).ends_with(".nvdb")) return writeNano(argv[1]);
    auto frustum = std::make_shared<math::NonlinearFrustumMap>(BBoxd(Vec3d(0), Vec3d(10)), 0.5, 10.0);
    GridPtrVec grids{spoilt(),
                     withBackground(),
                     farApart("far", 1'000'000),
                     farApart("too-far", 1 << 27),
                     vast(),
                     named<FloatGrid>("empty"),
                     block<DoubleGrid>("double", 0.25),
                     block<Int32Grid>("integer", 3),
                     block<BoolGrid>("mask", true),
                     block<Vec3DGrid>("wind", Vec3d(1, 2, 3)),
                     spoiltTiles(),
                     gale(),
                     placed("frustum", frustum),
                     placed("flat", std::make_shared<math::ScaleMap>(Vec3d(1e-14, 1e17, 1e17))),
                     turned()};
    io::File(argv[1]).write(grids);
    return 0;
}
