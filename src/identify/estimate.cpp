#include "identify/estimate.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace treacle::identify {

namespace {
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

constexpr double least_noise = 0.1; // of the usual one
constexpr int rounds = 20;           // of reweighting
constexpr double correlated = 0.2;   // autocorrelation below which frames count as independent

// Segments of all experiments in one list: those that stand in every run and that this one compares.
struct Layout {
    struct Row {
        std::size_t experiment, segment;
        double usual; // noise
    };
    std::vector<Row> rows;
    std::size_t experiments = 0;
};

Layout layout_of(const EvaluatedRun& run, const std::vector<EvaluatedRun>& others, const std::vector<std::vector<EvaluatedRun>>& finer) {
    Layout out;
    out.experiments = run.experiments.size();
    for (std::size_t e = 0; e < run.experiments.size(); ++e) {
        const double usual = usual_noise(run.experiments[e].kind);
        for (std::size_t s = 0; s < run.experiments[e].segments.size(); ++s) {
            const auto finite = [&](const EvaluatedRun& one) { return std::isfinite(one.experiments[e].segments[s].displacement); };
            const auto all_finite = [&](const std::vector<EvaluatedRun>& runs) { return std::ranges::all_of(runs, finite); };
            if (run.experiments[e].segments[s].points > 0 && finite(run) && all_finite(others) && std::ranges::all_of(finer, all_finite)) out.rows.push_back({e, s, usual});
        }
    }
    return out;
}

const SegmentResidual& at(const EvaluatedRun& run, const Layout::Row& row) { return run.experiments[row.experiment].segments[row.segment]; }

double huber_weight(double residual, double scale, double bend) { return std::abs(residual) <= bend * scale ? 1 : bend * scale / std::abs(residual); }

// The value below which half of the weights lie.
double weighted_median(std::vector<std::pair<double, double>> values) { // value, weight
    std::ranges::sort(values);
    double half = 0;
    for (const auto& [value, weight] : values) half += 0.5 * weight;
    for (const auto& [value, weight] : values) {
        half -= weight;
        if (half <= 0) return value;
    }
    return 0;
}

// Noise of each experiment, by the segments that tell the parameters: those that do not move, along walls say, have no part in the noise.
// pooled: the same for all, in units of what is usual of each.
std::vector<double> robust_scales(const Vector& residuals, const Layout& layout, const Vector& telling, bool pooled) {
    std::vector<std::vector<std::pair<double, double>>> sizes(pooled ? 1 : layout.experiments);
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        sizes[pooled ? 0 : layout.rows[i].experiment].emplace_back(std::abs(residuals[Eigen::Index(i)]), telling[Eigen::Index(i)]);
    }
    std::vector<double> out;
    for (auto& one : sizes) out.push_back(std::max(least_noise, 1.4826 * weighted_median(std::move(one))));
    if (pooled) out.resize(layout.experiments, out.front());
    return out;
}

// Derivatives by the view's parameters of all experiments, [rows][experiments * view_count].
Matrix view_matrix(const EvaluatedRun& run, const Layout& layout) {
    Matrix out = Matrix::Zero(Eigen::Index(layout.rows.size()), Eigen::Index(run.experiments.size() * view_count));
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const auto& row = layout.rows[i];
        for (int k = 0; k < view_count; ++k) out(Eigen::Index(i), Eigen::Index(row.experiment) * view_count + k) = at(run, row).by_view[std::size_t(k)] / row.usual;
    }
    return out;
}

// In units of their usual noise.
Vector displacements(const EvaluatedRun& run, const Layout& layout) {
    Vector out(Eigen::Index(layout.rows.size()));
    for (std::size_t i = 0; i < layout.rows.size(); ++i) out[Eigen::Index(i)] = at(run, layout.rows[i]).displacement / layout.rows[i].usual;
    return out;
}

