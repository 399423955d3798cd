#include "video/pose/contour_pose.hpp"

#include "base/median.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/camera/camera_matrix.hpp"
#include "video/picture/vector.hpp"
#include "video/pose/contour_noise.hpp"
#include "video/pose/pose_algebra.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::video {

namespace {

constexpr int rounds = 22, last_rounds = 3; // the last ones with correlated errors
constexpr double coarse_correlation = 25;   // [points] of the rounds before
constexpr double narrowest = 4;             // [pixels] of the search, or five deviations
constexpr double tukey = 4.685;             // deviations beyond which a point has no weight
constexpr double floor_noise = 0.1;         // [pixels] of outlines of masks

// Position of the solid's outline along the normal of a point of the silhouette's outline.
struct Match {
    double displacement = 0; // [pixels] outward
    Vec3 foot{0, 0, 0};      // [m] the point of the solid that is seen there
    std::size_t point = 0;   // of the contour
};

// Follows the normal from where rays hit the solid to where they pass it. The distance at which a ray passes, over that
// of a pixel, gives the distance outside of the outline: two or three steps reach it.
bool find_outline(
    const scene::CameraModel& camera, const SeenSolid& solid, const ContourPoint& point, double search, Match& match) {
    const double focal = 0.5 * (camera.lens().fx + camera.lens().fy);
    const auto look = [&](double s) {
        const auto ray = ray_of(camera, {point.pixel[0] + s * point.normal[0], point.pixel[1] + s * point.normal[1]});
        const auto passing = pass(solid, ray.origin, ray.direction);
        return std::pair(passing, ray.origin + passing.at * ray.direction);
    };
    double inside = -search, outside = search;
    auto [at, foot] = look(0);
    if (at.hits)
        inside = 0;
    else
        outside = 0;
    // The end of the bracket that is not known is stepped to in growing steps.
    for (double step = std::min(2.0, search); at.hits ? outside == search : inside == -search; step *= 2) {
        const double s = at.hits ? std::min(inside + step, search) : std::max(outside - step, -search);
        const auto next = look(s);
        if (next.first.hits == at.hits) {
            if (std::abs(s) >= search) return false;
            (at.hits ? inside : outside) = s;
            continue;
        }
        (at.hits ? outside : inside) = s;
        break;
    }
    for (int round = 0; round < 40 && outside - inside > 0.002; ++round) {
        std::tie(at, foot) = look(outside);
        const double pixels = at.least * focal / std::max(camera.to_camera(foot)[2], 1e-6);
        const double guess = outside - std::max(pixels - 0.0005, 0.0005);
        const double s = guess > inside && round % 4 != 3 ? guess : 0.5 * (inside + outside);
        (look(s).first.hits ? inside : outside) = s;
    }
    std::tie(at, foot) = look(outside);
    match.displacement = 0.5 * (inside + outside);
    match.foot = foot;
    return true;
}

std::vector<Match> match_outlines(const scene::CameraModel& camera, const SeenSolid& solid,
    const std::vector<ContourPoint>& contour, double search, std::size_t stride) {
    std::vector<Match> out;
    for (std::size_t i = 0; i < contour.size(); i += stride) {
        Match match;
        match.point = i;
        if (find_outline(camera, solid, contour[i], search, match) &&
            camera.to_camera(match.foot)[2] > scene::CameraModel::near_plane)
            out.push_back(match);
    }
    return out;
}

// Robust deviation about zero.
double spread_of(const std::vector<Match>& matches) {
    std::vector<double> sizes;
    sizes.reserve(matches.size());
    for (const auto& match : matches) sizes.push_back(std::abs(match.displacement));
    return std::max(floor_noise, 1.4826 * upper_median(sizes));
}

double weight_of(double displacement, double deviation) {
    const double u = displacement / (tukey * deviation);
    return std::abs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0;
}

struct Normal {
    PoseMatrix information = PoseMatrix::zeros();
    PoseVector gradient = PoseVector::all(0);
    cv::Matx<double, 6, 12> across = cv::Matx<double, 6, 12>::zeros();
    double weights = 0, mean = 0;
};

// Equations of sum w (d + n . J x)^2.
Normal equations(const scene::CameraModel& camera, const std::vector<ContourPoint>& contour,
    const std::vector<Match>& matches, double deviation, bool with_lens) {
    Normal out;
    for (const auto& match : matches) {
        const double w = weight_of(match.displacement, deviation);
        if (w == 0) continue;
        const auto& n = contour[match.point].normal;
        const cv::Matx<double, 1, 2> normal(n[0], n[1]);
        const cv::Matx<double, 1, 6> row = normal * pixel_jacobian(camera, match.foot);
        out.information += w * row.t() * row;
        for (int i = 0; i < 6; ++i) out.gradient[i] -= w * match.displacement * row(i);
        if (with_lens) out.across += w * row.t() * (normal * lens_jacobian(camera, match.foot));
        out.weights += w;
        out.mean += w * match.displacement;
    }
    out.mean /= std::max(out.weights, 1e-300);
    return out;
}

// The equations of the points that fit, for the estimate with correlated errors.
std::vector<OutlineEquation> fitting_equations(const scene::CameraModel& camera,
    const std::vector<ContourPoint>& contour, const std::vector<Match>& matches, double deviation) {
    std::vector<OutlineEquation> out;
    for (const auto& match : matches) {
        if (std::abs(match.displacement) > 4 * deviation) continue;
        const auto& point = contour[match.point];
        out.push_back({match.displacement,
            cv::Matx<double, 1, 2>(point.normal[0], point.normal[1]) * pixel_jacobian(camera, match.foot), point.pixel,
            point.normal});
    }
    return out;
}

PoseMatrix prior_of(const CameraRecord& start, const ContourPoseOptions& options) {
    if (start.pose_covariance) return inverse(matrix_of(*start.pose_covariance));
    PoseMatrix prior = PoseMatrix::zeros();
    for (int i = 0; i < 6; ++i) prior(i, i) = 1 / std::pow(i < 3 ? options.angle : options.shift, 2);
    return prior;
}

// Change that leads from one pose to another one, to first order in the translation.
PoseVector change_between(const scene::CameraPose& from, const scene::CameraPose& to) {
    const Vec3 w = scene::rotation_vector(scene::product(to.rotation, scene::transposed(from.rotation)));
    const Vec3 t = to.translation - from.translation;
    return {w[0], w[1], w[2], t[0], t[1], t[2]};
}

class ContourRefinement {
public:
    ContourRefinement(const CameraRecord& start, const SeenSolid& solid, const Silhouette& silhouette,
        const ContourPoseOptions& options)
        : start_(start), solid_(solid), silhouette_(silhouette), options_(options),
          contour_(find_contour(silhouette.mask)), prior_(prior_of(start, options)), pose_(*start.pose),
          search_(options.search), deviation_(options.search) {}

