#include "io/export.hpp"
#include "io/frame.hpp"
#include "sample.hpp"

#include <filesystem>

// Writes the frames and exports that open_frames.py opens: many, few and no particles, with a rank without.
int main(int argc, char** argv) {
    treacle::MpiRuntime mpi(argc, argv);
    using namespace treacle::io;
    const auto comm = treacle::Comm::world();
    const std::filesystem::path folder = argv[1];
    comm.guard_root([&] { std::filesystem::remove_all(folder); });

    FrameWriter liquid(comm, folder, "liquid");
    FrameWriter solid(comm, folder, "solid", Precision::float64);
    const int counts[] = {70, 9, 0, 100};
    for (int f = 0; f < 4; ++f) {
        const auto part = part_without(comm, counts[f], f % comm.size());
        const Sample sample(part.first, part.count);
        liquid.write(10 * f, 0.125 * f, sample.block());
        solid.write(10 * f, 0.125 * f, sample.block());
    }
    comm.guard_root([&] {
        for (const std::string name : {"liquid_000000", "liquid_000020", "solid_000030"})
            for (const auto format : {ExportFormat::ply, ExportFormat::vtp, ExportFormat::csv})
                export_particles(
                    folder / (name + "." + format_name(format)), read_frame(folder / (name + ".hdf")), format);
    });
}