// Points of each segment over their mean in its experiment.
Vector sizes(const EvaluatedRun& run, const Layout& layout) {
    Vector out(Eigen::Index(layout.rows.size()));
    std::vector<double> sum(layout.experiments), count(layout.experiments);
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const auto e = layout.rows[i].experiment;
        out[Eigen::Index(i)] = at(run, layout.rows[i]).points;
        sum[e] += out[Eigen::Index(i)];
        count[e] += 1;
    }
    for (std::size_t i = 0; i < layout.rows.size(); ++i) out[Eigen::Index(i)] *= count[layout.rows[i].experiment] / sum[layout.rows[i].experiment];
    return out;
}

Matrix prior_matrix(const std::vector<ViewInformation>& priors, Eigen::Index before) {
    const auto n = before + Eigen::Index(priors.size()) * view_count;
    Matrix out = Matrix::Zero(n, n);
    for (std::size_t e = 0; e < priors.size(); ++e) {
        const auto first = before + Eigen::Index(e) * view_count;
        out.block(first, first, view_count, view_count) = priors[e];
    }
    return out;
}

// The parameters of a linear model r + G x whose reweighted squares are least within the priors.
struct Fit {
    Vector x, left, weights;
    Matrix inverse; // of G^T W G + P
    std::vector<double> noise; // per experiment, in usual ones
};

struct FitOptions {
    bool usual_noise = false; // that of the residuals otherwise
    double bend = 3;
    std::vector<double> dilution; // per experiment: how many correlated segments count as one
    Eigen::Index parameters = 0;  // columns before those of the views
    Vector pull = {};             // slope of what is known beside the residuals; empty: none
};

Fit fit(const Vector& r, const Matrix& g, const Vector& size, const Matrix& information, const Layout& layout, const FitOptions& options) {
    Fit out;
    out.x = Vector::Zero(g.cols());
    out.weights = size;
    out.noise.assign(layout.experiments, 1);
    for (int round = 0; round < rounds; ++round) {
        out.left = r + g * out.x;
        if (!options.usual_noise) out.noise = robust_scales(out.left, layout, g.leftCols(options.parameters).rowwise().norm(), options.parameters > 1);
        // Residuals that the view explains are no noise: a first fit that takes it for noise would leave the view where it is, and so the noise.
        if (round == 0) std::ranges::transform(out.noise, out.noise.begin(), [](double noise) { return std::min(noise, 1.0); });
        for (Eigen::Index i = 0; i < r.size(); ++i) {
            const auto e = layout.rows[std::size_t(i)].experiment;
            const double dilution = options.dilution.empty() ? 1 : options.dilution[e];
            out.weights[i] = size[i] * huber_weight(out.left[i], out.noise[e], options.bend) / (out.noise[e] * out.noise[e] * dilution);
        }
        const Matrix weighted = out.weights.asDiagonal() * g;
        out.inverse = (g.transpose() * weighted + information).ldlt().solve(Matrix::Identity(g.cols(), g.cols()));
        Vector slope = weighted.transpose() * r;
        if (options.pull.size() > 0) slope += options.pull;
        const Vector next = -out.inverse * slope;
        const double change = (next - out.x).norm();
        out.x = next;
        if (change <= 1e-10 * (1e-10 + out.x.norm())) break;
    }
    out.left = r + g * out.x;
    return out;
}

// Value, gradient and square term of each row at the centre [p].
struct LocalModel {
    Vector value;
    Matrix gradient; // [rows][p]
    Vector square;   // second derivative along the first parameter; 0 where the runs do not give it
    std::size_t runs = 0;
};

// Distances over which the local model may be fitted, of the logarithm of a viscosity: runs at `reach` count half. With several parameters
// the model is linear, and less far.
constexpr double reach = 0.3, farthest = 0.7;

