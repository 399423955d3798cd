#include "identify/estimate/estimate.hpp"

#include "base/text/error.hpp"
#include "identify/estimate/drift.hpp"
#include "identify/estimate/local_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace treacle::identify {

namespace {
constexpr int most_rounds = 20; // of diluting

// Distance by which the fit takes the view of each experiment from what is known of it: its square, in units of its
// expectation by the priors and a standard deviation more. Above 1 the residuals are less independent than their
// scatter shows: what the model does not explain has pulled at the view.
std::vector<double> excesses(const Vector& view, const Matrix& information, const EvaluatedRun& run) {
    std::vector<double> out;
    for (std::size_t e = 0; e < run.experiments.size(); ++e) {
        const auto first = Eigen::Index(e) * view_count;
        const auto count = Eigen::Index(view_parameters(run.experiments[e].kind).size());
        const Vector v = view.segment(first, count);
        constexpr double exact = 1e20; // information on what is held to be known
        const auto free = (information.diagonal().segment(first, count).array() < exact).count();
        const double n = double(std::max<Eigen::Index>(1, free));
        out.push_back(v.dot(information.block(first, first, count, count) * v) / (n + std::sqrt(2 * n)));
    }
    return out;
}

double& part_of(VarianceParts& parts, ViewPart part) {
    switch (part) {
    case ViewPart::time: return parts.time;
    case ViewPart::contour: return parts.contour;
    case ViewPart::camera: return parts.camera;
    case ViewPart::sheet: return parts.sheet;
    case ViewPart::instrument: break;
    }
    return parts.instrument;
}

// Parts of the variance: the fit, its gradient, the priors' information, and what leaving out each block changes.
struct Spread {
    const Fit& fit;
    const Matrix& g;
    const Matrix& information;
    Matrix changes; // [blocks][parameters]
};

// Parts of the variance of the parameter k of p.
VarianceParts parts_of(Eigen::Index k, Eigen::Index p, const Spread& spread, const EvaluatedRun& run) {
    const auto& [fit, g, information, changes] = spread;
    VarianceParts out;
    const Matrix& a = fit.inverse;
    const Vector moves = g * a.col(k);
    out.pixels = std::max(
        changes.col(k).squaredNorm(), moves.dot(fit.weights.cwiseProduct(moves))); // of blocks, and of diluted segments
    for (std::size_t e = 0; e < run.experiments.size(); ++e) {
        const auto& views = view_parameters(run.experiments[e].kind);
        for (std::size_t first = 0, end = 0; first < views.size();
             first = end) { // parameters of a part share a covariance
            while (end < views.size() && views[end].part == views[first].part) ++end;
            const auto at_view = p + Eigen::Index(e) * view_count + Eigen::Index(first),
                       count = Eigen::Index(end - first);
            const Vector column = a.row(k).segment(at_view, count).transpose();
            part_of(out, views[first].part) += column.dot(information.block(at_view, at_view, count, count) * column);
        }
    }
    out.range = a.row(k).head(p).dot(information.topLeftCorner(p, p) * a.row(k).head(p).transpose());
    return out;
}

// Covariance of the parameters, by blocks and by the priors of views and ranges.
Matrix covariance_of(const Spread& spread, Eigen::Index p) {
    const Matrix moves = spread.changes.leftCols(p), by_priors = spread.fit.inverse.topRows(p);
    return moves.transpose() * moves + by_priors * spread.information * by_priors.transpose();
}

// Standard deviation of each parameter if every point had the noise of its segment, independent of its neighbours, and the view were known.
std::vector<double> naive_deviations(
    const EvaluatedRun& run, const Layout& layout, const Matrix& gradient, const std::vector<double>& noise) {
    Vector information = Vector::Zero(gradient.cols());
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const double scale = noise[layout.rows[i].experiment];
        information +=
            at(run, layout.rows[i]).points / (scale * scale) * gradient.row(Eigen::Index(i)).cwiseAbs2().transpose();
    }
    std::vector<double> out;
    for (const double one : information) out.push_back(1 / std::sqrt(one));
    return out;
}

// By experiment and frame: squares of what is left over in the experiment's unit, weighted by the points of the segments; these points; the time [s].
std::map<std::pair<std::size_t, int>, std::array<double, 3>> squares_by_frame(
    const EvaluatedRun& run, const Layout& layout, const Vector& left) {
    std::map<std::pair<std::size_t, int>, std::array<double, 3>> out;
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const auto& row = layout.rows[i];
        const auto& s = at(run, row);
        auto& sum = out[{row.experiment, s.frame}];
        sum[0] += s.points * std::pow(left[Eigen::Index(i)] * row.usual, 2);
        sum[1] += s.points;
        sum[2] = s.time;
    }
    return out;
}

