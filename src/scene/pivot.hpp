#pragma once
// Private to src/scene.
#include "base/options/options.hpp"

#include <optional>
#include <string>

namespace treacle::scene {

// The block `pivot: {point: [x, y, z]}` [m], which may be absent.
inline void declare_pivot(
    Declaration& d, std::optional<Vec3>& pivot, const std::string& point_doc, const std::string& doc) {
    Vec3 point = pivot.value_or(Vec3{0, 0, 0});
    const bool present = d.optional_block(
        "pivot", pivot.has_value(),
        [&](Declaration& inside) {
            inside.vec3("point", point, unit::length, point_doc);
            inside.required("point");
        },
        doc);
    pivot = present ? std::optional(point) : std::nullopt;
}

} // namespace treacle::scene
