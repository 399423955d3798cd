#include "scene_text.hpp"

#include <algorithm>
#include <random>

namespace treacle::scene {
namespace {

TEST(BadScene, VersionsAreKnownOrRejected) {
    EXPECT_TRUE(is_problem(start.substr(start.find('\n') + 1), "scene.yaml:1: schema_version is missing"));
    auto other = start;
    other[other.find('1')] = '2';
    EXPECT_TRUE(is_problem(other, "scene.yaml:1: schema_version = 2: must be 1"));
}

TEST(BadScene, MissingBlocksAreNamed) {
    const auto found = problems("schema_version: 1\n");
    ASSERT_EQ(found.size(), 3u);
    EXPECT_EQ(found[0].rfind("scene.yaml:1: domain.max is missing", 0), 0u);
    EXPECT_EQ(found[1].rfind("scene.yaml:1: domain.spacing is missing", 0), 0u);
    EXPECT_EQ(found[2].rfind("scene.yaml:1: liquids is missing", 0), 0u);
}

TEST(BadScene, UnknownKeysComeWithTheNearestOne) {
    EXPECT_TRUE(is_problem(start + "ouput: {}\n", "scene.yaml:4: ouput is not a known key; did you mean output?"));
    EXPECT_TRUE(is_problem(
        start + "time:\n  end: 1\n  stop: 2\n", "scene.yaml:6: time.stop is not a known key; did you mean step?"));
    EXPECT_TRUE(is_problem(liquid("    viscocity: 3\n" + shapes),
        "scene.yaml:5: liquids.honey.viscocity is not a known key; did you mean viscosity?"));
}

TEST(BadScene, ADomainHasAVolumeAndFitsItsSpacing) {
    EXPECT_TRUE(is_problem(domain("  max: [1, 0, 1]\n  spacing: 0.1\n"),
        "scene.yaml:3: domain.max = [1, 0, 1]: must be greater than min in y"));
    EXPECT_TRUE(is_problem(
        domain("  max: [1, 1, 1]\n  spacing: -0.1\n"), "scene.yaml:4: domain.spacing = -0.1 m: must be > 0"));
    EXPECT_TRUE(is_problem(domain("  max: [1, 2, 2]\n  spacing: 1.5\n"),
        "scene.yaml:4: domain.spacing = 1.5: must be at most the length of the domain in x"));
    EXPECT_TRUE(is_problem(domain("  max: [1, 0.5, 0.5]\n  spacing: 0.9 um\n"),
        "scene.yaml:4: domain.spacing = 0.9 um: must be at least a millionth"));
    EXPECT_TRUE(is_problem(domain("  max: [1, 1, 1]\n  spacing: 0.1\n  dimensions: 4\n"),
        "scene.yaml:5: domain.dimensions = 4: must be in [2, 3]"));
    EXPECT_TRUE(is_problem(domain("  max: [1, 1]\n  spacing: 0.1\n"),
        "scene.yaml:3: domain.max = [1, 1]: must be a list of 3 numbers; it has 2"));
}

TEST(BadScene, SidesAreConsistent) {
    const auto sides = [](const std::string& text) {
        return domain("  max: [1, 1, 1]\n  spacing: 0.1\n  boundaries:\n    " + text + "\n");
    };
    EXPECT_TRUE(
        is_problem(sides("x_min: periodic"), "scene.yaml:6: domain.boundaries.x_max: must be periodic as x_min is"));
    EXPECT_TRUE(is_problem(sides("x_max: periodic\n    x_min: wall"),
        "scene.yaml:7: domain.boundaries.x_min = wall: must be periodic as x_max is"));
    EXPECT_TRUE(is_problem(sides("x_min: wal"), "scene.yaml:6: domain.boundaries.x_min.kind = wal: must be one of"));
    EXPECT_TRUE(is_problem(sides("x_min: {slip: slip_length}"),
        "scene.yaml:6: domain.boundaries.x_min.slip_length: must be > 0 with slip: slip_length"));
    EXPECT_TRUE(is_problem(sides("x_min: {slip_length: 1 mm}"),
        "scene.yaml:6: domain.boundaries.x_min.slip_length = 1 mm: has no effect"));
    EXPECT_TRUE(is_problem(sides("x_min: {kind: open, slip: no_slip}"),
        "scene.yaml:6: domain.boundaries.x_min.slip = no_slip: has no effect"));
    EXPECT_TRUE(is_problem(sides("x_min: {outflow: true}"),
        "scene.yaml:6: domain.boundaries.x_min.outflow = true: has no effect; the side is not open"));
    EXPECT_TRUE(is_problem("schema_version: 1\n"
                           "domain: {dimensions: 2, max: [4, 3], spacing: 0.1, boundaries: {z_min: open}}\n"
                           "liquids: [{shapes: [{sphere: {centre: [0, 0], radius: 1}}]}]\n",
        "scene.yaml:2: domain.boundaries.z_min = open: must not be given; a plane scene"));
}

TEST(BadScene, SidesMoveAlongThemselvesWhereTheyHoldTheLiquid) {
    const auto sides = [](const std::string& text) {
        return domain("  max: [1, 1, 1]\n  spacing: 0.1\n  boundaries:\n    " + text + "\n");
    };
    EXPECT_TRUE(problems(sides("y_max: {slip: no_slip, velocity: [1, 0, 2]}")).empty());
    EXPECT_TRUE(problems(sides("y_max: {slip: slip_length, slip_length: 1 mm, velocity: [1, 0, 2]}")).empty());
    EXPECT_TRUE(problems(sides("y_max: {skin_friction: 0.01, velocity: [1, 0, 2]}")).empty());
    const std::string at = "scene.yaml:6: domain.boundaries.y_max.velocity = [1, 0, 0]: has no effect; ";
    EXPECT_TRUE(is_problem(
        sides("y_max: {velocity: [1, 0, 0]}"), at + "a free-slip wall takes nothing along; write slip: no_slip"));
    EXPECT_TRUE(is_problem(sides("y_max: {kind: open, velocity: [1, 0, 0]}"), at + "the side is open and no wall"));
    EXPECT_TRUE(is_problem(sides("y_max: {kind: periodic, velocity: [1, 0, 0]}\n    y_min: periodic"),
        at + "the side is periodic and no wall"));
    EXPECT_TRUE(is_problem(sides("y_max: {slip: no_slip, velocity: [1, 2, 0]}"),
        "scene.yaml:6: domain.boundaries.y_max.velocity = [1, 2, 0]: must be 0 along y; a side of the domain moves "
        "along itself alone"));
}

TEST(BadScene, WhatIsInThePlaneStaysInIt) {
    const auto scene = [](const std::string& text) {
        return "schema_version: 1\n"
               "domain: {dimensions: 2, max: [4, 3], spacing: 0.1}\n"
               "liquids: [{shapes: [{sphere: {centre: [0, 0], radius: 1}}]}]\n" +
               text + "\n";
    };
    const auto body = [&](const std::string& keys) {
        return scene(
            "bodies: [{name: drum, kind: kinematic, shape: {sphere: {centre: [1, 1], radius: 1}}, " + keys + "}]");
    };
    for (const std::string spin : {"[0, 12.566]", "[12, 0, 0]", "[0, 12, 3]"}) {
        EXPECT_TRUE(is_problem(
            body("angular_velocity: " + spin), "scene.yaml:4: bodies.drum.angular_velocity = " + spin + ": must be "))
            << spin;
    }
    EXPECT_EQ(read(body("angular_velocity: 3")).bodies[0].angular_velocity, (Vec3{0, 0, 3}));
    EXPECT_EQ(read(body("angular_velocity: 30 deg/s")).bodies[0].angular_velocity[0], 0);
    EXPECT_EQ(read(body("angular_velocity: [0, 0, -3]")).bodies[0].angular_velocity, (Vec3{0, 0, -3}));
    EXPECT_TRUE(is_problem(body("angular_velocity: fast"),
        "scene.yaml:4: bodies.drum.angular_velocity = fast: must be an angular velocity"));
    EXPECT_TRUE(is_problem(
        body("velocity: [0, 0, 1]"), "scene.yaml:4: bodies.drum.velocity = [0, 0, 1]: must have no third number"));
    EXPECT_TRUE(is_problem(body("keyframes: [{time: 1, rotation_axis: [0, 1], rotation_angle: 1}]"),
        "scene.yaml:4: bodies.drum.keyframes.0.rotation_axis = [0, 1]: must be z"));
    EXPECT_TRUE(problems(body("keyframes: [{time: 1, rotation_axis: [0, 0, -1], rotation_angle: 1}]")).empty());
    EXPECT_TRUE(is_problem(body("keyframes: [{time: 1, translation: [0, 0, 1]}]"),
        "scene.yaml:4: bodies.drum.keyframes.0.translation = [0, 0, 1]: must have no third number"));
    EXPECT_TRUE(is_problem(scene("inlets: [{velocity: 1, disc: {centre: [1, 2], direction: [0, -1, 1], radius: 0.3}}]"),
        "scene.yaml:4: inlets.0.disc.direction = [0, -1, 1]: must have no third number"));
    EXPECT_TRUE(is_problem(scene("outlets: [{half_space: {point: [1, 2], normal: [0, 0, 1]}}]"),
        "scene.yaml:4: outlets.0.half_space.normal = [0, 0, 1]: must have no third number"));
    const auto space =
        start + "bodies: [{kind: kinematic, angular_velocity: 3, shape: {sphere: {centre: [0, 0, 0], radius: 1}}}]\n";
    EXPECT_TRUE(is_problem(space, "scene.yaml:4: bodies.0.angular_velocity = 3: must be a list of 3 numbers"));
}

TEST(BadScene, PropertiesOfALiquidAreInRange) {
    EXPECT_EQ(problems(liquid("    viscosity: -3\n" + shapes)).at(0),
        "scene.yaml:5: liquids.honey.viscosity = -3 Pa s: must be >= 0; a Newtonian viscosity is "
        "positive; honey "
        "is about 10 Pa s, water 0.001 Pa s.");
    EXPECT_TRUE(
        is_problem(liquid("    density: 0\n" + shapes), "scene.yaml:5: liquids.honey.density = 0 kg/m3: must be > 0"));
    EXPECT_TRUE(is_problem(liquid("    surface_tension: -1 mN/m\n" + shapes),
        "scene.yaml:5: liquids.honey.surface_tension = -1 mN/m: must be >= 0"));
    EXPECT_TRUE(is_problem(liquid("    viscosity: 3 mm\n" + shapes),
        "scene.yaml:5: liquids.honey.viscosity = 3 mm: must be a dynamic viscosity [Pa s]"));
    EXPECT_TRUE(is_problem(
        liquid("    material: hony\n" + shapes), "scene.yaml:5: liquids.honey.material = hony: must be one of"));
    EXPECT_TRUE(is_problem(liquid("    density: 1\n"), "scene.yaml:4: liquids: the shapes of honey are missing"));
    EXPECT_TRUE(is_problem(liquid("    shapes: []\n"), "scene.yaml:4: liquids: the shapes of honey are missing"));
    EXPECT_TRUE(is_problem("schema_version: 1\ndomain: {max: [1, 1, 1], spacing: 0.1}\nliquids: []\n",
        "scene.yaml:3: liquids = []: must not be empty"));
}

TEST(BadScene, NamesAreWordsAndDiffer) {
    EXPECT_TRUE(
        is_problem(start + "cameras: [{name: a.b}]\n", "scene.yaml:4: cameras.a.b.name = a.b: must start with"));
    EXPECT_TRUE(is_problem(start + "cameras: [{name: 7}]\n", "scene.yaml:4: cameras.7.name = 7: must start with"));
    EXPECT_TRUE(
        is_problem(start + "cameras: [{name: a}, {name: a}]\n", "scene.yaml:4: cameras: the name a stands twice"));
}

TEST(BadScene, JointsLinkADynamicBodyToAnother) {
    const auto joint = [](const std::string& keys) {
        return body("    kind: dynamic\n    density: 5\n") + "joints:\n  - {name: pin, point: [0, 0, 0], " + keys +
               "}\n";
    };
    const std::string hinge = "axis: [0, 0, 1], ";
    EXPECT_TRUE(problems(joint(hinge + "body: ship")).empty());
    EXPECT_TRUE(is_problem(joint("body: ship"), "scene.yaml:10: joints.pin.axis: must be given"));
    EXPECT_TRUE(is_problem(joint(hinge + "body: shop"), "scene.yaml:10: joints: the body shop of pin is not among"));
    EXPECT_TRUE(is_problem(joint(hinge + "body: ship, to: quay"), "scene.yaml:10: joints: the body quay of pin"));
    EXPECT_TRUE(is_problem(joint(hinge + "body: ship, to: ship"), "scene.yaml:10: joints: pin links ship to itself"));
    EXPECT_TRUE(is_problem(
        joint("kind: ball, axis: [1, 0, 0], body: ship"), "scene.yaml:10: joints.pin.axis = [1, 0, 0]: has no effect"));
    EXPECT_TRUE(is_problem(joint("kind: weld, body: ship"), "scene.yaml:10: joints.pin.kind = weld: must be one of"));
    EXPECT_TRUE(is_problem(joint(hinge), "scene.yaml:10: joints.pin.body is missing"));
}

TEST(BadScene, ShapesHaveAVolume) {
    const std::string at = "scene.yaml:6: liquids.honey.shapes.0.";
    EXPECT_TRUE(is_problem(
        shape("box: {min: [0, 0, 0], max: [1, 1, 0]}"), at + "box.max = [1, 1, 0]: must be greater than min in z"));
    EXPECT_TRUE(is_problem(shape("box: {min: [0, 0, 0]}"), at + "box.max is missing"));
    EXPECT_TRUE(is_problem(shape("sphere: {centre: [0, 0, 0], radius: 0}"), at + "sphere.radius = 0 m: must be > 0"));
    EXPECT_TRUE(is_problem(shape("sphere: {radius: 1}"), at + "sphere.centre is missing"));
    EXPECT_TRUE(is_problem(
        shape("cylinder: {centre: [0, 0, 0], radius: 1, height: -1}"), at + "cylinder.height = -1 m: must be > 0"));
    EXPECT_TRUE(is_problem(shape("capsule: {centre: [0, 0, 0], radius: 1}"), at + "capsule.height is missing"));
    EXPECT_TRUE(is_problem(shape("cone: {centre: [0, 0, 0], radius: 1, height: 1, axis: [0, 0, 0]}"),
        at + "cone.axis = [0, 0, 0]: must not be zero"));
    EXPECT_TRUE(is_problem(shape("torus: {centre: [0, 0, 0], radius: 1, tube_radius: 2}"),
        at + "torus.tube_radius = 2: must be < radius"));
    EXPECT_TRUE(is_problem(shape("plane: {point: [0, 0, 0]}"), at + "plane.normal is missing"));
    EXPECT_TRUE(is_problem(shape("mesh: {size: 1}"), at + "mesh.file is missing"));
    EXPECT_TRUE(is_problem(shape("mesh: {file: \"\"}"), at + "mesh.file: must not be empty"));
    EXPECT_TRUE(is_problem(shape("mesh: {file: a.ply, scale: 0}"), at + "mesh.scale = 0: must be > 0"));
    EXPECT_TRUE(is_problem(shape("mesh: {file: a.ply, size: -1}"), at + "mesh.size = -1 m: must be >= 0"));
    EXPECT_EQ(problems(shape("mesh: {file: a.ply, fallback: {mesh: {file: b.ply}}}")).size(), 2u);
    EXPECT_TRUE(is_problem(shape("{}"), "scene.yaml:6: liquids.honey.shapes.0 has no box, sphere"));
    EXPECT_TRUE(is_problem(shape("{box: {min: [0, 0, 0], max: [1, 1, 1]}, sphere: {centre: [0, 0, 0], radius: 1}}"),
        "scene.yaml:6: liquids.honey.shapes.0 has box and sphere"));
}

TEST(BadScene, AMotionFitsTheKindOfTheBody) {
    const std::string at = "scene.yaml:7: bodies.ship.";
    EXPECT_TRUE(
        is_problem(body("    kind: dynamic\n"), "scene.yaml:5: bodies.ship.density: must be > 0 for a dynamic body"));
    EXPECT_TRUE(is_problem(body("    density: 5\n"), at + "density = 5: has no effect"));
    EXPECT_TRUE(is_problem(body("    density: -5\n"), at + "density = -5 kg/m3: must be >= 0"));
    EXPECT_TRUE(is_problem(body("    velocity: [1, 0, 0]\n"), at + "velocity = [1, 0, 0]: has no effect"));
    EXPECT_TRUE(
        is_problem(body("    angular_velocity: [1, 0, 0]\n"), at + "angular_velocity = [1, 0, 0]: has no effect"));
    EXPECT_TRUE(is_problem(body("    kind: kinematic\n"), "scene.yaml:5: bodies.ship.keyframes: must not be empty"));
    EXPECT_TRUE(is_problem(body("    keyframes: [{time: 0}]\n"), at + "keyframes: have no effect"));
    EXPECT_TRUE(is_problem(body("    keyframes: [{time: 1}, {time: 1}]\n    kind: kinematic\n"),
        at + "keyframes: must have increasing times"));
    EXPECT_TRUE(is_problem(body("    keyframes: [{time: 0, translation: [1, 0, 0]}]\n    kind: kinematic\n"),
        at + "keyframes: must leave the body in its place at time 0"));
    EXPECT_TRUE(is_problem(body("    keyframes: [{time: 1}]\n    kind: kinematic\n    velocity: [1, 0, 0]\n"),
        at + "keyframes: must not be given beside velocities"));
    EXPECT_TRUE(is_problem(body("    kind: dynamic\n    density: 5\n    mass: 3\n"),
        "scene.yaml:9: bodies.ship.mass = 3: must not be given beside the density"));
    EXPECT_TRUE(is_problem(body("    locked: [x]\n"), at + "locked = [x]: has no effect"));
    EXPECT_TRUE(is_problem(body("    kind: dynamic\n    density: 5\n    locked: [w]\n"),
        "scene.yaml:9: bodies.ship.locked.0 = w: must be one of x, y, z, rotation_x, rotation_y, rotation_z"));
    EXPECT_TRUE(is_problem(body("    pivot: {point: [1, 0, 0]}\n"), at + "pivot: has no effect"));
    EXPECT_TRUE(is_problem(body("    restitution: 2\n"), at + "restitution = 2: must be in [0, 1]"));
    EXPECT_TRUE(is_problem(
        body("    keyframes: [{time: -1}]\n    kind: kinematic\n"), at + "keyframes.0.time = -1 s: must be >= 0"));
    EXPECT_TRUE(is_problem(
        body("    keyframes: [{translation: [0, 0, 0]}]\n    kind: kinematic\n"), at + "keyframes.0.time is missing"));
    EXPECT_TRUE(is_problem(body("    slip: slip_length\n"), "scene.yaml:5: bodies.ship.slip_length: must be > 0"));
    EXPECT_TRUE(
        is_problem(body("    kind: moving\n"), at + "kind = moving: must be one of static, kinematic, dynamic"));
    EXPECT_TRUE(is_problem(start + "bodies: [{name: ship}]\n", "scene.yaml:4: bodies.ship.shape has no box, sphere"));
}

TEST(BadScene, TimesAreConsistent) {
    const auto time = [](const std::string& keys) { return start + "time: {" + keys + "}\n"; };
    EXPECT_TRUE(is_problem(time("end: 0"), "scene.yaml:4: time.end = 0 s: must be > 0"));
    EXPECT_TRUE(is_problem(time("rule: fixed"), "scene.yaml:4: time.step: must be > 0 with rule: fixed"));
    EXPECT_TRUE(is_problem(time("step: -1"), "scene.yaml:4: time.step = -1 s: must be >= 0"));
    EXPECT_TRUE(is_problem(time("step: 1e-9"), "scene.yaml:4: time.step = 1e-9: must be at least min_step"));
    EXPECT_TRUE(is_problem(time("cfl: 15"), "scene.yaml:4: time.cfl = 15: must be in [0, 10]"));
    EXPECT_TRUE(is_problem(time("min_step: 0"), "scene.yaml:4: time.min_step = 0 s: must be > 0"));
    EXPECT_TRUE(is_problem(time("rule: slow"), "scene.yaml:4: time.rule = slow: must be one of cfl, fixed"));
}

TEST(BadScene, OutputIsConsistent) {
    const auto output = [](const std::string& keys) { return start + "output: {" + keys + "}\n"; };
    EXPECT_TRUE(is_problem(output("name: a/b"), "scene.yaml:4: output.name = a/b: must have letters"));
    EXPECT_TRUE(is_problem(output("name: \"\""), "scene.yaml:4: output.name: must have letters"));
    for (const std::string key : {"interval", "checkpoint_interval", "checkpoint_wall_interval", "log_interval"}) {
        EXPECT_TRUE(is_problem(output(key + ": -1"), "scene.yaml:4: output." + key + " = -1 s: must be >= 0"));
    }
    EXPECT_TRUE(is_problem(output("checkpoints_kept: 0"), "scene.yaml:4: output.checkpoints_kept = 0: must be >= 1"));
}

TEST(BadScene, CamerasAndMeasurementsAreConsistent) {
    const auto camera = [](const std::string& keys) { return start + "cameras: [{" + keys + "}]\n"; };
    EXPECT_TRUE(is_problem(camera("position: [1, 1, 1], target: [1, 1, 1]"),
        "scene.yaml:4: cameras.0.position = [1, 1, 1]: must differ from target"));
    EXPECT_TRUE(is_problem(
        camera("position: [1, 1, 1], automatic: true"), "scene.yaml:4: cameras.0.position = [1, 1, 1]: has no effect"));
    EXPECT_TRUE(is_problem(camera("target: [1, 1, 1]"), "scene.yaml:4: cameras.0.target = [1, 1, 1]: has no effect"));
    EXPECT_TRUE(is_problem(camera("up: [0, 0, 0]"), "scene.yaml:4: cameras.0.up = [0, 0, 0]: must not be zero"));
    EXPECT_TRUE(
        is_problem(camera("field_of_view: 180 deg"), "scene.yaml:4: cameras.0.field_of_view = 180 deg: must be in"));
    EXPECT_TRUE(is_problem(camera("width: 8"), "scene.yaml:4: cameras.0.width = 8: must be in [16, 16384]"));
    EXPECT_TRUE(is_problem(camera("height: 99999"), "scene.yaml:4: cameras.0.height = 99999: must be in [16, 16384]"));
    EXPECT_TRUE(is_problem(start + "measurements: [{axis: x}]\n", "scene.yaml:4: measurements.0.kind is missing"));
    EXPECT_TRUE(is_problem(start + "measurements: [{kind: front, axis: w}]\n",
        "scene.yaml:4: measurements.0.axis = w: must be one of x, y, z"));
    EXPECT_TRUE(is_problem(start + "measurements: [{kind: front, interval: -1}]\n",
        "scene.yaml:4: measurements.0.interval = -1 s: must be >= 0"));
    EXPECT_TRUE(is_problem("schema_version: 1\n"
                           "domain: {dimensions: 2, max: [4, 3], spacing: 0.1}\n"
                           "liquids: [{shapes: [{sphere: {centre: [0, 0], radius: 1}}]}]\n"
                           "measurements: [{kind: front, axis: z}]\n",
        "scene.yaml:4: measurements.0.axis = z: must be x or y"));
    EXPECT_TRUE(is_problem(start + "max_lost_fraction: 2\n", "scene.yaml:4: max_lost_fraction = 2: must be in [0, 1]"));
}

// A good scene with a value, key or line replaced at random: success or an InputError, nothing else.
TEST(BadScene, RandomChangesAreReadOrRejected) {
    const std::vector<std::string> values{"", "~", "[]", "{}", "-1", "1e999", ".nan", "x", "[1, 2]", "{a: b}", "\"",
        "5 kg", "99999999999", "&a [*a ]", "- 1", "[[[]]]", "true"};
    std::mt19937 random(11);
    for (int i = 0; i < 5000; ++i) {
        auto text = everything;
        for (int changes = 1 + static_cast<int>(random() % 3); changes > 0; --changes) {
            const auto from = random() % text.size();
            const auto to = std::min(text.size(), from + random() % 20);
            text.replace(from, to - from, values[random() % values.size()]);
        }
        try {
            effective(read(text));
        } catch (const InputError& error) {
            EXPECT_FALSE(error.diagnostics().empty());
        } catch (const std::exception& error) {
            FAIL() << text << "\n: " << error.what();
        }
    }
}

} // namespace
} // namespace treacle::scene
