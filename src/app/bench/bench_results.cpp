#include "app/bench/bench_results.hpp"

#include "app/input/table_text.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <functional>

namespace treacle::app {

Spread spread(std::vector<double> values) {
    if (values.empty()) return {};
    std::ranges::sort(values);
    const std::size_t n = values.size();
    return {(values[(n - 1) / 2] + values[n / 2]) / 2, values.front(), values.back()};
}

double least_bytes(const std::string& phase, const StepSample& s) {
    constexpr double number = 8, vector = 24, integer = 4;
    constexpr double state = 2 * vector + 2 * number + integer; // position, velocity, pressure, id, liquid
    const double lists = integer * (s.liquid_pairs + s.solid_pairs) + 2 * number * s.liquid;
    if (phase == "sort") return s.liquid * (2 * state + vector + 3 * integer);
    if (phase == "neighbours") return s.liquid * vector + lists;
    if (phase == "density") return lists + s.liquid * (vector + 2 * number);
    if (phase == "forces") return lists + s.liquid * (3 * vector + number);
    if (phase == "predict") return lists + s.liquid * (2 * vector + 5 * number + integer);
    if (phase == "assemble") {
        return integer * s.liquid_pairs + s.liquid * (vector + 4 * number + integer) + (number + integer) * s.entries +
               s.rows * (2 * number + integer);
    }
    if (phase == "pressure force") return lists + s.liquid * (3 * vector + 2 * number);
    if (phase == "move") return s.liquid * 3 * vector;
    return 0;
}

double product_bytes(const StepSample& s) { return 12 * s.entries + (4 + 8 + 8) * s.rows; }

std::string one_line(const io::Value& value) {
    std::string out;
    const auto text = value.json();
    for (std::size_t k = 0; k < text.size(); ++k) {
        if (text[k] != '\n') {
            out += text[k];
            continue;
        }
        while (k + 1 < text.size() && text[k + 1] == ' ') ++k; // the indent; line ends in words are escaped
    }
    return out;
}

namespace {
using Measure = std::function<double(const StepSample&)>;

// Evaluation of the steps into the numbers of the table and the file.
class Evaluation {
public:
    explicit Evaluation(const BenchResults& figures) : at_(figures) {}