    double overlap_now() const {
        return overlap(look_at(unchecked_camera(start_.lens, pose_), {solid_}).mask(), silhouette_.mask);
    }
    void run() {
        for (int round = 0; round < rounds; ++round) {
            const auto camera = unchecked_camera(start_.lens, pose_);
            // Far from the end a part of the outline will do.
            const bool fine = round + last_rounds >= rounds;
            match(camera, fine ? 1 : std::max<std::size_t>(1, contour_.size() / 150));
            const PoseVector to_start = change_between(pose_, *start_.pose);
            if (fine) {
                fit_ = fit_outline(fitting_equations(camera, contour_, matches_, deviation_), prior_, to_start);
                normal_ = equations(camera, contour_, matches_, deviation_, start_.covariance.has_value());
                if (round + 1 < rounds) pose_ = changed(pose_, fit_.change);
            } else {
                step(camera, to_start);
            }
            search_ = std::min(std::max({0.75 * search_, narrowest, 5 * deviation_}), options_.search);
        }
    }
    void tell(ContourPose& out) const {
        out.estimate.pose = pose_;
        out.estimate.covariance = covariance_of(covariance());
        std::size_t fitting = 0;
        double squares = 0, weights = 0;
        for (const auto& match : matches_) {
            const double w = weight_of(match.displacement, deviation_);
            fitting += w > 0;
            squares += w * match.displacement * match.displacement;
            weights += w;
        }
        out.estimate.noise = std::max(fit_.deviation, 0.0);
        out.estimate.rms = std::sqrt(squares / std::max(weights, 1e-300));
        out.mean = normal_.mean;
        out.correlation = fit_.correlation;
        out.pieces = fit_.pieces;
        out.points = contour_.size();
        out.fitting = double(fitting) / double(contour_.size());
    }

private:
    void match(const scene::CameraModel& camera, std::size_t stride) {
        matches_ = match_outlines(camera, solid_, contour_, search_, stride);
        if (matches_.size() < 20)
            throw InputError(
                {silhouette_.name, "the outline of " + solid_.name + " lies nowhere near that of the silhouette",
                    "the pose is too far off, or the frame shows something else",
                    "look at the overlay; give a better pose by points"});
        deviation_ = spread_of(matches_);
    }
    // Coarse step, of points that are taken to have one correlation.
    void step(const scene::CameraModel& camera, const PoseVector& to_start) {
        normal_ = equations(camera, contour_, matches_, deviation_, false);
        const double variance = deviation_ * deviation_ * coarse_correlation;
        const cv::Matx<double, 6, 1> step = inverse((1 / variance) * normal_.information + prior_) *
                                            ((1 / variance) * normal_.gradient + PoseVector((prior_ * to_start).val));
        pose_ = changed(pose_, PoseVector(step.val));
    }
    PoseMatrix covariance() const {
        PoseMatrix out = fit_.covariance;
        if (start_.covariance) {
            const cv::Matx<double, 6, 12> by_lens = inverse(normal_.information) * normal_.across;
            out += by_lens * cv::Matx<double, 12, 12>(start_.covariance->values.data()) * by_lens.t();
        }
        return out;
    }