// Runs that the model is fitted to: all that are not far from the centre, and the nearest ones where these are too few. A model
// through the nearest alone, where a search has closed in, has the derivatives of the runs' numerical noise.
std::vector<const EvaluatedRun*> runs_near(const std::vector<EvaluatedRun>& runs, const Vector& centre) {
    const std::size_t p = std::size_t(centre.size()), wanted = p == 1 ? 5 : p + 3;
    std::vector<std::pair<double, const EvaluatedRun*>> order;
    for (const auto& run : runs) order.emplace_back((run.point - centre).norm(), &run);
    std::ranges::stable_sort(order, {}, &std::pair<double, const EvaluatedRun*>::first);
    std::vector<const EvaluatedRun*> out;
    for (const auto& [distance, run] : order) {
        if (distance <= (p == 1 ? farthest : reach) || out.size() < wanted) out.push_back(run);
    }
    if (out.size() < p + 1) {
        throw InputError({"identify", "has " + std::to_string(out.size()) + " good runs", "its local model needs " + std::to_string(p + 1),
                          "raise search.evaluations, or see why runs failed"});
    }
    return out;
}

LocalModel local_model(const std::vector<EvaluatedRun>& runs, const Layout& layout, const Vector& centre) {
    const auto near = runs_near(runs, centre);
    const auto p = centre.size();
    LocalModel out;
    out.runs = near.size();
    const bool quadratic = p == 1 && out.runs >= 3;
    Matrix basis(Eigen::Index(out.runs), p + 1 + (quadratic ? 1 : 0));
    Matrix values(Eigen::Index(out.runs), Eigen::Index(layout.rows.size()));
    for (std::size_t k = 0; k < out.runs; ++k) {
        const auto i = Eigen::Index(k);
        const Vector d = near[k]->point - centre;
        const double weight = 1 / (1 + d.squaredNorm() / (reach * reach));
        basis(i, 0) = weight;
        basis.row(i).segment(1, p) = weight * d.transpose();
        if (quadratic) basis(i, p + 1) = weight * 0.5 * d[0] * d[0];
        values.row(i) = weight * displacements(*near[k], layout).transpose();
    }
    const Matrix coefficients = basis.colPivHouseholderQr().solve(values);
    out.value = coefficients.row(0).transpose();
    out.gradient = coefficients.middleRows(1, p).transpose();
    out.square = quadratic ? Vector(coefficients.row(p + 1).transpose()) : Vector(Vector::Zero(out.value.size()));
    return out;
}

// Takes the model to the resolution of other runs: what these show beyond it is a value and a slope, by least squares in which the slope is
// expected to be none, over distances at which the numerical noise of runs hides it.
void correct(LocalModel& model, const std::vector<EvaluatedRun>& runs, const Layout& layout, const Vector& centre) {
    constexpr double hidden = 0.1; // distance, of the logarithm of a viscosity, over which the model's slope errs by as much as runs scatter
    const auto p = centre.size(), count = Eigen::Index(runs.size());
    Matrix basis = Matrix::Zero(count + p, p + 1), beyond = Matrix::Zero(count + p, model.value.size());
    for (Eigen::Index i = 0; i < count; ++i) {
        const auto& run = runs[std::size_t(i)];
        const Vector d = run.point - centre;
        basis(i, 0) = 1;
        basis.row(i).tail(p) = d.transpose();
        beyond.row(i) = (displacements(run, layout) - model.value - model.gradient * d).transpose();
        if (p == 1) beyond.row(i) -= 0.5 * d[0] * d[0] * model.square.transpose();
    }
    for (Eigen::Index k = 0; k < p; ++k) basis(count + k, k + 1) = hidden;
    const Matrix change = basis.colPivHouseholderQr().solve(beyond);
    model.value += change.row(0).transpose();
    model.gradient += change.bottomRows(p).transpose();
}

// Number of each frame among those of its experiment.
std::map<std::size_t, std::map<int, int>> frame_order(const EvaluatedRun& run, const Layout& layout) {
    std::map<std::size_t, std::map<int, int>> order;
    for (const auto& row : layout.rows) order[row.experiment].emplace(at(run, row).frame, 0);
    for (auto& [experiment, frames] : order) {
        int k = 0;
        for (auto& [frame, number] : frames) number = k++;
    }
    return order;
}

