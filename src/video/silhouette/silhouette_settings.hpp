#pragma once
#include "base/options/options.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace treacle::video {

// Source of the silhouettes: OpenCV's mixture model, the difference from the mean of the empty scene, a grey level, a
// colour, or masks that were made elsewhere.
enum class SilhouetteMethod { gmm, difference, threshold, colour, masks };
// Levels at which half of a pixel is liquid lie half way in the numbers or in the light that they stand for.
enum class MixingSpace { automatic, light, code };
// Parts of the mask that stay: all, or those connected to `start` or to the parts of the frame before.
enum class KeptParts { all, connected };
// Tone of the liquid against the background; automatic: the one that does not fill the rim of the
// first frame.
enum class MaskPolarity { automatic, dark, light };

// Frames first to last, both included, negative from the end; "" for all.
struct FrameSpan {
    std::int64_t first = 0, last = -1;
    bool contains(std::int64_t index, std::int64_t count) const;
};
// "10:59"; InputError at `where` for anything else.
FrameSpan read_frame_span(const std::string& text, const std::string& where);

// Pixels that count as neither liquid nor background: hands, tools, what a solid hides.
struct ExclusionSettings {
    std::string name, frames, polygon, picture;
    void declare(Declaration& d);
};

// All settings from a clip to silhouettes, as YAML that is written beside them and read again.
struct SilhouetteSettings {
    SilhouetteMethod method = SilhouetteMethod::gmm;

    // The scene without liquid: exactly one, else the frames before the first that changes.
    struct Empty {
        std::string frames, picture, clip;
        void declare(Declaration& d);
    } empty;

    double deviations = 4;        // gmm, difference: of the noise, above which a pixel is foreground
    double min_difference = 12;   // difference: grey levels of 255
    double shadow_ratio = 0.5;    // gmm, difference: darker than this share of the background is no shadow
    double highlight_ratio = 1.1; // difference: brighter up to this ratio, in the same colour, is no liquid
    double level = 0;             // threshold: grey level of 255; 0: Otsu's
    MaskPolarity liquid = MaskPolarity::automatic; // threshold, masks: is dark or light
    Vec3 colour{0, 0, 0};                          // colour: of the liquid, red green blue of 255
    double tolerance = 60;                         // colour: distance in red green blue

    bool brightness = true;   // drift of the exposure is taken out
    bool registration = true; // frames are shifted onto the first
    double max_shift = 20;    // a larger one is a moving camera [px]
    double max_changed = 0.5; // share of the background that may change

    bool sub_pixel = true; // contour at half way between liquid and background, as they are there
    // Automatic: the space in which blurred contours of the clip are more even.
    MixingSpace mixing = MixingSpace::automatic;
    double closing = 2, opening = 2;           // radius of the disc [px]
    bool fill_holes = true;                    // background enclosed by liquid becomes liquid
    double min_area = 60;                      // of a part, below which it is a speck [px]
    KeptParts keep = KeptParts::all;           // among parts of min_area or more
    std::string start;                         // polygon that parts must touch, or the parts of the frame before must
    std::string region;                        // polygon or picture outside which nothing counts
    std::vector<ExclusionSettings> exclusions; // their pixels get mask_excluded

    // Keys, ranges and units of the YAML.
    void declare(Declaration& d);
};

// Defaults for an empty path. changes: "key=value" that replace values of the file. InputError with file and line.
SilhouetteSettings read_silhouette_settings(const std::filesystem::path& path, const std::vector<std::string>& changes);
// Every value as YAML; reading it gives the same settings.
std::string silhouette_settings_text(const SilhouetteSettings& settings);

} // namespace treacle::video
