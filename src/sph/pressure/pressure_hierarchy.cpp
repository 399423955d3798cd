#include "sph/pressure/pressure_hierarchy.hpp"

#include <array>
#include <cmath>
#include <unordered_map>

namespace treacle::sph {

namespace {
using Cell = std::array<int, 3>;
struct CellHash {
    std::size_t operator()(const Cell& c) const {
        return static_cast<std::size_t>(c[0]) * 73856093u ^ static_cast<std::size_t>(c[1]) * 19349663u ^
               static_cast<std::size_t>(c[2]) * 83492791u;
    }
};
enum Content : unsigned { contains_poisson = 1, contains_dirichlet = 2, contains_solid = 4 };

CellGrid finest_grid(const SphOptions& options, const Constants& constants, const CellGrid& search) {
    CellGrid grid = search;
    const double cell = options.pressure.multilevel.cell;
    if (cell == 0 || options.pressure.preconditioner == PressurePreconditioner::multilevel_rediscretised) return grid;
    for (double& inverse : grid.inverse_width) inverse = 1 / (cell * constants.spacing);
    return grid;
}

solve::MultilevelOptions algebra(const SphOptions& options, const Constants& constants, const CellGrid& grid) {
    const auto& given = options.pressure.multilevel;
    solve::MultilevelOptions out;
    out.overcorrection = given.overcorrection;
    out.smoother = given.smoother;
    out.cycle = given.cycle;
    out.jacobi_weight = given.jacobi_weight;
    out.coarse_sweeps = given.coarse_sweeps;
    if (options.pressure.preconditioner == PressurePreconditioner::multilevel_rediscretised) {
        out.coarse = solve::CoarseMatrices::grids;
        out.smoother = solve::Smoother::jacobi;
        out.cycle = solve::Cycle::v;
        double volume = 1;
        for (int k = 0; k < constants.dimensions; ++k) volume /= grid.inverse_width[k];
        const double particles = volume / std::pow(constants.spacing, constants.dimensions);
        const double width = std::pow(volume, 1.0 / constants.dimensions);
        out.grid_coupling = particles / (given.grid_factor * width * width);
    }
    return out;
}
} // namespace

PressureHierarchy::PressureHierarchy(const Comm& comm, const SphOptions& options, const Constants& constants,
    const DomainBox& domain, const CellGrid& grid)
    : grid_(finest_grid(options, constants, grid)), domain_(domain), immiscible_(constants.immiscible),
      solids_unknown_(options.pressure.solid_term == SolidTerm::unknowns),
      multilevel_(comm, algebra(options, constants, grid)),
      bounded_(options.pressure.dirichlet == DirichletRule::complementarity) {}

solve::UserPreconditioner PressureHierarchy::preconditioner() {
    return {[this](std::span<const double> r, std::span<double> z) { multilevel_.apply(r, z); },
        [this](solve::Matrix& matrix) { set_up(matrix); }};
}

template <class Particles>
void PressureHierarchy::locate_rows(const Particles& particles, int first_row) {
    const auto x = particles.position();
    const auto row = particles.row();
    const auto cells = cells_;
    const auto grid = grid_;
    Kokkos::parallel_for(
        "treacle::locate_rows", particles.store.owned(), KOKKOS_LAMBDA(int i) {
            if (row(i) < 0) return;
            int c[3];
            grid.locate(x(i, 0), x(i, 1), x(i, 2), c);
            for (int k = 0; k < 3; ++k) cells(3 * (row(i) - first_row) + k) = c[k];
        });
}

void PressureHierarchy::find_walls(int first_row) {
    const auto row = liquid_->row();
    const auto wall = liquid_->wall_term(), walls = walls_;
    Kokkos::parallel_for(
        "treacle::find_walls", liquid_->store.owned(), KOKKOS_LAMBDA(int i) {
            if (row(i) >= 0) walls(row(i) - first_row) = wall(i);
        });
}

void PressureHierarchy::find_densities(int first_row) {
    const auto row = liquid_->row(), of = liquid_->liquid();
    const auto density = immiscible_.density, densities = densities_;
    Kokkos::parallel_for(
        "treacle::find_densities", liquid_->store.owned(), KOKKOS_LAMBDA(int i) {
            if (row(i) >= 0) densities(row(i) - first_row) = density(of(i));
        });
}

void PressureHierarchy::find_fixed(int first_row) {
    const auto row = liquid_->row(), role = liquid_->role();
    const auto fixed = fixed_;
    Kokkos::parallel_for(
        "treacle::find_fixed", liquid_->store.owned(), KOKKOS_LAMBDA(int i) {
            if (row(i) >= 0) fixed(row(i) - first_row) = role(i) == Role::poisson ? 0 : 1;
        });
}

// Cells with a Dirichlet particle, and cells of air beside liquid: those without particles, inside the domain.
void PressureHierarchy::find_dirichlet_cells() {
    std::unordered_map<Cell, unsigned, CellHash> contents;
    const auto add = [&](const auto& x, int i, unsigned content) {
        Cell c;
        grid_.locate(x(i, 0), x(i, 1), x(i, 2), c.data());
        contents[c] |= content;
    };
    const auto x = on_host(liquid_->position());
    const auto role = on_host(liquid_->role());
    for (int i = 0; i < liquid_->store.total(); ++i) {
        if (role(i) == Role::poisson) add(x, i, contains_poisson);
        if (role(i) == Role::dirichlet) add(x, i, contains_dirichlet);
    }
    const auto walls = on_host(solid_->position());
    for (int i = 0; i < solid_->store.total(); ++i) add(walls, i, contains_solid);
    const auto inside = [&](const Cell& c) {
        for (std::size_t k = 0; k < 3; ++k) {
            const double middle = grid_.origin[k] + (c[k] + 0.5) / grid_.inverse_width[k];
            if (static_cast<int>(k) < domain_.dimensions && (middle < domain_.lo[k] || middle > domain_.hi[k])) {
                return false;
            }
        }
        return true;
    };
    dirichlet_.clear();
    for (const auto& [cell, content] : contents) {
        if (content & contains_dirichlet) dirichlet_.insert(dirichlet_.end(), cell.begin(), cell.end());
        if ((content & contains_dirichlet) || !(content & contains_poisson)) continue;
        for (int face = 0; face < 2 * grid_.dimensions; ++face) {
            Cell next = cell;
            next[static_cast<std::size_t>(face / 2)] += face % 2 == 0 ? -1 : 1;
            if (!contents.contains(next) && inside(next)) {
                dirichlet_.insert(dirichlet_.end(), next.begin(), next.end());
            }
        }
    }
}

void PressureHierarchy::set_up(solve::Matrix& matrix) {
    const auto rows = static_cast<std::size_t>(matrix.rows());
    reserve(cells_, 3 * rows);
    locate_rows(*liquid_, matrix.first_row());
    if (solids_unknown_) locate_rows(*solid_, matrix.first_row());
    const bool grids = multilevel_.options().coarse == solve::CoarseMatrices::grids;
    if (grids) { // Galerkin products find walls in the matrix
        reserve(walls_, rows);
        find_walls(matrix.first_row());
    }
    const bool several = grids && immiscible_.several();
    if (several) {
        reserve(densities_, rows);
        find_densities(matrix.first_row());
    }
    if (bounded_) {
        reserve(fixed_, rows);
        find_fixed(matrix.first_row());
    }
    const auto cells = on_host(cells_);
    const auto walls = on_host(walls_);
    const auto densities = on_host(densities_);
    solve::MultilevelCells where;
    where.cells = {cells.data(), 3 * rows};
    const auto fixed = on_host(fixed_);
    if (bounded_) where.fixed = {fixed.data(), rows};
    if (grids) {
        find_dirichlet_cells();
        where.dirichlet = dirichlet_;
        where.walls = {walls.data(), rows};
        if (several) where.densities = {densities.data(), rows};
    }
    multilevel_.set_up(matrix, where);
}

std::size_t PressureHierarchy::bytes() const {
    return multilevel_.bytes() + fixed_.span() + 4 * cells_.span() + 8 * (walls_.span() + densities_.span()) +
           4 * dirichlet_.capacity();
}

namespace {
solve::Preconditioner translate(PressurePreconditioner kind) {
    switch (kind) {
    case PressurePreconditioner::none: return solve::Preconditioner::none;
    case PressurePreconditioner::jacobi: return solve::Preconditioner::jacobi;
    case PressurePreconditioner::incomplete_cholesky: return solve::Preconditioner::ic0;
    case PressurePreconditioner::ssor: return solve::Preconditioner::ssor;
    case PressurePreconditioner::sor_jacobi: return solve::Preconditioner::sor_jacobi;
    case PressurePreconditioner::gamg: return solve::Preconditioner::gamg;
    case PressurePreconditioner::boomeramg: return solve::Preconditioner::boomeramg;
    case PressurePreconditioner::multilevel:
    case PressurePreconditioner::multilevel_rediscretised: break; // called by the solver for the hierarchy
    }
    return solve::Preconditioner::ic0;
}
} // namespace

std::unique_ptr<PressureHierarchy> make_hierarchy(const Comm& comm, const SphOptions& options,
    const Constants& constants, const DomainBox& domain, const CellGrid& grid) {
    if (options.pressure.solver != PressureSolver::isph) return nullptr;
    const auto kind = options.pressure.preconditioner;
    if (kind != PressurePreconditioner::multilevel && kind != PressurePreconditioner::multilevel_rediscretised)
        return nullptr;
    return std::make_unique<PressureHierarchy>(comm, options, constants, domain, grid);
}

solve::KrylovOptions krylov_options(const SphOptions& options, int dimensions, PressureHierarchy* hierarchy) {
    solve::KrylovOptions out;
    out.preconditioner = translate(options.pressure.preconditioner);
    out.max_iterations = options.pressure.max_iterations;
    out.relaxation = options.pressure.relaxation;
    if (hierarchy != nullptr) out.user = hierarchy->preconditioner();
    out.strong_threshold = dimensions == 3 ? 0.5 : 0.25;
    return out;
}

} // namespace treacle::sph
