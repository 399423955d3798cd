#include "sph/viscosity/multigrid/viscous_multilevel.hpp"

#include "sph/viscosity/multigrid/velocity_transfers.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

namespace treacle::sph {

namespace {
constexpr double spacings_across = 1.7; // of the finest cells
// Squares of a cell's width that the viscosity must cover in a step for coarser cells to have a benefit.
constexpr double coarsening_limit = 2;
constexpr std::int64_t dense_nodes = 60; // of all ranks, for which the coarsest level is solved directly
// Chebyshev's polynomials of the smoothers, on this fraction of the eigenvalues and above.
constexpr int smoother_steps = 2, last_steps = 4;
constexpr double smoothed_fraction = 0.15, last_fraction = 0.06;
} // namespace

struct ViscousMultilevel::Levels {
    virtual ~Levels() = default;
    virtual void set_up(const ViscousContext& parts, const ViscousOperator& of) = 0;
    virtual double apply(const ViscousOperator& of, const Array3& r, const Array3& z) = 0;
    virtual std::size_t bytes() const = 0;
};

namespace {
GradientEnergy energy_of(ViscosityForm form) {
    switch (form) {
    case ViscosityForm::laplacian: return {1, 0};
    default: // of the pairwise one nearly
        return {1, 1};
    }
}

template <int D>
class CellLevels : public ViscousMultilevel::Levels {
public:
    CellLevels(const Comm& comm, const CellGrid& grid, double spacing, const GradientEnergy& energy)
        : comm_(comm), energy_(energy) {
        for (int k = 0; k < D; ++k) {
            origin_[k] = grid.origin[k];
            finest_.width[k] = spacings_across * spacing;
            if (!grid.periodic(k)) continue;
            // Two or three cells on the coarsest of all levels.
            int coarsening_levels = 0;
            const double fitting = grid.period[k] / finest_.width[k];
            while (fitting > 3.5 * (1 << coarsening_levels)) ++coarsening_levels;
            const int coarsest = std::max(1, static_cast<int>(std::lround(fitting / (1 << coarsening_levels))));
            finest_.period[k] = coarsest << coarsening_levels;
            finest_.width[k] = grid.period[k] / finest_.period[k];
        }
    }

    void set_up(const ViscousContext& parts, const ViscousOperator& of) override;
    double apply(const ViscousOperator& of, const Array3& r, const Array3& z) override;
    std::size_t bytes() const override;

private:
    using Level = VelocityCells<D>;
    void sort_particles(const ViscousContext& parts, const ViscousOperator& of, Level& level);
    bool coarsen(Level& fine, Level& coarse) const;
    void coarsen_masses(Level& fine, Level& coarse) const;
    void finish(Level& level);
    void factorise(const Level& level);
    void solve_densely(Level& level);
    void cycle(std::size_t depth);

