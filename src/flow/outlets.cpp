#include "flow/outlets.hpp"

namespace treacle::flow {

Outlets make_outlets(const std::vector<OutletSetup>& outlets, int dimensions) {
    Outlets out;
    out.rows = Array<double>("treacle::outlets", 7 * outlets.size());
    out.count = static_cast<int>(outlets.size());
    out.dimensions = dimensions;
    auto host = Kokkos::create_mirror_view(out.rows);
    for (std::size_t o = 0; o < outlets.size(); ++o) {
        host(7 * o) = outlets[o].box ? 1 : 0;
        for (std::size_t k = 0; k < 3; ++k) {
            host(7 * o + 1 + k) = outlets[o].box ? outlets[o].min[k] : outlets[o].point[k];
            host(7 * o + 4 + k) = outlets[o].box ? outlets[o].max[k] : outlets[o].normal[k];
        }
    }
    Kokkos::deep_copy(out.rows, host);
    return out;
}

} // namespace treacle::flow
