#pragma once
#include "app/input/folder_under_way.hpp"
#include "base/text/error.hpp"
#include "mpi/comm.hpp"
#include "video/clip/frame_source.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace treacle::app {

// Arguments of `treacle silhouettes`.
struct SilhouettesRequest {
    video::SourceRequest source;                      // the clip and its times
    std::filesystem::path out;                        // a folder
    std::filesystem::path settings;                   // YAML; see video::SilhouetteSettings
    std::vector<std::string> changes;                 // "key=value", over the file's
    ExistingFolder existing = ExistingFolder::refuse; // treatment of `out` when it holds something
    bool overlay = true;                              // overlay.mp4: the clip with the contours
};

// `treacle silhouettes`: mask_000000.png and on (0 background, 64 excluded, 255 liquid), silhouettes.csv, settings.yaml,
// overlay.mp4 and summary.json in `out`, all or nothing. Collective; rank 0 works. Throws InputError, SimulationError.
ExitCode make_silhouettes(const Comm& comm, const SilhouettesRequest& request);

// The manual of the settings' keys.
std::string silhouettes_manual();

} // namespace treacle::app
