#include "sph/model/options.hpp"

#include "base/options/options.hpp"

namespace treacle::sph {

namespace {
constexpr double least_tolerance = 1e-14;

const char* const unreachable = "rounding alone leaves about 1e-15";
const char* const accurate = "1e-10 is very accurate already";

Range attainable(const Range& range) { return range.because(unreachable, accurate); }

// A tolerance, or 0 for the one that goes with the other options.
void check_tolerance(Declaration& d, const std::string& key, double value) {
    d.check(value == 0 || value >= least_tolerance, key, {"must be 0 or at least 1e-14", unreachable, accurate});
}
} // namespace

void DensityOptions::declare(Declaration& d) {
    d.choice("kind", kind,
        {{"blended", DensityKind::blended}, {"smooth", DensityKind::smooth}, {"spiky", DensityKind::spiky}},
        "Density by the smooth kernel, by the spiky number-density kernel, or the smooth one blended into "
        "the spiky one near solids (Eq. 2.3).");
    d.number("blend_from", blend_from, unit::none, range_at_least(0),
        "Solid neighbours below which the smooth kernel rules alone (alpha of Eq. 2.3).");
    d.number("blend_to", blend_to, unit::none, range_at_least(0),
        "Solid neighbours from which the spiky kernel rules alone (beta of Eq. 2.3).");
    d.check(blend_to > blend_from, "blend_to",
        {"must be larger than blend_from", "the blend runs from the one to the other", "5 and 15 are usual"});
}

void MultilevelOptions::declare(Declaration& d) {
    d.number("cell", cell, unit::none, range_at_least(0),
        "Width of the finest cells of `multilevel` in particle spacings; 0: the cells of the neighbour search, "
        "one support radius. `multilevel_rediscretised` always has those.");
    d.number("overcorrection", overcorrection, unit::none, range_between(1, 1.95),
        "What the coarse matrices of `multilevel` are divided by.");
    d.choice("smoother", smoother,
        {{"gauss_seidel", solve::Smoother::gauss_seidel}, {"jacobi", solve::Smoother::jacobi},
            {"chebyshev", solve::Smoother::chebyshev}},
        "Smoother of `multilevel`: `gauss_seidel` sweeps row by row on one thread of each rank; `chebyshev`, a "
        "polynomial, "
        "runs on all threads and on devices, and is the default there; `jacobi`, weighted, is for the particles alone, "
        "coarse levels sweep. `multilevel_rediscretised` always takes weighted Jacobi.");
    d.number("jacobi_weight", jacobi_weight, unit::none, range_above_to(0, 1), "Weight of the Jacobi smoother.");
    d.choice("cycle", cycle, {{"v", solve::Cycle::v}, {"w", solve::Cycle::w}},
        "Each coarse level of `multilevel` once, or twice for each time of the one above. `multilevel_rediscretised` "
        "always takes the V-cycle.");
    d.integer("coarse_sweeps", coarse_sweeps, range_at_least(1), "Smoothing sweeps each way on coarse levels.");
    d.number("grid_factor", grid_factor, unit::none, range_above(0),
        "Factor lambda of `multilevel_rediscretised` (dissertation, section 3.5.2).");
}

void PressureOptions::check_solver(Declaration& d) const {
    const PressureOptions usual;
    const auto needs_isph = [&](const char* key, bool differs) {
        d.check(!differs || solver == PressureSolver::isph, key,
            {"is read by method.pressure.solver: isph only", "the others would ignore it",
                "set solver: isph too, or leave it out"});
    };
    needs_isph("dirichlet", dirichlet != usual.dirichlet);
    needs_isph("surface_density", surface_density != usual.surface_density);
    needs_isph("clamping", clamping != usual.clamping);
    needs_isph("prediction", prediction != usual.prediction);
    needs_isph("solid_term", solid_term != usual.solid_term);
    needs_isph("amplification_limit", amplification_limit != usual.amplification_limit);
    needs_isph("wall_force", wall_force != usual.wall_force);
    needs_isph("preconditioner", preconditioner != usual.preconditioner);
    needs_isph("corrections", corrections != usual.corrections);
}

void PressureOptions::declare_solver(Declaration& d) {
    d.choice("solver", solver,
        {{"iisph", PressureSolver::iisph}, {"isph", PressureSolver::isph},
            {"iisph_jacobi", PressureSolver::iisph_jacobi}, {"dfsph", PressureSolver::dfsph}},
        "Pressures by implicit incompressible SPH (Ihmsen et al. 2014), whose operator is that of the forces, by "
        "spectral projected "
        "gradients; by incompressible SPH with an assembled Laplacian (dissertation, chapters 2 and 3), which alone "
        "reads "
        "`dirichlet` and what belongs to it, `solid_term`, `wall_force`, `preconditioner`, `multilevel` and "
        "`corrections`; or, to "
        "compare with, by implicit incompressible SPH with relaxed Jacobi, as published, or by divergence-free SPH "
        "(Bender & "
        "Koschier 2017), two solves of that kind, one for the velocities, without dynamic bodies.");
    d.number("jacobi_weight", jacobi_weight, unit::none, range_between(0, 1),
        "Weight of the Jacobi iteration of `iisph_jacobi` and `dfsph`, and of the first step of `iisph`; 0: "
        "the 0.5 published for IISPH, or less for kernels wide enough that it would diverge.");
}

void PressureOptions::declare_roles(Declaration& d) {
    d.choice("dirichlet", dirichlet,
        {{"predicted", DirichletRule::predicted}, {"source", DirichletRule::source},
            {"density", DirichletRule::density}, {"predicted_density", DirichletRule::predicted_density},
            {"surface", DirichletRule::surface}, {"ghosts", DirichletRule::ghosts},
            {"complementarity", DirichletRule::complementarity}},
        "Which particles keep zero pressure: those that one Jacobi step from the last pressures predicts to "
        "have none (Eq. 2.6); those with a negative source; those whose density, or predicted density, is below "
        "`surface_density`; those with an uncovered side; none, the missing neighbours being ghosts at zero "
        "pressure (Nair & Tomar 2014); or those that the exact solution without negative pressures leaves at zero, "
        "which is searched for from the predicted ones.");
    d.number("surface_density", surface_density, unit::none, range_above_to(0, 1),
        "Share of the rest density below which a particle lies at the surface, with `dirichlet: density` and "
        "`predicted_density`; 0.97 is that of Koshizuka et al. 1996, 0.99 that of Shao & Lo 2003.");
    d.choice("clamping", clamping, {{"pressures", Clamping::pressures}, {"sources", Clamping::sources}},
        "What keeps pressures from being negative: those that the solve leaves negative are set to zero; or the "
        "negative sources of unknowns are, so that none arises.");
    d.number("prediction", prediction, unit::none, range_between(0, 1),
        "Share of the last step's pressures that the prediction starts from (gamma of Eq. 2.6).");
}

void PressureOptions::declare_solids(Declaration& d) {
    d.choice("solid_term", solid_term,
        {{"none", SolidTerm::none}, {"decomposed", SolidTerm::decomposed}, {"unified", SolidTerm::unified},
            {"amplified", SolidTerm::amplified}, {"exact", SolidTerm::exact}, {"unknowns", SolidTerm::unknowns}},
        "What solids add to the pressure system: nothing; Eq. 2.10; Eq. 3.2; Eq. 3.3; Eq. 3.2 with the source "
        "that makes the system's solution that of the Neumann problem; or solid particles as unknowns "
        "(Koshizuka et al. 1996, Shao & Lo 2003), without dynamic bodies.");
    d.number("amplification_limit", amplification_limit, unit::none, range_at_least(1),
        "Largest amplification of the source near solids (gamma of Eq. 3.3).");
    d.choice("wall_force", wall_force, {{"one_sided", WallForce::one_sided}, {"balanced", WallForce::balanced}},
        "How hard solids push back: by the pressure of the liquid alone (Akinci et al. 2012), which lets the first "
        "layer sink until its pressure is several times that of the next; or as many times more as keeps liquid "
        "at rest beside a flat wall in balance, for large time steps.");
    d.choice("wall_contact", wall_contact, {{"stop", WallContact::stop}, {"none", WallContact::none}},
        "Whether a particle that would sink below the surface of a solid within the step loses the part of its "
        "velocity "
        "that leads there, or pressures alone hold it off, which they do only while it meets the solid in several "
        "steps.");
    d.choice("coupling", coupling, {{"strong", BodyCoupling::strong}, {"weak", BodyCoupling::weak}},
        "Whether the pressures know that dynamic bodies give way to them, or these feel the pressures that stop "
        "the liquid at a body at rest; bodies not much denser than the liquid fly off then.");
}

void PressureOptions::declare_preconditioner(Declaration& d) {
    d.choice("preconditioner", preconditioner,
        {{"none", PressurePreconditioner::none}, {"jacobi", PressurePreconditioner::jacobi},
            {"incomplete_cholesky", PressurePreconditioner::incomplete_cholesky},
            {"ssor", PressurePreconditioner::ssor}, {"sor_jacobi", PressurePreconditioner::sor_jacobi},
            {"gamg", PressurePreconditioner::gamg}, {"boomeramg", PressurePreconditioner::boomeramg},
            {"multilevel", PressurePreconditioner::multilevel},
            {"multilevel_rediscretised", PressurePreconditioner::multilevel_rediscretised}},
        "Preconditioner of the conjugate gradients: `ssor` relaxes row by row on each rank, `sor_jacobi` all rows at "
        "once, twice, as the dissertation's SORCG; the two multilevel ones coarsen particles to cells, by sums "
        "of the matrix's entries or by finite differences (dissertation, section 3.5).");
    d.number("relaxation", relaxation, unit::none, range_above_to(0, 1.95),
        "Over-relaxation omega of `ssor`; of `sor_jacobi`, in which it must stay so small that two sweeps keep "
        "the preconditioner positive: conjugate gradients say when it does not.");
    const bool relaxed =
        preconditioner == PressurePreconditioner::ssor || preconditioner == PressurePreconditioner::sor_jacobi;
    d.check(relaxed || relaxation == 1, "relaxation",
        {"is read by preconditioner: ssor and sor_jacobi only", "another would ignore it", "leave it out"});
    d.check(solid_term != SolidTerm::unknowns || preconditioner != PressurePreconditioner::multilevel_rediscretised,
        "preconditioner",
        {"cannot be multilevel_rediscretised with solid_term: unknowns", "its coarse grids know the liquid alone",
            "take multilevel"});
    d.check(solid_term != SolidTerm::unknowns || dirichlet != DirichletRule::ghosts, "dirichlet",
        {"cannot be ghosts with solid_term: unknowns",
            "solids count as cover there, and as neighbours with pressures of their own here",
            "take another of the two"});
    d.block("multilevel", multilevel, "The multilevel preconditioners.");
}

void PressureOptions::declare_stop(Declaration& d) {
    d.choice("stop", stop, {{"density_error", StoppingRule::density_error}, {"residual", StoppingRule::residual}},
        "Iterate until the mean compression, or until the relative residual, is small enough.");
    d.number("density_error", density_error, unit::none, range_at_least(0),
        "Mean compression of the Poisson particles at which iterating ends, as a share of the density; 0: 1e-5, with "
        "`recovery: positions` 1e-3, less in wide liquids that solids or inlets drive.");
    check_tolerance(d, "density_error", density_error);
    d.choice("recovery", recovery,
        {{"automatic", DensityRecovery::automatic}, {"velocities", DensityRecovery::velocities},
            {"positions", DensityRecovery::positions}},
        "How liquid that is compressed gets its density back. `velocities`: within a step, by the pressures that move "
        "it, "
        "so that it is thrown apart the faster the shorter the step. `positions`: the pressures only stop what would "
        "compress it further, and a second solve moves the particles apart without a velocity; no impact gains energy. "
        "`automatic`: positions with `solver: iisph`, velocities with the others. Positions need `solver: iisph` or "
        "`iisph_jacobi`.");
    d.check(!recovers_positions() || solver == PressureSolver::iisph || solver == PressureSolver::iisph_jacobi,
        "recovery",
        {"needs solver: iisph or iisph_jacobi", "no other's pressures take energy out of whatever they meet",
            "set the solver too, or leave it out"});
    d.choice("gradients", gradients,
        {{"automatic", PressureGradients::automatic}, {"kernel", PressureGradients::kernel},
            {"corrected", PressureGradients::corrected}},
        "Gradients by which pressures act: those of the kernel, or corrected, so that the divergence is exact for "
        "linear velocities. "
        "Particles out of order resist shear by a friction of 0.5 to 2 % of the pressure with the former, and hardly "
        "with "
        "the latter, which take about twice the time. `automatic`: corrected where bodies or sides "
        "move, with `recovery: positions` of `iisph`.");
    d.check(!corrects_gradients() || may_correct_gradients(), "gradients",
        {"corrected needs solver: iisph, recovery: positions and wall_force: one_sided",
            "the others have gradients of their own", "set these too, or leave it out"});
    d.number("divergence_error", divergence_error, unit::none, attainable(range_at_least(least_tolerance)),
        "Of `dfsph`: mean compression in a step, as a share of the density, that the velocities may have before "
        "forces act.");
    d.number("largest_residual", largest_residual, unit::none, range_between(0, 1),
        "Relative residual that must be reached as well, with `stop: density_error`: gravity compresses only the "
        "lowest layer in a step, too little to count on average, and the liquid would fall until it does. With "
        "`recovery: positions` "
        "it holds for particles above solids that bear them. 0: 0.1, with `recovery: positions` 0.05.");
    check_tolerance(d, "largest_residual", largest_residual);
    d.number("residual", residual, unit::none, attainable(range_between(least_tolerance, 1)),
        "Relative residual at which iterating ends, with `stop: residual`.");
    d.integer("corrections", corrections, range_between(0, 20),
        "Most corrections of the pressures in a step, until the mean compression that they leave by the very forces "
        "that move the liquid is below `density_error`: the pressure system's Laplacian approximates these, and at "
        "walls poorly. Each takes about the time of two to three iterations of the solve; 2 do for large time steps.");
    d.check(corrections == 0 || solid_term != SolidTerm::unknowns, "corrections",
        {"cannot be with solid_term: unknowns", "the pressures of solids push nothing", "take another solid_term"});
    d.integer("max_iterations", max_iterations, range_at_least(1),
        "Iterations after which the run ends as failed; 20 times as many with `solver: iisph_jacobi` and `dfsph`.");
}

void PressureOptions::check_complementarity(Declaration& d) const {
    const bool exact = dirichlet == DirichletRule::complementarity;
    const bool cut = preconditioner != PressurePreconditioner::gamg &&
                     preconditioner != PressurePreconditioner::boomeramg &&
                     preconditioner != PressurePreconditioner::multilevel_rediscretised;
    d.check(!exact || clamping == Clamping::pressures, "clamping",
        {"cannot be sources with dirichlet: complementarity",
            "its pressures are not negative, whatever the sources are", "leave it out"});
    d.check(!exact || solid_term != SolidTerm::unknowns, "dirichlet",
        {"cannot be complementarity with solid_term: unknowns", "solids have no sign of their pressures to keep",
            "take another of the two"});
    d.check(!exact || cut, "preconditioner",
        {"cannot serve dirichlet: complementarity", "the set of unknowns changes within a solve",
            "choose multilevel, incomplete_cholesky, ssor, jacobi or none"});
}

void PressureOptions::declare(Declaration& d) {
    declare_solver(d);
    declare_roles(d);
    declare_solids(d);
    declare_preconditioner(d);
    declare_stop(d);
    check_complementarity(d);
    check_solver(d);
}

void ViscosityOptions::declare_form(Declaration& d) {
    d.choice("integration", integration,
        {{"automatic", ViscosityIntegration::automatic}, {"implicit", ViscosityIntegration::implicit},
            {"explicit", ViscosityIntegration::explicit_form}},
        "Whether the liquids' viscosity acts by a linear solve in each step, or at the velocities that the step "
        "starts with, which limits the step; `automatic` is implicit where that limit would matter, and where not "
        "explicit by forces along the lines between particles, whatever the form.");
    d.choice("form", form,
        {{"corrected", ViscosityForm::corrected}, {"adjoint", ViscosityForm::adjoint},
            {"pairwise", ViscosityForm::pairwise}, {"laplacian", ViscosityForm::laplacian},
            {"as_published", ViscosityForm::as_published}},
        "The full stress (dissertation, chapter 4) of gradients that are exact for linear velocities; of the plain "
        "ones, made symmetric; forces along the lines between particles (Weiler et al. 2018), for support_ratio 3 "
        "and more; the Laplacian of each component, which stops rotations; or equations 4.5 to 4.12 as published, "
        "which are not symmetric.");
    d.number("hourglass_coefficient", hourglass_coefficient, unit::none, range_between(0, 1),
        "Share of the viscosity that acts on what `corrected` gradients do not see of the velocities around a "
        "particle.");
    d.number("support_ratio", support_ratio, unit::none, range_between(1.5, 4),
        "Support radius of the `corrected` form's sums in particle spacings, at most that of all others.");
    d.boolean("assembled", assembled,
        "Solve with the matrix, whose rows reach to the neighbours' neighbours (dissertation, Algorithm 8), and not "
        "with products that need none; up to 50 kB a particle.");
}

void ViscosityOptions::declare_solver(Declaration& d) {
    d.choice("solver", solver,
        {{"conjugate_gradients", ViscositySolver::conjugate_gradients}, {"bicgstab", ViscositySolver::bicgstab}},
        "Conjugate gradients need a symmetric matrix, and may fail on that as published at high viscosities; "
        "`bicgstab` does not.");
    d.choice("preconditioner", preconditioner,
        {{"jacobi", ViscosityPreconditioner::jacobi}, {"multilevel", ViscosityPreconditioner::multilevel},
            {"gamg", ViscosityPreconditioner::gamg}, {"boomeramg", ViscosityPreconditioner::boomeramg}},
        "Of the viscous solve: the diagonal blocks of the particles, to which `multilevel` adds a cycle of "
        "multigrid over cells 1.7 spacings wide; or algebraic multigrid of the assembled matrix.");
    const bool by_matrix =
        preconditioner == ViscosityPreconditioner::gamg || preconditioner == ViscosityPreconditioner::boomeramg;
    d.check(assembled || !by_matrix, "preconditioner",
        {"needs assembled: true", "algebraic multigrid is made of a matrix",
            "take multilevel, or set assembled: true"});
    d.check(assembled || solver != ViscositySolver::bicgstab, "solver",
        {"bicgstab needs assembled: true", "the other forms are symmetric", "leave it out, or set assembled: true"});
    d.check(assembled || form != ViscosityForm::as_published || integration == ViscosityIntegration::explicit_form,
        "form",
        {"as_published needs assembled: true", "it is there to compare with, solved as the dissertation does",
            "set assembled: true, or take adjoint, which is symmetric"});
    d.choice("guess", guess, {{"velocity", ViscosityGuess::velocity}, {"last_change", ViscosityGuess::last_change}},
        "What the solve starts from: the velocities that it is given, or these and what the last solve changed.");
    d.choice("precision", precision, {{"double", ViscosityPrecision::full}, {"mixed", ViscosityPrecision::mixed}},
        "Of the products without a matrix: mixed takes single precision for the iterations of the forms with "
        "gradients, and "
        "ends by the residual in double precision all the same.");
    d.number("residual", residual, unit::none, range_above_to(0, 0.1), "Relative residual at which the solve ends.");
    d.integer(
        "max_iterations", max_iterations, range_between(1, 1000000), "Iterations after which the solve has failed.");
}

void ViscosityOptions::declare_others(Declaration& d) {
    d.choice("coupling", coupling, {{"strong", BodyCoupling::strong}, {"weak", BodyCoupling::weak}},
        "Whether dynamic bodies move along in the viscous solve, or take the forces that the liquid would put on them "
        "if they did not; bodies that are light, or in very viscous liquid, are shaken to pieces then.");
    d.number("picard_residual", picard_residual, unit::none, range_above_to(0, 1),
        "Of liquids whose viscosity depends on the shear rate: the step is solved again with the viscosities of the "
        "velocities found, until these leave no larger a relative residual.");
    d.integer("max_picard_iterations", max_picard_iterations, range_between(1, 1000),
        "Most solves of a step for that; what is left is taken up by the next step. 1: the viscosities are those of "
        "the last step.");
    d.number("bulk", bulk, unit::none, range_between(0, 1000),
        "Bulk viscosity, over the viscosity, of liquid that is stretched: pressures are never negative, and without it "
        "such liquid comes apart. 0: none.");
    d.number("artificial", artificial, unit::none, range_at_least(0),
        "Coefficient alpha of Monaghan's artificial viscosity alpha h c, which acts between approaching "
        "particles.");
    d.number("reference_speed", reference_speed, unit::velocity, range_at_least(0),
        "Speed c of the artificial viscosity; 0: sqrt(g H) with the height H of the liquid at the start.");
    d.number("xsph", xsph, unit::none, range_between(0, 1),
        "Share of the neighbours' mean velocity that particles move with (XSPH).");
}

void ViscosityOptions::declare(Declaration& d) {
    declare_form(d);
    declare_solver(d);
    declare_others(d);
}

void SurfaceTensionOptions::declare(Declaration& d) {
    d.choice("model", model,
        {{"none", SurfaceTensionModel::none}, {"cohesion", SurfaceTensionModel::cohesion},
            {"curvature", SurfaceTensionModel::curvature}},
        "How `liquids.*.surface_tension` acts: not at all; by the curvature of the surface, as a force towards its "
        "inside; or by forces that draw particles together (Becker & Teschner 2007), which stiffen the liquid "
        "(src/sph/theory.md). Both limit the time step.");
}

void SphOptions::declare(Declaration& d) {
    d.choice("kernel", kernel,
        {{"cubic_spline", KernelKind::cubic_spline}, {"wendland_c2", KernelKind::wendland_c2},
            {"mueller", KernelKind::mueller}},
        "Smoothing kernel; `mueller` is the dissertation's poly6 and spiky pair.");
    d.number("support_ratio", support_ratio, unit::none, range_between(1.5, 4),
        "Support radius of the kernel in particle spacings.");
    d.block("density", density, "How densities are measured.");
    d.block("pressure", pressure, "The pressure solve.");
    d.block(
        "viscosity", viscosity, "The viscosity of the liquids, and numerical viscosity that keeps particles in order.");
    d.check(viscosity.xsph == 0 || !pressure.recovers_positions(), "viscosity.xsph",
        {"cannot go with pressure.recovery: positions", "either moves particles by more than their velocities",
            "leave one of the two out"});
    d.block("surface_tension", surface_tension, "The surface tension of the liquids against air.");
    d.number("max_load_imbalance", max_load_imbalance, unit::none, range_at_least(1),
        "Largest over mean number of particles of a rank above which the domain is cut anew.");
}

} // namespace treacle::sph
