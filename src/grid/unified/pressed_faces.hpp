#pragma once
#include "grid/pressure/pressure_system.hpp"
#include "grid/viscosity/viscosity.hpp"
#include "grid/viscosity/viscous_system.hpp"

#include <span>
#include <vector>

namespace treacle::grid {

// The faces between the pressures and the velocities of one system (U), by rows of both: G, its transpose, and what pressures
// change of velocities where there is no viscosity. On the host, where the solvers are. Spans are of this rank's rows.
//
// G = P^T G_0 with G_0 that of the faces' middles, and P what fluxes take of the faces beside (open_flux.hpp).
class PressedFaces {
public:
    struct Scales {
        double area;   // of a face [m2], of a 2D scene [m]
        double change; // dt/(rho dx), of a face's velocity by a pressure difference [m/(s Pa)]
    };
    // Collective. Both systems for the same faces (Stokes::Parts).
    void build(ViscousSystem& viscous, PressureSystem& pressure, const Scales& scales);

    // y = G^T u, of what flows into each cell [m3/s]. Collective.
    void flux(std::span<const double> u, std::span<double> y);
    // y += G p: what the pressures hold against [N]. Collective.
    void add_forces(std::span<const double> p, std::span<double> y);
    // u -= dt/(rho dx) (p_c - p_below), over theta at a surface, as Pressure::apply() does. Collective.
    void push(std::span<const double> p, std::span<double> u);

    std::size_t bytes() const; // of this rank [bytes]

    // Parts of build(); not private, since nvcc takes no kernel in a private function.
    void find_sides(const ViscousSystem& viscous, const PressureSystem& pressure, const Scales& scales);
    void find_flux(const ViscousSystem& viscous, const PressureSystem& pressure, double area);
    void find_neighbours(const ViscousSystem& viscous);

private:
    struct Sides {
        int below, above;    // local pressure row, or from pressures_ on place in the halo, or none
        double area, change; // [m2]; of the velocity by the difference [m/(s Pa)]
    };
    struct Entry {
        int face;    // local viscous row, or from faces_ on place in the halo
        double area; // into the cell
    };
    struct Neighbour {
        int face, other; // local viscous row; the same, or from faces_ on place in the halo
        double
            weight; // of the other one's velocity in the flux through the face, or of this one's in that through the other
    };
    static constexpr int none = -1;
    void differences(std::span<const double> p, std::vector<double>& out);
    void middle_flux(std::span<const double> u, std::span<double> y);
    void add_middle_forces(std::span<const double> p, std::span<double> y);

    int faces_ = 0, pressures_ = 0;
    std::vector<Sides> sides_;       // [faces]
    std::vector<Entry> entries_;     // of cell r from first_[r] to first_[r + 1]
    std::vector<int> first_;         // [pressures + 1]
    std::vector<double> difference_; // [faces], of pressures
    bool interpolates_ = false;
    std::vector<Neighbour> taken_,
        given_; // faces whose flux takes another's velocity; faces whose velocity another's flux takes
    std::vector<double> at_open_; // [faces] velocities, forces
    RowHalo* of_faces_ = nullptr; // those of the two systems
    RowHalo* of_pressures_ = nullptr;
    Array<int> rows_{"treacle::pressed_rows", 0};
    Array<double> values_{"treacle::pressed_values", 0};
};

} // namespace treacle::grid
