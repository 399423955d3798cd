#include "video/silhouette/silhouette_settings.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"

namespace treacle::video {

namespace {
const Range pixels_range = range_at_least(0).because("it is a number of pixels", "2 is usual; 0 switches it off");

std::optional<std::int64_t> whole(const std::string& text) {
    const auto value = read_number(text);
    if (!value || *value != static_cast<double>(static_cast<std::int64_t>(*value))) return std::nullopt;
    return static_cast<std::int64_t>(*value);
}
} // namespace

bool FrameSpan::contains(std::int64_t index, std::int64_t count) const {
    const auto from_end = [&](std::int64_t i) { return i < 0 ? i + count : i; };
    return index >= from_end(first) && index <= from_end(last);
}

FrameSpan read_frame_span(const std::string& text, const std::string& where) {
    if (text.empty()) return {};
    const auto colon = text.find(':');
    const auto first = whole(text.substr(0, colon));
    const auto last = colon == std::string::npos ? first : whole(text.substr(colon + 1));
    if (first && last && !((*first >= 0) == (*last >= 0) && *first > *last)) return {*first, *last};
    throw InputError({where + " = " + shorten(text), "is no range of frames", "it takes the first and the last one",
        "write for instance 0:59; -1 is the last frame of the clip"});
}

void ExclusionSettings::declare(Declaration& d) {
    d.text("name", name, "What is there, for messages: a hand, the container's wall.");
    d.text("frames", frames, "First and last frame, as 10:59; all without it.");
    d.text("polygon", polygon, "Corners in pixels of the upright picture: \"x,y x,y x,y\".");
    d.text("picture", picture, "PNG of the clip's size; white pixels are excluded.");
    d.check(polygon.empty() != picture.empty(), "polygon",
        {"needs exactly one of polygon and picture", "either says where", "give one"});
}

void SilhouetteSettings::Empty::declare(Declaration& d) {
    d.text("frames", frames, "Frames of the clip without liquid, as 0:59.");
    d.text("picture", picture, "Picture of the scene without liquid.");
    d.text("clip", clip, "Video, folder or pattern of the scene without liquid.");
    const int given = int(!frames.empty()) + int(!picture.empty()) + int(!clip.empty());
    d.check(given <= 1, "frames",
        {"frames, picture and clip exclude each other", "each says where the empty scene is", "give one"});
}

void SilhouetteSettings::declare(Declaration& d) {
    d.choice("method", method,
        {{"gmm", SilhouetteMethod::gmm}, {"difference", SilhouetteMethod::difference},
            {"threshold", SilhouetteMethod::threshold}, {"colour", SilhouetteMethod::colour},
            {"masks", SilhouetteMethod::masks}},
        "How liquid is told from background: a Gaussian mixture of the empty scene, the difference from its mean, a "
        "grey level "
        "(back light), a colour, or masks that are ready.");
    d.block("empty", empty,
        "The scene without liquid, for gmm and difference; without it the frames before the first change.");
    d.number("deviations", deviations, unit::none,
        range_above(0).because("it is a number of standard deviations", "4 is usual"),
        "gmm, difference: standard deviations of the noise above which a pixel is foreground.");
    d.number("min_difference", min_difference, unit::none,
        range_between(1, 255).because("it is a grey level of 255", "12 is usual"),
        "difference: grey levels below which a pixel is background.");
    d.number("shadow_ratio", shadow_ratio, unit::none,
        range_between(0, 1).because("it is a ratio of grey levels", "0.5 is usual; 1 knows no shadows"),
        "gmm, difference: what is darker than the background by less than this ratio, in the same colour, is a "
        "shadow.");
    d.number("highlight_ratio", highlight_ratio, unit::none,
        range_at_least(1).because("it is a ratio of grey levels", "1.1 is usual"),
        "difference: what is brighter than the background by less than this ratio, in the same colour, is a "
        "reflection.");
    d.number("level", level, unit::none,
        range_between(0, 255).because("it is a grey level of 255", "0 finds it by Otsu's method"),
        "threshold: grey level that parts liquid and background; 0: found by Otsu's method.");
    d.choice("liquid", liquid,
        {{"automatic", MaskPolarity::automatic}, {"dark", MaskPolarity::dark}, {"light", MaskPolarity::light}},
        "threshold, masks: the liquid is the darker or the lighter part; automatic: the one that does not fill the "
        "picture's edge.");
    d.vec3("colour", colour, unit::none, "colour: of the liquid, red, green and blue of 255.", VectorKind::in_space);
    d.number("tolerance", tolerance, unit::none, range_above(0).because("it is a distance of colours", "60 is usual"),
        "colour: largest distance from it in red, green and blue.");
    d.boolean("brightness", brightness, "gmm, difference: drift of the exposure is taken out, by the background.");
    d.boolean("registration", registration, "Frames are shifted and turned onto the first by the background.");
    d.number("max_shift", max_shift, unit::none, pixels_range, "Shift in pixels above which the camera moves.");
    d.number("max_changed", max_changed, unit::none, range_above_to(0, 1).because("it is a share", "0.5 is usual"),
        "Share of the background that may change before the camera counts as moving.");
    d.boolean("sub_pixel", sub_pixel,
        "The contour is where light is half way between that of liquid and background near it.");
    d.choice("mixing", mixing,
        {{"automatic", MixingSpace::automatic}, {"light", MixingSpace::light}, {"code", MixingSpace::code}},
        "Half way in light (as a camera blurs), in the numbers of the file, or as the blurred contours themselves "
        "show.");
    d.number("closing", closing, unit::none, pixels_range, "Radius of the disc of the closing, in pixels.");
    d.number("opening", opening, unit::none, pixels_range, "Radius of the disc of the opening after it, in pixels.");
    d.boolean("fill_holes", fill_holes, "Holes are filled; glass and handles have real ones.");
    d.number("min_area", min_area, unit::none, pixels_range,
        "Area in pixels below which a part is a speck, dropped and counted.");
    d.choice("keep", keep, {{"all", KeptParts::all}, {"connected", KeptParts::connected}},
        "All parts, or those that touch `start` or the liquid of the frame before.");
    d.text("start", start, "Polygon in pixels that the liquid touches first: \"x,y x,y x,y\".");
    d.text("region", region, "Polygon in pixels, or picture with white pixels, outside which nothing counts.");
    d.list("exclusions", exclusions,
        "Pixels that count as neither liquid nor background: hands, tools, what a solid hides.");
}

SilhouetteSettings read_silhouette_settings(
    const std::filesystem::path& path, const std::vector<std::string>& changes) {
    auto document = path.empty() ? Document::from_text("{}", "settings") : Document::load(path);
    for (const auto& change : changes) document.set(change);
    SilhouetteSettings settings;
    parse(document, settings);
    return settings;
}

std::string silhouette_settings_text(const SilhouetteSettings& settings) { return effective(settings); }

} // namespace treacle::video
