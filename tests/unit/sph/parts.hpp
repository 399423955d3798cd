#pragma once
#include "sample.hpp"
#include "sph/forces/density.hpp"
#include "sph/pressure/components.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace treacle::sph {

// The parts of a step one by one, up to the assembled matrix, so that tests may change what lies between
// them.
struct Parts {
    Comm comm;
    IsphSetup setup;
    LiquidParticles liquid;
    SolidParticles solid;
    Decomposition decomposition;
    Halo halo, solid_halo;
    Neighbourhood neighbours;
    PressureSystem system;
    CellList liquid_cells, solid_cells;

    Parts(const Comm& group, const Sample& sample)
        : comm(group), setup(sample.setup), decomposition(group, sample.setup.grid) {
        if (setup.options.pressure.corrects_gradients()) liquid.add_gradient_correction();
        put(comm, sample, liquid, solid);
        std::vector<int> cells;
        for (const auto& point : test::read(liquid.store, 0, liquid.store.owned())) {
            const auto cell = test::cell_of(setup.grid, point);
            cells.insert(cells.end(), cell.begin(), cell.end());
        }
        decomposition.repartition(cells, std::vector<double>(cells.size() / 3, 1.0));
        distribute(liquid.store, halo, liquid_cells);
        distribute(solid.store, solid_halo, solid_cells);
        const double support = setup.constants.support;
        NeighbourList solids;
        solids.build(solid.store, solid.store, setup.grid, solid_cells, support);
        compute_solid_volumes(setup.options, setup.constants, solid, solids);
        solid_halo.gather(
            solid.store, {solid.volume_field(), solid.body_field(), solid.velocity_field(), solid.normal_field()});
        neighbours.liquid.build(liquid.store, liquid.store, setup.grid, liquid_cells, support);
        neighbours.solid.build(liquid.store, solid.store, setup.grid, solid_cells, support);
        compute_density(setup.options, setup.constants, liquid, solid, neighbours);
        halo.gather(liquid.store,
            {liquid.volume_field(), liquid.velocity_field(), liquid.pressure_field(), liquid.liquid_field()});
    }

    StepContext step() { return {setup.options, setup.constants, comm, liquid, solid, neighbours, halo, liquid_cells}; }
    RoleCounts predict_roles(LastPressures pressures, double dt) {
        const auto counts = predict(step(), pressures, dt);
        halo.gather(liquid.store, {liquid.role_field()});
        return counts;
    }
    std::int64_t anchor() {
        PressurePinning pinning;
        return comm.sum(pinning.anchor(setup.options, setup.constants, comm, liquid, neighbours, halo));
    }
    void assemble() { system.assemble(setup.options, setup.constants, comm, liquid, neighbours, halo); }
    // The velocities change by the pressures that the liquid has.
    BodyLoads push(double dt) {
        compute_pressure_over_density2(setup.constants, liquid);
        halo.gather(liquid.store, {liquid.load_field()});
        auto loads = apply_pressure(step(), setup.bodies, dt);
        comm.sum(std::span(loads));
        return loads;
    }
    template <class Value>
    void set_by_id(const Array<int>& field, const Value& value) {
        const auto id = test::on_host(liquid.id());
        test::edit(field, [&](auto& v) {
            for (int i = 0; i < liquid.store.owned(); ++i) v(i) = value(id(i));
        });
    }
    template <class Value>
    void set_by_id(const Array<double>& field, const Value& value) {
        const auto id = test::on_host(liquid.id());
        test::edit(field, [&](auto& v) {
            for (int i = 0; i < liquid.store.owned(); ++i) v(i) = value(id(i));
        });
    }

private:
    // The window spans the rank's whole box: a rank may need solids where it has none of its own.
    void distribute(ParticleStore& store, Halo& ghosts, CellList& cells) {
        Migration migration;
        CellSort sort;
        migration.to_owner(store, decomposition);
        sort.sort(store, setup.grid, decomposition.box(), cells);
        ghosts.connect(decomposition);
        ghosts.rebuild(store, cells);
    }
};

// The whole matrix on every rank, its rows in the order of the particles' ids.
struct DenseSystem {
    std::vector<std::int64_t> ids;
    Eigen::MatrixXd matrix;
    Eigen::VectorXd right_hand_side;
};

// Particles with rows, and what is added to their ids so that they differ from those of others.
struct RowsOf {
    const ParticleStore* store;
    Array<int> row;
    std::int64_t shift;
};

inline DenseSystem gather_rows(Parts& parts, const std::vector<RowsOf>& particles) {
    auto& system = parts.system;
    const auto& comm = parts.comm;
    EXPECT_NO_THROW(solve::check_pattern(system.blocks(system.to_host())));
    std::vector<std::int64_t> row_ids(static_cast<std::size_t>(system.rows()), -1);
    for (const auto& of : particles) {
        const auto id = test::on_host(of.store->id());
        const auto row = test::on_host(of.row);
        for (int i = 0; i < of.store->owned(); ++i) {
            if (row(i) >= 0) row_ids[std::size_t(row(i) - system.first_row())] = id(i) + of.shift;
        }
    }
    row_ids = comm.all_gather(std::span<const std::int64_t>(row_ids));
    std::vector<std::int64_t> rows_and_columns;
    std::vector<double> values, sources;
    const auto add_block = [&](const PressureSystem::Block& block, const auto& global) {
        const auto offset = test::on_host(block.offset), column = test::on_host(block.column);
        const auto value = test::on_host(block.value);
        for (int r = 0; r < system.rows(); ++r) {
            for (int k = offset(r); k < offset(r + 1); ++k) {
                rows_and_columns.push_back(system.first_row() + r);
                rows_and_columns.push_back(global(column(k)));
                values.push_back(value(k));
            }
        }
    };
    add_block(system.own(), [&](int column) { return system.first_row() + column; });
    add_block(system.other(), [&](int column) { return system.halo().columns()[std::size_t(column)]; });
    const auto b = test::on_host(system.right_hand_side());
    for (int r = 0; r < system.rows(); ++r) sources.push_back(b(r));
    rows_and_columns = comm.all_gather(std::span<const std::int64_t>(rows_and_columns));
    values = comm.all_gather(std::span<const double>(values));
    sources = comm.all_gather(std::span<const double>(sources));

    DenseSystem out;
    out.ids = row_ids;
    std::sort(out.ids.begin(), out.ids.end());
    const auto dense_index = [&](std::int64_t global_row) {
        const auto at = std::lower_bound(out.ids.begin(), out.ids.end(), row_ids[std::size_t(global_row)]);
        return at - out.ids.begin();
    };
    const auto n = static_cast<Eigen::Index>(row_ids.size());
    EXPECT_EQ(n, system.global_rows());
    out.matrix = Eigen::MatrixXd::Zero(n, n);
    out.right_hand_side = Eigen::VectorXd::Zero(n);
    for (std::size_t k = 0; k < values.size(); ++k) {
        out.matrix(dense_index(rows_and_columns[2 * k]), dense_index(rows_and_columns[2 * k + 1])) += values[k];
    }
    for (Eigen::Index r = 0; r < n; ++r) out.right_hand_side(dense_index(r)) = sources[std::size_t(r)];
    return out;
}

inline DenseSystem gather_system(Parts& parts) {
    return gather_rows(parts, {{&parts.liquid.store, parts.liquid.row(), 0}});
}

} // namespace treacle::sph
