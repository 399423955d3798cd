#pragma once
#include "surface/mesh/mesher.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>

namespace treacle::surface::test {

using Shape = std::function<bool(const Vec3&)>;

// Particles on a lattice of unit spacing, displaced by up to `jitter` along each axis.
struct Cloud {
    std::vector<double> position, velocity, pressure;
    std::vector<std::int64_t> id, liquid;

    ParticleRows rows() const { return {position, id, velocity, pressure, liquid}; }
    double count() const { return static_cast<double>(id.size()); }
    void add(const Vec3& x) {
        position.insert(position.end(), x.begin(), x.end());
        velocity.insert(velocity.end(), {1 + x[0], 2 - x[1], 0.5 * x[2]});
        pressure.push_back(x[0] + 2 * x[1] - x[2]);
        liquid.push_back(x[0] > 0 ? 1 : 0);
        id.push_back(static_cast<std::int64_t>(id.size()));
    }
    Vec3 centre() const {
        Vec3 sum{0, 0, 0};
        for (std::size_t i = 0; i < position.size(); ++i) sum[i % 3] += position[i];
        for (double& s : sum) s /= std::max(1.0, count());
        return sum;
    }
    // Every ranks-th of them; the rest of the ranks have the others.
    Cloud part(const Comm& comm) const {
        Cloud out;
        for (std::size_t i = 0; i < id.size(); ++i) {
            if (static_cast<int>(i) % comm.size() != comm.rank()) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                out.position.push_back(position[3 * i + k]);
                out.velocity.push_back(velocity[3 * i + k]);
            }
            out.pressure.push_back(pressure[i]);
            out.liquid.push_back(liquid[i]);
            out.id.push_back(id[i]);
        }
        return out;
    }
};

using Rotation = std::array<Vec3, 3>;

inline Rotation random_rotation(std::mt19937& random) {
    std::normal_distribution<double> normal;
    double q[4], length = 0;
    for (double& c : q) length += std::pow(c = normal(random), 2);
    for (double& c : q) c /= std::sqrt(length);
    const auto [w, x, y, z] = std::tie(q[0], q[1], q[2], q[3]);
    return {Vec3{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
        Vec3{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
        Vec3{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
}

// The points of a lattice with its nodes at `offset` + whole numbers that lie in the shape, then turned and displaced.
inline Cloud fill(const Shape& shape, int half, const Vec3& offset, double jitter = 0, const Rotation* turn = nullptr,
    int dimensions = 3, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-jitter, jitter);
    Cloud out;
    const int depth = dimensions == 3 ? half : 0;
    for (int z = -depth; z <= depth; ++z) {
        for (int y = -half; y <= half; ++y) {
            for (int x = -half; x <= half; ++x) {
                Vec3 p{x + offset[0], y + offset[1], dimensions == 3 ? z + offset[2] : 0};
                if (!shape(p)) continue;
                for (int k = 0; k < dimensions; ++k) p[static_cast<std::size_t>(k)] += jitter > 0 ? uniform(random) : 0;
                if (turn != nullptr) {
                    const Vec3 q = p;
                    for (std::size_t k = 0; k < 3; ++k)
                        p[k] = (*turn)[k][0] * q[0] + (*turn)[k][1] * q[1] + (*turn)[k][2] * q[2];
                }
                out.add(p);
            }
        }
    }
    return out;
}

// Directed edges of all ranks together: each must be there once, and once the other way round.
inline bool closed(const Comm& comm, const Mesh& mesh) {
    std::vector<std::int64_t> edges;
    for (const auto& t : mesh.triangles) {
        const int per = mesh.dimensions;
        for (int k = 0; k < (per == 3 ? 3 : 1); ++k) {
            edges.push_back(mesh.global[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])]);
            edges.push_back(mesh.global[static_cast<std::size_t>(t[static_cast<std::size_t>((k + 1) % per)])]);
        }
    }
    const auto all = comm.all_gather(std::span<const std::int64_t>(edges));
    if (mesh.dimensions == 2) {
        std::map<std::int64_t, int> in, out; // each vertex is left once and reached once
        for (std::size_t k = 0; k < all.size(); k += 2) {
            ++out[all[k]];
            ++in[all[k + 1]];
        }
        if (in.size() != out.size()) return false;
        return std::all_of(
            out.begin(), out.end(), [&](const auto& one) { return one.second == 1 && in[one.first] == 1; });
    }
    std::map<std::pair<std::int64_t, std::int64_t>, int> count;
    for (std::size_t k = 0; k < all.size(); k += 2) ++count[{all[k], all[k + 1]}];
    return std::all_of(count.begin(), count.end(), [&](const auto& one) {
        const auto back = count.find({one.first.second, one.first.first});
        return one.second == 1 && back != count.end() && back->second == 1;
    });
}

// Centre of the volume that the surface encloses.
inline Vec3 centroid(const Comm& comm, const Mesh& mesh) {
    double sums[4] = {0, 0, 0, 0};
    for (const auto& t : mesh.triangles) {
        Vec3 x[3];
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t a = 0; a < 3; ++a) x[k][a] = mesh.vertices[3 * static_cast<std::size_t>(t[k]) + a];
        }
        const double v =
            (x[0][0] * (x[1][1] * x[2][2] - x[1][2] * x[2][1]) + x[0][1] * (x[1][2] * x[2][0] - x[1][0] * x[2][2]) +
                x[0][2] * (x[1][0] * x[2][1] - x[1][1] * x[2][0])) /
            6;
        sums[3] += v;
        for (std::size_t a = 0; a < 3; ++a) sums[a] += v * (x[0][a] + x[1][a] + x[2][a]) / 4;
    }
    comm.sum(std::span<double>(sums));
    return {sums[0] / sums[3], sums[1] / sums[3], sums[2] / sums[3]};
}

} // namespace treacle::surface::test