    const CameraRecord& start_;
    const SeenSolid& solid_;
    const Silhouette& silhouette_;
    const ContourPoseOptions& options_;
    std::vector<ContourPoint> contour_;
    PoseMatrix prior_;
    scene::CameraPose pose_;
    double search_, deviation_; // [pixels]
    std::vector<Match> matches_;
    Normal normal_;
    OutlineFit fit_;
};

} // namespace

namespace {

void check_fit(ContourPose& found, const SeenSolid& solid, const Silhouette& silhouette) {
    const auto percentage_text =
        "only " + format_number(std::round(100 * found.fitting)) + " % of the silhouette's outline ";
    if (found.fitting < 0.2)
        throw InputError({silhouette.name, percentage_text + "meets that of " + solid.name,
            "the pose is too far off, or the frame shows something else",
            "look at the overlay; give a better pose by points"});
    if (found.fitting < 0.6)
        found.estimate.warnings.push_back(
            percentage_text + "is that of " + solid.name + ": the rest may have moved, or is hidden");
}

} // namespace

ContourPose refine_on_contour(const CameraRecord& given, const SeenSolid& solid, const Silhouette& silhouette,
    const ContourPoseOptions& options) {
    const auto start = for_pictures(given, silhouette.mask.width, silhouette.mask.height, silhouette.name);
    if (!start.pose) (void)start.model(); // throws where it has none
    ContourRefinement refinement(start, solid, silhouette, options);
    ContourPose out;
    out.overlap_before = refinement.overlap_now();
    refinement.run();
    refinement.tell(out);
    out.overlap_after = refinement.overlap_now();
    check_fit(out, solid, silhouette);
    return out;
}

} // namespace treacle::video
