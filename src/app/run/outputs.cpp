#include "app/run/outputs.hpp"

#include "app/input/host_rows.hpp"
#include "app/run/measure.hpp"
#include "app/setup/bodies.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {
std::vector<std::string> step_columns(const Input& input, const Simulation& simulation) {
    const std::string mass = input.scene.domain.dimensions == 3 ? "kg" : "kg/m";
    const std::string energy = input.scene.domain.dimensions == 3 ? "J" : "J/m";
    std::vector<std::string> columns{"step", "time [s]", "dt [s]"};
    for (auto& name : simulation.columns()) columns.push_back(std::move(name));
    columns.insert(columns.end(), {"particles", "flowed in", "flowed out", "mass [" + mass + "]"});
    for (const char* axis : {"x", "y", "z"}) columns.push_back(std::string("momentum ") + axis + " [" + mass + " m/s]");
    for (const char* axis : {"x", "y", "z"}) {
        columns.push_back(std::string("angular momentum ") + axis + " [" + mass + " m2/s]");
    }
    for (const auto* name : {"kinetic energy", "potential energy"})
        columns.push_back(std::string(name) + " [" + energy + "]");
    columns.insert(columns.end(), {"max speed [m/s]", "lost by leak", "lost as non-finite", "lost through open sides"});
    for (const auto& phase : simulation.phases()) columns.push_back(phase + " [s]");
    return columns;
}

std::vector<std::string> measurement_columns(const Input& input) {
    std::vector<std::string> columns{"step", "time [s]"};
    for (const auto& one : input.scene.measurements) columns.push_back(measurement_column(one, input.scene.domain));
    return columns;
}

std::vector<std::string> body_columns(const Input& input, const Simulation& simulation) {
    const std::string force = input.scene.domain.dimensions == 3 ? "N" : "N/m";
    const std::string torque = input.scene.domain.dimensions == 3 ? "N m" : "N";
    std::vector<std::string> columns{"step", "time [s]"};
    const auto append = [&](const std::string& what, const std::string& unit) {
        for (const char* axis : {"x", "y", "z"}) columns.push_back(what + " " + axis + " [" + unit + "]");
    };
    for (const char* cause : {" pressure", " viscous"}) {
        for (const auto& name : simulation.load_names()) {
            append(name + cause + " force", force);
            append(name + cause + " torque", torque);
        }
    }
    for (const auto& body : input.scene.bodies) {
        if (!moves(body)) continue;
        append(body.name + " position", "m");
        append(body.name + " rotation", "rad");
        append(body.name + " velocity", "m/s");
        append(body.name + " angular velocity", "rad/s");
    }
    if (!any_dynamic(input)) return columns;
    for (const char* cause : {" contact", " joint"}) {
        for (const auto& body : input.scene.bodies) {
            append(body.name + cause + " force", force);
            append(body.name + cause + " torque", torque);
        }
    }
    return columns;
}

const std::vector<std::string> lost_columns{"step", "time [s]", "id", "cause", "x [m]", "y [m]", "z [m]",
    "velocity x [m/s]", "velocity y [m/s]", "velocity z [m/s]"};

// When a value is due after one at `time` [s].
double next_time(double interval, double time) {
    return interval > 0 ? interval * (std::floor(time / interval + 1e-9) + 1) : 0;
}

struct HostField {
    const Field* field;
    std::variant<std::vector<double>, std::vector<std::int64_t>> rows;
};

// Frame fields refer to the rows, which must outlive them.
std::vector<HostField> collect_fields(const ParticleStore& store, const std::vector<std::string>& names) {
    std::vector<HostField> out;
    for (const auto& field : store.fields()) {
        if (!field.output || std::find(names.begin(), names.end(), field.name) == names.end()) continue;
        std::visit([&](const auto& view) { out.push_back({&field, host_rows(view, store.owned())}); }, field.array);
    }
    return out;
}

