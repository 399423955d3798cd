#pragma once
#include "app/render/picture.hpp"
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace treacle::app {

// Use of the pictures of `treacle render`.
enum class Movie { write, leave_out };
// Representation of the liquid.
enum class Style {
    spheres, // every particle a ball
    surface, // the surface mesh of each liquid
};

// Arguments of `treacle render`.
struct RenderRequest {
    std::filesystem::path folder;                     // of a run
    std::string field = "speed";                      // see scalar_names; with Style::surface also no_field
    video::ColourMap map = video::ColourMap::viridis; // diverging for signed fields
    std::optional<video::ValueRange> range; // of the colours, in the field's unit; found from all frames unless given
    std::string camera;                     // see find_camera
    Style style = Style::spheres;           // surface: meshes of src/surface, cut at walls and solids
    std::optional<video::CutPlane> cut;     // liquid and solids on the camera's side of the plane are left out
    std::vector<std::string> colours;       // "LIQUID=#rrggbb" of liquids that are drawn in their own colours
    video::Background background = video::Background::white; // of the picture; the ink of text and edges follows
    std::string frames;                                      // see FrameRange
    double frames_per_second = 0;                            // 0: real time, within 10 and 60
    PictureSize size;                                        // of the pictures and the movie
    Movie movie = Movie::write;                              // left out for a single frame
    std::filesystem::path movie_file;                        // default: CAMERA_FIELD.mp4 in `out`
    std::filesystem::path out;                               // default: the run's folder pictures/
};

// "low:high" as a range of values. Throws InputError.
video::ValueRange read_value_range(const std::string& text);

// "x=5 cm", or a point and a normal, "10 0 5 cm; 1 0 1". Throws InputError.
video::CutPlane read_cut(const std::string& text);

// `treacle render`: one PNG per frame, CAMERA_FIELD_STEP.png, and a movie of them. Collective; each rank
// makes some of the pictures, for which all draw the liquid's surface together; rank 0 writes the movie. Throws InputError, SimulationError.
ExitCode render_run(const Comm& comm, const RenderRequest& request);

} // namespace treacle::app
