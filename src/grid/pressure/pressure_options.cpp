#include "grid/pressure/pressure_options.hpp"

#include "base/options/options.hpp"

namespace treacle::grid {

void PressureOptions::declare(Declaration& d) {
    declare_solve(d, preconditioner, residual, max_iterations);
    d.choice("smoother", smoother,
        {{"gauss_seidel", solve::Smoother::gauss_seidel}, {"chebyshev", solve::Smoother::chebyshev}},
        "Of `multilevel`: `gauss_seidel` sweeps row by row on one thread of each rank; `chebyshev`, a polynomial, runs "
        "on "
        "all threads and on devices, and is the default there.");
    d.number("min_theta", min_theta, unit::none, range_between(1e-6, 0.5),
        "Least distance along an axis, in grid widths, that a cell's centre is taken to have from the liquid's "
        "surface (theta of the ghost fluid method). Liquid at rest below a surface along no axis moves where it "
        "counts.");
    d.number("min_face_area_fraction", min_face_area_fraction, unit::none, range_between(0, 0.5),
        "Share of a face's area that solids leave open below which the face is closed: what passes smaller ones "
        "counts for nothing, and pressures behind them come out of differences of small numbers.");
    d.choice("ceilings", ceilings, {{"separate", Ceilings::separate}, {"adhere", Ceilings::adhere}},
        "Liquid under a wall from which gravity pulls it: separate where only a pressure below that of the air would "
        "keep "
        "it there, or adhere. Where pressure and viscosity are solved together (stokes.solve), a liquid so stiff "
        "adheres.");
}

} // namespace treacle::grid
