#include "identify/report/report_film.hpp"

#include "base/options/parse_some.hpp"
#include "identify/experiment/observation.hpp"
#include "video/clip/clip_writer.hpp"
#include "video/clip/frame_source.hpp"
#include "video/clip/movie.hpp"
#include "video/drawing/contour_overlay.hpp"
#include "video/drawing/overlay.hpp"

#include <algorithm>
#include <cstdio>

namespace treacle::identify {

namespace {
constexpr std::size_t most_columns = 6;
constexpr int cell_width = 260, gap = 4, label_height = 18, capitals = 9; // [pixels]
constexpr video::Rgb8 ink{40, 40, 40};

// Part of the picture in which there is liquid at some time, with a margin.
struct Crop {
    int left = 0, top = 0, right = 0, bottom = 0; // the last two behind it

    void add(const video::Mask& mask) {
        for (int y = 0; y < mask.height; ++y)
            for (int x = 0; x < mask.width; ++x) {
                if (!mask.liquid(x, y)) continue;
                if (right == 0) *this = {x, y, x + 1, y + 1};
                left = std::min(left, x);
                top = std::min(top, y);
                right = std::max(right, x + 1);
                bottom = std::max(bottom, y + 1);
            }
    }
    Crop widened(int width, int height) const {
        if (right == 0) return {0, 0, width, height};
        const int margin = std::max(8, (right - left) / 10);
        return {std::max(0, left - margin), std::max(0, top - margin), std::min(width, right + margin),
            std::min(height, bottom + margin)};
    }
};

// Pixels from low to high that the k-th of `count` equal parts covers: at least one.
std::pair<int, int> part_of_range(int low, int high, int k, int count) {
    const int begin = low + (high - low) * k / count;
    return {begin, std::max(begin + 1, low + (high - low) * (k + 1) / count)};
}

// A part of a picture in another size; pixels of the result are means of those that they cover.
video::Image scaled(const video::Image& from, const Crop& crop, int width, int height) {
    video::Image out{width, height, std::vector<std::uint8_t>(3 * std::size_t(width) * std::size_t(height))};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {

            const auto [x0, x1] = part_of_range(crop.left, crop.right, x, width);
            const auto [y0, y1] = part_of_range(crop.top, crop.bottom, y, height);
            for (int c = 0; c < 3; ++c) {
                int sum = 0;
                for (int j = y0; j < y1; ++j)
                    for (int i = x0; i < x1; ++i)
                        sum += from.at(std::min(i, from.width - 1), std::min(j, from.height - 1))[c];
                out.pixels[3 * (std::size_t(y) * std::size_t(width) + std::size_t(x)) + std::size_t(c)] =
                    std::uint8_t(sum / ((x1 - x0) * (y1 - y0)));
            }
        }
    return out;
}

video::Image filled(const video::Mask& mask) {
    video::Image out{mask.width, mask.height, std::vector<std::uint8_t>(3 * mask.pixels.size(), 255)};
    for (std::size_t i = 0; i < mask.pixels.size(); ++i) {
        if (mask.pixels[i] == video::mask_liquid)
            std::fill_n(out.pixels.begin() + std::ptrdiff_t(3 * i), 3, std::uint8_t(120));
    }
    return out;
}

// Pictures in rows below each other, a column a frame, a line for the label above each row and one for the times above all.
class FrameRows {
public:
    FrameRows(const Crop& crop, std::size_t columns, const std::vector<std::string>& labels) : crop_(crop) {
        height_ = std::max(1, cell_width * (crop.bottom - crop.top) / std::max(1, crop.right - crop.left));
        image_.width = int(columns) * (cell_width + gap) - gap;
        image_.height = label_height + int(labels.size()) * (label_height + height_);
        image_.pixels.assign(3 * std::size_t(image_.width) * std::size_t(image_.height), 255);
        for (std::size_t row = 0; row < labels.size(); ++row)
            video::draw_words(image_, labels[row], gap, top(int(row)) - gap, capitals, ink);
    }
    void add_column(double time, const std::vector<video::Image>& pictures) {
        const int left = column_++ * (cell_width + gap);
        char text[32];
        std::snprintf(text, sizeof text, "%.3f s", time);
        video::draw_words(image_, text, left + gap, label_height - gap, capitals, ink);
        int row = 0;
        for (const auto& one : pictures) draw_cell(scaled(one, crop_, cell_width, height_), left, top(row++));
    }
    const video::Image& image() const { return image_; }

private:
    int top(int row) const { return label_height + row * (label_height + height_) + label_height; }
    void draw_cell(const video::Image& cell, int left, int top) {
        for (int y = 0; y < cell.height; ++y)
            std::copy_n(cell.at(0, y), 3 * cell.width,
                image_.pixels.begin() + 3 * (std::ptrdiff_t(top + y) * image_.width + left));
    }