    Spread over_steps(const Measure& measure) const {
        std::vector<double> values;
        for (const auto& step : at_.steps) values.push_back(measure(step));
        return spread(std::move(values));
    }
    double phase(const StepSample& step, const std::string& name) const {
        const auto found = std::ranges::find(at_.phases, name);
        return found == at_.phases.end() ? 0.0 : step.phases[static_cast<std::size_t>(found - at_.phases.begin())];
    }
    double outside(const StepSample& step) const { return step.step - phase(step, "solve"); }
    // Seconds in all phases together; what a step takes beyond is spent between them.
    double between(const StepSample& step) const {
        double sum = 0;
        for (const double seconds : step.phases) sum += seconds;
        return std::max(0.0, step.step - sum);
    }
    static double floor(const StepSample& step, const std::string& name) {
        return least_bytes(name, step) / product_bytes(step);
    }
    double outside_floor(const StepSample& step) const {
        double sum = 0;
        for (const auto& name : at_.phases) sum += floor(step, name);
        return sum;
    }
    // Lines of the table: a name, and the seconds behind it.
    std::vector<std::pair<std::string, Measure>> lines() const {
        std::vector<std::pair<std::string, Measure>> out;
        for (const auto& name : at_.phases) {
            out.emplace_back(name, [this, name](const StepSample& s) { return phase(s, name); });
        }
        out.emplace_back("between phases", [this](const StepSample& s) { return between(s); });
        out.emplace_back("step", [](const StepSample& s) { return s.step; });
        out.emplace_back("outside the solve", [this](const StepSample& s) { return outside(s); });
        return out;
    }
    Spread lowest_floor(const std::string& name) const {
        return over_steps([&](const StepSample& s) {
            if (name == "outside the solve") return outside_floor(s);
            return floor(s, name);
        });
    }
    double per_particle(double bytes) const { return bytes / std::max(1.0, double(at_.liquid)); }

private:
    const BenchResults& at_;
};

Measure in_products(const Measure& seconds) {
    return [seconds](const StepSample& s) { return seconds(s) / s.product; };
}

double iteration_seconds(const Evaluation& at, const StepSample& s) {
    return (at.phase(s, "solve") - s.set_up) / std::max(1.0, double(s.iterations));
}

double product_bandwidth(const StepSample& s) { return product_bytes(s) / s.product; }

std::string line(const char* format, ...) {
    char text[512];
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return std::string(text) + "\n";
}

std::string heading(const BenchResults& f) {
    return line("bench %s: %s liquid and %s solid particles, %d rank%s x %d thread%s, %zu steps after %d",
               f.kind.c_str(), grouped(static_cast<std::uint64_t>(f.liquid)).c_str(),
               grouped(static_cast<std::uint64_t>(f.solid)).c_str(), f.ranks, f.ranks == 1 ? "" : "s", f.threads,
               f.threads == 1 ? "" : "s", f.steps.size(), f.disorder_steps) +
           line("%s, %d cores, %s; times of the slowest rank, median [min max] of the steps",
               f.machine.processor.c_str(), f.machine.cores, f.machine.back_end.c_str());
}

std::string timing_lines(const Evaluation& at) {
    std::string out = line("%-20s %9s  %-19s %8s  %-17s %9s", "", "ms", "", "WU", "", "least WU");
    for (const auto& [name, seconds] : at.lines()) {
        const auto t = at.over_steps(seconds), w = at.over_steps(in_products(seconds));
        const double floor = at.lowest_floor(name).median;
        out += line("%-20s %9.2f  [%8.2f %8.2f] %8.2f  [%7.2f %7.2f] %9s", name.c_str(), 1e3 * t.median, 1e3 * t.min,
            1e3 * t.max, w.median, w.min, w.max, floor > 0 ? short_number(floor).c_str() : "-");
    }
    return out;
}

std::string solver_lines(const Evaluation& at) {
    const auto product = at.over_steps([](const StepSample& s) { return s.product; });
    const auto bandwidth = at.over_steps(product_bandwidth);
    const auto one = at.over_steps([](const StepSample& s) { return s.triad.one; });
    const auto all = at.over_steps([](const StepSample& s) { return s.triad.all; });
    const auto iterations = at.over_steps([](const StepSample& s) { return double(s.iterations); });
    const auto set_up = at.over_steps(in_products([](const StepSample& s) { return s.set_up; }));
    const auto each = at.over_steps(in_products([&](const StepSample& s) { return iteration_seconds(at, s); }));
    const auto rows = at.over_steps([](const StepSample& s) { return s.rows; });
    const auto entries = at.over_steps([](const StepSample& s) { return s.entries / std::max(1.0, s.rows); });
    return line("WU: one product with the pressure matrix  %.3f ms [%.3f %.3f]; %.0f rows of %.1f entries",
               1e3 * product.median, 1e3 * product.min, 1e3 * product.max, rows.median, entries.median) +
           line("bandwidth  product %.2f GB/s; triad %.2f GB/s by one rank, %.2f [%.2f %.2f] by all",
               1e-9 * bandwidth.median, 1e-9 * one.median, 1e-9 * all.median, 1e-9 * all.min, 1e-9 * all.max) +
           line("solve      %.0f iterations [%.0f %.0f] of %.2f WU, set-up of the preconditioner %.2f WU",
               iterations.median, iterations.min, iterations.max, each.median, set_up.median);
}

std::string memory_lines(const BenchResults& f, const Evaluation& at) {
    const auto imbalance = at.over_steps([](const StepSample& s) { return s.imbalance; });
    return line("memory     peak %.0f bytes per liquid particle; own arrays %.0f; %s in all",
               at.per_particle(f.peak_bytes), at.per_particle(f.counted_bytes),
               format_bytes(static_cast<std::uint64_t>(std::max(0.0, f.peak_bytes))).c_str()) +
           line("imbalance  %.3f most over mean liquid particles of a rank", imbalance.median);
}

io::Value to_value(const Spread& s) {
    return io::Value::object({{"median", s.median}, {"min", s.min}, {"max", s.max}});
}
} // namespace

std::string bench_table(const BenchResults& figures) {
    const Evaluation at(figures);
    return heading(figures) + timing_lines(at) + solver_lines(at) + memory_lines(figures, at);
}

io::Value bench_values(const BenchResults& f) {
    const Evaluation at(f);
    auto out = io::Value::object(
        {{"bench", f.kind}, {"ranks", f.ranks}, {"threads per rank", f.threads}, {"processor", f.machine.processor},
            {"cores", f.machine.cores}, {"back end", f.machine.back_end}, {"liquid particles", f.liquid},
            {"solid particles", f.solid}, {"steps", static_cast<std::int64_t>(f.steps.size())}});
    io::Value seconds = io::Value::object({}), products = seconds, least = seconds;
    for (const auto& [name, measure] : at.lines()) {
        seconds.set(name, to_value(at.over_steps(measure)));
        products.set(name, to_value(at.over_steps(in_products(measure))));
        const double floor = at.lowest_floor(name).median;
        if (floor > 0) least.set(name, floor);
    }
    out.set("seconds", seconds).set("WU", products).set("least WU by bytes", least);
    const auto add = [&](const char* name, const Measure& measure) { out.set(name, to_value(at.over_steps(measure))); };
    add("one WU [s]", [](const StepSample& s) { return s.product; });
    add("rows", [](const StepSample& s) { return s.rows; });
    add("entries", [](const StepSample& s) { return s.entries; });
    add("bandwidth of a product [B/s]", product_bandwidth);
    add("triad of one rank [B/s]", [](const StepSample& s) { return s.triad.one; });
    add("triad of all ranks [B/s]", [](const StepSample& s) { return s.triad.all; });
    add("iterations", [](const StepSample& s) { return double(s.iterations); });
    add("products of the solve", [](const StepSample& s) { return s.products; });
    add("one iteration [s]", [&](const StepSample& s) { return iteration_seconds(at, s); });
    add("one iteration [WU]", in_products([&](const StepSample& s) { return iteration_seconds(at, s); }));
    add("set-up of the preconditioner [WU]", in_products([](const StepSample& s) { return s.set_up; }));
    add("imbalance", [](const StepSample& s) { return s.imbalance; });
    out.set("peak memory per particle [B]", at.per_particle(f.peak_bytes));
    out.set("own arrays per particle [B]", at.per_particle(f.counted_bytes));
    return out;
}

} // namespace treacle::app
