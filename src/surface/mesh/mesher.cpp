#include "surface/mesh/mesher.hpp"

#include "base/text/error.hpp"
#include "kokkos/bounds.hpp"
#include "surface/mesh/components.hpp"
#include "surface/mesh/numbering.hpp"
#include "surface/mesh/solid_images.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::surface {

namespace {
constexpr int velocity = 2, pressure = 3, liquid = 4, image = 5; // fields of the store

// Layers of cells beside a rank's own that its smoothed vertices depend on: one a step, and one for normals.
int layers_for(const Options& options) { return 2 * options.smoothing_passes + 1; }

void check(const Options& options) {
    const auto refuse = [](const std::string& problem, const std::string& cure) {
        throw InputError({"surface", problem, "", cure});
    };
    if (!(options.spacing > 0)) refuse("the particles' spacing must be > 0", "");
    if (!(options.lattice_step >= 0.25 && options.lattice_step <= 1))
        refuse("the lattice's step must be 0.25 to 1 spacings", "0.5 is usual");
    // A tile's neighbours hold what its nodes are summed over.
    if (!(options.kernel_width >= 1 && 2 * options.kernel_width <= (tile_edge - 1) * options.lattice_step)) {
        refuse("the kernel's width must be 1 spacing or more and its support within 7 cells of the lattice",
            "take a larger step");
    }
    if (options.smoothing_passes < 0 || options.smoothing_passes > 3) refuse("smoothing passes must be 0 to 3", "");
    if (!(std::abs(options.iso) <= 0.5))
        refuse("the surface's value must be -0.5 to 0.5 spacings", "0 keeps the volume");
    if (options.scalars < 0 || options.scalars > most_scalars)
        refuse("vertices take up to 16 numbers", "name fewer fields");
    if (options.deconvolution_passes < 0 || options.deconvolution_passes > 20)
        refuse("deconvolution passes must be 0 to 20", "");
}
} // namespace

Mesher::Mesher(const Comm& comm, const Domain& domain, const Options& options)
    : comm_(comm), domain_(domain), options_(options),
      base_((check(options), make_lattice(domain, options.lattice_step * options.spacing))) {
    store_.add<Array3>("velocity", "m/s", FieldRole::state);
    store_.add<Array<double>>("pressure", "Pa", FieldRole::state);
    store_.add<Array<int>>("liquid", "", FieldRole::state);
    store_.add<Array<std::int64_t>>("image", "", FieldRole::state);
    sources_ = {velocity, pressure, liquid, {}};
    for (int k = 0; k < options.scalars; ++k)
        sources_.scalars.push_back(store_.add<Array<double>>("scalar " + std::to_string(k), "", FieldRole::state));
}

Mesher::~Mesher() = default;

// True when a particle counts for nodes of the domain. Those that do not are farther behind a cut than the kernel
// reaches.
bool Mesher::near_domain(const double* position) const {
    const double support_radius = 2 * options_.kernel_width * options_.spacing;
    for (std::size_t k = 0; k < static_cast<std::size_t>(domain_.dimensions); ++k) {
        if (domain_.sides[2 * k] == Side::cut && position[k] < domain_.min[k] - support_radius) return false;
        if (domain_.sides[2 * k + 1] == Side::cut && position[k] > domain_.max[k] + support_radius) return false;
    }
    return true;
}

void Mesher::take(const ParticleRows& particles) {
    std::vector<std::size_t> rows;
    bool finite = true;
    for (std::size_t i = 0; i < particles.id.size(); ++i) {
        const double* x = particles.position.data() + 3 * i;
        finite = finite && std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
        if (near_domain(x)) rows.push_back(i);
    }
    if (comm_.any(!finite))
        throw InputError(
            {"surface", "a particle's position is not finite", "the run has diverged", "take an earlier frame"});
    const auto n = static_cast<int>(rows.size());
    store_.resize_owned(n);
    const auto& x = store_.position();
    const auto& id = store_.id();
    const auto& u = store_.get<Array3>(velocity);
    const auto& p = store_.get<Array<double>>(pressure);
    const auto& l = store_.get<Array<int>>(liquid);
    const auto hx = Kokkos::create_mirror_view(x), hu = Kokkos::create_mirror_view(u);
    const auto hid = Kokkos::create_mirror_view(id);
    const auto hp = Kokkos::create_mirror_view(p);
    const auto hl = Kokkos::create_mirror_view(l);
    for (int i = 0; i < n; ++i) {
        const auto row = rows[static_cast<std::size_t>(i)];
        for (int k = 0; k < 3; ++k) {
            const auto at = 3 * row + static_cast<std::size_t>(k);
            hx(i, k) = k < domain_.dimensions ? particles.position[at] : 0;
            hu(i, k) = particles.velocity.empty() ? 0 : particles.velocity[at];
        }
        hid(i) = particles.id[row];
        hp(i) = particles.pressure.empty() ? 0 : particles.pressure[row];
        hl(i) = particles.liquid.empty() ? 0 : static_cast<int>(particles.liquid[row]);
    }
    Kokkos::deep_copy(x, hx);
    Kokkos::deep_copy(u, hu);
    Kokkos::deep_copy(id, hid);
    Kokkos::deep_copy(p, hp);
    Kokkos::deep_copy(l, hl);
    Kokkos::deep_copy(store_.get<Array<std::int64_t>>(image), std::int64_t(0));
    for (std::size_t k = 0; k < sources_.scalars.size(); ++k) {
        const auto& values = store_.get<Array<double>>(sources_.scalars[k]);
        const auto host = Kokkos::create_mirror_view(values);
        for (int i = 0; i < n; ++i) host(i) = particles.scalars[k][rows[static_cast<std::size_t>(i)]];
        Kokkos::deep_copy(values, host);
    }
}

