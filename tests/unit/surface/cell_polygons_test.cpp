#include "surface/mesh/cell_polygons.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace treacle::surface {
namespace {

// Random values of every pattern of signs: most of the ambiguous faces come up joined and parted.
template <class Visit>
void for_each_case(const Visit& visit) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int signs = 0; signs < 256; ++signs) {
        for (int repeat = 0; repeat < 400; ++repeat) {
            double value[8];
            for (int c = 0; c < 8; ++c) value[c] = (signs >> c & 1 ? 1 : -1) * (std::pow(uniform(random), 3) + 1e-3);
            visit(value);
        }
    }
}

TEST(CellPolygons, EdgesAndCornersAreNumberedConsistently) {
    for (int e = 0; e < 12; ++e) {
        EXPECT_EQ(edge_of(e / 4, edge_corner(e)), e);
        EXPECT_EQ(edge_corner(e) >> (e / 4) & 1, 0);
    }
}

TEST(CellPolygons, AreClosedWhateverTheSigns) {
    for_each_case([](const double value[8]) {
        int next[12], into[12] = {};
        link_edges(value, next);
        for (int e = 0; e < 12; ++e) {
            const int lower = edge_corner(e), upper = lower | 1 << (e / 4);
            EXPECT_EQ(next[e] >= 0, (value[lower] > 0) != (value[upper] > 0));
            if (next[e] >= 0) ++into[next[e]];
        }
        for (int e = 0; e < 12; ++e) EXPECT_EQ(into[e], next[e] >= 0 ? 1 : 0);
    });
}

// The segments that a cell draws on a face are those of its neighbour, turned around.
TEST(CellPolygons, OfNeighboursMeetOnTheirFace) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int repeat = 0; repeat < 20000; ++repeat) {
        double below[8], above[8];
        for (int c = 0; c < 8; ++c) {
            below[c] = uniform(random);
            above[c] = uniform(random);
        }
        for (int axis = 0; axis < 3; ++axis) {
            for (int c = 0; c < 8; ++c) {
                if ((c >> axis & 1) == 0) above[c] = below[c | 1 << axis];
            }
            int next_below[12], next_above[12];
            link_edges(below, next_below);
            link_edges(above, next_above);
            const auto on = [&](int e, int side) { return e >= 0 && (edge_faces(e) >> (2 * axis + side) & 1) != 0; };
            const auto across = [&](int e) { return edge_of(e / 4, edge_corner(e) ^ 1 << axis); };
            for (int e = 0; e < 12; ++e) {
                if (!on(e, 1) || !on(next_below[e], 1)) continue;
                EXPECT_EQ(next_above[across(next_below[e])], across(e));
            }
        }
    }
}

TEST(CellPolygons, TrianglesAvoidTheFacesOrTakeOneCentre) {
    for_each_case([](const double value[8]) {
        int next[12], faces[12], n = 0, without = 0;
        link_edges(value, next);
        follow_polygons(
            next, [&](int edge) { faces[n++] = edge_faces(edge); },
            [&] {
                const int edges = n;
                n = 0;
                int triangles[10][3];
                const int count = triangulate_polygon(
                    edges, faces, [](int, int) { return 1.0; }, triangles);
                if (count < 0) {
                    ++without;
                    EXPECT_GE(edges, 8);
                    return;
                }
                ASSERT_EQ(count, edges - 2);
                for (int t = 0; t < count; ++t) {
                    for (int k = 0; k < 3; ++k) {
                        const int i = triangles[t][k], j = triangles[t][(k + 1) % 3];
                        const bool side = (i + 1) % edges == j || (j + 1) % edges == i;
                        EXPECT_TRUE(side || (faces[i] & faces[j]) == 0);
                    }
                }
            });
        EXPECT_LE(without, 1);
    });
}

} // namespace
} // namespace treacle::surface
