#include "video/drawing/liquid_light.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::video {

namespace {
constexpr float clearest = 0.35f; // share of the light from behind that the thinnest film lets through

// The mirrored surroundings: a dim floor, a bright sky and the lamp as a soft disc.
float mirrored(const Vec3f& direction, const DirectionalLight& lamp, float lit) {
    const float height = 0.5f + 0.5f * dot(direction, lamp.up);
    const float sky = 0.50f + 0.60f * height * height;
    const float disc = std::clamp((dot(direction, lamp.towards) - 0.88f) / 0.08f, 0.0f, 1.0f);
    return sky + 5.0f * disc * disc * (3 - 2 * disc) * lit;
}

// Colour of a liquid with depth: the light that comes back has been filtered again and again.
Vec3f deepened(const Vec3f& albedo, float fraction) {
    Vec3f deep;
    for (int k = 0; k < 3; ++k) deep[k] = 0.85f * albedo[k] * std::sqrt(std::max(albedo[k], 0.0f));
    return mix(albedo, deep, fraction);
}
} // namespace

Vec3f shade_liquid(
    const Fragment& f, const DirectionalLight& lamp, const Vec3f& behind, float thickness, float attenuation_length) {
    const Vec3f into = normalised(f.point);
    const float facing = std::clamp(-dot(into, f.normal), 0.0f, 1.0f);
    // Light scatters inside the liquid before it leaves: the lamp reaches a little round the edge.
    const float wrapped = std::max(0.0f, (dot(f.normal, lamp.towards) + 0.35f) / 1.35f);
    const float sky = 0.34f + 0.18f * dot(f.normal, lamp.up) + 0.12f * facing;
    const Vec3f deep =
        attenuation_length > 0 ? deepened(f.albedo, 1 - std::exp(-0.12f * thickness / attenuation_length)) : f.albedo;
    const Vec3f own = (0.80f * wrapped * (0.35f + 0.65f * f.lit) + 1.1f * sky * f.open) * deep;
    Vec3f colour = own;
    if (attenuation_length > 0) {
        const float path = thickness / attenuation_length;
        const float through = clearest * std::exp(-path);
        Vec3f tinted = behind;
        for (int k = 0; k < 3; ++k) tinted[k] *= std::pow(std::max(f.albedo[k], 0.02f), 0.9f * std::min(path, 3.0f));
        colour = mix(own, tinted, through);
    }
    const float grazing = 1 - facing, power = grazing * grazing * grazing * grazing * grazing;
    const float fresnel = (0.04f + 0.55f * power) * (0.3f + 0.7f * f.open);
    const Vec3f mirror = into + (2 * facing) * f.normal;
    const float reflected = mirrored(mirror, lamp, f.lit);
    return mix(colour, Vec3f{reflected, reflected, reflected}, fresnel);
}

} // namespace treacle::video
