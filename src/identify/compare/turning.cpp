#include "identify/compare/turning.hpp"

#include "base/median.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

namespace {
// Columns of a row's liquid: how many, and their sum.
struct Row {
    int width = 0;
    double sum = 0;
};

std::vector<Row> rows_of(const video::Mask& mask) {
    std::vector<Row> out(static_cast<std::size_t>(mask.height));
    for (int r = 0; r < mask.height; ++r) {
        for (int c = 0; c < mask.width; ++c) {
            if (!mask.liquid(c, r)) continue;
            ++out[std::size_t(r)].width;
            out[std::size_t(r)].sum += c;
        }
    }
    return out;
}

double mean_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double one : values) sum += one;
    return values.empty() ? 0 : sum / double(values.size());
}

double deviation_of(const std::vector<double>& values) {
    const double mean = mean_of(values);
    double square = 0;
    for (const double one : values) square += (one - mean) * (one - mean);
    return values.size() < 2 ? 0 : std::sqrt(square / double(values.size() - 1));
}
} // namespace

double thread_column(const video::Mask& mask) {
    constexpr double wide = 1.7, low = 0.1, high = 0.35; // thread's widths of a heap; fractions of the height of fall
    const auto rows = rows_of(mask);
    const auto has = [](const Row& row) { return row.width > 0; };
    const auto top = std::ranges::find_if(rows, has) - rows.begin();
    const auto bottom =
        std::ptrdiff_t(rows.size()) - (std::ranges::find_if(rows.rbegin(), rows.rend(), has) - rows.rbegin());
    if (top >= bottom) return std::nan("");
    std::vector<int> widths;
    for (auto r = top; r < top + std::max<std::ptrdiff_t>(1, (bottom - top) / 5); ++r)
        widths.push_back(rows[std::size_t(r)].width);
    const double thread = upper_median(widths);
    auto heap = top;
    while (heap < bottom && rows[std::size_t(heap)].width <= wide * thread) ++heap;
    const double fall = double(heap - top);
    double sum = 0, count = 0;
    for (auto r = std::ptrdiff_t(double(heap) - high * fall);
         r <= std::ptrdiff_t(double(heap) - low * fall) && r < bottom; ++r) {
        sum += rows[std::size_t(r)].sum;
        count += rows[std::size_t(r)].width;
    }
    return count > 0 ? sum / count : std::nan("");
}

Turning turning_of(const std::vector<double>& times, const std::vector<double>& positions) {
    constexpr double noise = 0.3; // of the amplitude
    std::vector<double> known;
    for (const double one : positions) {
        if (std::isfinite(one)) known.push_back(one);
    }
    const double middle = mean_of(known), amplitude = std::sqrt(2.0) * deviation_of(known);
    Turning out;
    int side = 0;
    double last_time = 0, last_way = 0, crossed = 0;
    for (std::size_t k = 0; k < times.size() && amplitude > 0; ++k) {
        if (!std::isfinite(positions[k])) continue;
        const double way = positions[k] - middle;
        if (k > 0 && way * last_way < 0) crossed = last_time + (times[k] - last_time) * last_way / (last_way - way);
        if (std::abs(way) > noise * amplitude) {
            const int now = way > 0 ? 1 : -1;
            if (side != 0 && now != side) out.passages.push_back(crossed);
            side = now;
        }
        last_time = times[k];
        if (way != 0) last_way = way;
    }
    std::vector<double> turns;
    for (std::size_t i = 2; i < out.passages.size(); ++i) turns.push_back(out.passages[i] - out.passages[i - 2]);
    if (turns.size() >= 2) out.scatter = deviation_of(turns) / mean_of(turns);
    return out;
}

TurningRate rate_between(const Turning& turning, double begin, double end) {
    const auto& passages = turning.passages;
    if (passages.size() < 2) return {};
    const double from = std::max(begin, passages.front()), to = std::min(end, passages.back());
    if (to - from < 0.5 * (end - begin)) return {};
    const auto half_turns = [&](double time) {
        const auto after = std::clamp<std::ptrdiff_t>(
            std::ranges::upper_bound(passages, time) - passages.begin(), 1, std::ptrdiff_t(passages.size()) - 1);
        const auto i = std::size_t(after);
        return double(i) - (passages[i] - time) / (passages[i] - passages[i - 1]);
    };
    const double turns = 0.5 * (half_turns(to) - half_turns(from));
    return {turns / (to - from), turns};
}

} // namespace treacle::identify
