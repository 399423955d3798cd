#pragma once
#include "grid/geometry/fractions.hpp"
#include "grid/geometry/level_set.hpp"
#include "grid/geometry/seeding.hpp"
#include "grid/transport/apic.hpp"
#include "mpi/halo.hpp"
#include "mpi/migration.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::grid::test {

inline scene::Domain make_domain(int dimensions, Vec3 max, double dx) {
    scene::Domain domain;
    domain.dimensions = dimensions;
    domain.max = max;
    domain.spacing = dx;
    return domain;
}
inline scene::SolidRegion box(const Vec3& min, const Vec3& max, int dimensions) {
    scene::Shape shape;
    shape.kind = scene::ShapeKind::box;
    shape.min = min;
    shape.max = max;
    return scene::SolidRegion(shape, dimensions);
}
inline scene::SolidRegion ball(const Vec3& centre, double radius, int dimensions) {
    scene::Shape shape;
    shape.kind = scene::ShapeKind::sphere;
    shape.centre = centre;
    shape.radius = radius;
    return scene::SolidRegion(shape, dimensions);
}

// Liquid in a domain, shared out among the ranks, with everything around it up to date.
struct Liquid {
    scene::Domain domain;
    MacGrid grid;
    Decomposition decomposition;
    GridParticles particles;
    CellList cells;
    CellHalo faces;
    Halo halo;
    Solids solids;
    rigid::RigidBodies bodies;
    LevelSet surface;
    Array<double> mass{"treacle::particle_mass", 2}; // [kg] of the two liquids

    explicit Liquid(const Comm& comm, const scene::Domain& in, rigid::BodiesSetup setup = {})
        : domain(in), grid(make_mac_grid(in)), decomposition(comm, grid.cells), solids(grid, in),
          bodies(std::move(setup)) {
        Kokkos::deep_copy(mass, 1000 * particle_volume(grid));
    }
    // Seeds the regions, cuts the grid by the particles and shares them out.
    void fill(const Seeding& seeding) {
        seed(seeding, grid, decomposition, particles);
        const auto x = on_host(particles.position());
        std::vector<int> where;
        for (int i = 0; i < particles.store.owned(); ++i) {
            int c[3];
            const auto row = static_cast<std::size_t>(i);
            grid.cells.locate(x(row, 0), x(row, 1), x(row, 2), c);
            where.insert(where.end(), c, c + 3);
        }
        decomposition.repartition(where, std::vector<double>(where.size() / 3, 1.0));
        halo.connect(decomposition);
        settle();
    }
    // After positions have changed: owners, block, ghosts, distances.
    void settle(int band = 4) {
        Migration migration;
        migration.to_owner(particles.store, decomposition);
        CellBox block = occupied_cells(particles.store, grid.cells);
        std::int64_t bounds[6];
        for (int k = 0; k < 3; ++k) {
            bounds[k] = block.empty() ? -1000000 : -block.lo[k];
            bounds[3 + k] = block.empty() ? -1000000 : block.hi[k];
        }
        decomposition.comm().max(std::span<std::int64_t>(bounds));
        for (int k = 0; k < 3; ++k) {
            const int grow = grid.cells.halo_width(k) * band;
            block.lo[k] = std::max(0, static_cast<int>(-bounds[k]) - grow);
            block.hi[k] = std::min(grid.cells.count[k], static_cast<int>(bounds[3 + k]) + grow);
        }
        faces.connect(decomposition, block, 3);
        CellSort sort;
        sort.sort(particles.store, grid.cells, faces.owned(), cells);
        halo.rebuild(particles.store, cells);
        halo.gather(
            particles.store, {particles.velocity_field(), particles.affine_field(0), particles.affine_field(1),
                                 particles.affine_field(2), particles.liquid_field(), particles.viscosity_field()});
        solids.update(faces, bodies);
        surface.build(grid, faces, particles, cells, solids);
    }
    // Sum over the owned cells of the block, of all ranks.
    double sum(const Array<double>& field) const {
        const auto host = on_host(field);
        double total = 0;
        const CellBox owned = faces.owned();
        for (int i = 0; i < owned.size(); ++i) {
            int c[3];
            owned.cell(i, c);
            total += host(static_cast<std::size_t>(faces.window().index(c[0], c[1], c[2])));
        }
        return decomposition.comm().sum(total);
    }
};

} // namespace treacle::grid::test
