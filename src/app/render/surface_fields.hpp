#pragma once
#include "app/render/scene_surface.hpp"
#include "io/surface_file.hpp"

#include <string>
#include <vector>

namespace treacle::app {

// The fields that an exported surface carries, and the scalars that the mesh must take for them.
class SurfaceFields {
public:
    // `list`: names with commas between them, of the frame's fields, their components, and "normal"; "none"; "": normal, and
    // of velocity, pressure and liquid those that the frame has. Throws InputError that lists the names.
    SurfaceFields(const std::string& list, const io::Frame& frame, io::SurfaceFormat format);

    // Names as in scalar_names, for SurfaceChoice::scalars.
    const std::vector<std::string>& scalars() const { return scalars_; }
    // The mesh's part of a file; it must stay, and this object too.
    io::SurfacePart part_of(const surface::Mesh& mesh, double time);

private:
    struct Wanted {
        std::string name, unit;
        int components = 1;
        std::size_t scalar = 0; // the first of its scalars
        bool whole = false;     // the liquid
    };
    void want(const std::string& name, const io::Frame& frame);

    std::vector<Wanted> wanted_;
    std::vector<std::string> scalars_;
    std::vector<std::vector<double>> vectors_; // components side by side
    bool normals_ = false;
};

} // namespace treacle::app
