#pragma once
#include "app/compare/compare_films.hpp"

#include <list>
#include <optional>

namespace treacle::app {

// Compares a run under way with the films of its scene, frame by frame, until the sum over the films of (6.9) is above a cut.
class MismatchWatch {
public:
    // Collective. folder: that of the request, with the run in folder/run, which need not be there yet. Throws InputError.
    MismatchWatch(const Comm& comm, const identify::StudyFile& file, const study::StudyScene& scene,
        std::filesystem::path folder, double cut);

    // Collective, after a frame has been written: whether the sum is above the cut.
    bool look();
    // That the sum is at least, where it is above the cut: what it was at the first frame with which it was.
    const std::optional<double>& bound() const { return bound_; }
    // For the rest of the frames of a run that has ended without.
    std::list<FilmComparison>& comparisons() { return comparisons_; }

private:
    Comm comm_;
    std::filesystem::path folder_;
    double cut_;
    std::list<FilmComparison> comparisons_; // in the order of the study
    std::optional<RunView> run_;            // as far as it is
    std::optional<double> bound_;
};

} // namespace treacle::app
