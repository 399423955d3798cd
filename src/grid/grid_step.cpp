#include "grid/grid_step.hpp"

#include "grid/geometry/seeding.hpp"
#include "grid/mac/active_block.hpp"
#include "grid/transport/inflow.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::grid {

namespace {
constexpr double least_depth = 0.05;   // widths, of the centre of a cell with a drop or a sheet thinner than it
constexpr double longest_growth = 1.5; // of a step over the one before it
constexpr double wave_safety = 0.9;    // of the longest step at which waves stay bounded
constexpr int layers = 3;              // of halo: what linear interpolation and a step of CFL 3 reach
} // namespace

GridStep::GridStep(const Comm& comm, const GridSetup& setup)
    : comm_(comm), setup_(setup), grid_(make_mac_grid(setup.domain)), bodies_(setup.rigid),
      decomposition_(comm, grid_.cells), load_balance_(setup.options.max_load_imbalance),
      source_(make_inlet_emitter(setup.inflow, grid_)),
      outlets_(flow::make_outlets(setup.inflow.outlets, grid_.dimensions)), solids_(grid_, setup.domain),
      slip_(grid_, setup.domain, setup.slip), resting_(grid_, setup.domain, setup.rigid.bodies.size()),
      no_slip_(grid_, setup.domain, setup.rigid.bodies.size()), rheology_(setup.rheology),
      tensions_(setup.surface_tension),
      pressure_(comm, setup.options.pressure, setup.options.coupling, grid_.dimensions),
      viscosity_(comm, setup.options.viscosity, setup.options.coupling), stokes_(comm, setup.options.stokes),
      correction_(grid_) {
    particle_mass_ = Array<double>("treacle::particle_mass", static_cast<std::size_t>(setup.liquids));
    Kokkos::deep_copy(particle_mass_, setup.density * particle_volume(grid_));
    if (balances()) balance_.add_field(particles_);
}

namespace {
// Densities of the first frame: later ones have those that the position correction measures.
void fill_rest_densities(const GridParticles& particles, const Array<double>& mass, double volume) {
    const auto density = particles.density();
    const auto liquid = particles.liquid();
    Kokkos::parallel_for(
        "treacle::rest_densities", particles.store.owned(),
        KOKKOS_LAMBDA(int i) { density(i) = mass(liquid(i)) / volume; });
}
} // namespace

void GridStep::start() {
    repartition();
    distribute_particles();
    if (before_ > 0) return;
    begin_velocities(particles_, 0);
    if (balances()) keep_angular_momenta(balance_scene(), 0);
    fill_rest_densities(particles_, particle_mass_, particle_volume(grid_));
    end_motion_.start(middle_motion());
}

std::vector<double> GridStep::history() const {
    std::vector<double> out{before_, max_density_error_, double(steps_)};
    const auto motion = end_motion_.state();
    out.insert(out.end(), motion.begin(), motion.end());
    return out;
}

void GridStep::restore_history(std::span<const double> state) {
    before_ = state[0];
    max_density_error_ = state[1];
    steps_ = static_cast<std::int64_t>(state[2]);
    end_motion_.restore(state.subspan(3), bodies_.size());
}

void GridStep::restore(std::span<const std::int64_t> state) {
    load_balance_.restore(state, decomposition_);
    halo_.connect(decomposition_);
    distribute_particles();
}

std::vector<std::int64_t> GridStep::decomposition_state() const { return load_balance_.state(decomposition_); }

// By particles; cells' own cost follows them.
void GridStep::repartition() {
    if (comm_.size() > 1) {
        load_balance_.add(particles_.store, grid_.cells);
        load_balance_.cut(decomposition_);
    }
    halo_.connect(decomposition_);
}

void GridStep::rebalance() {
    if (!load_balance_.is_due(comm_, particles_.store.owned())) return;
    repartition();
    distribute_particles();
    load_balance_.note_cut(comm_, particles_.store.owned());
}

// Arrays over the block around the particles, and the solids in it.
void GridStep::connect(const CellBox& occupied) {
    const CellBox block = active_block(comm_, grid_, occupied, setup_.options.band);
    cells_halo_.connect(decomposition_, block, layers);
    for (auto* field : {&mass_, &velocity_, &scratch_}) reserve_faces(*field, grid_, cells_halo_.window());
    reserve(distance_, static_cast<std::size_t>(cells_halo_.window().size()));
}

void GridStep::distribute_particles() {
    connect(migration_.to_owner(particles_.store, decomposition_).cells);
    sort_.sort(particles_.store, grid_.cells, cells_halo_.owned(), cells_);
    halo_.rebuild(particles_.store, cells_);
}