namespace {
Bounds bounds_of(const ParticleStore& store) {
    const auto x = store.position();
    int none = 0;
    return reduce_bounds(
        "treacle::surface_bounds", 0, store.owned(), none,
        KOKKOS_LAMBDA(int i, Bounds& around, int&) { around.include(x(i, 0), x(i, 1), x(i, 2)); });
}
} // namespace

// Tiles to ranks by particles.
void Mesher::cut_domain() {
    const auto x = store_.position();
    const auto bounds = bounds_of(store_);
    double ends[6];
    for (int k = 0; k < 3; ++k) {
        ends[k] = -bounds.lo[k];
        ends[3 + k] = bounds.hi[k];
    }
    comm_.max(std::span<double>(ends));
    const double lo[3] = {-ends[0], -ends[1], -ends[2]};
    lattice_ = base_;
    cover(lattice_, domain_, lo, ends + 3);
    const auto& grid = lattice_.grid;
    decomposition_ = std::make_unique<Decomposition>(comm_, grid);
    if (comm_.size() > 1) {
        const auto mine = bounds.cells(grid);
        std::vector<double> weight(static_cast<std::size_t>(mine.size()), 0);
        const auto host = on_host(x);
        for (int i = 0; i < store_.owned(); ++i) {
            int c[3];
            grid.locate(host(i, 0), host(i, 1), host(i, 2), c);
            weight[static_cast<std::size_t>(mine.index(c[0], c[1], c[2]))] += 1;
        }
        std::vector<int> cells;
        std::vector<double> weights;
        for (std::size_t t = 0; t < weight.size(); ++t) {
            if (weight[t] == 0) continue;
            int c[3];
            mine.cell(static_cast<int>(t), c);
            cells.insert(cells.end(), c, c + 3);
            weights.push_back(weight[t]);
        }
        decomposition_->repartition(cells, weights);
    }
}

// Particles to their ranks, sorted, with those of the neighbouring tiles as ghosts.
void Mesher::distribute() {
    const auto& grid = lattice_.grid;
    migration_.to_owner(store_, *decomposition_);
    sort_.sort(store_, grid, decomposition_->box(), cells_);
    halo_.connect(*decomposition_);
    halo_.rebuild(store_, cells_);
    halo_.gather(store_, {velocity, pressure, liquid, image});
    for (const int scalar : sources_.scalars) halo_.gather(store_, {scalar});
}

const Mesh& Mesher::build(const ParticleRows& particles, const Solids& solids) {
    take(particles);
    const auto total = comm_.sum(static_cast<std::int64_t>(store_.owned()));
    summary_ = {};
    summary_.particles = total;
    mesh_ = {};
    mesh_.dimensions = domain_.dimensions;
    if (total == 0) return mesh_;
    const double support = 2 * options_.kernel_width * options_.spacing;
    const Solids* cut = solids.bodies.empty() ? nullptr : &solids;
    cut_domain();
    if (cut != nullptr) add_solid_images(store_, image, solids, support, lattice_);
    distribute();
    const CellBox box = decomposition_->box();
    const CellBox window = box.empty() ? CellBox{} : grown(box, 1, lattice_.dimensions);
    const auto& points = points_.build(store_, {image, liquid}, lattice_, window, support);
    function_.build(*decomposition_, lattice_, points, options_, cut);
    triangulation_.build(lattice_, box, function_, layers_for(options_));
    auto& patch = triangulation_.patch();
    smoothing_.smooth(patch, options_.smoothing_passes);
    const auto normals = smoothing_.normals(patch);
    attributes_.interpolate(patch, {store_, sources_}, lattice_, points, options_);

    const auto host = to_host(patch);
    const VertexOwners owners(*decomposition_, lattice_);
    const auto kept = find_components(comm_, host, owners, options_.spacing, options_.min_volume, summary_);
    number_mesh(comm_, {host, kept}, owners,
        {normals, attributes_.velocity(), attributes_.pressure(), attributes_.liquid(), attributes_.scalars(),
            options_.scalars},
        mesh_);
    summary_.area = comm_.sum(area_of(mesh_));
    return mesh_;
}

} // namespace treacle::surface
