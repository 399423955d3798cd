#pragma once
#include "video/drawing/rasteriser.hpp"

namespace treacle::video {

// Colours of a picture beside those of its layers.
struct Palette {
    Vec3f top, bottom, floor; // linear; the background runs from top to bottom
    Rgb8 ink;
    Vec3f lines; // linear; edges of the domain
};

// Colours of the background, the floor, text and edges.
Palette palette_of(Background background);

// Colour of a layer that states none.
Rgb8 default_colour(LayerKind kind);

} // namespace treacle::video
