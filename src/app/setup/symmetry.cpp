#include "app/setup/symmetry.hpp"

#include "base/text/error.hpp"
#include "scene/sampling/sampling.hpp"
#include "scene/sampling/signed_distance.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {
using scene::MirrorPlane;

std::string across(const MirrorPlane& mirror) { return std::string("across ") + "xyz"[mirror.axis]; }

// Shapes that are taken together, with the names of their owners.
struct Group {
    scene::Regions regions;
    std::vector<std::string> owners, locations; // one a region

    void add(const std::string& owner, const scene::Shape& shape, int dimensions) {
        regions.emplace_back(shape, dimensions);
        owners.push_back(owner);
        locations.push_back(shape.where);
    }
    std::size_t nearest(const Vec3& x) const {
        std::size_t out = 0;
        for (std::size_t i = 1; i < regions.size(); ++i) {
            if (regions[i].distance(x) < regions[out].distance(x)) out = i;
        }
        return out;
    }
    double distance(const Vec3& x) const { return regions[nearest(x)].distance(x); }
};

// Point at which the distance from the shapes differs most from that at its image.
struct Unevenness {
    double difference = 0; // [m]
    Vec3 at{};
};

Vec3 image_of(Vec3 x, const MirrorPlane& mirror) {
    x[mirror.axis] = 2 * mirror.position - x[mirror.axis];
    return x;
}

Unevenness unevenness(const Group& group, const scene::Domain& domain, const MirrorPlane& mirror) {
    constexpr int points = 24;
    const auto whole = domain.with_images();
    Unevenness out;
    const int layers = domain.dimensions == 3 ? points : 1;
    for (int i = 0; i < points * points * layers; ++i) {
        const std::array<int, 3> at{i % points, i / points % points, i / points / points};
        Vec3 x{};
        for (std::size_t c = 0; c < std::size_t(domain.dimensions); ++c)
            x[c] = whole.min[c] + (at[c] + 0.5) / points * (whole.max[c] - whole.min[c]);
        const auto image = image_of(x, mirror);
        const double here = group.distance(x), there = group.distance(image), difference = std::abs(here - there);
        if (difference > out.difference) out = {difference, here < there ? x : image};
    }
    return out;
}

class SymmetryCheck {
public:
    SymmetryCheck(const Input& input, const MirrorPlane& mirror, std::vector<Diagnostic>& problems)
        : input_(input), mirror_(mirror), problems_(problems) {}

    void run() {
        const auto& scene = input_.scene;
        std::vector<Group> groups(scene.liquids.size() + 1);
        for (std::size_t k = 0; k < scene.liquids.size(); ++k) {
            const auto& liquid = scene.liquids[k];
            for (const auto& shape : liquid.shapes)
                groups[k].add("liquids." + liquid.name, shape, scene.domain.dimensions);
        }
        for (const auto& body : scene.bodies) {
            groups.back().add("bodies." + body.name, body.shape, scene.domain.dimensions);
            motion_of(body);
        }
        if (std::ranges::any_of(groups, [this](const Group& group) { return extends_beyond(group); })) {
            for (const auto& group : groups) shapes_of(group);
            for (const auto& liquid : scene.liquids) motion_of(liquid);
        }
        for (const auto& face : scene.domain.faces) {
            if (face.velocity[mirror_.axis] != 0) moves(face.where, "a side of the domain");
        }
    }

private:
    // A scene of which nothing does is described by its half.
    bool extends_beyond(const Group& group) const {
        const auto k = mirror_.axis;
        const double touching = 1e-6 * input_.scene.domain.spacing;
        const bool low = input_.scene.domain.faces[2 * k].mirror;
        return std::ranges::any_of(group.regions, [&](const auto& region) {
            const auto bounds = region.bounds();
            return low ? bounds.min[k] < mirror_.position - touching : bounds.max[k] > mirror_.position + touching;
        });
    }

    void shapes_of(const Group& group) {
        constexpr double allowed = 0.05; // of a spacing, as meshes are rounded
        if (group.regions.empty()) return;
        const auto worst = unevenness(group, input_.scene.domain, mirror_);
        if (worst.difference <= allowed * input_.scene.domain.spacing) return;
        const auto which = group.nearest(worst.at);
        problems_.push_back(
            {group.locations[which], group.owners[which] + " is not its own mirror image " + across(mirror_),
                "the scene is mirrored there, and half of it is run",
                "move it so that the mirror goes through its middle, add its image, or remove the axis from "
                "domain.symmetry"});
    }

    void moves(const std::string& where, const std::string& owner) {
        problems_.push_back({where, owner + " moves " + across(mirror_), "its mirror image would move the other way",
            "remove the axis from domain.symmetry"});
    }

    void motion_of(const scene::Liquid& liquid) {
        if (liquid.shapes.empty()) return;
        const auto k = mirror_.axis;
        const auto gradient = liquid.initial_gradient();
        bool across_it = liquid.velocity[k] != 0;
        for (std::size_t j = 0; j < 3; ++j)
            across_it = across_it || (j != k && (gradient[j][k] != 0 || gradient[k][j] != 0));
        if (across_it) moves(liquid.where, "liquids." + liquid.name);
    }

    // Bodies that lie on one side have an image of their own.
    void motion_of(const scene::Body& body) {
        const auto k = mirror_.axis;
        const auto bounds = scene::SolidRegion(body.shape, input_.scene.domain.dimensions).bounds();
        if (body.kind != scene::BodyKind::kinematic || bounds.min[k] >= mirror_.position ||
            bounds.max[k] <= mirror_.position)
            return;
        bool across_it = body.velocity[k] != 0;
        for (std::size_t j = 0; j < 3; ++j) across_it = across_it || (j != k && body.angular_velocity[j] != 0);
        for (const auto& frame : body.keyframes) {
            across_it = across_it || frame.translation[k] != 0;
            for (std::size_t j = 0; j < 3; ++j)
                across_it = across_it || (j != k && frame.rotation_angle != 0 && frame.rotation_axis[j] != 0);
        }
        if (across_it) moves(body.where, "bodies." + body.name);
    }

    const Input& input_;
    const MirrorPlane& mirror_;
    std::vector<Diagnostic>& problems_;
};
} // namespace

void check_symmetry(const Input& input, std::vector<Diagnostic>& problems) {
    for (const auto& mirror : input.scene.domain.mirrors()) SymmetryCheck(input, mirror, problems).run();
}

} // namespace treacle::app
