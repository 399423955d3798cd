#pragma once
#include "scene/camera/triangle_raster.hpp"
#include "video/drawing/shading.hpp"
#include "video/picture/colour.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace treacle::video {

// Cuts a picture's scene: what lies on the camera's side of the plane is left out.
struct CutPlane {
    Vec3 point{0, 0, 0};  // [m]
    Vec3 normal{0, 0, 1}; // of any length, to either side
};
// The plane with its unit normal towards the camera. InputError for a normal without length and a camera on it.
CutPlane facing(const CutPlane& cut, const Camera& camera);

// A part of a closed, oriented surface of liquid. The spans must stay valid during the call.
struct LiquidMesh {
    std::span<const double> vertices, normals;     // [n][3] [m], unit and outward
    std::span<const int> liquid;                   // [n] index of the scene's liquid
    std::span<const double> values;                // [n], or none
    std::span<const std::array<int, 3>> triangles; // 2D scenes: segments with the liquid on their left, the third is -1
};

// Particles, from which sections of liquid and 2D scenes take their values.
struct LiquidPoints {
    std::span<const double> positions;    // [n][3] [m]
    std::span<const std::int64_t> liquid; // [n], or none
    std::span<const double> values;       // [n], or none
};

// View of liquids.
struct LiquidScene {
    View view;
    DomainBox domain;
    double spacing = 0; // of the particles [m]
    ValueRange range;   // of the values
    std::optional<CutPlane> cut;
};

// Liquids in the picture of a camera, by their surfaces; filled part by part, also by several ranks: the result does
// not depend on how the parts are shared out. Depths are kept for samples x samples points of each pixel.
class LiquidView {
public:
    static constexpr int samples = 2;

    // InputError as facing().
    explicit LiquidView(const LiquidScene& scene);

    // Local. The meshes of all parts cover each surface once; points give values to
    // sections and 2D scenes, and have no effect elsewhere. Any order.
    void add(const LiquidMesh& mesh);
    void add(const LiquidPoints& points);

    // Packs what has been added, as bytes for another rank, and merges what another rank has added.
    std::vector<char> pack() const;
    void merge(std::span<const char> packed);

    // Data of a sample.
    struct Seen {
        float depth = far_away; // [m]
        Vec3f normal{0, 0, -1}; // unit, camera axes, on the camera's side
        float value = 0;        // place in the range, in [0, 1]
        int liquid = 0;
        float thickness = 0;  // [m] of liquid along the camera's axis
        bool section = false; // where the cut passes through liquid, and in 2D scenes
    };
    Seen at(int column, int row) const; // of samples

    const Camera& camera() const { return camera_; } // of pixels
    const Camera& fine() const { return fine_; }     // of samples
    // With its normal unit and towards the camera; none: no cut.
    const std::optional<CutPlane>& cut() const { return cut_; }
    const ShadowMap& shadows() const { return shadows_; } // casters: the surfaces that were added

private:
    // The nearest surface in a sample, and sums over all of them.
    struct Sample {
        float depth = far_away;
        std::array<float, 3> normal{0, 0, 0};
        float value = 0;
        std::int32_t liquid = 0;
        std::int32_t crossings =
            0; // surfaces that the ray enters, less those that it leaves: -1 if it starts in liquid
        std::int64_t thickness = 0; // [nm]
        bool hides(const Sample& other) const;
    };
    // Values of the particles around a pixel's point of the section, with whole numbers as weights.
    struct Mean {
        std::int64_t weight = 0, value = 0;
        float nearest = far_away; // [m] squared
        std::int32_t liquid = 0;
    };

    void add_space(const LiquidMesh& mesh);
    void add_plane(const LiquidMesh& mesh);
    float map_position(double value) const;
    // The point of the section on the ray of a pixel or sample, camera axes; false where there is none.
    bool section_point(const Camera& camera, int column, int row, Vec3f& point) const;
    const Mean& mean_near(int column, int row) const;

    int dimensions_;
    Camera camera_, fine_;
    double spacing_;
    ValueRange range_;
    std::optional<CutPlane> cut_;
    Vec3f cut_normal_{0, 0, -1};              // camera axes
    float cut_offset_ = 0;                    // [m] normal . x of the section's points
    std::optional<scene::CameraModel> model_; // in 3D
    ShadowMap shadows_;
    std::vector<Sample> samples_; // [height][width] of samples
    std::vector<Mean> means_;     // [height][width] of pixels; empty without a section
};

} // namespace treacle::video
