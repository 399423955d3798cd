#pragma once
#include "mpi/comm.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace treacle::io {

// Precision of real-valued data in a frame's file. Integers keep their type.
enum class Precision { float32, float64 };

// [n * components], of one of these types on all ranks.
using FieldValues = std::variant<std::span<const double>, std::span<const std::int64_t>, std::span<const std::int32_t>,
    std::span<const std::uint8_t>>;

// One quantity of this rank's particles, [n][components], components of a particle side by side.
struct FrameField {
    std::string name; // "velocity"; no slash
    std::string unit; // "m/s"; "1" without dimension
    int components = 1;
    FieldValues values;
};

// This rank's particles; may be none. The fields are the same, in the same order, on every rank.
struct ParticleBlock {
    std::span<const double> positions; // [n][3], m
    std::vector<FrameField> fields;
};

// Entry of the index NAME.hdf.series.
struct SeriesEntry {
    std::string file; // name within the folder
    double time = 0;  // s
};

// Writes the frames of one set of particles ("liquid", "solid") into one folder: NAME_000042.hdf, one file a
// frame in the VTKHDF 1.0 layout (UnstructuredGrid of vertex cells, one partition per rank that has
// particles), and the index NAME.hdf.series that ParaView opens as one animation. Each dataset has the
// attribute "unit"; the group has "time" [s] and "step". Every file appears as a whole or not at all.
class FrameWriter {
public:
    // Collective; makes the folder when it is missing. Throws SimulationError.
    FrameWriter(const Comm& comm, const std::filesystem::path& folder, const std::string& name,
        Precision precision = Precision::float32);
    ~FrameWriter();
    FrameWriter(FrameWriter&&) noexcept;

    // Collective: goes on with the index of an earlier run. Frames up to the time [s] are kept, later ones
    // are dropped together with their files.
    void resume(double time);
    // Collective. Returns the path of the frame; a frame of the same step is replaced. Throws SimulationError
    // on every rank when it cannot be written; the earlier frames and the index then stand.
    std::filesystem::path write(std::int64_t step, double time, const ParticleBlock& block);

private:
    struct State;
    std::unique_ptr<State> state_;
};

// A field as read. Integers of any width come as int64.
struct FrameColumn {
    std::string name;
    std::string unit;
    int components = 1;
    std::variant<std::vector<double>, std::vector<std::int64_t>> values; // [n][components]
};

// Particles of one frame: all, or this rank's part.
struct Frame {
    std::int64_t step = 0;                    // of the simulation
    double time = 0;                          // s
    Precision precision = Precision::float32; // of the positions in the file
    std::int64_t total = 0;                   // particles in the file
    std::vector<double> positions;            // [n][3], m
    std::vector<FrameColumn> fields;          // all but the positions

    std::int64_t size() const { return static_cast<std::int64_t>(positions.size() / 3); } // particles here
    // Null when there is no such field.
    const FrameColumn* find(const std::string& name) const;
};

// The whole frame, on this rank alone. Throws InputError when it is no frame or damaged.
Frame read_frame(const std::filesystem::path& path);
// Collective: this rank's share, an equal part of the rows in their order. Throws the same on every rank.
Frame read_frame(const Comm& comm, const std::filesystem::path& path);

// The index of a set of frames, in order of time. Throws InputError when it cannot be read.
std::vector<SeriesEntry> read_series(const std::filesystem::path& path);
// Names of the sets in a folder, sorted: "liquid" for liquid.hdf.series.
std::vector<std::string> series_names(const std::filesystem::path& folder);

} // namespace treacle::io
