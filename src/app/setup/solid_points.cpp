#include "app/setup/solid_points.hpp"

#include "app/input/host_rows.hpp"

namespace treacle::app {

SolidPoints::SolidPoints(const Comm& comm, const Geometry& geometry) {
    std::vector<std::int64_t> ids, numbers;
    std::int64_t id = 0;
    for (std::size_t b = 0; b < geometry.bodies.size(); ++b) {
        for (const auto& x : scene::sample_surface(geometry.bodies[b], body_sampling(geometry, b)).positions) {
            if (id++ % comm.size() != comm.rank()) continue;
            start_.push_back(x);
            body_.push_back(b);
            ids.push_back(id - 1);
            numbers.push_back(domain_sides + static_cast<std::int64_t>(b));
        }
    }
    const int number = store_.add<Array<int>>("body", "", FieldRole::state, true);
    store_.resize_owned(static_cast<int>(start_.size()));
    set_rows(store_.id(), ids);
    set_rows(store_.get<Array<int>>(number), numbers);
}

void SolidPoints::move_points(const rigid::RigidBodies& bodies) {
    std::vector<double> rows;
    rows.reserve(3 * start_.size());
    for (std::size_t i = 0; i < start_.size(); ++i) {
        using namespace rigid;
        const auto& pose = bodies.pose(body_[i]);
        const Vec3 x = pose.centre + to_matrix(pose.turn) * (start_[i] - bodies.setup().bodies[body_[i]].centre);
        rows.insert(rows.end(), x.begin(), x.end());
    }
    set_rows(store_.position(), rows);
}

} // namespace treacle::app