io::ParticleBlock make_block(const std::vector<double>& positions, const std::vector<HostField>& fields) {
    io::ParticleBlock block{positions, {}};
    for (const auto& one : fields) {
        const std::string unit = one.field->unit.empty() ? "1" : one.field->unit;
        std::visit(
            [&](const auto& rows) {
                block.fields.push_back({one.field->name, unit, components(*one.field), std::span(rows)});
            },
            one.rows);
    }
    return block;
}

io::Precision precision_of(const Input& input) {
    return input.scene.output.double_precision ? io::Precision::float64 : io::Precision::float32;
}
} // namespace

Outputs::Outputs(
    const io::RunFolder& folder, const Input& input, Simulation& simulation, const Progress& progress, Opening opening)
    : comm_(simulation.comm()), folder_(folder), input_(input), simulation_(simulation),
      frames_(comm_, folder.frames(), input.scene.output.name, precision_of(input)),
      solid_frames_(comm_, folder.frames(), "solid", precision_of(input)),
      next_measurement_(input.scene.measurements.size(), 0.0), last_measurement_(input.scene.measurements.size(), 0.0),
      phases_(simulation.phases()), phase_seconds_(phases_.size(), 0.0) {
    const bool fresh = opening == Opening::fresh;
    if (!fresh) {
        frames_.resume(progress.time);
        if (any_moves(input)) solid_frames_.resume(progress.time);
    }
    comm_.guard_root([&] {
        const auto open = [&](const std::filesystem::path& path, std::vector<std::string> columns) {
            return fresh ? CsvTable::create(path, std::move(columns))
                         : CsvTable::resume(path, std::move(columns), progress.step);
        };
        steps_ = open(folder.steps(), step_columns(input, simulation));
        bodies_ = open(folder.bodies(), body_columns(input, simulation));
        if (!input.scene.measurements.empty()) measurements_ = open(folder.measurements(), measurement_columns(input));
        if (std::filesystem::exists(folder.lost_particles())) lost_ = open(folder.lost_particles(), lost_columns);
    });
    if (!fresh) resume_measurements(progress.time);
}

// Goes on with the values of the last row and the times at which new ones are due. Without a row all are due.
void Outputs::resume_measurements(double time) {
    std::vector<double> last;
    if (measurements_) last = measurements_->last_row();
    last = comm_.all_gather(std::span<const double>(last)); // rank 0 alone has a table
    const auto& measurements = input_.scene.measurements;
    if (last.size() != measurements.size() + 2) return;
    std::copy(last.begin() + 2, last.end(), last_measurement_.begin());
    for (std::size_t k = 0; k < measurements.size(); ++k)
        next_measurement_[k] = next_time(measurements[k].interval, time);
}

void Outputs::write_frame(const Progress& progress) {
    const auto& store = simulation_.liquid();
    auto names = input_.scene.output.fields;
    names.push_back("id");
    if (input_.scene.liquids.size() > 1) names.push_back("liquid"); // pictures and ParaView distinguish them by it
    const auto positions = host_rows(store.position(), store.owned());
    const auto fields = collect_fields(store, names);
    frames_.write(progress.step, progress.time, make_block(positions, fields));
}

void Outputs::write_solids(const Progress& progress) {
    if (progress.step > 0 && !any_moves(input_)) return;
    if (!simulation_.solid() && input_.scene.bodies.empty()) return; // nothing to show
    const auto& store = simulation_.solid_points();
    const auto positions = host_rows(store.position(), store.owned());
    const auto fields = collect_fields(store, {"id", "body"});
    solid_frames_.write(progress.step, progress.time, make_block(positions, fields));
}

