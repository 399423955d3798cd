#include "parts.hpp"

#include <cstdio>
#include <cstdlib>

namespace treacle::sph::square_test {
namespace {

// The dissertation's figure 3.4: liquid at rest in a square with solids on three sides and p = 0 in the layer of the
// fourth, the same positive source everywhere. The exact solution is that of the Neumann problem.
constexpr int width = 24;       // particles
constexpr double dt = 1e-3;     // [s]
constexpr double excess = 1e-3; // of the density, the source

Sample make_square(SolidTerm term) {
    SphOptions options;
    options.pressure.solid_term = term;
    options.pressure.amplification_limit = 5; // the dissertation's
    const double far = (width + 8) * spacing;
    Sample sample{
        make_setup(
            make_domain(2, {-far, -far, 0}, {2 * far, 2 * far, spacing}, {scene::BoundaryKind::open, {}}), options),
        {}, {}};
    add_block(sample, {{0, 0, 0}, {width, width, 1}});
    const auto& c = sample.setup.constants;
    const double gap = equilibrium_wall_distance({options.kernel, 2, c.support, spacing, spacing}, options.density);
    const double last = (width - 1) * spacing;
    for (int k = 0; k < width; ++k) sample.solid.push_back({{k * spacing, -gap, 0}, 0});
    for (int k = -1; k < width + 6; ++k) { // the walls go on above the liquid, dry
        const double y = k < 0 ? -gap : k * spacing;
        sample.solid.push_back({{-gap, y, 0}, 0});
        sample.solid.push_back({{last + gap, y, 0}, 0});
    }
    return sample;
}

using Pressures = std::map<std::int64_t, double>; // of the unknowns of the liquid

Pressures solve_square(SolidTerm term, const Pressures& last = {}) {
    const auto sample = make_square(term);
    Parts parts(Comm::world(), sample);
    std::map<std::int64_t, bool> surface;
    for (std::size_t k = 0; k < sample.liquid.size(); ++k) surface[id_of(k)] = k >= width * (width - 1);
    parts.set_by_id(parts.liquid.blended_density(), [](std::int64_t) { return rest_density * (1 + excess); });
    parts.set_by_id(parts.liquid.pressure(), [&](std::int64_t id) { return last.contains(id) ? last.at(id) : 0.0; });
    parts.halo.gather(parts.liquid.store, {parts.liquid.pressure_field()});
    parts.predict_roles(LastPressures::known, dt);
    parts.set_by_id(
        parts.liquid.role(), [&](std::int64_t id) { return surface.at(id) ? Role::dirichlet : Role::poisson; });
    parts.halo.gather(parts.liquid.store, {parts.liquid.role_field()});
    std::vector<RowsOf> rows{{&parts.liquid.store, parts.liquid.row(), 0}};
    if (term == SolidTerm::unknowns) {
        SolidRows around;
        const double support = parts.setup.constants.support;
        around.liquid.build(parts.solid.store, parts.liquid.store, parts.setup.grid, parts.liquid_cells, support);
        around.solid.build(parts.solid.store, parts.solid.store, parts.setup.grid, parts.solid_cells, support);
        around.predict(
            parts.setup.options, parts.setup.constants, parts.liquid, parts.solid, parts.neighbours, parts.solid_halo);
        parts.system.assemble_with_solids(parts.setup.options, parts.setup.constants, parts.comm,
            {parts.liquid, parts.solid, parts.neighbours, around, parts.halo, parts.solid_halo});
        rows.push_back({&parts.solid.store, parts.solid.row(), 1 << 24});
    } else {
        parts.assemble();
    }
    const auto system = gather_rows(parts, rows);
    const Eigen::VectorXd p = system.matrix.ldlt().solve(system.right_hand_side);
    Pressures out;
    for (std::size_t r = 0; r < system.ids.size(); ++r) {
        if (system.ids[r] < 1 << 24) out[system.ids[r]] = p(Eigen::Index(r));
    }
    return out;
}

// Largest difference over the largest pressure.
double error(const Pressures& p, const Pressures& exact) {
    double most = 0, difference = 0;
    for (const auto& [id, value] : exact) {
        most = std::max(most, value);
        difference = std::max(difference, std::abs(p.at(id) - value));
    }
    return difference / most;
}

double mean(const Pressures& p) {
    double sum = 0;
    for (const auto& [id, value] : p) sum += value;
    return sum / double(p.size());
}

void write_table(const char* file, const Pressures& exact, const Pressures& amplified, const Pressures& unknowns) {
    std::FILE* out = std::fopen(file, "w");
    ASSERT_NE(out, nullptr) << file;
    std::fprintf(out, "x [d],y [d],exact [Pa],unified [Pa],solids as unknowns [Pa]\n");
    for (int k = 0; k < width * (width - 1); ++k) {
        const auto id = id_of(std::size_t(k));
        std::fprintf(
            out, "%d,%d,%.17g,%.17g,%.17g\n", k % width, k / width, exact.at(id), amplified.at(id), unknowns.at(id));
    }
    EXPECT_EQ(std::fclose(out), 0);
}
} // namespace

// TREACLE_SQUARE names a file for the pressures.
TEST(SquareDomain, TheUnifiedTermIsFarMoreAccurateThanSolidsAsUnknowns) {
    const auto exact = solve_square(SolidTerm::none);
    const auto amplified = solve_square(SolidTerm::amplified, exact);
    const auto unknowns = solve_square(SolidTerm::unknowns, exact);
    const auto ours = solve_square(SolidTerm::exact, exact);
    const double unified_error = error(amplified, exact), unknowns_error = error(unknowns, exact);
    EXPECT_LT(5 * unified_error, unknowns_error);
    EXPECT_LT(error(ours, exact), 1e-10) << "its fixed point is the exact solution; round-off of 600 unknowns";
    EXPECT_LT(mean(unknowns), mean(exact)) << "paths along the walls lead to p = 0";
    testing::Test::RecordProperty("unified", std::to_string(unified_error));
    testing::Test::RecordProperty("unknowns", std::to_string(unknowns_error));
    if (Comm::world().is_root()) std::printf("unified %.6g unknowns %.6g\n", unified_error, unknowns_error);
    const char* file = std::getenv("TREACLE_SQUARE");
    if (file != nullptr && Comm::world().is_root()) write_table(file, exact, amplified, unknowns);
}

} // namespace treacle::sph::square_test
