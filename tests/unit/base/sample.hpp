#pragma once
#include "base/options/options.hpp"
#include "base/text/error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace treacle {

enum class Colour { red, green };

struct Part {
    std::string name;
    double length = 0.5; // [m]
    double mass = 1;     // [kg]
    int disc = 0;        // 0 box, 1 disc
    Vec3 corner{0, 0, 0};
    double radius = 1;

    void declare(Declaration& d) {
        d.text("name", name, "Its name.");
        d.number("length", length, unit::length, range_above(0).because("lengths are positive", "write 5 mm"),
            "Its length.");
        d.number("mass", mass, unit::mass, range_any(), "Its mass.");
        d.one_of<int>(disc,
            {{0, {"box", [this](Declaration& b) { b.vec3("corner", corner, unit::length, "Corner."); }, "A box."}},
                {1, {"disc",
                        [this](Declaration& b) { b.number("radius", radius, unit::length, range_above(0), "Radius."); },
                        "A disc."}}});
    }
};

struct Side {
    Colour colour = Colour::red;
    int layers = 2;

    void declare(Declaration& d) {
        d.choice<Colour>("colour", colour, {{"red", Colour::red}, {"green", Colour::green}}, "Its colour.");
        d.integer("layers", layers, range_between(1, 9), "How many layers.");
    }
};

// One option of each kind.
struct Sample {
    double width = 0.25; // [m]
    bool hollow = false;
    std::string title = "plain";
    std::vector<std::string> tags{"a", "b"};
    Vec3 pull{0, 0, -9.81};
    Vec3 axis{0, 0, 1};
    Side side;
    std::vector<Part> parts;
    std::vector<Side> spare; // at most one

    void declare(Declaration& d) {
        d.number("width", width, unit::length, range_above_to(0, 10), "The width.");
        d.boolean("hollow", hollow, "Whether it is hollow.");
        d.text("title", title, "A title.");
        d.texts("tags", tags, "Labels.", {"a", "b", "c"});
        d.vec3("pull", pull, unit::acceleration, "The pull.");
        d.direction("axis", axis, "The axis.");
        d.block("side", side, "A side.", "colour");
        d.list("parts", parts, "The parts.");
        d.required("parts");
        d.check(width < 5 || hollow, "hollow", {"must be true for a wide one", "it would be heavy", "write true"});
        Side other = spare.empty() ? Side{} : spare[0];
        const bool present = d.optional_block(
            "spare", !spare.empty(), [&](Declaration& s) { other.declare(s); }, "Another side.");
        spare.clear();
        if (present) spare.push_back(other);
    }
};

inline Document document(const std::string& text) { return Document::from_text(text, "scene.yaml"); }

inline Sample read(const std::string& text, const std::vector<std::string>& overrides = {}) {
    auto source = document(text);
    for (const auto& assignment : overrides) source.set(assignment);
    Sample sample;
    parse(source, sample);
    return sample;
}

// The messages of the InputError that reading must throw.
inline std::vector<std::string> problems(const std::string& text, const std::vector<std::string>& overrides = {}) {
    std::vector<std::string> out;
    try {
        read(text, overrides);
    } catch (const InputError& error) {
        for (const auto& diagnostic : error.diagnostics()) out.push_back(diagnostic.text());
    }
    return out;
}

} // namespace treacle