// Root mean square residual left over by frame of each experiment.
void tell_misfit(Estimate& out, const EvaluatedRun& run, const Layout& layout, const Vector& left_over) {
    for (const auto& [key, sum] : squares_by_frame(run, layout, left_over)) {
        out.misfit.push_back(std::sqrt(sum[0] / sum[1]));
        out.times.push_back(sum[2]);
        out.misfit_of.push_back(key.first);
    }
}

// (I7) Shares of the frames in the information on a single parameter, sums of `telling` by rows.
void tell_information(Estimate& out, const EvaluatedRun& run, const Layout& layout, const Vector& telling) {
    std::map<std::pair<std::size_t, int>, double> sums;
    for (std::size_t i = 0; i < layout.rows.size(); ++i)
        sums[{layout.rows[i].experiment, at(run, layout.rows[i]).frame}] += telling[Eigen::Index(i)];
    const double all = telling.sum();
    for (const auto& [frame, sum] : sums) out.information_fraction.push_back(all > 0 ? sum / all : 0);
}

// By frame of all experiments: how far the run's liquid goes on beyond the observed one, in usual noises, a segment each. Empty where nothing is compared by contours.
std::vector<double> beyond_contours(const EvaluatedRun& run) {
    std::vector<double> out;
    for (const auto& one : run.experiments) {
        if (one.kind != ExperimentKind::contours) continue;
        for (const auto& frame : one.frames) out.push_back(frame.beyond / usual_noise(one.kind));
    }
    return out;
}

const EvaluatedRun& least_of(const std::vector<EvaluatedRun>& runs, const std::vector<ViewInformation>& priors) {
    std::vector<double> objectives;
    objectives.reserve(runs.size());
    for (const auto& run : runs) objectives.push_back(residual_objective(run, priors));
    return runs[std::size_t(std::ranges::min_element(objectives) - objectives.begin())];
}
} // namespace

const char* misfit_unit(ExperimentKind kind) { return kind == ExperimentKind::contours ? "px" : "noises"; }

double residual_objective(const EvaluatedRun& run, const std::vector<ViewInformation>& priors, double bend) {
    const auto layout = layout_of(run, {}, {});
    if (layout.rows.empty()) return 1e300;
    const auto r = displacements(run, layout), size = sizes(run, layout);
    const auto best = fit({r, view_matrix(run, layout), size, prior_matrix(priors, 0)}, layout, {true, bend, {}, 0});
    double sum = best.x.dot(prior_matrix(priors, 0) * best.x);
    for (Eigen::Index i = 0; i < r.size(); ++i) {
        const double u = std::abs(best.left[i]);
        sum += size[i] * (u <= bend ? u * u : 2 * bend * u - bend * bend);
    }
    for (const double beyond : beyond_contours(run)) sum += 2 * bend * beyond;
    return 0.5 * sum / double(r.size());
}

std::vector<double> search_residuals(const EvaluatedRun& run, const std::vector<ViewInformation>& priors, double bend) {
    std::vector<double> out;
    std::vector<std::size_t> first;
    for (const auto& one : run.experiments) {
        first.push_back(out.size());
        out.resize(out.size() + one.segments.size(), std::nan(""));
    }
    const auto layout = layout_of(run, {}, {});
    if (layout.rows.empty()) return {};
    const auto size = sizes(run, layout);
    const auto information = prior_matrix(priors, 0);
    const auto best =
        fit({displacements(run, layout), view_matrix(run, layout), size, information}, layout, {true, bend, {}, 0});
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        out[first[layout.rows[i].experiment] + layout.rows[i].segment] =
            std::sqrt(size[Eigen::Index(i)]) * best.left[Eigen::Index(i)];
    }
    const auto beyond = beyond_contours(run);
    out.insert(out.end(), beyond.begin(), beyond.end());
    const Vector away = information.llt().matrixU() * best.x;
    out.insert(out.end(), away.data(), away.data() + away.size());
    return out;
}