// Windows of time are averages, independent of each other but whole: what a turn does it does all around.
bool is_averaged(const EvaluatedRun& run, const Layout::Row& row) { return run.experiments[row.experiment].kind == ExperimentKind::occupancy; }

// Frames until the displacements left over are no more correlated: from those of segments at like places in the picture.
int correlation_frames(const EvaluatedRun& run, const Layout& layout, const Vector& left, const std::vector<int>& sector) {
    std::map<std::pair<std::size_t, int>, std::map<int, std::pair<double, int>>> series; // by experiment and sector: sums by frame
    auto order = frame_order(run, layout);
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const auto& row = layout.rows[i];
        if (is_averaged(run, row)) continue;
        auto& entry = series[{row.experiment, sector[i]}][order[row.experiment][at(run, row).frame]];
        entry.first += left[Eigen::Index(i)];
        ++entry.second;
    }
    for (int lag = 1; lag < 200; ++lag) {
        double product = 0, square = 0;
        for (const auto& [key, sums] : series) {
            for (const auto& [place, sum] : sums) {
                const auto other = sums.find(place + lag);
                if (other == sums.end()) continue;
                const double a = sum.first / sum.second, b = other->second.first / other->second.second;
                product += a * b;
                square += 0.5 * (a * a + b * b);
            }
        }
        if (!(square > 0) || product < correlated * square) return lag;
    }
    return 200;
}

// Sixths of the picture around the middle of a frame's contour: parts that share no noise. One where frames are averages.
std::vector<int> sectors(const EvaluatedRun& run, const Layout& layout) {
    std::map<std::pair<std::size_t, int>, std::array<double, 3>> sums;
    for (const auto& row : layout.rows) {
        const auto& s = at(run, row);
        auto& sum = sums[{row.experiment, s.frame}];
        sum[0] += s.x;
        sum[1] += s.y;
        sum[2] += 1;
    }
    std::vector<int> out;
    for (const auto& row : layout.rows) {
        const auto& s = at(run, row);
        const auto& sum = sums[{row.experiment, s.frame}];
        if (is_averaged(run, row)) {
            out.push_back(0);
            continue;
        }
        const double angle = std::atan2(s.y - sum[1] / sum[2], s.x - sum[0] / sum[2]);
        out.push_back(std::min(5, int((angle + 3.14159265358979) / 1.04719755119660)));
    }
    return out;
}
// Block of each row: neighbouring frames, a sector.
std::vector<int> blocks_of(const EvaluatedRun& run, const Layout& layout, const std::vector<int>& sector, int frames_each) {
    auto order = frame_order(run, layout);
    std::map<std::tuple<std::size_t, int, int>, int> numbers;
    std::vector<int> out;
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const auto& row = layout.rows[i];
        const int part = order[row.experiment][at(run, row).frame] / (is_averaged(run, row) ? 1 : frames_each);
        out.push_back(numbers.try_emplace({row.experiment, part, sector[i]}, int(numbers.size())).first->second);
    }
    return out;
}

// What leaving out each block changes of the parameters, [blocks][parameters]: (A - A_b)^-1 G_b^T W_b r_b.
Matrix block_changes(const Fit& fit, const Matrix& g, const Matrix& information, const std::vector<int>& blocks) {
    const int count = *std::ranges::max_element(blocks) + 1;
    const auto n = g.cols();
    std::vector<Matrix> shares(std::size_t(count), Matrix::Zero(n, n));
    Matrix scores = Matrix::Zero(count, n);
    for (Eigen::Index i = 0; i < g.rows(); ++i) {
        const auto b = std::size_t(blocks[std::size_t(i)]);
        shares[b] += fit.weights[i] * g.row(i).transpose() * g.row(i);
        scores.row(Eigen::Index(b)) += fit.weights[i] * fit.left[i] * g.row(i);
    }
    Matrix whole = information;
    for (const auto& share : shares) whole += share;
    Matrix out(count, n);
    for (int b = 0; b < count; ++b) out.row(b) = (whole - shares[std::size_t(b)]).ldlt().solve(scores.row(b).transpose()).transpose();
    return out * (count > 1 ? std::sqrt(double(count - 1) / double(count)) : 1.0);
}

