#pragma once
#include "video/film/film_raster.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace treacle::video::test {

struct Ball {
    std::vector<double> position, normal, velocity;
    std::vector<std::array<int, 3>> triangles;

    FilmMesh mesh() const { return {3, position, normal, velocity, triangles}; }
};

// An octahedron, each triangle cut into four, `rounds` times; triangles counter-clockwise from outside.
inline Ball make_ball(const Vec3& centre, double radius, int rounds, const Vec3& velocity = {0, 0, 0}) {
    std::vector<Vec3> points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    std::vector<std::array<int, 3>> triangles = {
        {0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int round = 0; round < rounds; ++round) {
        std::map<std::pair<int, int>, int> middles;
        const auto middle = [&](int a, int b) {
            const auto key = std::minmax(a, b);
            if (const auto found = middles.find(key); found != middles.end()) return found->second;
            Vec3 m;
            double square = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                m[k] = points[std::size_t(a)][k] + points[std::size_t(b)][k];
                square += m[k] * m[k];
            }
            for (auto& v : m) v /= std::sqrt(square);
            points.push_back(m);
            return middles[key] = int(points.size()) - 1;
        };
        std::vector<std::array<int, 3>> finer;
        for (const auto& [a, b, c] : triangles) {
            const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        triangles = finer;
    }
    Ball ball;
    for (const auto& p : points)
        for (std::size_t k = 0; k < 3; ++k) {
            ball.position.push_back(centre[k] + radius * p[k]);
            ball.normal.push_back(p[k]);
            ball.velocity.push_back(velocity[k]);
        }
    ball.triangles = triangles;
    return ball;
}

} // namespace treacle::video::test
