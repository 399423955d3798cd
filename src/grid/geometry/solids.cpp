#include "grid/geometry/solids.hpp"

#include "scene/sampling/nearby_distance.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::grid {

namespace {
// Cell widths of exact distances: outside for level sets near contact lines, inside as deep as a particle can come in
// a step (CFL 3).
constexpr double outer_band = 2, inner_band = 4;
constexpr int tile = 4; // cells that are tested together first

// The cells of `all` that are not in `hole`, as up to six boxes.
std::vector<CellBox> without(CellBox all, const CellBox& hole) {
    std::vector<CellBox> out;
    if (intersect(all, hole).empty()) return {all};
    for (int k = 0; k < 3; ++k) {
        CellBox below = all, above = all;
        below.hi[k] = math::min(hole.lo[k], all.hi[k]);
        above.lo[k] = math::max(hole.hi[k], all.lo[k]);
        if (!below.empty()) out.push_back(below);
        if (!above.empty()) out.push_back(above);
        all.lo[k] = math::max(all.lo[k], hole.lo[k]);
        all.hi[k] = math::min(all.hi[k], hole.hi[k]);
    }
    return out;
}

void copy_box(const CellBox& cells, const FineNodes& from, const Array<double>& distance, const Array<int>& number,
    const FineNodes& to, const Array<double>& to_distance, const Array<int>& to_number) {
    if (cells.empty()) return;
    Kokkos::parallel_for(
        "treacle::copy_solid", static_cast<int>(cells.size()), KOKKOS_LAMBDA(int i) {
            int c[3];
            cells.cell(i, c);
            const int a = FineNodes::per_cell * from.window.index(c[0], c[1], c[2]);
            const int b = FineNodes::per_cell * to.window.index(c[0], c[1], c[2]);
            for (int k = 0; k < FineNodes::per_cell; ++k) {
                to_distance(b + k) = distance(a + k);
                to_number(b + k) = number(a + k);
            }
        });
}

// Outside of the domain the exact distance, beyond edges and corners too.
void fill_wall_distance(const FineNodes& nodes, const WallPlanes& walls, double far, const Array<double>& distance,
    const Array<int>& number) {
    Kokkos::parallel_for(
        "treacle::wall_distance", static_cast<int>(nodes.window.size()), KOKKOS_LAMBDA(int i) {
            int c[3];
            nodes.window.cell(i, c);
            for (int corner = 0; corner < FineNodes::per_cell; ++corner) {
                double x[3];
                nodes.position(c, corner, x);
                double least = far, beyond = 0;
                int nearest = Solids::nothing;
                for (int side = 0; side < 2 * walls.dimensions; ++side) {
                    if (!walls.is_wall[side]) continue;
                    const double d = walls.distance(side, x);
                    if (d < 0) beyond += d * d;
                    if (d < least) {
                        least = d;
                        nearest = Solids::side(side);
                    }
                }
                if (beyond > 0) least = -math::sqrt(beyond);
                distance(FineNodes::per_cell * i + corner) = least;
                number(FineNodes::per_cell * i + corner) = nearest;
            }
        });
}

// A body where it is, or an image of it.
class PosedBody {
public:
    PosedBody(const rigid::RigidBodies& bodies, std::size_t body, const Vec3& shift)
        : distance_(bodies.setup().bodies[body].region.front()), start_(bodies.setup().bodies[body].centre),
          now_(rigid::operator+(bodies.pose(body).centre, shift)), moves_(bodies.moves(body)), shift_(shift) {
        if (moves_) back_ = rigid::transposed(rigid::to_matrix(bodies.pose(body).turn));
    }
    double distance(const Vec3& x) {
        using namespace rigid;
        return moves_ ? distance_(start_ + back_ * (x - now_)) : distance_(x - shift_);
    }

private:
    scene::NearbyDistance distance_;
    Vec3 start_, now_;
    bool moves_;
    Vec3 shift_;
    rigid::Matrix3 back_{};
};

// Moving bodies that are present, and their poses.
std::vector<std::pair<std::size_t, rigid::Pose>> moving_poses(const rigid::RigidBodies& bodies) {
    std::vector<std::pair<std::size_t, rigid::Pose>> out;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (bodies.moves(b) && bodies.present(b)) out.emplace_back(b, bodies.pose(b));
    }
    return out;
}