std::vector<double> misfits_of_run(const EvaluatedRun& run, const std::vector<ViewInformation>& priors, double bend) {
    std::vector<double> squares(run.experiments.size(), 0.0), frames(run.experiments.size(), 0.0), out;
    const auto layout = layout_of(run, {}, {});
    if (layout.rows.empty()) return std::vector<double>(run.experiments.size(), std::nan(""));
    const auto best =
        fit({displacements(run, layout), view_matrix(run, layout), sizes(run, layout), prior_matrix(priors, 0)}, layout,
            {true, bend, {}, 0});
    for (const auto& [key, sum] : squares_by_frame(run, layout, best.left)) {
        squares[key.first] += sum[0] / sum[1];
        frames[key.first] += 1;
    }
    for (std::size_t e = 0; e < squares.size(); ++e)
        out.push_back(frames[e] > 0 ? std::sqrt(squares[e] / frames[e]) : std::nan(""));
    return out;
}

double VarianceParts::total() const {
    double sum = pixels + time + contour + camera + sheet + instrument + range + resolution + noise + clips;
    for (const auto& [name, part] : measured) sum += part;
    return sum;
}

double ninety_percent(const VarianceParts& parts, double freedom) {
    constexpr double z = 1.6449;
    const double total = parts.total();
    double inverse = 0; // of the sum's degrees of freedom
    if (parts.pixels > 0) inverse += parts.pixels * parts.pixels / (total * total * freedom);
    if (parts.clips > 0) inverse += parts.clips * parts.clips / (total * total * parts.clip_freedom);
    if (!(inverse > 0)) return z;
    const double n = 1 / inverse;
    // Expansion of the quantile in 1 / n (Abramowitz & Stegun 26.7.5).
    const double z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
    return z + (z3 + z) / (4 * n) + (5 * z5 + 16 * z3 + 3 * z) / (96 * n * n) +
           (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * n * n * n);
}

namespace {
// Runs and prior knowledge that the answer is found from.
struct Given {
    const std::vector<EvaluatedRun>& runs;
    const std::vector<ViewInformation>& priors;
    const std::vector<std::vector<EvaluatedRun>>& finer;
    const RangePrior& range;
};

class Estimator {
public:
    Estimator(const Given& given, const EvaluatedRun& best, const Layout& layout)
        : given_(given), best_(best), layout_(layout), p_(given.runs.front().point.size()),
          bounded_(given.range.lower.size() == p_), size_(sizes(best, layout)), views_(view_matrix(best, layout)),
          information_(prior_matrix(given.priors, p_)), g_(views_.rows(), p_ + views_.cols()) {
        if (bounded_) information_.diagonal().head(p_) = given.range.information();
    }

