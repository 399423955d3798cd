#pragma once
#include "video/drawing/splat.hpp"

#include <span>
#include <vector>

namespace treacle::video {

// One distant lamp over the left shoulder of the camera, and a bright sky. Camera axes, unit length.
struct DirectionalLight {
    Vec3f towards; // the lamp
    Vec3f up;      // the sky
};
DirectionalLight lamp_of(const Camera& camera, const Vec3& world_up);
Vec3 up_of(const DomainBox& domain); // z; in 2D scenes y

// Point that a ray meets, in camera axes.
struct Fragment {
    Vec3f point;        // [m]
    Vec3f normal;       // unit, on the camera's side
    Vec3f albedo;       // linear
    float gloss = 0.2f; // linear light of the highlight at its brightest; the lamp's is 1
    float lit = 1;      // share of the lamp's light that arrives
    float open = 1;     // share of the sky that is not hidden nearby
};

// Linear light that the fragment sends to the camera; diffuse, with a soft highlight.
Vec3f shade(const Fragment& fragment, const DirectionalLight& lamp);

// Map of the points that the lamp reaches.
class ShadowMap {
public:
    // Shadows on what is among the spheres `around`, with casters of no larger radius than theirs. Points farther out
    // are lit.
    ShadowMap(const DirectionalLight& lamp, std::span<const Sphere> around);
    void add(std::span<const Sphere> casters);
    // Depths of the lamp's nearest casters; the nearer of two maps of one lamp.
    const std::vector<float>& depth() const { return buffer_.depth; }
    void merge(std::span<const float> depth);
    // Share in [0, 1] of the lamp seen from `point`, averaged over a small square. `pattern` (0..3) picks one
    // of four sets of samples that complete each other when neighbouring pixels use different ones.
    float light_at(const Vec3f& point, int pattern) const;

private:
    Camera camera_;
    DepthBuffer buffer_;
    float bias_;
};

// Share of the sky left open by the depths around each pixel, [height][width]: dark in creases and between
// balls. `radius` [m]: how far around a point things count.
std::vector<float> ambient_occlusion(const Camera& camera, const std::vector<float>& depth, float radius);

// The nearest depth of each square of factor x factor pixels.
std::vector<float> reduce_depth(const std::vector<float>& depth, int width, int height, int factor);

} // namespace treacle::video