// (A3)
void GridStep::particles_to_grid() {
    auto& p = particles_;
    halo_.gather(
        p.store, {p.velocity_field(), p.affine_field(0), p.affine_field(1), p.affine_field(2), p.liquid_field()});
    particles_to_faces(grid_, {p, cells_, particle_mass_}, cells_halo_.window(), mass_, velocity_);
    gather_faces(grid_, cells_halo_, mass_);
    gather_faces(grid_, cells_halo_, velocity_);
    mark_faces(grid_, cells_halo_.window(), mass_, 0, known_);
    extrapolate(grid_, cells_halo_, velocity_, known_, 2);
    copy_faces(grid_, cells_halo_.window(), velocity_, start_);
}

// Distances at the centres of cells. Liquid that contains no centre, drops and sheets thinner than a cell, would have
// no pressure and fall through the floor: where a cell with particles has no liquid beside it, its own centre is in the
// liquid.
void GridStep::sample_level_set_at_centres() {
    const auto& nodes = solids_.nodes();
    const int middle = grid_.dimensions == 2 ? 3 : 7, dimensions = grid_.dimensions;
    const auto fine = level_set_.distance(), centre = distance_;
    Kokkos::parallel_for(
        "treacle::centre_distance", static_cast<int>(nodes.window.size()),
        KOKKOS_LAMBDA(int i) { centre(i) = fine(FineNodes::per_cell * i + middle); });
    const auto faces = pressure_faces(cells_halo_.window(), dimensions);
    const CellBox owned = cells_halo_.owned();
    const CellList cells = cells_;
    const double thin = -least_depth * grid_.dx;
    Kokkos::parallel_for(
        "treacle::thin_liquid", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int i) {
            int c[3];
            owned.cell(i, c);
            const int here = cells.window.index(c[0], c[1], c[2]), at = faces.window.index(c[0], c[1], c[2]);
            if (cells.end(here) == cells.begin(here)) return;
            bool seen = centre(at) < 0;
            for (int a = 0; a < dimensions; ++a) {
                for (int side = -1; side <= 1; side += 2) {
                    const int next = at + side * static_cast<int>(faces.stride[a]);
                    seen = seen || fine(FineNodes::per_cell * next + middle) < 0;
                }
            }
            if (!seen) centre(at) = thin;
        });
    cells_halo_.gather({distance_});
}

// (F1), (F2)
void GridStep::update_geometry() {
    solids_.update(cells_halo_, bodies_);
    level_set_.build(grid_, cells_halo_, particles_, cells_, solids_);
    sample_level_set_at_centres();
    fraction_builder_.build(solids_, level_set_.distance(), setup_.options.fractions, fractions_);
    resting_.find(solids_, fraction_builder_, bodies_);
    if (slip_.any()) closed_centres_.find(solids_);
    if (!bodies_.any_moves()) { // what rests has no fractions, but the lists of the faces are read
        const auto faces = static_cast<std::size_t>(cells_halo_.window().size()) + 1;
        for (auto& of : body_fractions_) {
            if (bodies_.size() == 0 || of.first.extent(0) >= faces) continue;
            reserve(of.first, faces);
            Kokkos::deep_copy(of.first, 0);
        }
        return;
    }
    fraction_builder_.build_body_fractions(
        solids_.nodes(), solids_.distance(), solids_.number(), solids_.moves(), body_fractions_.data());
}

// (S), (D)
void GridStep::find_strains(double dt) {
    strains_.find({grid_, cells_halo_, velocity_, mass_, fractions_, solids_, before_, dt, slip_.lengths()});
    closing_.clear(cells_halo_);
    separation_.clear();
    if (relaxes_density())
        density_relaxation_.find(setup_.options.density_relaxation,
            {grid_, cells_halo_, cells_, particles_, distance_, fractions_, scene::length(setup_.domain.gravity)}, dt);
    find_inflow(fractions_.open);
}

// Inflow that cells must have: by (D), and by (S) through the parts of their faces that are open.
void GridStep::find_inflow(const FaceField& open) {
    const CellBox window = cells_halo_.window(), owned = cells_halo_.owned();
    reserve(inflow_, static_cast<std::size_t>(window.size()));
    const auto out = inflow_, more = density_relaxation_.inflow(), closes = closing_.inflow();
    const bool relaxes_density = more.extent(0) > 0;
    Kokkos::parallel_for(
        "treacle::inflow", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int n) {
            int c[3];
            owned.cell(n, c);
            const int i = window.index(c[0], c[1], c[2]);
            out(i) = closes(i) >= 0 ? closes(i) : relaxes_density ? more(i) : 0.0;
        });
    strains_.add_flux(grid_, cells_halo_, open, inflow_);
}