// Cells that a body's surface and the band around it may reach; all of them for what has no end.
CellBox bounding_cells(
    const rigid::RigidBodies& bodies, std::size_t body, const Vec3& shift, const MacGrid& grid, const CellBox& cells) {
    const auto& setup = bodies.setup().bodies[body];
    const auto& region = setup.region.front();
    if (region.inverted() || !region.closed()) return cells;
    Vec3 low = region.bounds().min, high = region.bounds().max;
    if (bodies.moves(body)) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = bodies.pose(body).centre[k] - setup.bounding_radius;
            high[k] = bodies.pose(body).centre[k] + setup.bounding_radius;
        }
    }
    CellBox out = cells;
    for (int k = 0; k < grid.dimensions; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        const double first = (low[axis] + shift[axis] - grid.lower[k]) / grid.dx - outer_band - 1;
        const double last = (high[axis] + shift[axis] - grid.lower[k]) / grid.dx + outer_band + 1;
        out.lo[k] = math::max(out.lo[k], static_cast<int>(std::floor(math::max(first, double(out.lo[k])))));
        out.hi[k] = math::min(out.hi[k], static_cast<int>(std::ceil(math::min(last, double(out.hi[k])))));
    }
    return out;
}

// Takes the distance of one body into what there is, coarse blocks first.
template <class Distances, class Numbers>
class BodySampler {
public:
    BodySampler(PosedBody& body, int number, const FineNodes& nodes, double dx, const Distances& distance,
        const Numbers& numbers)
        : body_(body), number_(number), nodes_(nodes), dx_(dx), distance_(distance), numbers_(numbers) {}

    void sample(const CellBox& cells) { visit(cells, tile); }

private:
    void visit(const CellBox& cells, int size) {
        CellBox block;
        for (block.lo[2] = cells.lo[2]; block.lo[2] < cells.hi[2]; block.lo[2] += size) {
            for (block.lo[1] = cells.lo[1]; block.lo[1] < cells.hi[1]; block.lo[1] += size) {
                for (block.lo[0] = cells.lo[0]; block.lo[0] < cells.hi[0]; block.lo[0] += size) {
                    for (int k = 0; k < 3; ++k) block.hi[k] = math::min(block.lo[k] + size, cells.hi[k]);
                    take(block, size);
                }
            }
        }
    }
    void take(const CellBox& block, int size) {
        Vec3 middle{0, 0, 0};
        double radius2 = 0;
        for (int k = 0; k < nodes_.dimensions; ++k) {
            const double width = dx_ * (block.hi[k] - block.lo[k]);
            middle[static_cast<std::size_t>(k)] = nodes_.lower[k] + dx_ * block.lo[k] + 0.5 * width;
            radius2 += 0.25 * width * width;
        }
        const double d = body_.distance(middle), radius = std::sqrt(radius2);
        if (d - radius > outer_band * dx_) return;
        if (d + radius < -inner_band * dx_) {
            for_nodes(block, [&](const double*, int at) { lower(at, d); });
        } else if (size > 1) {
            visit(block, 1);
        } else {
            for_nodes(block, [&](const double* x, int at) { lower(at, body_.distance({x[0], x[1], x[2]})); });
        }
    }
    template <class Visit>
    void for_nodes(const CellBox& block, const Visit& visit_node) {
        for (int i = 0; i < block.size(); ++i) {
            int c[3];
            block.cell(i, c);
            for (int corner = 0; corner < nodes_.used(); ++corner) {
                double x[3];
                nodes_.position(c, corner, x);
                visit_node(x, FineNodes::per_cell * nodes_.window.index(c[0], c[1], c[2]) + corner);
            }
        }
    }
    void lower(int at, double d) {
        if (d >= distance_(at)) return;
        // The first of two that are as near but for round-off counts, on all ranks.
        if (numbers_(at) == Solids::nothing || d < distance_(at) - nodes_.surface()) numbers_(at) = number_;
        distance_(at) = d;
    }

    PosedBody& body_;
    int number_;
    const FineNodes& nodes_;
    double dx_;
    Distances distance_;
    Numbers numbers_;
};

// Shifts by whole periods whose image of the body may meet the cells, with what they reach.
template <class Visit>
void for_images(
    const rigid::RigidBodies& bodies, std::size_t body, const MacGrid& grid, const CellBox& cells, const Visit& visit) {
    int images[3];
    Vec3 back{0, 0, 0}; // to the domain, for what has gone through periodic sides
    const auto& region = bodies.setup().bodies[body].region.front();
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        images[k] = grid.cells.periodic(k) && region.closed() && !region.inverted() ? 1 : 0;
        if (images[k] == 0) continue;
        back[axis] =
            -grid.cells.period[k] * std::floor((bodies.pose(body).centre[axis] - grid.lower[k]) / grid.cells.period[k]);
    }
    for (int z = -images[2]; z <= images[2]; ++z) {
        for (int y = -images[1]; y <= images[1]; ++y) {
            for (int x = -images[0]; x <= images[0]; ++x) {
                const Vec3 shift{back[0] + x * grid.cells.period[0], back[1] + y * grid.cells.period[1],
                    back[2] + z * grid.cells.period[2]};
                const CellBox covered = bounding_cells(bodies, body, shift, grid, cells);
                if (!covered.empty()) visit(shift, covered);
            }
        }
    }
}
} // namespace