    Crop crop_;
    int height_ = 0, column_ = 0;
    video::Image image_;
};

// Frames of the film one after the other; masks in their place where there is none.
class Film {
public:
    explicit Film(const std::filesystem::path& path) {
        video::SourceRequest request;
        request.clip = path;
        if (!path.empty()) source_ = video::open_frames(request);
    }
    bool is_there() const { return source_ != nullptr; }
    // Pictures ascend. The mask's where the film has another size or ends before.
    video::Image at(int number, const video::Mask& mask) {
        while (source_ && frame_.index < number && source_->read(frame_)) {
        }
        const bool fits =
            source_ && frame_.index == number && frame_.image.width == mask.width && frame_.image.height == mask.height;
        return fits ? frame_.image : filled(mask);
    }

private:
    std::unique_ptr<video::FrameSource> source_;
    video::TimedFrame frame_{.index = -1, .stamp = 0, .time = 0, .image = {}};
};

bool is_shown(std::size_t k, std::size_t frames) {
    const auto count = std::min(most_columns, frames);
    for (std::size_t c = 0; c < count; ++c) {
        if (k == (count == 1 ? 0 : c * (frames - 1) / (count - 1))) return true;
    }
    return false;
}
} // namespace

std::filesystem::path film_of(const std::filesystem::path& masks) {
    for (const char* name : {"film.mp4", "film.mkv"}) {
        if (std::filesystem::exists(masks / name)) return masks / name;
    }
    const auto summary = masks / "summary.json"; // JSON is YAML
    if (!std::filesystem::exists(summary)) return {};
    std::string clip;
    parse_some(Document::load(summary), [&](Declaration& d) { d.text("clip", clip, "File of the video."); });
    for (const auto& path : {std::filesystem::path(clip), masks / clip, masks.parent_path() / clip,
             masks.parent_path() / std::filesystem::path(clip).filename()}) {
        if (!clip.empty() && std::filesystem::is_regular_file(path)) return path;
    }
    return {};
}

ReportFilm write_film(
    const std::filesystem::path& folder, const StudyFile& file, const Experiment& experiment, const FilmRuns& runs) {
    const auto frames = observed_frames(experiment, file.beside(experiment.masks));
    const bool compared = !runs.at_curve.empty();
    const auto drawn = [](const std::filesystem::path& masks, const ObservedFrame& frame) {
        return video::read_mask(masks / frame.mask.filename());
    };
    Crop crop;
    std::size_t columns = 0;
    for (std::size_t k = 0; k < frames.size(); ++k) {
        if (!is_shown(k, frames.size())) continue;
        crop.add(video::read_mask(frames[k].mask));
        crop.add(drawn(runs.answer, frames[k]));
        if (compared) crop.add(drawn(runs.at_curve, frames[k]));
        ++columns;
    }
    const auto first = video::read_mask(frames.front().mask);
    ReportFilm out{experiment.name + "_contours.mp4", experiment.name + "_rows.png", false};
    Film film(film_of(file.beside(experiment.masks)));
    out.has_film = film.is_there();
    const std::vector<std::string> usual{
        "film", "run", "contours of film (blue) and run (red)", "differences: film only (blue), run only (red)"};
    const std::vector<std::string> both{"film", "run at the answer", "run at the measured curve",
        "film only (blue), answer only (red)", "film only (blue), curve only (red)",
        "answer only (blue), curve only (red)"};
    FrameRows rows(crop.widened(first.width, first.height), columns, compared ? both : usual);
    video::ClipOptions options;
    options.width = first.width / 2 * 2;
    options.height = first.height / 2 * 2;
    options.quality = 20;
    video::ClipWriter writer(folder / out.overlay, options);
    for (std::size_t k = 0; k < frames.size(); ++k) {
        const auto observed = video::read_mask(frames[k].mask), answer = drawn(runs.answer, frames[k]);
        const auto picture = film.at(frames[k].number, observed);
        const auto contours = video::draw_contours(picture, observed, answer);
        writer.add(contours, frames[k].time - frames.front().time);
        if (!is_shown(k, frames.size())) continue;
        if (!compared) {
            rows.add_column(frames[k].time, {picture, filled(answer), contours, draw_differences(observed, answer)});
            continue;
        }
        const auto curve = drawn(runs.at_curve, frames[k]);
        rows.add_column(frames[k].time, {picture, filled(answer), filled(curve), draw_differences(observed, answer),
                                            draw_differences(observed, curve), draw_differences(answer, curve)});
    }
    writer.finish();
    video::write_png(folder / out.rows, rows.image());
    return out;
}

} // namespace treacle::identify
