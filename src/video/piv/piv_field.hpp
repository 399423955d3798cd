#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace treacle::video {

// Velocities in a sheet of light at one time, as particle image velocimetry gives them.
struct PivField {
    std::vector<double> x, y; // [n] in length_unit
    std::vector<double> u, v; // [n] in velocity_unit
    std::vector<std::uint8_t>
        valid;                 // [n] 0: not measured, masked, or rejected by the program that wrote it; u, v may be NaN
    std::string length_unit;   // "mm", "px"; empty: not stated in the file
    std::string velocity_unit; // "m/s", "px/frame"; empty likewise
    std::string format;        // "DaVis", "Insight", "OpenPIV", "OpenPIV without header", "CSV"
    std::size_t count_valid() const;
};

// Reads a text file by what stands in it:
// - LaVision DaVis: "#DaVis ..." with units, decimal commas, tabs; a vector of zeros was not measured;
// - TSI Insight: TITLE= ... VARIABLES="X mm", ..., commas; a negative CHC is invalid;
// - OpenPIV: "# x y u v flags mask", nan where invalid, flags or mask above 0 too; without a header x y u v and a ratio;
// - CSV with a header of names and units: "x [mm],y [mm],u [m/s],v [m/s]", perhaps valid or flags.
// InputError with file and line for what is none of these, for no vectors, and for rows of unlike lengths.
PivField read_piv_text(const std::filesystem::path& path);

// Scale of pixels and frames; 0: not given.
struct PivScale {
    double pixel = 0;    // [m]
    double interval = 0; // [s] between the pictures of a pair
};

// The field in m and m/s. InputError where the file's unit is none of a length or velocity, or pixels have no scale;
// `where` names it.
PivField in_si(PivField field, const PivScale& scale, const std::string& where);

// Samples of one place over time whose velocity changes too suddenly are marked as not valid (E.2, E.3 of the dissertation):
// kept are those with |u_(f+1) - 2 u_f + u_(f-1)| < change |u_f| + floor, of frames at equal intervals; the first and last
// have no neighbour to one side and take the one-sided difference of the three nearest. `change` is the dissertation's
// alpha dt^2, `floor` [m/s] keeps slow samples. Returns how many were marked. All fields have the same places.
std::size_t reject_sudden(std::vector<PivField>& frames, double change, double floor);

} // namespace treacle::video
