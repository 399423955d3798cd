#pragma once
#include "video/drawing/liquid_view.hpp"
#include "video/drawing/view.hpp"
#include "video/picture/colour.hpp"
#include "video/picture/image.hpp"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace treacle::video {

// Kind of a layer: the object that the particles stand for, on which occlusion depends.
enum class LayerKind {
    liquid, // drawn in full
    body,   // drawn in full, grey
    wall,   // pale; left out where it stands between the camera and the inside of the domain
};

// Particles drawn alike. The spans must stay valid during the call.
struct ParticleLayer {
    LayerKind kind = LayerKind::liquid;
    std::string name = "liquid";         // for messages
    std::span<const double> positions;   // [n][3] [m]
    double radius = 0;                   // [m], half of the spacing
    std::span<const double> values = {}; // [n] or empty: one colour for all
    std::string title = "";              // of the colour bar: "speed [m/s]"
    ColourMap map = ColourMap::viridis;
    std::optional<ValueRange> range = {}; // robust_range of `values` unless given
    std::optional<Rgb8> colour = {};      // the kind's colour unless given
    double opacity = 1;                   // in (0, 1]; below 1 what lies behind shines through
};

// Background of a picture, with the ink that can be read on it.
enum class Background { white, dark };
// Rule by which light changes the colours of particles and surfaces.
enum class Lighting {
    shaded, // lamp, shadows, ambient occlusion
    flat,   // every pixel has exactly the colour of its value
};
// Objects that are drawn around the particles.
enum class Scenery {
    none,
    box_and_floor, // edges of the domain; in 3D also its floor, which catches shadows
};

// Liquids drawn by their surfaces.
struct LiquidLayer {
    const LiquidView* view = nullptr; // of the picture's view; must stay valid during the call
    bool has_values = false;          // else each liquid has its own colour and lets light through
    std::string title = "";           // of the colour bar
    ColourMap map = ColourMap::viridis;
    ValueRange range = {};
    bool has_lower = false, has_higher = false; // values beyond the range
    double spacing = 0;                         // of the particles [m]
    std::vector<Rgb8> colours = {};             // by the liquid's number, without values; colour_of_liquid beyond
};

// One picture.
struct RenderRequest {
    DomainBox domain;
    std::optional<View> view = {}; // automatic_view of the domain at 1280 x 720 unless given
    std::vector<ParticleLayer> layers = {};
    std::string caption = ""; // bottom left; see caption_of
    std::optional<LiquidLayer> liquid = {};
    std::optional<CutPlane> cut = {}; // particles on the camera's side are left out
    std::function<double(const Vec3&)> solid_distance =
        {}; // [m] of the solids, whose section the cut shows; may be none
    Background background = Background::white;
    Lighting lighting = Lighting::shaded;
    Scenery scenery = Scenery::box_and_floor;
};

// "t = 0.25 s   50 000 particles", with a name before it if there is one.
std::string caption_of(const std::string& name, double time, std::size_t particles);

// The colour of a liquid among others.
Rgb8 colour_of_liquid(int number);

// Draws a picture. The same request gives the same bytes. The colour bar belongs to the first layer with
// values. InputError for a bad view or a layer whose arrays do not fit together; SimulationError for
// positions or values that are not finite. No particles: an empty domain.
Image render_frame(const RenderRequest& request);

} // namespace treacle::video
