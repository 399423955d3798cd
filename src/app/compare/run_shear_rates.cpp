#include "app/compare/run_shear_rates.hpp"

#include "app/setup/geometry.hpp"
#include "identify/compare/velocity_sampler.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {
double shear_rate(const std::array<Vec3, 3>& gradient) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) sum += 0.5 * std::pow(gradient[i][j] + gradient[j][i], 2); // 2 D_ij D_ij
    }
    return std::sqrt(sum);
}

// Viscosity of a liquid at a shear rate [Pa s].
double viscosity_at(
    const Input& input, const std::vector<flow::ViscosityModel>& curves, std::size_t liquid, double rate) {
    return curves.empty() ? input.scene.liquids[liquid].viscosity : curves[liquid](rate);
}

void add_frame(const Input& input, const std::vector<flow::ViscosityModel>& curves, const io::Frame& frame,
    identify::ShearRates& out) {
    constexpr std::int64_t sampled = 2000;
    const auto* velocity = frame.find("velocity");
    if (!velocity || frame.size() == 0) return;
    const auto* liquid = frame.find("liquid");
    const identify::VelocitySampler sampler(frame.positions, std::get<std::vector<double>>(velocity->values),
        particle_spacing(input), input.scene.domain.dimensions);
    const auto stride = std::max<std::int64_t>(1, frame.size() / sampled);
    for (std::int64_t i = 0; i < frame.size(); i += stride) {
        const double* x = &frame.positions[3 * std::size_t(i)];
        const auto local = sampler.at({x[0], x[1], x[2]});
        if (!local) continue;
        const double rate = shear_rate(local->gradient);
        const auto which =
            liquid ? std::size_t(std::get<std::vector<std::int64_t>>(liquid->values)[std::size_t(i)]) : 0;
        out.add(rate, viscosity_at(input, curves, std::min(which, input.scene.liquids.size() - 1), rate) * rate * rate);
    }
}
} // namespace

RunShearRates run_shear_rates(const Comm& comm, const RunView& run) {
    constexpr std::size_t size = identify::ShearRates::bins + 1; // numbers of a frame: its place, its weights
    std::vector<double> mine;
    comm.guard([&] {
        const auto curves = viscosity_models(run.input);
        for (std::size_t k = 1 + std::size_t(comm.rank()); k < run.frames.size(); k += std::size_t(comm.size())) {
            identify::ShearRates frame;
            add_frame(run.input, curves, io::read_frame(run.frame(k)), frame);
            mine.push_back(double(k));
            mine.insert(mine.end(), frame.weights().begin(), frame.weights().end());
        }
    });
    const auto all = comm.all_gather(std::span<const double>(mine));
    RunShearRates out;
    for (std::size_t first = 0; first < all.size(); first += size) {
        std::array<double, identify::ShearRates::bins> weights;
        std::copy_n(all.begin() + std::ptrdiff_t(first + 1), weights.size(), weights.begin());
        out.all.add(weights);
        identify::ShearRates frame;
        frame.add(weights);
        if (!frame.empty())
            out.frames.push_back(identify::frame_shear_rates(run.frames[std::size_t(all[first])].time, frame));
    }
    std::ranges::sort(out.frames, {}, &identify::FrameShearRates::time);
    return out;
}

} // namespace treacle::app
