#pragma once
#include "base/options/options.hpp"
#include "base/text/error.hpp"
#include "scene/scene.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace treacle::scene {

inline Scene read(const std::string& text) {
    Scene scene;
    parse(Document::from_text(text, "scene.yaml"), scene);
    return scene;
}

inline std::vector<std::string> problems(const std::string& text) {
    std::vector<std::string> out;
    try {
        read(text);
    } catch (const InputError& error) {
        for (const auto& diagnostic : error.diagnostics()) out.push_back(diagnostic.text());
    }
    return out;
}

// A complete scene of three lines: what is added to it starts at line 4.
inline const std::string start = "schema_version: 1\n"
                                 "domain: {min: [0, 0, 0], max: [1, 1, 1], spacing: 10 mm}\n"
                                 "liquids: [{material: water, shapes: [{box: {min: [0, 0, 0], max: [0.5, 1, 1]}}]}]\n";

// Whether exactly one problem is found, and it starts with `expected`.
inline testing::AssertionResult is_problem(const std::string& text, const std::string& expected) {
    const auto found = problems(text);
    if (found.size() == 1 && found[0].starts_with(expected)) return testing::AssertionSuccess();
    auto result = testing::AssertionFailure() << found.size() << " problems";
    for (const auto& problem : found) result << "\n" << problem;
    return result;
}

inline std::string domain(const std::string& keys) {
    return "schema_version: 1\ndomain:\n" + keys + "liquids: [{shapes: [{sphere: {centre: [0, 0, 0], radius: 1}}]}]\n";
}
inline std::string liquid(const std::string& keys) {
    return "schema_version: 1\ndomain: {max: [1, 1, 1], spacing: 10 mm}\nliquids:\n  - name: honey\n" + keys;
}
inline const std::string shapes = "    shapes: [{sphere: {centre: [0, 0, 0], radius: 1}}]\n";
inline std::string shape(const std::string& text) { return liquid("    shapes:\n      - " + text + "\n"); }
inline std::string body(const std::string& keys) {
    return start + "bodies:\n  - name: ship\n    shape: {sphere: {centre: [0, 0, 0], radius: 1}}\n" + keys;
}

inline const std::string everything =
    "schema_version: 1\n"
    "title: all\n"
    "domain:\n"
    "  max: [1, 1, 1]\n"
    "  spacing: 10 mm\n"
    "  boundaries: {x_min: periodic, x_max: periodic, y_min: {slip: slip_length, slip_length: 2 mm}, z_max: "
    "open}\n"
    "liquids:\n"
    "  - material: honey\n"
    "    viscosity: 7 cSt\n"
    "    velocity: [1 cm/s, 0, 0]\n"
    "    shapes:\n"
    "      - box: {min: [0, 0, 0], max: [2, 1, 1], rotation_angle: 17 deg}\n"
    "      - mesh: {file: \"a \\\"b\\\".ply\", fallback: {torus: {centre: [0, 0, 0], radius: 1, tube_radius: "
    "0.3}}}\n"
    "    viscosity_profile: {axis: z, interpolation: logarithmic, points: [{at: 0, viscosity: 1}, {at: 5 cm, "
    "viscosity: 10}]}\n"
    "    viscosity_regions: [{shape: {sphere: {centre: [0, 0, 0], radius: 1}}, viscosity: 3}]\n"
    "  - {name: paint, viscosity: 3, rheology: {law: carreau, exponent: 0.4, relaxation_time: 2 ms}, shapes: [{sphere: "
    "{centre: [3, 0, 0], radius: 1}}]}\n"
    "bodies:\n"
    "  - {kind: dynamic, density: 600, angular_velocity: [0, 0, 5 rpm], shape: {plane: {point: [0, 0, 0], "
    "normal: "
    "[0, 1, 1]}}}\n"
    "  - kind: kinematic\n"
    "    shape: {sphere: {centre: [0, 0, 0], radius: 1}}\n"
    "    keyframes: [{time: 0}, {time: 3 ms, translation: [1, 2, 3], rotation_angle: 1 deg}]\n"
    "joints: [{kind: slider, body: body, to: body_2, point: [0, 0, 0], axis: [1, 1, 0]}, {kind: ball, body: body, "
    "point: [1, 2, 3]}]\n"
    "time: {end: 2, rule: fixed, step: 1 ms}\n"
    "output: {interval: 20 ms, fields: [velocity], checkpoints_kept: 3}\n"
    "cameras: [{}, {name: side, position: [0, -3, 1], field_of_view: 40 deg}]\n"
    "measurements: [{kind: flow, axis: z, position: [0, 0, 0.1]}]\n"
    "max_lost_fraction: 1 %\n";

} // namespace treacle::scene
