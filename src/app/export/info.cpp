#include "app/export/info.hpp"

#include "app/export/info_run.hpp"
#include "app/input/table_text.hpp"
#include "app/render/frame_field.hpp"
#include "base/text/log.hpp"
#include "base/text/text.hpp"
#include "identify/experiment/piv_files.hpp"
#include "io/checkpoint/checkpoint.hpp"
#include "io/frame.hpp"

#include <limits>

namespace treacle::app {

namespace {

// Smallest and largest value over all ranks, as text.
std::string range_text(const Comm& comm, const std::vector<double>& values, std::size_t first, std::size_t stride) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (auto i = first; i < values.size(); i += stride) {
        low = std::min(low, values[i]);
        high = std::max(high, values[i]);
    }
    low = comm.min(low);
    high = comm.max(high);
    if (low > high) return "none";
    return low == high ? short_number(low) : short_number(low) + " to " + short_number(high);
}

void show_frame(const Comm& comm, const std::filesystem::path& path, Log& log) {
    const auto frame = io::read_frame(comm, path);
    log.line("frame of particles: " + path.string());
    log.line(label("step") + std::to_string(frame.step));
    log.line(label("time") + short_number(frame.time) + " s");
    log.line(label("particles") + std::to_string(frame.total));
    log.line(label("precision") + (frame.precision == io::Precision::float64 ? "64 bits" : "32 bits"));
    for (std::size_t k = 0; k < 3; ++k) {
        log.line(label(std::string(1, "xyz"[k]) + " [m]") + range_text(comm, frame.positions, k, 3));
    }
    for (const auto& column : frame.fields) {
        log.line(label(with_unit_of(column.name, column)) +
                 range_text(comm, scalar_field(frame, column.name).values, 0, 1) +
                 (column.components > 1 ? "  (length of " + std::to_string(column.components) + " components)" : ""));
    }
}

std::string text_of(const io::AttributeValue& value) {
    if (const auto* number = std::get_if<double>(&value)) return format_number(*number);
    if (const auto* number = std::get_if<std::int64_t>(&value)) return std::to_string(*number);
    return std::get<std::string>(value);
}

void show_checkpoint(const Comm& comm, const std::filesystem::path& path, Log& log) {
    const io::CheckpointReader reader(comm, path);
    log.line("checkpoint: " + path.string());
    log.line(label("written by") + std::to_string(reader.writer_ranks()) + " ranks");
    for (const auto& name : reader.attribute_names()) log.line(label(name) + text_of(reader.attribute(name)));
    for (const auto& name : reader.distributed_names()) {
        log.line(label(name) + std::to_string(reader.total_rows(name)) + " rows");
    }
    const auto broken = io::validate_checkpoint(comm, path);
    log.line(label("checksums") + (broken.empty() ? "right" : broken));
}

void show_series(const std::filesystem::path& path, Log& log) {
    const auto entries = io::read_series(path);
    log.line("series of " + std::to_string(entries.size()) + " frames: " + path.string());
    for (const auto& entry : entries) log.line("  " + entry.file + "  " + format_number(entry.time) + " s");
}

bool may_be_piv(const std::string& extension) {
    return extension == ".txt" || extension == ".vec" || extension == ".mat" || extension == ".csv";
}

void show_piv(const std::filesystem::path& path, Log& log) {
    const auto fields = identify::read_piv(path);
    const auto& first = fields.front();
    const auto unit = [](const std::string& text) { return text.empty() ? std::string("not stated") : text; };
    std::size_t valid = 0;
    for (const auto& field : fields) valid += field.count_valid();
    log.line("velocity field of a sheet, as " + first.format + " writes it: " + path.string());
    log.line(label("frames") + std::to_string(fields.size()));
    log.line(label("vectors a frame") + std::to_string(first.x.size()));
    log.line(label("valid in all frames") + std::to_string(valid));
    log.line(label("unit of places") + unit(first.length_unit));
    log.line(label("unit of velocities") + unit(first.velocity_unit));
}

} // namespace

ExitCode show_info(const Comm& comm, const std::filesystem::path& path) {
    Log log(comm.is_root() ? LogOutput::enabled : LogOutput::disabled);
    std::string kind;
    comm.guard_root([&] {
        if (!std::filesystem::exists(path)) {
            throw InputError({path.string(), "there is no such file or folder", "", ""});
        }
        kind = std::filesystem::is_directory(path) ? "folder" : path.extension().string();
    });
    kind = comm.broadcast(kind);
    if (kind == "folder") {
        show_run(comm, path, log);
    } else if (kind == ".hdf") {
        show_frame(comm, path, log);
    } else if (kind == ".h5") {
        show_checkpoint(comm, path, log);
    } else if (kind == ".series") {
        comm.guard([&] { show_series(path, log); });
    } else if (may_be_piv(kind)) {
        comm.guard([&] { show_piv(path, log); });
    } else {
        throw InputError({path.string(), "is nothing that treacle writes",
            "frames end in .hdf, their index in .hdf.series, checkpoints in .h5; a run has a folder; of others PIV's "
            ".txt, .vec, .mat and .csv are known",
            kind == ".yaml" ? "look at a scene with treacle check" : ""});
    }
    return ExitCode::ok;
}

} // namespace treacle::app
