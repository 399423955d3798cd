#include "app/compare/compare_occupancy.hpp"

#include "app/compare/film_drawer.hpp"
#include "identify/compare/occupancy_comparison.hpp"

namespace treacle::app {

namespace {
using identify::Experiment;
using identify::OccupancyWindow;

// Positions of the thread in each frame, of film and run [px].
struct ThreadColumns {
    explicit ThreadColumns(std::size_t frames) : film(frames), run(frames) {}
    std::vector<double> film, run;
};

// A film, the run drawn as it, and the folder that the run's masks go to.
struct DrawnFilm {
    FilmDrawer& drawer;
    const Experiment& experiment;
    const std::filesystem::path& masks;
};

// Sums of the frames [begin, end), whose masks are kept. Collective; `columns` are those of this rank's frames, and 0 for others.
OccupancyWindow sum_window(
    const Comm& comm, const DrawnFilm& drawn_film, std::size_t begin, std::size_t end, ThreadColumns& columns) {
    auto& film = drawn_film.drawer;
    const auto& frames = film.frames();
    const auto& lens = film.camera().lens();
    OccupancyWindow out(lens.width, lens.height);
    comm.guard([&] {
        for (auto k = begin + std::size_t(comm.rank()); k < end; k += std::size_t(comm.size())) {
            const auto mask = video::read_mask(frames[k].mask);
            out.film.add(mask, mask);
            const auto add = [&](const identify::SimulatedFrame& one) {
                out.now.add(mask, one.now.mask, one.now.depth);
                out.later.add(mask, one.later.mask);
                out.step = one.step;
            };
            const auto drawn = film.draw(k);
            video::write_mask(drawn_film.masks / frames[k].mask.filename(), drawn.now.mask);
            add(drawn);
            columns.film[k] = identify::thread_column(mask);
            columns.run[k] = identify::thread_column(drawn.now.mask);
            if (drawn_film.experiment.occupancy.mirror != identify::MirrorAxis::none) add(film.draw_mirrored(k));
        }
    });
    for (auto* sum : {&out.film, &out.now, &out.later}) comm.sum(sum->numbers());
    out.step = comm.max(out.step);
    out.frame = frames[begin + (end - begin) / 2];
    out.frame.time = 0.5 * (frames[begin].time + frames[end - 1].time);
    return out;
}

} // namespace

void compare_occupancy(const Comm& comm, const identify::StudyFile& file, const Experiment& experiment,
    const RunView& run, const std::filesystem::path& folder) {
    std::optional<FilmDrawer> film;
    const auto masks = folder / ("masks_" + experiment.name);
    comm.guard([&] { film.emplace(file, experiment, run); });
    comm.guard_root([&] { std::filesystem::create_directories(masks); });
    const auto& frames = film->frames();
    const auto windows = identify::windows_of(frames.size(), experiment.occupancy.windows);
    std::vector<OccupancyWindow> sums;
    ThreadColumns columns(frames.size());
    identify::RunResiduals residuals;
    residuals.kind = identify::ExperimentKind::occupancy;
    for (const auto& [begin, end] : windows) {
        sums.push_back(sum_window(comm, {*film, experiment, masks}, begin, end, columns));
        residuals.frames.push_back(identify::compare_window(sums.back(), experiment.occupancy.levels, film->camera()));
        residuals.observed.push_back(sums.back().frame);
    }
    const double noise = identify::occupancy_noise(sums, experiment.occupancy.levels);
    comm.sum(std::span<double>(columns.film));
    comm.sum(std::span<double>(columns.run));
    std::vector<double> times;
    times.reserve(frames.size());
    for (const auto& frame : frames) times.push_back(frame.time);
    const auto filmed = identify::turning_of(times, columns.film), simulated = identify::turning_of(times, columns.run);
    for (std::size_t w = 0; w < windows.size(); ++w) {
        auto& one = residuals.frames[w];
        identify::scale_by_noise(one, noise);
        const double begin = times[windows[w].first], end = times[windows[w].second - 1];
        identify::add_turning(one, residuals.observed[w], identify::rate_between(filmed, begin, end),
            identify::rate_between(simulated, begin, end), filmed.scatter, experiment.occupancy.levels.size());
        residuals.segments.insert(residuals.segments.end(), one.segments.begin(), one.segments.end());
    }
    comm.guard_root([&] { identify::write_residuals(folder, experiment.name, residuals); });
}

} // namespace treacle::app
