#pragma once
#include "app/render/frame_field.hpp"
#include "app/render/moving_solids.hpp"
#include "surface/mesh/mesher.hpp"

#include <array>
#include <optional>

namespace treacle::app {

// Domain and spacing of a scene for src/surface, in SI; other options have their defaults.
surface::Domain surface_domain(const Input& input);
surface::Options surface_options(const Input& input);

// Options of a SceneSurface.
struct SurfaceChoice {
    surface::Options options;                    // its scalars are those below
    std::vector<std::string> scalars = {};       // fields that the mesh takes, see scalar_names
    std::optional<std::array<Vec3, 2>> box = {}; // [m] corners of the part that is meshed
    bool images = false; // mesh and rows with the mirror images, for drawing (surface/mirror.hpp)
};

// The surfaces of a run's liquid, frame by frame, cut at walls and at the solids where these are at the frame's time.
class SceneSurface {
public:
    // Collective. Throws InputError. The run must stay.
    SceneSurface(const Comm& comm, const RunView& run, const SurfaceChoice& choice);

    // Collective: each rank reads an equal part of the frame's rows. The mesh and the rows stay until the call for another frame; nothing is
    // done for the frame of the last call. Throws InputError.
    const surface::Mesh& build(std::size_t frame);
    const surface::Summary& summary() const { return mesher_.summary(); }
    double time() const { return rows_.time; }                         // [s] of that frame
    const io::Frame& rows() const { return rows_; }                    // of this rank
    const std::vector<ScalarField>& fields() const { return fields_; } // of those rows, one a scalar
    const surface::Solids& solids() const { return solids_; }          // where they are at that time
    bool solids_move() const { return moving_.any_moves(); }

private:
    const surface::Mesh& build_anew(std::size_t frame);

    Comm comm_;
    const RunView& run_;
    std::vector<std::string> scalars_;
    surface::Mesher mesher_;
    MovingSolids moving_;
    io::Frame rows_;
    std::vector<ScalarField> fields_;
    surface::Solids solids_;
    bool images_ = false;
    surface::Mesh drawn_;
    std::optional<std::size_t> built_;
    const surface::Mesh* mesh_ = nullptr; // of that frame
};

} // namespace treacle::app