Solids::Solids(const MacGrid& grid, const scene::Domain& domain, std::vector<char> counted)
    : grid_(grid), counted_(std::move(counted)), band_(outer_band * grid.dx) {
    walls_.dimensions = grid.dimensions;
    for (std::size_t side = 0; side < 6; ++side) {
        walls_.is_wall[side] =
            static_cast<int>(side) / 2 < grid.dimensions && domain.faces[side].kind == scene::BoundaryKind::wall;
        walls_.at[side] = side % 2 == 0 ? domain.min[side / 2] : domain.max[side / 2];
        for (std::size_t k = 0; k < 3; ++k) motion_.side[side][k] = domain.faces[side].velocity[k];
    }
}

void Solids::add_bodies(const rigid::RigidBodies& bodies, bool moving, const CellBox& cells) {
    const auto& to = moving ? distance_ : resting_;
    const auto& to_number = moving ? number_ : resting_number_;
    auto distance = Kokkos::create_mirror_view(to);
    auto numbers = Kokkos::create_mirror_view(to_number);
    bool fetched = false;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (bodies.moves(b) != moving || !bodies.present(b) || (!counted_.empty() && counted_[b] == 0)) continue;
        for_images(bodies, b, grid_, cells, [&](const Vec3& shift, const CellBox& covered) {
            if (!fetched) {
                Kokkos::deep_copy(distance, to);
                Kokkos::deep_copy(numbers, to_number);
                fetched = true;
            }
            PosedBody body(bodies, b, shift);
            BodySampler sampler(body, static_cast<int>(b), nodes_, grid_.dx, distance, numbers);
            sampler.sample(covered);
            if (moving) touched_.push_back(covered);
        });
    }
    if (!fetched) return;
    Kokkos::deep_copy(to, distance);
    Kokkos::deep_copy(to_number, numbers);
}

void Solids::follow_window(const CellBox& window, const rigid::RigidBodies& bodies) {
    const FineNodes old = nodes_;
    const auto old_distance = resting_;
    const auto old_number = resting_number_;
    nodes_ = FineNodes(grid_, window);
    resting_ =
        Array<double>(Kokkos::view_alloc(Kokkos::WithoutInitializing, "treacle::resting_distance"), nodes_.size());
    resting_number_ =
        Array<int>(Kokkos::view_alloc(Kokkos::WithoutInitializing, "treacle::resting_number"), nodes_.size());
    fill_wall_distance(nodes_, walls_, band_, resting_, resting_number_);
    const CellBox known = intersect(old.window, window);
    for (const auto& cells : without(window, known)) add_bodies(bodies, false, cells);
    copy_box(known, old, old_distance, old_number, nodes_, resting_, resting_number_);
    touched_.clear();
    if (bodies.any_moves()) {
        reserve(distance_, nodes_.size());
        reserve(number_, nodes_.size());
        copy_box(window, nodes_, resting_, resting_number_, nodes_, distance_, number_);
    } else {
        distance_ = resting_;
        number_ = resting_number_;
    }
}

bool Solids::update(const CellHalo& halo, const rigid::RigidBodies& bodies) {
    const bool changed = follow(halo, bodies);
    changes_ += changed ? 1 : 0;
    return changed;
}

bool Solids::follow(const CellHalo& halo, const rigid::RigidBodies& bodies) {
    const bool anew = !same_cells(nodes_.window, halo.window());
    if (anew) follow_window(halo.window(), bodies);
    upload_motion(bodies);
    auto poses = moving_poses(bodies);
    if (!anew && poses == poses_) return false;
    poses_ = std::move(poses);
    if (!bodies.any_moves()) return anew;
    const bool before = !touched_.empty();
    for (const auto& cells : touched_) {
        copy_box(cells, nodes_, resting_, resting_number_, nodes_, distance_, number_);
    }
    touched_.clear();
    add_bodies(bodies, true, nodes_.window);
    return anew || before || !touched_.empty();
}

void Solids::upload_motion(const rigid::RigidBodies& bodies) {
    update_motion(bodies, grid_, motion_);
    reserve(moves_, bodies.size());
    auto moves = Kokkos::create_mirror_view(moves_);
    for (std::size_t b = 0; b < bodies.size(); ++b) moves(b) = bodies.moves(b) ? 1 : 0;
    Kokkos::deep_copy(moves_, moves);
}

double Solids::distance_at(const Vec3& x, const rigid::RigidBodies& bodies) const {
    double least = 1e300;
    for (int side = 0; side < 6; ++side) {
        if (walls_.is_wall[side]) least = std::min(least, walls_.distance(side, x.data()));
    }
    const CellBox all = grid_.cells.all();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (!bodies.present(b)) continue;
        for_images(bodies, b, grid_, all, [&](const Vec3& shift, const CellBox&) {
            least = std::min(least, PosedBody(bodies, b, shift).distance(x));
        });
    }
    return least;
}

} // namespace treacle::grid