    Estimate find() {
        out_.point = best_.point;
        settle({});
        find_blocks();
        const Fit spread = p_ == 1 ? dilute_one() : dilute_several();
        tell_variance({spread, g_, information_, block_changes({spread, g_, blocks_}, information_)});
        tell_fit();
        if (p_ == 1) tell_drifts();
        return out_;
    }

private:
    // Rounds of the local model and its fit, until the point stays.
    void settle(const std::vector<double>& dilution) {
        const auto& range = given_.range;
        for (int round = 0; round < 12; ++round) {
            model_ = local_model(given_.runs, layout_, out_.point);
            for (const auto& rung : given_.finer) correct(model_, rung, layout_, out_.point);
            g_ << model_.gradient, views_;
            Vector pull = Vector::Zero(g_.cols());
            if (bounded_) pull.head(p_) = range.information().cwiseProduct(out_.point - range.centre());
            result_ = fit({model_.value, g_, size_, information_}, layout_, {false, 3, dilution, p_, pull});
            const Vector before = out_.point;
            // Not far beyond the runs, where the model is a guess.
            out_.point += result_.x.head(p_) / std::max(1.0, result_.x.head(p_).cwiseAbs().maxCoeff() / 0.5);
            if (bounded_) out_.point = out_.point.cwiseMax(range.lower).cwiseMin(range.upper);
            const Vector step = out_.point - before;
            if (step.cwiseAbs().maxCoeff() < 1e-6) break;
        }
    }
    void find_blocks() {
        const auto sector = sectors(best_, layout_);
        out_.block_frames = correlation_frames(best_, layout_, result_.left, sector);
        blocks_ = blocks_of(best_, layout_, sector, 2 * out_.block_frames);
        out_.blocks = std::size_t(*std::ranges::max_element(blocks_)) + 1;
        // Segments that share their noise must not outvote what is known of the view.
        dilution_ = inflation({result_, g_, blocks_}, block_changes({result_, g_, blocks_}, information_), layout_, p_);
    }
    Matrix view_information() const { return information_.bottomRightCorner(views_.cols(), views_.cols()); }
    std::vector<double> excess() const {
        return excesses(result_.x.tail(result_.x.size() - p_), view_information(), best_);
    }
    void dilute(const std::vector<double>& excess) {
        for (std::size_t e = 0; e < excess.size(); ++e) dilution_[e] *= std::max(1.0, std::min(10.0, excess[e]));
    }
    Fit dilute_one() {
        settle(dilution_);
        for (int round = 0; round < most_rounds && std::ranges::max(excess()) > 1; ++round) {
            dilute(excess());
            settle(dilution_);
        }
        return result_;
    }
    // Several parameters can do what the resolution does to the view, if this is held: they leave by the valley in which they trade with
    // each other. So the view is free within its priors, and dilution widens the region alone, by the same for all experiments: with
    // one of its own the one that the model explains worse would be given up for the others.
    Fit dilute_several() {
        dilute(excess());
        std::ranges::fill(dilution_, std::ranges::max(dilution_));
        return fit({model_.value, g_, size_, information_}, layout_, {false, 3, dilution_, p_, {}});
    }
    void tell_variance(const Spread& spread) {
        out_.covariance = covariance_of(spread, p_);
        for (Eigen::Index k = 0; k < p_; ++k) {
            out_.parts.push_back(parts_of(k, p_, spread, best_));
            const auto squares = spread.changes.col(k).array().square();
            out_.freedom.push_back(
                std::max(1.0, squares.sum() * squares.sum() / std::max(1e-300, squares.square().sum()) - 1));
        }
        const double deviation = std::sqrt(out_.parts.front().total());
        const double slope = model_.gradient.col(0).norm();
        out_.curvature = slope > 0 ? 0.5 * deviation * model_.square.norm() / slope : 0;
    }
    void tell_fit() {
        const auto& noise = result_.noise;
        out_.naive = naive_deviations(best_, layout_, model_.gradient, noise);
        for (std::size_t e = 0; e < given_.priors.size(); ++e)
            out_.view.push_back(result_.x.segment(p_ + Eigen::Index(e) * view_count, view_count));
        for (std::size_t e = 0; e < layout_.experiments; ++e)
            out_.noise.push_back(noise[e] * usual_noise(best_.experiments[e].kind));
        out_.runs = model_.runs;
        out_.dilution = dilution_;
        for (std::size_t e = 0; e < layout_.experiments; ++e) {
            constexpr double half_quantile = 1.353; // of chi square of one degree of freedom, 90 %
            out_.alike =
                std::max(out_.alike, half_quantile * dilution_[e] * noise[e] * noise[e] / double(layout_.rows.size()));
        }
        tell_misfit(out_, best_, layout_, result_.left);
    }
    void tell_drifts() {
        const WholeFit all{best_, layout_, result_, model_.gradient.col(0), views_, view_information(), blocks_};
        for (std::size_t e = 0; e < layout_.experiments; ++e) out_.drifts.push_back(drift_of(e, all));
        tell_information(out_, best_, layout_, result_.weights.cwiseProduct(all.gradient.cwiseAbs2()));
    }

    Given given_;
    const EvaluatedRun& best_;
    const Layout& layout_;
    Eigen::Index p_;
    bool bounded_;
    Vector size_;
    Matrix views_, information_, g_;
    LocalModel model_;
    Fit result_;
    std::vector<int> blocks_;
    std::vector<double> dilution_; // per experiment
    Estimate out_;
};
} // namespace

Estimate estimate(const std::vector<EvaluatedRun>& runs, const std::vector<ViewInformation>& priors,
    const std::vector<std::vector<EvaluatedRun>>& finer, const RangePrior& range) {
    if (runs.empty())
        throw InputError({"identify", "has no good run", "all have failed", "look at their reasons in the table"});
    const auto& best = least_of(finer.empty() ? runs : finer.back(), priors);
    const auto layout = layout_of(best, runs, finer);
    if (layout.rows.empty()) {
        throw InputError({"identify", "finds nothing to compare: no contour in the masks, no vector in the liquid",
            "masks hold no liquid, or only specks and what touches the rim; or sheets lie where no run has liquid",
            "look at the masks or fields, and at from and to"});
    }
    return Estimator({runs, priors, finer, range}, best, layout).find();
}

} // namespace treacle::identify
