#pragma once
#include "video/picture/colour.hpp"
#include "video/picture/image.hpp"

#include <string>

namespace treacle::video {

// Content of a colour bar.
struct Legend {
    std::string title; // quantity and unit: "speed [m/s]"
    ColourMap map = ColourMap::viridis;
    ValueRange range;                           // in the unit of the title
    bool has_lower = false, has_higher = false; // values beyond the ends, shown by pointed ends
};

// At the right, with title and ticks.
void draw_colour_bar(Image& image, const Legend& legend, const Rgb8& ink);

// Words whose capitals are `height` pixels high, their left end and baseline at (left, baseline) [pixels]. Plain ASCII, as below.
void draw_words(Image& image, const std::string& words, int left, int baseline, int height, const Rgb8& ink);

// Bottom left. Plain ASCII; other characters are drawn as '?'.
void draw_caption(Image& image, const std::string& caption, const Rgb8& ink);

} // namespace treacle::video
