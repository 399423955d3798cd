#include "app/compare/mismatch_watch.hpp"

#include "app/compare/experiments.hpp"

namespace treacle::app {

MismatchWatch::MismatchWatch(const Comm& comm, const identify::StudyFile& file, const study::StudyScene& scene,
    std::filesystem::path folder, double cut)
    : comm_(comm), folder_(std::move(folder)), cut_(cut) {
    for (const auto* experiment : experiments_of(file, scene))
        comparisons_.emplace_back(comm_, file, *experiment, folder_);
}

bool MismatchWatch::look() {
    if (run_) {
        comm_.guard([&] { look_again(*run_); });
    } else {
        run_ = open_run(comm_, folder_ / "run");
    }
    std::vector<identify::FilmMismatches> films;
    for (auto& one : comparisons_) {
        one.compare_up_to(*run_);
        films.push_back(one.mismatches());
    }
    bound_ = identify::mismatch_bound(films, cut_);
    return bound_.has_value();
}

} // namespace treacle::app