// Variance of the parameters by the blocks of each experiment over that by its independent segments, the largest, at least 1.
std::vector<double> inflation(const Fit& fit, const Matrix& g, const Matrix& changes, const std::vector<int>& blocks, const Layout& layout, Eigen::Index p) {
    const Matrix weighted = fit.weights.cwiseProduct(fit.left).asDiagonal() * g;
    const Matrix moves = weighted * fit.inverse.leftCols(p);
    Matrix independent = Matrix::Zero(Eigen::Index(layout.experiments), p), by_blocks = independent;
    std::vector<bool> counted(std::size_t(changes.rows()));
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const auto e = Eigen::Index(layout.rows[i].experiment);
        independent.row(e) += moves.row(Eigen::Index(i)).cwiseAbs2();
        const auto block = std::size_t(blocks[i]);
        if (!counted[block]) by_blocks.row(e) += changes.row(Eigen::Index(block)).head(p).cwiseAbs2();
        counted[block] = true;
    }
    std::vector<double> out(layout.experiments, 1);
    for (std::size_t e = 0; e < layout.experiments; ++e) {
        for (Eigen::Index k = 0; k < p; ++k) {
            if (independent(Eigen::Index(e), k) > 0) out[e] = std::max(out[e], by_blocks(Eigen::Index(e), k) / independent(Eigen::Index(e), k));
        }
    }
    return out;
}

// Distance by which the fit takes the view of each experiment from what is known of it: its square, in units of its expectation by
// the priors and a standard deviation more. Above 1 the residuals are less independent than their scatter tells: what the model does not explain has pulled at the view.
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

VarianceParts parts_of(Eigen::Index k, Eigen::Index p, const Matrix& changes, const Fit& fit, const Matrix& g, const Matrix& information, const EvaluatedRun& run) {
    VarianceParts out;
    const Matrix& a = fit.inverse;
    const Vector moves = g * a.col(k);
    out.pixels = std::max(changes.col(k).squaredNorm(), moves.dot(fit.weights.cwiseProduct(moves))); // of blocks, and of diluted segments
    for (std::size_t e = 0; e < run.experiments.size(); ++e) {
        const auto& views = view_parameters(run.experiments[e].kind);
        for (std::size_t first = 0, end = 0; first < views.size(); first = end) { // parameters of a part share a covariance
            while (end < views.size() && views[end].part == views[first].part) ++end;
            const auto at_view = p + Eigen::Index(e) * view_count + Eigen::Index(first), count = Eigen::Index(end - first);
            const Vector column = a.row(k).segment(at_view, count).transpose();
            part_of(out, views[first].part) += column.dot(information.block(at_view, at_view, count, count) * column);
        }
    }
    out.range = a.row(k).head(p).dot(information.topLeftCorner(p, p) * a.row(k).head(p).transpose());
    return out;
}

// Covariance of the parameters, by blocks and by the priors of views and ranges.
Matrix covariance_of(const Matrix& changes, const Fit& fit, const Matrix& information, Eigen::Index p) {
    const Matrix moves = changes.leftCols(p), by_priors = fit.inverse.topRows(p);
    return moves.transpose() * moves + by_priors * information * by_priors.transpose();
}

