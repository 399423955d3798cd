#include "video/drawing/palette.hpp"

namespace treacle::video {

Palette palette_of(Background background) {
    if (background == Background::dark)
        return {to_linear({38, 42, 50}), to_linear({20, 22, 27}), to_linear({58, 62, 70}), {226, 229, 234},
            to_linear({120, 128, 140})};
    return {to_linear({255, 255, 255}), to_linear({246, 247, 249}), to_linear({238, 240, 243}), {48, 52, 60},
        to_linear({128, 134, 144})};
}

Rgb8 default_colour(LayerKind kind) {
    switch (kind) {
    case LayerKind::body: return {154, 154, 152};
    case LayerKind::wall: return {214, 218, 224};
    case LayerKind::liquid: break;
    }
    return colour_of_liquid(0);
}

} // namespace treacle::video
