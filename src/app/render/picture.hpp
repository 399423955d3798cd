#pragma once
#include "app/input/input.hpp"
#include "video/drawing/rasteriser.hpp"

#include <string>
#include <vector>

namespace treacle::app {

// View of a scene, shared by the pictures of `check` and `render`.

// The domain with its mirror images [m].
video::DomainBox domain_box(const scene::Domain& domain);

// Size of a picture, in the place of the camera's.
struct PictureSize {
    int width = 0, height = 0; // [pixels]; 0: the camera's
};

// "1280x720"; throws InputError for anything else.
PictureSize read_picture_size(const std::string& text);

// The scene's camera of that name; "": its first one, or a view of the whole domain when it has none;
// "automatic": that view; a camera file, or FILE:NAME: that camera. Throws InputError that lists the names when there is
// no such camera.
scene::Camera find_camera(const scene::Scene& scene, const std::string& name);
video::View view_of(const scene::Camera& camera, const scene::Domain& domain, const PictureSize& size);

// Part of a scene that a particle of a solid belongs to; decides what it hides.
enum class SolidKind {
    wall, // of the domain
    body,
    hollow, // fills all space but what it holds (`inverted`)
};
// The particles of solids, parted by what they hide.
struct DrawnSolids {
    std::vector<double> walls, bodies, hollows; // [n][3] [m]

    void add(const Vec3& position, SolidKind kind);                                           // position: [m]
    std::size_t count() const { return (walls.size() + bodies.size() + hollows.size()) / 3; } // particles of all three
};
// Layers over the points, which must stay. Hollow bodies are translucent, so that their content is in the picture.
void add_solid_layers(const DrawnSolids& points, double spacing, std::vector<video::ParticleLayer>& layers);

} // namespace treacle::app