void Outputs::write_step(const Progress& progress, const StepDiagnostics& report, const LiquidTotals& totals) {
    if (!steps_) return;
    std::vector<double> row{double(progress.step), progress.time, report.dt};
    row.insert(row.end(), report.values.begin(), report.values.end());
    row.insert(
        row.end(), {double(totals.particles), double(simulation_.emitted()), double(progress.lost[0]), totals.mass});
    row.insert(row.end(), totals.momentum.begin(), totals.momentum.end());
    row.insert(row.end(), totals.angular_momentum.begin(), totals.angular_momentum.end());
    row.insert(row.end(), {totals.kinetic_energy, totals.potential_energy, totals.max_speed});
    for (std::size_t k = 1; k < progress.lost.size(); ++k) row.push_back(double(progress.lost[k]));
    for (std::size_t k = 0; k < phases_.size(); ++k) {
        const double seconds = simulation_.timers().seconds(phases_[k]);
        row.push_back(seconds - phase_seconds_[k]);
        phase_seconds_[k] = seconds;
    }
    steps_->append(row);
}

void Outputs::write_measurements(const Progress& progress) {
    const auto& measurements = input_.scene.measurements;
    bool due = false;
    for (std::size_t k = 0; k < measurements.size(); ++k) {
        if (progress.time < next_measurement_[k] - 1e-12) continue;
        last_measurement_[k] = measure(measurements[k], input_.scene, simulation_);
        next_measurement_[k] = next_time(measurements[k].interval, progress.time);
        due = true;
    }
    if (!due || !measurements_) return;
    std::vector<double> row{double(progress.step), progress.time};
    row.insert(row.end(), last_measurement_.begin(), last_measurement_.end());
    measurements_->append(row);
}

void Outputs::write_bodies(const Progress& progress, const StepDiagnostics& report) {
    if (!bodies_) return;
    const auto& bodies = simulation_.bodies();
    std::vector<double> row{double(progress.step), progress.time};
    row.insert(row.end(), report.loads.begin(), report.loads.end());
    row.insert(row.end(), report.viscous_loads.begin(), report.viscous_loads.end());
    const std::size_t count = input_.scene.bodies.size(); // the method may have bodies of its own behind them
    for (std::size_t b = 0; b < count && b < bodies.size(); ++b) {
        if (!bodies.moves(b)) continue;
        for (const auto& values : {bodies.pose(b).centre, rigid::rotation_vector(bodies.pose(b).turn),
                 bodies.end_velocity(b), bodies.end_spin(b)}) {
            row.insert(row.end(), values.begin(), values.end());
        }
    }
    if (bodies.any_dynamic()) {
        for (const auto& loads : {bodies.contact_loads(), bodies.joint_loads()}) {
            row.insert(row.end(), loads.begin(), loads.begin() + static_cast<std::ptrdiff_t>(6 * count));
        }
    }
    bodies_->append(row);
}

void Outputs::write_lost(const Progress& progress, const StepDiagnostics& report) {
    std::vector<double> rows;
    for (const auto& particle : report.lost) {
        rows.insert(rows.end(),
            {double(progress.step), progress.time, double(particle.id), double(static_cast<int>(particle.cause))});
        rows.insert(rows.end(), particle.position, particle.position + 3);
        rows.insert(rows.end(), particle.velocity, particle.velocity + 3);
    }
    const auto gathered = comm_.all_gather(std::span<const double>(rows));
    comm_.guard_root([&] {
        if (!lost_) lost_ = CsvTable::create(folder_.lost_particles(), lost_columns);
        const std::size_t width = lost_columns.size();
        for (std::size_t k = 0; k < gathered.size(); k += width) lost_->append(std::span(gathered).subspan(k, width));
        lost_->flush();
    });
}

void Outputs::flush() {
    comm_.guard_root([&] {
        for (auto* table : {&steps_, &measurements_, &bodies_, &lost_}) {
            if (*table) (*table)->flush();
        }
    });
}

void Outputs::sync() {
    comm_.guard_root([&] {
        for (auto* table : {&steps_, &measurements_, &bodies_, &lost_}) {
            if (*table) (*table)->sync();
        }
    });
}

} // namespace treacle::app
