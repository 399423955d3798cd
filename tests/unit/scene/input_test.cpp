#include "scene_text.hpp"

#include <numbers>

namespace treacle::scene {
namespace {

TEST(SceneInput, TheSmallestSceneHasTheDefaults) {
    const auto scene = read(start);
    EXPECT_EQ(scene.domain.dimensions, 3);
    EXPECT_EQ(scene.domain.spacing, 0.01);
    EXPECT_EQ(scene.domain.gravity, (Vec3{0, 0, -9.81}));
    EXPECT_EQ(scene.domain.faces[0].kind, BoundaryKind::wall);
    ASSERT_EQ(scene.liquids.size(), 1u);
    EXPECT_EQ(scene.liquids[0].name, "water");
    EXPECT_EQ(scene.liquids[0].where, "scene.yaml:3");
    EXPECT_EQ(scene.time.rule, StepRule::cfl);
    EXPECT_EQ(scene.output.fields.size(), 3u);
}

TEST(SceneInput, APlaneSceneHasVectorsOfTwoNumbersAndGravityDownwards) {
    const auto scene = read("schema_version: 1\n"
                            "domain: {dimensions: 2, max: [4, 3], spacing: 0.1}\n"
                            "liquids: [{shapes: [{box: {min: [0, 0], max: [1, 2]}}], velocity: [1, 0]}]\n"
                            "measurements: [{kind: height, position: [1, 0]}]\n");
    EXPECT_EQ(scene.domain.max, (Vec3{4, 3, 0}));
    EXPECT_EQ(scene.domain.gravity, (Vec3{0, -9.81, 0}));
    EXPECT_EQ(scene.liquids[0].shapes[0].max, (Vec3{1, 2, 0}));
    EXPECT_EQ(scene.liquids[0].velocity, (Vec3{1, 0, 0}));
    EXPECT_TRUE(is_problem("schema_version: 1\n"
                           "domain: {dimensions: 2, max: [4, 3, 1], spacing: 0.1}\n"
                           "liquids: [{shapes: [{sphere: {centre: [0, 0], radius: 1}}]}]\n",
        "scene.yaml:2: domain.max = [4, 3, 1]: must have no third number; the scene is plane"));
}

TEST(SceneInput, SidesAreWordsOrBlocks) {
    const auto scene = read(domain("  max: [1, 1, 1]\n  spacing: 0.1\n"
                                   "  boundaries:\n    x_min: periodic\n    x_max: periodic\n    z_max: open\n"
                                   "    z_min: {kind: open, outflow: true}\n"
                                   "    y_min: {slip: slip_length, slip_length: 2 mm}\n"));
    EXPECT_EQ(scene.domain.faces[0].kind, BoundaryKind::periodic);
    EXPECT_EQ(scene.domain.faces[5].kind, BoundaryKind::open);
    EXPECT_FALSE(scene.domain.faces[5].outflow);
    EXPECT_TRUE(scene.domain.faces[4].outflow);
    EXPECT_EQ(scene.domain.faces[2].kind, BoundaryKind::wall);
    EXPECT_EQ(scene.domain.faces[2].slip, Slip::slip_length);
    EXPECT_EQ(scene.domain.faces[2].slip_length, 0.002);
}

TEST(SceneInput, AMaterialGivesWhatIsNotGiven) {
    auto honey = read(liquid("    material: honey\n" + shapes)).liquids[0];
    EXPECT_EQ(honey.viscosity, 10);
    EXPECT_EQ(honey.density, 1420);
    honey = read(liquid("    material: honey\n    viscosity: 3 Pa.s\n" + shapes)).liquids[0];
    EXPECT_EQ(honey.viscosity, 3);
    EXPECT_EQ(honey.density, 1420);
    EXPECT_GT(honey.surface_tension, 0);
}

TEST(SceneInput, AKinematicViscosityIsTimesTheDensityInAnyOrder) {
    // Two roundings.
    EXPECT_DOUBLE_EQ(read(liquid("    viscosity: 1 cSt\n    density: 970\n" + shapes)).liquids[0].viscosity, 970e-6);
    EXPECT_DOUBLE_EQ(
        read(liquid("    viscosity: 1 cSt\n    material: glycerine\n" + shapes)).liquids[0].viscosity, 1261e-6);
}

TEST(SceneInput, EveryShapeIsRead) {
    const auto scene =
        read(liquid("    shapes:\n"
                    "      - box: {min: [0, 0, 0], max: [2, 1, 1], rotation_axis: [0, 0, 1], rotation_angle: 90 deg}\n"
                    "      - sphere: {centre: [1, 2, 3], radius: 5 mm, inverted: true}\n"
                    "      - cylinder: {centre: [0, 0, 0], axis: [0, 0, 1], radius: 1, height: 2}\n"
                    "      - capsule: {centre: [0, 0, 0], radius: 1, height: 2}\n"
                    "      - cone: {centre: [0, 0, 0], radius: 1, height: 2}\n"
                    "      - torus: {centre: [0, 0, 0], radius: 1, tube_radius: 0.2}\n"
                    "      - plane: {point: [0, 0, 1], normal: [0, 0, 1]}\n"
                    "      - mesh: {file: bunny.ply, size: 10 cm, translation: [1, 0, 0], fallback: {sphere: {centre: "
                    "[0, 0, 0], "
                    "radius: 1}}}\n"));
    const auto& list = scene.liquids[0].shapes;
    ASSERT_EQ(list.size(), 8u);
    const ShapeKind kinds[] = {ShapeKind::box, ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::capsule,
        ShapeKind::cone, ShapeKind::torus, ShapeKind::plane, ShapeKind::mesh};
    for (std::size_t i = 0; i < list.size(); ++i) {
        EXPECT_EQ(list[i].kind, kinds[i]);
        EXPECT_EQ(list[i].where, "scene.yaml:" + std::to_string(6 + i));
    }
    EXPECT_EQ(list[0].centre, (Vec3{1, 0.5, 0.5}));
    EXPECT_DOUBLE_EQ(list[0].rotation_angle, std::numbers::pi / 2);
    EXPECT_TRUE(list[1].inverted);
    EXPECT_EQ(list[6].centre, (Vec3{0, 0, 1}));
    EXPECT_EQ(list[7].size, 0.1);
    ASSERT_EQ(list[7].fallback.size(), 1u);
    EXPECT_EQ(list[7].fallback[0].kind, ShapeKind::sphere);
}

TEST(SceneInput, NamelessThingsGetNames) {
    const auto scene = read("schema_version: 1\n"
                            "domain: {max: [1, 1, 1], spacing: 0.1}\n"
                            "liquids:\n"
                            "  - {name: liquid, shapes: [{sphere: {centre: [0, 0, 0], radius: 1}}]}\n"
                            "  - {shapes: [{sphere: {centre: [0, 0, 0], radius: 1}}]}\n"
                            "  - {material: honey, shapes: [{sphere: {centre: [0, 0, 0], radius: 1}}]}\n"
                            "measurements: [{kind: front}, {kind: front, axis: y}, {kind: height}]\n");
    EXPECT_EQ(scene.liquids[0].name, "liquid");
    EXPECT_EQ(scene.liquids[1].name, "liquid_2");
    EXPECT_EQ(scene.liquids[2].name, "honey");
    EXPECT_EQ(scene.measurements[1].name, "front_2");
    EXPECT_EQ(scene.measurements[1].axis, 1);
    EXPECT_EQ(scene.measurements[2].name, "height");
}

TEST(SceneInput, ACameraWithAPositionIsNotAutomatic) {
    const auto scene = read(start + "cameras: [{name: a}, {name: b, position: [0, -3, 1], field_of_view: 40 deg}]\n");
    EXPECT_TRUE(scene.cameras[0].automatic);
    EXPECT_FALSE(scene.cameras[1].automatic);
}

const std::string spinning = "schema_version: 1\n"
                             "domain: {max: [1, 1, 1], spacing: 0.1}\n"
                             "liquids: [{shapes: [{box: {max: [1, 1, 1], min: [0, 0, 0]}}], velocity: [1, 0, 0],\n"
                             "           angular_velocity: [0, 0, 60 rpm], velocity_gradient: {x: [0, 2 1/s, 0]}, "
                             "pivot: {point: [0, 0, 0.5]}}]\n";

TEST(SceneInput, ALiquidMayStartWithASpinAndAGradient) {
    const auto liquid = read(spinning).liquids[0];
    const double w = 2 * std::numbers::pi;
    const Vec3 u = liquid.initial_velocity({3, 4, 9}, *liquid.pivot);
    EXPECT_NEAR(u[0], 1 + (2 - w) * 4, 1e-12);
    EXPECT_NEAR(u[1], w * 3, 1e-12);
    EXPECT_NEAR(u[2], 0, 1e-12);
    EXPECT_TRUE(liquid.sheared());
    const std::string empty = start.substr(0, start.find("liquids"));
    EXPECT_TRUE(is_problem(
        empty + "liquids: [{shapes: [{sphere: {centre: [0, 0, 0], radius: 1}}], velocity_gradient: {x: [1, 0, 0]}}]\n",
        "scene.yaml:3: liquids.0.velocity_gradient: must have a divergence of 0"));
    EXPECT_TRUE(is_problem(empty + "liquids: [{angular_velocity: [0, 0, 1]}]\ninlets: [{disc: {centre: [0, 0, 0], "
                                   "radius: 1, direction: [0, 0, 1]}, velocity: 1}]\n",
        "scene.yaml:3: liquids.0.shapes"));
    const std::string plane = "schema_version: 1\ndomain: {dimensions: 2, max: [1, 1], spacing: 0.1}\n"
                              "liquids: [{shapes: [{sphere: {centre: [0, 0], radius: 1}}], ";
    EXPECT_TRUE(is_problem(plane + "angular_velocity: [1, 0, 0]}]\n", "scene.yaml:3: liquids.0.angular_velocity"));
    EXPECT_EQ(read(plane + "angular_velocity: [0, 0, 2]}]\n").liquids[0].initial_gradient()[1][0], 2);
}

const std::string vessel = "schema_version: 1\n"
                           "domain: {max: [1, 1, 1], spacing: 0.1}\n"
                           "liquids: [{shapes: [{sphere: {centre: [0, 0, 0], radius: 0.5, clip: true}}]}]\n"
                           "bodies:\n"
                           "  - shape:\n"
                           "      difference:\n"
                           "        from: {cylinder: {centre: [0, 0, 0], radius: 1, height: 2}}\n"
                           "        subtract:\n"
                           "          - union:\n"
                           "              shapes:\n"
                           "                - {sphere: {centre: [0, 0, 0], radius: 0.5}}\n"
                           "                - box: {min: [0, 0, 0], max: [1, 1, 1]}\n"
                           "              translation: [0, 0, 1]\n"
                           "        rotation_angle: 90 deg\n";

TEST(SceneInput, ShapesAreMadeOfShapes) {
    const auto scene = read(vessel);
    EXPECT_TRUE(scene.liquids[0].shapes[0].clip);
    const Shape& shape = scene.bodies[0].shape;
    ASSERT_EQ(shape.kind, ShapeKind::subtract);
    ASSERT_EQ(shape.parts.size(), 2u);
    EXPECT_EQ(shape.parts[0].kind, ShapeKind::cylinder);
    ASSERT_EQ(shape.parts[1].parts.size(), 2u);
    EXPECT_EQ(shape.parts[1].parts[1].where, "scene.yaml:12");
    EXPECT_EQ(shape.parts[1].translation[2], 1);
    std::string text = vessel;
    text.replace(text.find("height: 2"), 9, "height: 2, clip: true");
    EXPECT_TRUE(is_problem(
        text, "scene.yaml:7: bodies.0.shape.difference.from.cylinder.clip = true: must stand at the outermost shape"));
    const std::string body = start + "bodies: [{shape: ";
    EXPECT_TRUE(is_problem(body + "{union: {shapes: []}}}]\n", "scene.yaml:4: bodies.0.shape.union.shapes"));
    EXPECT_TRUE(is_problem(body + "{difference: {from: {sphere: {centre: [0, 0, 0], radius: 1}}}}}]\n",
        "scene.yaml:4: bodies.0.shape.difference.subtract is missing"));
    EXPECT_TRUE(is_problem(body + "{intersection: {shapes: [{sphere: {centre: [0, 0, 0], radius: -1}}]}}}]\n",
        "scene.yaml:4: bodies.0.shape.intersection.shapes.0.sphere.radius = -1 m: must be > 0"));
    EXPECT_NE(manual(Scene{}, "bodies.shape.difference.from.box.min").find("difference"), std::string::npos);
}

TEST(SceneInput, TheEffectiveSceneParsesToTheSameOne) {
    for (const auto& text : {everything, start, spinning, vessel,
             std::string("schema_version: 1\n"
                         "domain: {dimensions: 2, max: [0.3, 3], spacing: 0.07}\n"
                         "liquids: [{shapes: [{box: {min: [0.1, 0], max: [1, 2]}}]}]\n")}) {
        const auto scene = read(text);
        const auto written = effective(scene);
        const auto again = read(written);
        EXPECT_EQ(effective(again), written);
        EXPECT_EQ(again.domain.faces, scene.domain.faces);
        EXPECT_EQ(again.domain.max, scene.domain.max);
        EXPECT_EQ(again.domain.gravity, scene.domain.gravity);
        EXPECT_EQ(again.liquids[0].viscosity, scene.liquids[0].viscosity);
        EXPECT_EQ(again.liquids[0].shapes[0].centre, scene.liquids[0].shapes[0].centre);
        EXPECT_EQ(again.liquids[0].shapes[0].rotation_angle, scene.liquids[0].shapes[0].rotation_angle);
        EXPECT_EQ(again.bodies.size(), scene.bodies.size());
        EXPECT_EQ(again.cameras.size(), scene.cameras.size());
        EXPECT_EQ(again.max_lost_fraction, scene.max_lost_fraction);
    }
}

TEST(SceneInput, TheManualAndTheSchemaHaveEveryBlock) {
    const auto text = manual(Scene{});
    for (const char* key :
        {"schema_version: whole number, required", "domain: block", "liquids: list of blocks, required", "bodies: list",
            "time: block", "output: block", "cameras: list", "measurements: list", "      fallback: block"}) {
        EXPECT_NE(text.find(key), std::string::npos) << key;
    }
    EXPECT_EQ(
        manual(Scene{}, "liquids.viscosity").rfind("liquids.viscosity: number [Pa s], >= 0, default 0 Pa s", 0), 0u);
    EXPECT_NE(json_schema(Scene{}).find("\"viscosity\""), std::string::npos);
}

} // namespace
} // namespace treacle::scene