MomentumBalance::Scene GridStep::balance_scene() {
    return {grid_, cells_halo_, cells_, distance_, fractions_.face_fluid, body_fractions_, particles_,
        balance_.kept(particles_), particle_mass_};
}

// (M)
void GridStep::balance_momentum(StepReport& report, double kick) {
    if (!balances()) return;
    auto loads = report.loads;
    for (std::size_t k = 0; k < report.viscous_loads.size(); ++k) loads[k] += report.viscous_loads[k];
    const auto before = loads;
    balance_.end(comm_, balance_scene(), {setup_.domain.gravity, kick}, bodies_, loads);
    for (std::size_t k = 0; k < loads.size(); ++k) report.loads[k] += loads[k] - before[k];
}

void GridStep::move(StepReport& report, StepTimes& times) {
    if (balances()) balance_.begin(comm_, balance_scene(), bodies_);
    faces_to_particles(grid_, cells_halo_.window(), velocity_, particles_); // (A4)
    balance_momentum(report, times.kick);                                   // (M)
    const double way = (setup_.options.cfl + 1) * grid_.dx, speed = fastest(particles_.velocity());
    if (speed * times.drift > way) times.drift = way / speed;
    const double dt = report.dt = times.drift;
    subtract_faces(grid_, cells_halo_.window(), velocity_, start_, scratch_);
    end_velocities(grid_, cells_halo_.window(), scratch_, times, particles_); // (E)
    const double before = bodies_.time();
    show_pressures();
    body_steps_.begin(solids_, bodies_, particles_);
    bodies_.move(dt);
    if (bodies_.any_moves()) solids_.update(cells_halo_, bodies_);
    const Advection how{FaceSampler(grid_, cells_halo_.window(), velocity_), solids_.sampler(),
        make_domain_sides(grid_, setup_.domain), setup_.options.advection, outlets_,
        body_steps_.end(grid_, solids_, bodies_)};
    const auto gone = advect(how, particles_, dt); // (A5)
    report.projected_out = gone.projected_out;
    report.imbalance = load_imbalance(comm_, particles_.store.owned());
    if (gone.lost + gone.outflow > 0) report.lost = remove_departed(particles_);
    report.lost_by_cause[static_cast<std::size_t>(LossCause::outflow) - 1] = gone.outflow;
    const int stay = particles_.store.owned();
    emit_layers(source_, {before, before + dt}, decomposition_, particles_); // (I)
    if (balances()) keep_angular_momenta(balance_scene(), stay);
    collect(report);
}

void GridStep::correct(StepReport& report) {
    ++steps_;
    const auto& options = setup_.options;
    if (options.correction.method == PositionMethod::none || steps_ % options.correction_every != 0) return;
    distribute_particles();
    solids_.update(cells_halo_, bodies_);
    halo_.gather(particles_.store, {particles_.liquid_field()});
    const auto& g = setup_.domain.gravity;
    report.correction = correction_.apply(
        options.correction, particles_, {cells_, halo_, comm_, solids_, particle_mass_, {g[0], g[1], g[2]}});
    max_density_error_ = report.correction.density_after;
}

// One MAC/APIC step, collective. Tags: src/grid/README.md.
StepReport GridStep::advance(double dt) {
    StepReport report;
    report.dt = dt;
    {
        const auto phase = timers_.scope("sort");
        distribute_particles();
        rebalance();
    }
    {
        const auto phase = timers_.scope("transfer");
        particles_to_grid(); // (A3)
    }
    {
        const auto phase = timers_.scope("surface");
        update_geometry(); // (F1), (F2)
        if (tensions_.largest() > 0) {
            curvature_.find({grid_, cells_halo_, particles_, cells_, particle_mass_, setup_.density, fractions_});
        }
        if (tensions_.differ()) tensions_.find(grid_, cells_halo_, particles_, cells_, particle_mass_);
    }
    // Velocities are those of the middles of steps: from the middle of the last one to that of this one.
    StepTimes times{0.5 * (before_ + dt), dt, !(before_ > 0)};
    const double kick = times.kick;
    wall_momentum_.clear(resting_.count());
    bodies_.begin(dt);
    solids_.update(cells_halo_, bodies_);
    dt_ = dt;
    find_strains(dt); // (S), (D)
    bodies_.fall(kick);
    accelerate(grid_, cells_halo_.window(), setup_.domain.gravity, kick, velocity_); // (A1)
    const bool at_once = solves_monolithic(kick);
    if (at_once) {
        together(report, kick); // (P), (U)
    } else {
        split(report, kick); // (P), (V)
    }
    {
        const auto phase = timers_.scope("move");
        solids_.update(cells_halo_, bodies_);
        extrapolate_velocity({viscous(), slip_.lengths(), viscous_spread(kick), separation_.separated()});
        load_resting(report, kick, at_once);
        move(report, times); // (A4), (E), (A5)
    }
    {
        const auto phase = timers_.scope("correct");
        correct(report); // (C)
    }
    before_ = times.drift;
    const auto weights = bodies_.weight_rates();
    end_motion_.record(middle_motion(), {bodies_.impact_momenta(), weights}, times);
    bodies_.set_lead(end_motion_.lead());
    return report;
}