    Comm comm_;
    GradientEnergy energy_;
    double origin_[3]{0, 0, 0};
    LatticeShape finest_;
    std::deque<Level> levels_;
    std::size_t used_ = 0;
    bool dense_ = false;
    CellParticles members_;
    double aspect_[3]{0, 0, 0}; // of the last element
    typename Element<D>::Matrix matrix_;
    Element<D> element_;
    double largest_ = 1;
    std::vector<std::size_t> dense_row_; // of each node of the coarsest level, in the matrix of all ranks
    Eigen::LDLT<Eigen::MatrixXd> factor_;
};

// Cells of the owned particles, with their stiffness and the nodes' masses.
template <int D>
void CellLevels<D>::sort_particles(const ViscousContext& parts, const ViscousOperator& of, Level& level) {
    const auto& store = parts.liquid.store;
    const auto n = static_cast<std::size_t>(store.owned());
    const auto x = on_host(store.position());
    const auto coefficient = on_host(of.smoothed_viscous_coefficient());
    const auto inertia_and_wall_diagonal = on_host(of.inertia_and_wall_diagonal());
    std::vector<int> cell_of(n);
    std::vector<float> weights(corners<D> * n);
    KeyIndexMap numbers;
    numbers.clear(n / 4);
    std::int64_t last = -1;
    int number = -1;
    for (std::size_t i = 0; i < n; ++i) {
        int node[3] = {0, 0, 0};
        double at[3];
        for (std::size_t k = 0; k < D; ++k) {
            const double along = (x(i, k) - origin_[k]) / finest_.width[k], below = std::floor(along);
            node[k] = static_cast<int>(below);
            at[k] = along - below;
        }
        trilinear_weights<D>(at, &weights[corners<D> * i]);
        finest_.wrap(node);
        const auto key = LatticeKey::pack(node);
        if (key != last) number = numbers.number(key);
        last = key;
        cell_of[i] = number;
    }
    level.shape = finest_;
    if (comm_.sum(std::int64_t{level.cell_keys != numbers.keys()}) > 0) { // on any rank
        level.cell_keys = numbers.keys();
        level.connect(comm_);
    }
    std::vector<int> begin(level.cell_keys.size() + 1, 0);
    for (const int e : cell_of) ++begin[static_cast<std::size_t>(e) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    auto next = begin;
    std::vector<int> particle(n);
    std::vector<float> sorted(corners<D> * n);
    level.host_stiffness.assign(level.cell_keys.size(), 0.0f);
    level.host_mass.assign(static_cast<std::size_t>(level.nodes), 0.0f);
    const double square = finest_.width[0] * finest_.width[0];
    for (std::size_t i = 0; i < n; ++i) {
        const auto e = static_cast<std::size_t>(cell_of[i]);
        const auto m = static_cast<std::size_t>(next[e]++);
        particle[m] = static_cast<int>(i);
        level.host_stiffness[e] += static_cast<float>(coefficient(i) / square);
        for (std::size_t a = 0; a < corners<D>; ++a) {
            const float one = sorted[corners<D> * m + a] = weights[corners<D> * i + a];
            level.host_mass[static_cast<std::size_t>(level.host_corner[corners<D> * e + a])] +=
                one * inertia_and_wall_diagonal(i);
        }
    }
    assign(members_.begin, begin);
    assign(members_.particle, particle);
    assign(members_.weight, sorted);
}

// Cells of two an axis; along periodic axes only where they come out even. False where no axis is left.
template <int D>
bool CellLevels<D>::coarsen(Level& fine, Level& coarse) const {
    bool halved[3] = {false, false, false};
    coarse.shape = fine.shape;
    for (int k = 0; k < D; ++k) {
        const int period = fine.shape.period[k];
        halved[k] = period == 0 || (period % 2 == 0 && period > 2);
        if (!halved[k]) continue;
        coarse.shape.width[k] *= 2;
        coarse.shape.period[k] /= 2;
    }
    if (!halved[0] && !halved[1] && !halved[2]) return false;
    KeyIndexMap numbers;
    numbers.clear(fine.cell_keys.size() / 4);
    std::vector<int> of(fine.cell_keys.size());
    for (std::size_t e = 0; e < fine.cell_keys.size(); ++e) {
        int cell[3];
        LatticeKey::unpack(fine.cell_keys[e], cell);
        for (int k = 0; k < D; ++k) cell[k] = halved[k] ? floor_divide(cell[k], 2) : cell[k];
        of[e] = numbers.number(LatticeKey::pack(cell));
    }
    coarse.cell_keys = numbers.keys();
    coarse.host_stiffness.assign(coarse.cell_keys.size(), 0.0f);
    const double widths = fine.shape.width[0] / coarse.shape.width[0];
    for (std::size_t e = 0; e < of.size(); ++e) {
        coarse.host_stiffness[static_cast<std::size_t>(of[e])] +=
            static_cast<float>(widths * widths) * fine.host_stiffness[e];
    }
    coarse.connect(comm_);
    coarsen_masses(fine, coarse);
    return true;
}

// Which nodes a finer one lies between, and the masses. Along an axis that is not halved a node lies on one.
template <int D>
void CellLevels<D>::coarsen_masses(Level& fine, Level& coarse) const {
    constexpr int family = power_of_3(D);
    const auto& keys = fine.node_numbers.keys();
    const auto coarse_nodes = static_cast<std::size_t>(coarse.nodes);
    std::vector<int> parents(keys.size() * corners<D>, -1), children(coarse_nodes * family, -1);
    std::vector<float> weights(keys.size());
    coarse.host_mass.assign(coarse_nodes, 0.0f);
    for (std::size_t v = 0; v < keys.size(); ++v) {
        int node[3], below[3], between[3] = {0, 0, 0};
        LatticeKey::unpack(keys[v], node);
        float weight = 1;
        for (int k = 0; k < 3; ++k) {
            below[k] = node[k];
            if (k >= D || coarse.shape.width[k] == fine.shape.width[k]) continue;
            below[k] = floor_divide(node[k], 2);
            between[k] = node[k] - 2 * below[k];
            if (between[k] == 1) weight *= 0.5f;
        }
        weights[v] = weight;
        for (int c = 0; c < corners<D>; ++c) {
            int parent[3] = {below[0], below[1], below[2]};
            bool there = true;
            int slot = 0;
            for (int k = 0, stride = 1; k < D; ++k, stride *= 3) {
                const int up = c >> k & 1;
                there = there && up <= between[k];
                parent[k] += up;
                slot += stride * (between[k] == 0 ? 1 : (up == 1 ? 0 : 2));
            }
            if (!there) continue;
            coarse.shape.wrap(parent);
            const auto number = static_cast<std::size_t>(coarse.node_numbers.find(LatticeKey::pack(parent)));
            parents[corners<D> * v + static_cast<std::size_t>(c)] = static_cast<int>(number);
            children[family * number + static_cast<std::size_t>(slot)] = static_cast<int>(v);
            coarse.host_mass[number] += weight * fine.host_mass[v];
        }
    }
    assign(fine.parents, parents);
    assign(fine.parent_weight, weights);
    assign(coarse.children, children);
}

template <int D>
void CellLevels<D>::finish(Level& level) {
    const double* width = level.shape.width;
    const double aspect[3] = {1, width[1] / width[0], width[2] / width[0]};
    if (!std::equal(aspect, aspect + D, aspect_)) {
        std::copy(aspect, aspect + 3, aspect_);
        element_ = Element<D>(energy_, width);
        matrix_ = element_.matrix();
        largest_ = largest_eigenvalue<D>(matrix_);
    }
    level.finish(element_, matrix_, largest_);
}

template <int D>
void CellLevels<D>::set_up(const ViscousContext& parts, const ViscousOperator& of) {
    used_ = 0;
    dense_ = false;
    for (;;) {
        if (levels_.size() == used_) levels_.emplace_back();
        auto& level = levels_[used_];
        if (used_ == 0)
            sort_particles(parts, of, level);
        else if (!coarsen(levels_[used_ - 1], level))
            return;
        ++used_;
        finish(level);
        dense_ = comm_.sum(std::int64_t{level.nodes}) <= dense_nodes;
        if (dense_) {
            factorise(level);
            return;
        }
        if (of.max_viscous_coefficient() <= coarsening_limit * level.shape.width[0] * level.shape.width[0]) return;
    }
}

// The matrix of the coarsest level, of which every rank gets all: a few dozen nodes.
template <int D>
void CellLevels<D>::factorise(const Level& level) {
    const auto& keys = level.node_numbers.keys();
    KeyIndexMap numbers;
    for (const auto key : comm_.all_gather(std::span<const std::int64_t>(keys))) numbers.number(key);
    const auto n = static_cast<std::size_t>(D * numbers.size());
    std::vector<double> entries(n * n, 0.0);
    dense_row_.resize(keys.size());
    for (std::size_t v = 0; v < keys.size(); ++v) {
        dense_row_[v] = static_cast<std::size_t>(D * numbers.find(keys[v]));
        for (std::size_t k = 0; k < D; ++k)
            entries[(dense_row_[v] + k) * (n + 1)] += static_cast<double>(level.host_mass[v]);
    }
    for (std::size_t e = 0; e < level.cell_keys.size(); ++e) {
        for (std::size_t a = 0; a < Element<D>::unknowns; ++a) {
            const auto row = dense_row_[static_cast<std::size_t>(level.host_corner[corners<D> * e + a / D])] + a % D;
            for (std::size_t b = 0; b < Element<D>::unknowns; ++b) {
                const auto column =
                    dense_row_[static_cast<std::size_t>(level.host_corner[corners<D> * e + b / D])] + b % D;
                entries[row * n + column] +=
                    static_cast<double>(level.host_stiffness[e]) * matrix_(static_cast<int>(a), static_cast<int>(b));
            }
        }
    }
    comm_.sum(std::span(entries));
    double most = 0;
    for (std::size_t k = 0; k < n; ++k) most = std::max(most, entries[k * (n + 1)]);
    for (std::size_t k = 0; k < n; ++k) entries[k * (n + 1)] += 1e-12 * most; // of nodes that nothing holds
    factor_.compute(Eigen::Map<const Eigen::MatrixXd>(entries.data(), static_cast<int>(n), static_cast<int>(n)));
}

template <int D>
void CellLevels<D>::solve_densely(Level& level) {
    std::vector<double> right(static_cast<std::size_t>(factor_.rows()), 0.0);
    const auto r = on_host(level.r), first = on_host(level.shared.first());
    for (std::size_t v = 0; v < dense_row_.size(); ++v) {
        for (std::size_t k = 0; k < D; ++k) right[dense_row_[v] + k] += static_cast<double>(first(v) * r(4 * v + k));
    }
    comm_.sum(std::span(right));
    const Eigen::VectorXd solution =
        factor_.solve(Eigen::Map<const Eigen::VectorXd>(right.data(), static_cast<int>(right.size())));
    std::vector<float> z(dense_row_.size() * 4, 0.0f);
    for (std::size_t v = 0; v < dense_row_.size(); ++v) {
        for (std::size_t k = 0; k < D; ++k)
            z[4 * v + k] = static_cast<float>(solution(static_cast<int>(dense_row_[v] + k)));
    }
    assign(level.z, z);
}

// z = M r of a level.
template <int D>
void CellLevels<D>::cycle(std::size_t depth) {
    auto& level = levels_[depth];
    const bool last = depth + 1 == used_;
    if (last && dense_) return solve_densely(level);
    level.smooth(last ? last_steps : smoother_steps, last ? last_fraction : smoothed_fraction, true);
    if (last) return;
    auto& next = levels_[depth + 1];
    level.subtract_product();
    Kokkos::parallel_for(
        "treacle::velocity_restrict", next.nodes, Restrict<D>{next.children, level.shared.first(), level.r, next.r});
    next.shared.add(next.r, 4);
    cycle(depth + 1);
    Kokkos::parallel_for("treacle::velocity_prolong", level.nodes,
        Prolong<D>{level.parents, level.parent_weight, next.z, level.d, level.z});
    level.smooth(smoother_steps, smoothed_fraction, false);
}

template <int D>
double CellLevels<D>::apply(const ViscousOperator& of, const Array3& r, const Array3& z) {
    auto& level = levels_.front();
    Kokkos::parallel_for("treacle::velocity_of_particles", level.cells, ParticleForces<D>{members_, r, level.force});
    level.sum_forces();
    cycle(0);
    double sum = 0;
    Kokkos::parallel_reduce("treacle::velocity_to_particles", level.cells,
        ParticleVelocities<D>{members_, level.corner, level.z, of.block(), r, z}, sum);
    return level.cells > 0 ? sum : 0;
}

template <int D>
std::size_t CellLevels<D>::bytes() const {
    std::size_t out = 4 * (members_.begin.span() + members_.particle.span() + members_.weight.span());
    for (const auto& level : levels_) out += level.bytes();
    return out;
}

std::unique_ptr<ViscousMultilevel::Levels> make_levels(const ViscousContext& parts, const CellGrid& grid) {
    const auto energy = energy_of(parts.options.viscosity.form);
    if (grid.dimensions == 2) return std::make_unique<CellLevels<2>>(parts.comm, grid, parts.constants.spacing, energy);
    return std::make_unique<CellLevels<3>>(parts.comm, grid, parts.constants.spacing, energy);
}
} // namespace

ViscousMultilevel::ViscousMultilevel(const CellGrid& grid) : grid_(grid) {}
ViscousMultilevel::~ViscousMultilevel() = default;

void ViscousMultilevel::set_up(const ViscousContext& parts, const ViscousOperator& of) {
    if (!levels_) levels_ = make_levels(parts, grid_);
    levels_->set_up(parts, of);
}
double ViscousMultilevel::apply(const ViscousOperator& of, const Array3& r, const Array3& z) {
    return levels_->apply(of, r, z);
}
std::size_t ViscousMultilevel::bytes() const { return levels_ ? levels_->bytes() : 0; }

} // namespace treacle::sph