// Standard deviation of each parameter if every point had the noise of its segment, independent of its neighbours, and the view were known.
std::vector<double> naive_deviations(const EvaluatedRun& run, const Layout& layout, const Matrix& gradient, const std::vector<double>& noise) {
    Vector information = Vector::Zero(gradient.cols());
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const double scale = noise[layout.rows[i].experiment];
        information += at(run, layout.rows[i]).points / (scale * scale) * gradient.row(Eigen::Index(i)).cwiseAbs2().transpose();
    }
    std::vector<double> out;
    for (const double one : information) out.push_back(1 / std::sqrt(one));
    return out;
}

const EvaluatedRun& least_of(const std::vector<EvaluatedRun>& runs, const std::vector<ViewInformation>& priors) {
    std::vector<double> objectives;
    for (const auto& run : runs) objectives.push_back(residual_objective(run, priors));
    return runs[std::size_t(std::ranges::min_element(objectives) - objectives.begin())];
}
} // namespace

double residual_objective(const EvaluatedRun& run, const std::vector<ViewInformation>& priors, double bend) {
    const auto layout = layout_of(run, {}, {});
    if (layout.rows.empty()) return 1e300;
    const auto r = displacements(run, layout), size = sizes(run, layout);
    const auto best = fit(r, view_matrix(run, layout), size, prior_matrix(priors, 0), layout, {true, bend, {}, 0});
    double sum = best.x.dot(prior_matrix(priors, 0) * best.x);
    for (Eigen::Index i = 0; i < r.size(); ++i) {
        const double u = std::abs(best.left[i]);
        sum += size[i] * (u <= bend ? u * u : 2 * bend * u - bend * bend);
    }
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
    const auto best = fit(displacements(run, layout), view_matrix(run, layout), size, information, layout, {true, bend, {}, 0});
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        out[first[layout.rows[i].experiment] + layout.rows[i].segment] = std::sqrt(size[Eigen::Index(i)]) * best.left[Eigen::Index(i)];
    }
    const Vector away = information.llt().matrixU() * best.x;
    out.insert(out.end(), away.data(), away.data() + away.size());
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
    return z + (z3 + z) / (4 * n) + (5 * z5 + 16 * z3 + 3 * z) / (96 * n * n) + (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * n * n * n);
}