// Sums the counts over the ranks.
void GridStep::collect(StepReport& report) {
    std::array<std::int64_t, loss_causes + 1> counts{};
    std::copy_n(report.lost_by_cause.begin(), loss_causes, counts.begin());
    for (const auto& particle : report.lost) ++counts[static_cast<std::size_t>(particle.cause) - 1];
    counts[loss_causes] = report.projected_out;
    comm_.sum(std::span<std::int64_t>(counts));
    std::copy_n(counts.begin(), loss_causes, report.lost_by_cause.begin());
    report.projected_out = counts[loss_causes];
    std::erase_if(report.lost, [](const LostParticle& particle) { return particle.cause == LossCause::outflow; });
}

// Collective: the largest size of a vector of the particles.
double GridStep::fastest(const Array3& of) const {
    double square = 0;
    Kokkos::parallel_reduce(
        "treacle::fastest", particles_.store.owned(),
        KOKKOS_LAMBDA(int i, double& most) {
            most = math::max(most, of(i, 0) * of(i, 0) + of(i, 1) * of(i, 1) + of(i, 2) * of(i, 2));
        },
        Kokkos::Max<double>(square));
    return comm_.max(particles_.store.owned() > 0 ? std::sqrt(square) : 0.0);
}

// Collective: the least number of the particles, infinity where there are none.
double GridStep::least(const Array<double>& of) const {
    double out = std::numeric_limits<double>::infinity();
    Kokkos::parallel_reduce(
        "treacle::least", particles_.store.owned(), KOKKOS_LAMBDA(int i, double& low) { low = math::min(low, of(i)); },
        Kokkos::Min<double>(out));
    return comm_.min(particles_.store.owned() > 0 ? out : std::numeric_limits<double>::infinity());
}

// Acceleration that may pull at the liquid in the next step: gravity, unless viscosity or solids hold the liquid
// against it [m/s2]. As that may end, no more than a few times what pulled in the last step.
double GridStep::pull() const {
    const double gravity = scene::length(setup_.domain.gravity);
    if (!(before_ > 0) || !viscous() || bodies_.any_dynamic()) return gravity;
    return std::min(gravity, 4 * fastest(particles_.acceleration()));
}

// Longest step [s] for waves of the surface, whose places are those of the beginning of a step: with viscosity implicit a wave of
// number k stays bounded where g k dt^2 <= 4 + 4 nu k^2 dt. Of all k the grid has, by the thinnest liquid there is.
double GridStep::wave_step() const {
    const double g = scene::length(setup_.domain.gravity);
    const double viscosity = least(particles_.viscosity());
    if (!(g > 0) || !std::isfinite(viscosity)) return std::numeric_limits<double>::infinity();
    const double nu = viscosity / setup_.density, shortest = math::pi / grid_.dx;
    const double a = g * shortest, b = 4 * nu * shortest * shortest;
    const double of_shortest = (b + std::sqrt(b * b + 16 * a)) / (2 * a);
    const bool longer_ones_grow = g * of_shortest < 8 * nu * shortest; // that of number g dt / 8 nu first
    return wave_safety * (longer_ones_grow ? 4 * std::cbrt(nu / (g * g)) : of_shortest);
}

double GridStep::stable_step(double cfl) const {
    const double speed = std::max({fastest(particles_.velocity()), bodies_.max_speed(), resting_.max_speed()});
    if (max_density_error_ > 1) cfl = std::min(cfl, std::max(1.0, cfl / max_density_error_));
    const double pull = this->pull(), way = cfl * grid_.dx;
    double dt = std::numeric_limits<double>::infinity();
    // (speed + pull dt) dt = way.
    if (pull > 0 || speed > 0) dt = 2 * way / (speed + std::sqrt(speed * speed + 4 * pull * way));
    if (before_ > 0 && scene::length(setup_.domain.gravity) > 0) dt = std::min(dt, longest_growth * before_);
    dt = std::min(dt, wave_step());
    if (tensions_.largest() > 0) {
        dt = std::min(dt, std::sqrt(setup_.density * std::pow(grid_.dx, 3) / (4 * math::pi * tensions_.largest())));
    }
    return dt;
}

} // namespace treacle::grid
