#include "app/check/check.hpp"

#include "app/check/check_report.hpp"
#include "app/render/preview.hpp"
#include "app/run/time_loop.hpp"
#include "app/setup/build_scene.hpp"
#include "base/text/log.hpp"
#include "video/clip/movie.hpp"

#include <functional>

namespace treacle::app {

namespace {

// Collects the problems of several checks of the scene into one error.
class Problems {
public:
    void of(const std::function<void()>& look) {
        try {
            look();
        } catch (const InputError& error) {
            found_.insert(found_.end(), error.diagnostics().begin(), error.diagnostics().end());
        }
    }
    void rethrow() const {
        if (!found_.empty()) throw InputError(found_);
    }

private:
    std::vector<Diagnostic> found_;
};

Geometry look_at(const Comm& comm, const CheckRequest& request, Input& input) {
    input = load_scene(request.source);
    Geometry geometry;
    Problems problems;
    problems.of([&] { check_supported(input); });
    problems.of([&] { check_time_step(input); });
    problems.of([&] {
        geometry = build_geometry(input);
        validate_geometry(input, geometry, comm);
    });
    problems.rethrow();
    return geometry;
}

} // namespace

ExitCode check_scene(const Comm& comm, const CheckRequest& request) {
    Input input;
    Geometry geometry;
    comm.guard([&] { geometry = look_at(comm, request, input); });
    comm.guard_root([&] {
        Log log(LogOutput::enabled);
        const auto preview = make_preview(input, geometry);
        for (const auto& line : check_report({input, geometry, request.source.scene, comm.size(), preview})) {
            log.line(line);
        }
        if (request.picture.empty()) return;
        video::write_png(request.picture, draw_preview(input, preview));
        log.line("picture: " + request.picture.string());
    });
    return ExitCode::ok;
}

} // namespace treacle::app
