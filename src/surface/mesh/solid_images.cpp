#include "surface/mesh/solid_images.hpp"

#include <cmath>
#include <vector>

namespace treacle::surface {

namespace {
constexpr double nearest = 0.7; // least depth of an image over the particle's distance

struct Image {
    Vec3 position;
    int row; // of the particle
    std::int64_t code;
};

// Tiles with particles within whose support a solid may be, by the distance of the tile's middle.
class NearTiles {
public:
    NearTiles(const Lattice& lattice, double support) : lattice_(lattice), support_(support) {
        near_.assign(static_cast<std::size_t>(lattice.grid.all().size()), -1);
    }
    bool near(const Solid& solid, const Vec3& x) {
        int c[3];
        lattice_.grid.locate(x[0], x[1], x[2], c);
        auto& known = near_[static_cast<std::size_t>(lattice_.grid.all().index(c[0], c[1], c[2]))];
        if (known >= 0) return known != 0;
        Vec3 middle{0, 0, 0};
        double square = 0;
        for (int k = 0; k < lattice_.dimensions; ++k) {
            const double width = lattice_.step[k] * tile_edge;
            middle[static_cast<std::size_t>(k)] = lattice_.grid.origin[k] + (c[k] + 0.5) * width;
            square += width * width;
        }
        known = solid.distance(middle) < 0.51 * std::sqrt(square) + support_ ? 1 : 0;
        return known != 0;
    }

private:
    const Lattice& lattice_;
    double support_;
    std::vector<signed char> near_;
};

std::vector<Image> find_images(
    const ParticleStore& store, const Solids& solids, double support, const Lattice& lattice) {
    std::vector<Image> out;
    const auto x = on_host(store.position());
    std::int64_t code = 0;
    for (const auto& solid : solids.bodies) {
        NearTiles tiles(lattice, support);
        code = code % 500 + 1;
        const auto reflect = [&](const Vec3& from, int row, std::int64_t parent) {
            if (!tiles.near(solid, from)) return;
            const double s = solid.distance(from);
            if (s <= 0 || s >= support) return;
            const Vec3 n = solid.normal(from);
            const Vec3 image{from[0] - 2 * s * n[0], from[1] - 2 * s * n[1], from[2] - 2 * s * n[2]};
            if (solid.distance(image) <= -nearest * s) out.push_back({image, row, parent * 512 + code});
        };
        const std::size_t before = out.size();
        for (int i = 0; i < store.owned(); ++i) reflect({x(i, 0), x(i, 1), x(i, 2)}, i, 0);
        for (std::size_t k = 0; k < before; ++k) reflect(Image(out[k]).position, out[k].row, out[k].code);
    }
    return out;
}

template <class View>
void copy_rows(const View& view, int first, const std::vector<Image>& images) {
    const auto host = on_host(view);
    for (std::size_t k = 0; k < images.size(); ++k) {
        const int to = first + static_cast<int>(k);
        if constexpr (View::rank == 1) {
            host(to) = host(images[k].row);
        } else {
            for (int c = 0; c < 3; ++c) host(to, c) = host(images[k].row, c);
        }
    }
    Kokkos::deep_copy(view, host);
}
} // namespace

void add_solid_images(
    ParticleStore& store, int image_field, const Solids& solids, double support, const Lattice& lattice) {
    const auto images = find_images(store, solids, support, lattice);
    const int first = store.owned();
    store.resize_owned(first + static_cast<int>(images.size()));
    for (const auto& field : store.fields()) {
        std::visit([&](const auto& view) { copy_rows(view, first, images); }, field.array);
    }
    const auto x = on_host(store.position());
    const auto code = on_host(store.get<Array<std::int64_t>>(image_field));
    for (std::size_t k = 0; k < images.size(); ++k) {
        const int to = first + static_cast<int>(k);
        for (int c = 0; c < 3; ++c) x(to, c) = images[k].position[static_cast<std::size_t>(c)];
        code(to) = images[k].code;
    }
    Kokkos::deep_copy(store.position(), x);
    Kokkos::deep_copy(store.get<Array<std::int64_t>>(image_field), code);
}

} // namespace treacle::surface
