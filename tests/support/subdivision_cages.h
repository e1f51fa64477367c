// Small cages written by hand.
#pragma once

#include "math/mesh_data.h"

#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace abbe::test {

inline void addFace(SubdivisionCage& cage, std::initializer_list<std::uint32_t> corners) {
    cage.faceSizes.push_back(static_cast<std::uint32_t>(corners.size()));
    cage.corners.insert(cage.corners.end(), corners);
}

inline SubdivisionCage cubeCage() {
    SubdivisionCage c;
    for (int i = 0; i < 8; ++i) c.positions.push_back({i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f});
    addFace(c, {0, 2, 3, 1});
    addFace(c, {4, 5, 7, 6});
    addFace(c, {0, 1, 5, 4});
    addFace(c, {2, 6, 7, 3});
    addFace(c, {0, 4, 6, 2});
    addFace(c, {1, 3, 7, 5});
    return c;
}

// Every edge of the cube as sharp as this.
inline SubdivisionCage creasedCube(float sharpness) {
    SubdivisionCage c = cubeCage();
    for (std::uint32_t i = 0; i < 8; ++i)
        for (const std::uint32_t bit : {1u, 2u, 4u})
            if (!(i & bit)) c.creases.push_back({i, i | bit, sharpness});
    return c;
}

// A cube with a texture of six separate squares: every edge is a seam.
inline SubdivisionCage seamedCube() {
    SubdivisionCage c = cubeCage();
    for (std::uint32_t f = 0; f < 6; ++f)
        for (std::uint32_t i = 0; i < 4; ++i) {
            const auto x = static_cast<float>(f);
            c.uvs.push_back({x + (i == 1 || i == 2 ? 0.9f : 0.f), i >= 2 ? 1.f : 0.f});
            c.uvCorners.push_back(4 * f + i);
        }
    return c;
}

// An apex above a polygon of `valence` corners, and the polygon: closed.
inline SubdivisionCage pyramidCage(std::uint32_t valence) {
    SubdivisionCage c;
    c.positions.push_back({0, 0, 1});
    for (std::uint32_t i = 0; i < valence; ++i) {
        const double phi = 2 * kPiD * i / valence;
        c.positions.push_back(Vec3(Vec3d(std::cos(phi), std::sin(phi), 0)));
    }
    for (std::uint32_t i = 0; i < valence; ++i) addFace(c, {0, 1 + i, 1 + (i + 1) % valence});
    c.faceSizes.push_back(valence);
    for (std::uint32_t i = valence; i > 0; --i) c.corners.push_back(i);
    return c;
}

// A dome of quads about one vertex of the given valence, two rings.
inline SubdivisionCage domeCage(std::uint32_t valence) {
    SubdivisionCage c;
    c.positions.push_back({0, 0, 1});
    const auto ring = [&](double radius, double height, double turn) {
        for (std::uint32_t i = 0; i < valence; ++i) {
            const double phi = 2 * kPiD * (i + turn) / valence;
            // Not round, so that normals are no symmetry's gift.
            const double r = radius * (1 + 0.1 * std::cos(2 * phi));
            c.positions.push_back(Vec3(Vec3d(r * std::cos(phi), r * std::sin(phi), height + 0.05 * std::sin(phi))));
        }
    };
    ring(0.5, 0.9, 0);
    ring(0.6, 0.8, 0.5);
    ring(1, 0.4, 0);
    ring(1.1, 0.3, 0.5);
    const std::uint32_t n = valence;
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = (i + 1) % n;
        addFace(c, {0, 1 + i, 1 + n + i, 1 + j});
        addFace(c, {1 + i, 1 + 2 * n + i, 1 + 3 * n + i, 1 + n + i});
        addFace(c, {1 + n + i, 1 + 3 * n + i, 1 + 2 * n + j, 1 + j});
    }
    return c;
}

// n x n quads over a wavy square, none of them flat.
inline SubdivisionCage gridCage(std::uint32_t n) {
    SubdivisionCage c;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
            const double x = i, y = j;
            c.positions.push_back(Vec3(Vec3d(x, y, 0.4 * std::sin(1.3 * x + 0.7 * y * y))));
        }
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i;
            addFace(c, {a, a + 1, a + n + 2, a + n + 1});
        }
    return c;
}

inline SubdivisionCage tetrahedronCage() {
    SubdivisionCage c;
    c.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    addFace(c, {0, 1, 2});
    addFace(c, {0, 2, 3});
    addFace(c, {0, 3, 1});
    addFace(c, {1, 3, 2});
    c.scheme = SubdivisionCage::Scheme::loop;
    return c;
}

inline SubdivisionCage icosahedronCage() {
    SubdivisionCage c;
    const float g = 1.618034f;
    c.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    c.corners = {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4,  11, 10, 2,  10, 7, 6, 7, 1, 8,
                 3, 9,  4, 3, 4, 2, 3, 2, 6, 3, 6, 8,  3, 8,  9,  4, 9, 5, 2, 4,  11, 6,  2,  10, 8,  6, 7, 9, 8, 1};
    c.faceSizes.assign(20, 3);
    c.scheme = SubdivisionCage::Scheme::loop;
    return c;
}

struct NamedCage {
    std::string name;
    SubdivisionCage cage;
    bool closed = true;
};

inline std::vector<NamedCage> namedCages() {
    std::vector<NamedCage> all{{"cube", cubeCage()},
                               {"cube, creases 2.5", creasedCube(2.5f)},
                               {"cube, creases 10", creasedCube(10)},
                               {"cube, seams", seamedCube()},
                               {"pyramid 3", pyramidCage(3)},
                               {"pyramid 5", pyramidCage(5)},
                               {"pyramid 8", pyramidCage(8)},
                               {"tetrahedron", tetrahedronCage()},
                               {"icosahedron", icosahedronCage()}};
    for (const auto boundary : {SubdivisionCage::Boundary::none, SubdivisionCage::Boundary::edgeOnly,
                                SubdivisionCage::Boundary::edgeAndCorner}) {
        all.push_back({"grid " + std::to_string(static_cast<int>(boundary)), gridCage(4), false});
        all.back().cage.boundary = boundary;
    }
    all.push_back({"grid with a hole", gridCage(3), false});
    all.back().cage.holes = {4};
    all.push_back({"cube, half a crease and a corner", cubeCage()});
    all.back().cage.creases = {{0, 1, 10}, {1, 3, 10}, {4, 5, 3.5f}};
    all.back().cage.sharpCorners = {{6, 10}, {7, 1.5f}};
    all.push_back({"cube, chaikin", cubeCage()});
    all.back().cage.creases = {{0, 1, 3}, {1, 3, 1}, {3, 2, 2}};
    all.back().cage.creasing = SubdivisionCage::Creasing::chaikin;
    all.push_back({"bilinear cube", cubeCage()});
    all.back().cage.scheme = SubdivisionCage::Scheme::bilinear;
    all.push_back({"icosahedron, creases", icosahedronCage()});
    all.back().cage.creases = {{0, 11, 10}, {11, 5, 10}, {5, 1, 2}};
    return all;
}

} // namespace abbe::test
