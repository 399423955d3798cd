#pragma once
#include "video/mask/mask.hpp"
#include "video/silhouette/silhouette_settings.hpp"

namespace treacle::video {

// Report of what cleaning took away or added.
struct CleaningReport {
    int parts = 0;           // that are kept
    int specks = 0;          // dropped for their size or place
    std::size_t dropped = 0; // their area [px]
    std::size_t filled = 0;  // of holes [px]
};

// Closing, then opening, with discs (dissertation 6.5.3), holes filled, specks dropped. Parts are connected over corners.
// `seeds` (empty: none): with keep: connected, parts must touch a pixel of it.
CleaningReport clean_mask(Mask& mask, const SilhouetteSettings& settings, const Mask& seeds);

// Corners in pixels: "x,y x,y x,y". Pixels whose centre is in it are 255. InputError at `where` for anything else.
Mask draw_polygon(const std::string& corners, int width, int height, const std::string& where);
// The same from a polygon or, where it names a file, a picture of that size: its pixels from 128 on.
Mask read_region(const std::string& text, int width, int height, const std::string& where);

} // namespace treacle::video