Estimate estimate(const std::vector<EvaluatedRun>& runs, const std::vector<ViewInformation>& priors, const std::vector<std::vector<EvaluatedRun>>& finer, const RangePrior& range) {
    if (runs.empty()) throw InputError({"identify", "has no good run", "all have failed", "look at their reasons in the table"});
    const auto p = runs.front().point.size();
    const auto* best = &least_of(finer.empty() ? runs : finer.back(), priors);
    const auto layout = layout_of(*best, runs, finer);
    if (layout.rows.empty()) {
        throw InputError({"identify", "finds nothing to compare: no contour in the masks, no vector in the liquid",
                          "masks hold no liquid, or only specks and what touches the rim; or sheets lie where no run has liquid",
                          "look at the masks or fields, and at from and to"});
    }
    const auto size = sizes(*best, layout);
    const auto views = view_matrix(*best, layout);
    auto information = prior_matrix(priors, p);
    const bool bounded = range.lower.size() == p;
    if (bounded) information.diagonal().head(p) = range.information();

    Estimate out;
    out.point = best->point;
    Fit result;
    LocalModel model;
    Matrix g(views.rows(), p + views.cols());
    const auto settle = [&](const std::vector<double>& dilution) {
        for (int round = 0; round < 12; ++round) {
            model = local_model(runs, layout, out.point);
            for (const auto& rung : finer) correct(model, rung, layout, out.point);
            g << model.gradient, views;
            Vector pull = Vector::Zero(g.cols());
            if (bounded) pull.head(p) = range.information().cwiseProduct(out.point - range.centre());
            result = fit(model.value, g, size, information, layout, {false, 3, dilution, p, pull});
            const Vector before = out.point;
            // Not far beyond the runs, where the model is a guess.
            out.point += result.x.head(p) / std::max(1.0, result.x.head(p).cwiseAbs().maxCoeff() / 0.5);
            if (bounded) out.point = out.point.cwiseMax(range.lower).cwiseMin(range.upper);
            const Vector step = out.point - before;
            if (step.cwiseAbs().maxCoeff() < 1e-6) break;
        }
    };
    settle({});
    const auto sector = sectors(*best, layout);
    out.block_frames = correlation_frames(*best, layout, result.left, sector);
    const auto blocks = blocks_of(*best, layout, sector, 2 * out.block_frames);
    out.blocks = std::size_t(*std::ranges::max_element(blocks)) + 1;
    // Segments that share their noise must not outvote what is known of the view.
    auto dilution = inflation(result, g, block_changes(result, g, information, blocks), blocks, layout, p);
    const auto far = [&] { return excesses(result.x.tail(result.x.size() - p), information.bottomRightCorner(views.cols(), views.cols()), *best); };
    const auto dilute = [&](const std::vector<double>& excess) {
        for (std::size_t e = 0; e < excess.size(); ++e) dilution[e] *= std::max(1.0, std::min(10.0, excess[e]));
    };
    Fit spread;
    if (p == 1) {
        settle(dilution);
        for (int round = 0; round < rounds && std::ranges::max(far()) > 1; ++round) {
            dilute(far());
            settle(dilution);
        }
        spread = result;
    } else {
        // Several parameters can do what the resolution does to the view, if this is held: they leave by the valley in which they trade with
        // each other. So the view is free within its priors, and dilution widens the region alone, by the same for all experiments: with
        // one of its own the one that the model explains worse would be given up for the others.
        dilute(far());
        std::ranges::fill(dilution, std::ranges::max(dilution));
        spread = fit(model.value, g, size, information, layout, {false, 3, dilution, p, {}});
    }

    const Matrix changes = block_changes(spread, g, information, blocks);
    out.covariance = covariance_of(changes, spread, information, p);
    for (Eigen::Index k = 0; k < p; ++k) {
        out.parts.push_back(parts_of(k, p, changes, spread, g, information, *best));
        const auto squares = changes.col(k).array().square();
        out.freedom.push_back(std::max(1.0, squares.sum() * squares.sum() / std::max(1e-300, squares.square().sum()) - 1));
    }
    out.naive = naive_deviations(*best, layout, model.gradient, result.noise);
    for (std::size_t e = 0; e < priors.size(); ++e) out.view.push_back(result.x.segment(p + Eigen::Index(e) * view_count, view_count));
    for (std::size_t e = 0; e < layout.experiments; ++e) out.noise.push_back(result.noise[e] * usual_noise(best->experiments[e].kind));
    out.runs = model.runs;
    out.dilution = dilution;
    for (std::size_t e = 0; e < layout.experiments; ++e) {
        constexpr double half_quantile = 1.353; // of chi square of one degree of freedom, 90 %
        out.alike = std::max(out.alike, half_quantile * dilution[e] * result.noise[e] * result.noise[e] / double(layout.rows.size()));
    }
    const double deviation = std::sqrt(out.parts.front().total());
    const double slope = model.gradient.col(0).norm();
    out.curvature = slope > 0 ? 0.5 * deviation * model.square.norm() / slope : 0;
    std::map<std::pair<std::size_t, int>, std::array<double, 3>> frames;
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const auto& row = layout.rows[i];
        const auto& s = at(*best, row);
        auto& sum = frames[{row.experiment, s.frame}];
        const double left = result.left[Eigen::Index(i)] * row.usual;
        sum[0] += s.points * left * left;
        sum[1] += s.points;
        sum[2] = s.time;
    }
    for (const auto& [key, sum] : frames) {
        out.misfit.push_back(std::sqrt(sum[0] / sum[1]));
        out.times.push_back(sum[2]);
        out.misfit_of.push_back(key.first);
    }
    return out;
}

} // namespace treacle::identify
