#include "video/drawing/rasteriser.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/drawing/liquid_light.hpp"
#include "video/drawing/overlay.hpp"
#include "video/drawing/palette.hpp"
#include "video/drawing/scenery.hpp"
#include "video/drawing/section.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace treacle::video {

namespace {
constexpr int samples = LiquidView::samples; // per pixel along each side
constexpr float plane_relief = 0.45f;        // share of the lamp in 2D scenes, where value matters more than shape

// A layer's balls in camera axes.
struct PreparedLayer {
    const ParticleLayer* source;
    ValueRange range;
    std::vector<Sphere> spheres;
    std::vector<float> map_positions; // of the values on the colour map, [0, 1]; empty: one colour
    Vec3f colour;
    std::array<Vec3f, 256> map; // linear
    float gloss;

    Vec3f albedo_at(float position) const { return map[std::size_t(std::lround(255 * position))]; }
    Vec3f albedo(std::size_t i) const { return map_positions.empty() ? colour : albedo_at(map_positions[i]); }
};

void check(const ParticleLayer& layer) {
    const auto refuse = [&](const std::string& problem, const std::string& cure) {
        throw InputError({"picture of " + layer.name, problem, "", cure});
    };
    const std::size_t n = layer.positions.size() / 3;
    if (layer.positions.size() != 3 * n) refuse("positions are not triples", "give [n][3] coordinates");
    if (!layer.values.empty() && layer.values.size() != n)
        refuse(std::to_string(layer.values.size()) + " values for " + std::to_string(n) + " particles",
            "give one value per particle");
    if (n > std::size_t(std::numeric_limits<std::int32_t>::max()))
        refuse(std::to_string(n) + " particles are more than a picture can tell apart", "draw every second one");
    if (n > 0 && !(layer.radius > 0 && std::isfinite(layer.radius)))
        refuse("radius = " + format_number(layer.radius) + " m: must be > 0", "half of the particle spacing");
    if (!(layer.opacity > 0 && layer.opacity <= 1))
        refuse("opacity = " + format_number(layer.opacity) + ": must be in (0, 1]", "1 hides what lies behind");
    if (layer.range && !(layer.range->low < layer.range->high)) refuse("range of values is empty", "give low < high");
    const auto bad =
        std::find_if(layer.positions.begin(), layer.positions.end(), [](double x) { return !std::isfinite(x); });
    if (bad != layer.positions.end())
        throw SimulationError({"picture of " + layer.name,
            "the position of particle " + std::to_string((bad - layer.positions.begin()) / 3) + " is not finite",
            "the simulation has failed before this frame", "draw an earlier frame"});
}

// True when a wall's particle stands between the camera and the inside of the domain.
bool hides_inside(const Vec3& p, const DomainBox& box, const Vec3& camera, double margin) {
    for (int a = 0; a < box.dimensions; ++a) {
        if (camera[a] < box.min[a] && p[a] < box.min[a] + margin) return true;
        if (camera[a] > box.max[a] && p[a] > box.max[a] - margin) return true;
    }
    return false;
}

// `cut`: towards the camera.
PreparedLayer prepare(const ParticleLayer& layer, const RenderRequest& request, const Camera& camera,
    const std::optional<CutPlane>& cut) {
    check(layer);
    PreparedLayer out{&layer, {}, {}, {}, to_linear(layer.colour.value_or(default_colour(layer.kind))), {}, 0.22f};
    if (layer.kind == LayerKind::wall) out.gloss = 0;
    const bool valued = !layer.values.empty();
    if (valued) {
        const ValueRange found = robust_range(layer.values, layer.map); // also throws for bad values
        out.range = layer.range.value_or(found);
        for (int k = 0; k < 256; ++k) out.map[k] = to_linear(colour_of(layer.map, k / 255.0));
        out.gloss *= 0.6f;
    }
    const std::size_t n = layer.positions.size() / 3;
    out.spheres.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3 p{layer.positions[3 * i], layer.positions[3 * i + 1], layer.positions[3 * i + 2]};
        if (layer.kind == LayerKind::wall && hides_inside(p, request.domain, camera.position(), 2 * layer.radius))
            continue;
        if (cut && dot(cut->normal, p - cut->point) > 0) continue;
        out.spheres.push_back({single(camera.to_camera(p)), float(layer.radius)});
        if (!valued) continue;
        const double position = (layer.values[i] - out.range.low) / (out.range.high - out.range.low);
        out.map_positions.push_back(float(std::clamp(position, 0.0, 1.0)));
    }
    return out;
}

// Parts of one picture.
struct Scene {
    const RenderRequest& request;
    Camera camera, fine; // per pixel and per sample
    Palette palette;
    DirectionalLight lamp;
    std::optional<CutPlane> cut; // towards the camera
    std::vector<PreparedLayer> layers;
    ShadowMap shadows;
    std::vector<float> liquid; // depth of the liquid's surface per sample; empty without one

    bool is_flat() const { return request.lighting == Lighting::flat; }
    bool is_plane() const { return request.domain.dimensions == 2; }
};

Vec3f background_at(const Palette& palette, int row, int height) {
    return mix(palette.top, palette.bottom, (row + 0.5f) / height);
}

Vec3f finish(const Scene& scene, Fragment f, int column, int row, float open) {
    if (scene.is_flat()) return f.albedo;
    f.open = open;
    if (scene.is_plane()) return mix(f.albedo, shade(f, scene.lamp), plane_relief);
    f.lit = scene.shadows.light_at(f.point, (row % samples) * samples + column % samples);
    return shade(f, scene.lamp);
}

Fragment sphere_fragment(
    const Scene& scene, const PreparedLayer& layer, std::size_t k, float depth, int column, int row) {
    const Ray ray = ray_through(scene.fine, column + 0.5f, row + 0.5f);
    const Vec3f point = ray.origin + depth * ray.direction;
    const auto& [centre, radius] = layer.spheres[k];
    return {point, (1 / radius) * (point - centre), layer.albedo(k), layer.gloss};
}

// Pixels that a layer adds to, and how.
struct Pass {
    DepthBuffer buffer;
    std::vector<float> open; // ambient occlusion per pixel of the picture
};

Pass draw_pass(const Scene& scene, const PreparedLayer& layer, const std::vector<float>& others) {
    Pass pass{DepthBuffer(scene.fine.width(), scene.fine.height()), {}};
    splat(scene.fine, layer.spheres, pass.buffer);
    std::vector<float> nearest = others;
    for (std::size_t i = 0; i < nearest.size(); ++i) nearest[i] = std::min(nearest[i], pass.buffer.depth[i]);
    const auto depth = reduce_depth(nearest, scene.fine.width(), scene.fine.height(), samples);
    if (!scene.is_flat()) pass.open = ambient_occlusion(scene.camera, depth, 5 * float(layer.source->radius));
    return pass;
}

float open_at(const std::vector<float>& open, const Scene& scene, int column, int row) {
    if (open.empty()) return 1;
    return open[std::size_t(row / samples) * scene.camera.width() + column / samples];
}

void composite_spheres(
    const Scene& scene, const PreparedLayer& layer, const Pass& pass, std::vector<float>& depth, Canvas& canvas) {
    const float opacity = float(layer.source->opacity);
    for (int row = 0; row < canvas.height; ++row)
        for (int column = 0; column < canvas.width; ++column) {
            const std::size_t i = std::size_t(row) * canvas.width + column;
            const auto k = pass.buffer.sphere[i];
            if (k == no_sphere || !(pass.buffer.depth[i] < depth[i])) continue;
            const Fragment f = sphere_fragment(scene, layer, std::size_t(k), pass.buffer.depth[i], column, row);
            const Vec3f light = finish(scene, f, column, row, open_at(pass.open, scene, column, row));
            canvas.light[i] = opacity < 1 ? mix(canvas.light[i], light, opacity) : light;
            if (opacity == 1) depth[i] = pass.buffer.depth[i];
        }
}

// Solids that are cut: their colour, hatched as on a drawing.
void composite_section(const Scene& scene, std::vector<float>& depth, Canvas& canvas) {
    if (!scene.cut || !scene.request.solid_distance) return;
    const auto section = draw_section(scene.fine, *scene.cut, scene.request.solid_distance);
    const Vec3f colour = to_linear(default_colour(LayerKind::body));
    const int step = std::max(4, canvas.height / 60);
    for (int row = 0; row < canvas.height; ++row)
        for (int column = 0; column < canvas.width; ++column) {
            const std::size_t i = std::size_t(row) * canvas.width + column;
            if (!(section[i] < depth[i])) continue;
            depth[i] = section[i];
            const bool line = !scene.is_flat() && (row + column) % step < std::max(1, step / 6);
            canvas.light[i] = line ? 0.45f * colour : colour;
        }
}

Vec3f own_colour(const LiquidLayer& layer, int liquid) {
    const auto number = std::size_t(std::max(liquid, 0));
    return to_linear(number < layer.colours.size() ? layer.colours[number] : colour_of_liquid(liquid));
}

void composite_liquid(const Scene& scene, std::vector<float>& depth, Canvas& canvas) {
    const auto& layer = *scene.request.liquid;
    std::array<Vec3f, 256> map{};
    for (int k = 0; k < 256; ++k) map[k] = to_linear(colour_of(layer.map, k / 255.0));
    std::vector<float> nearest = depth;
    for (std::size_t i = 0; i < nearest.size(); ++i) nearest[i] = std::min(nearest[i], scene.liquid[i]);
    std::vector<float> open;
    if (!scene.is_flat())
        open = ambient_occlusion(
            scene.camera, reduce_depth(nearest, canvas.width, canvas.height, samples), 6 * float(layer.spacing));
    const Vec3 size = scene.request.domain.max - scene.request.domain.min;
    const float attenuation_length = layer.has_values ? 0 : 0.045f * float(length(size));
    // Balls that cast the shadows touch the surface from within; none of them may shade its own place.
    const float lift = float(layer.spacing);
    const Canvas behind = canvas;
    for (int row = 0; row < canvas.height; ++row)
        for (int column = 0; column < canvas.width; ++column) {
            const std::size_t i = std::size_t(row) * canvas.width + column;
            if (!(scene.liquid[i] < depth[i])) continue;
            depth[i] = scene.liquid[i];
            const auto seen = layer.view->at(column, row);
            const Ray ray = ray_through(scene.fine, column + 0.5f, row + 0.5f);
            Fragment f{ray.origin + depth[i] * ray.direction, seen.normal,
                layer.has_values ? map[std::size_t(std::lround(255 * seen.value))] : own_colour(layer, seen.liquid)};
            // Sections are there to read values from.
            if (scene.is_flat() || seen.section) {
                canvas.light[i] = f.albedo;
                continue;
            }
            f.open = open_at(open, scene, column, row);
            f.lit = scene.shadows.light_at(f.point + lift * f.normal, (row % samples) * samples + column % samples);
            // Light bends towards the normal inside: the scene behind seems shifted.
            const float bend = 0.06f * float(canvas.height);
            const int c = std::clamp(int(column + bend * f.normal[0]), 0, canvas.width - 1);
            const int r = std::clamp(int(row + bend * f.normal[1]), 0, canvas.height - 1);
            canvas.light[i] = shade_liquid(f, scene.lamp, behind.light[std::size_t(r) * canvas.width + c],
                seen.thickness * length(ray.direction), attenuation_length);
        }
}

void paint_ground(const Scene& scene, DepthBuffer& ground, Canvas& canvas, float radius) {
    const bool shown = scene.request.scenery == Scenery::box_and_floor;
    if (shown && !scene.is_flat()) add_floor(scene.fine, scene.request.domain, ground);
    std::vector<float> open;
    if (shown && !scene.is_flat()) {
        DepthBuffer all(scene.camera.width(), scene.camera.height());
        std::vector<float> nearest = ground.depth;
        for (std::size_t i = 0; i < scene.liquid.size(); ++i) nearest[i] = std::min(nearest[i], scene.liquid[i]);
        all.depth = reduce_depth(nearest, canvas.width, canvas.height, samples);
        for (const auto& layer : scene.layers)
            if (layer.source->kind != LayerKind::wall) splat(scene.camera, layer.spheres, all);
        open = ambient_occlusion(scene.camera, all.depth, radius);
    }
    for (int row = 0; row < canvas.height; ++row)
        for (int column = 0; column < canvas.width; ++column) {
            const std::size_t i = std::size_t(row) * canvas.width + column;
            canvas.light[i] = background_at(scene.palette, row, canvas.height);
            if (ground.sphere[i] != floor_plane) continue;
            const Ray ray = ray_through(scene.fine, column + 0.5f, row + 0.5f);
            const float lit =
                scene.shadows.light_at(ground.depth[i] * ray.direction, (row % samples) * samples + column % samples);
            const float light = (0.45f + 0.55f * lit) * (0.5f + 0.5f * open_at(open, scene, column, row));
            canvas.light[i] = light * scene.palette.floor;
        }
}

Image develop(const Canvas& canvas) {
    static const auto codes = [] {
        std::vector<std::uint8_t> table(1 << 16);
        for (std::size_t i = 0; i < table.size(); ++i) {
            const float v = i / 65535.0f;
            table[i] = to_display({v, v, v})[0];
        }
        return table;
    }();
    Image image{canvas.width / samples, canvas.height / samples, {}};
    image.pixels.resize(3 * std::size_t(image.width) * image.height);
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column) {
            Vec3f sum{0, 0, 0};
            for (int y = 0; y < samples; ++y)
                for (int x = 0; x < samples; ++x)
                    sum = sum + canvas.light[std::size_t(row * samples + y) * canvas.width + column * samples + x];
            for (int k = 0; k < 3; ++k) {
                const float v = std::clamp(sum[k] / (samples * samples), 0.0f, 1.0f);
                image.pixels[3 * (std::size_t(row) * image.width + column) + k] =
                    codes[std::size_t(std::lround(v * 65535))];
            }
        }
    return image;
}

std::vector<Sphere> shadow_casters(const std::vector<PreparedLayer>& layers) {
    std::vector<Sphere> casters;
    for (const auto& layer : layers)
        if (layer.source->kind != LayerKind::wall && layer.source->opacity == 1)
            casters.insert(casters.end(), layer.spheres.begin(), layer.spheres.end());
    return casters;
}

Scene set_scene(const RenderRequest& request) {
    const Camera camera(request.view ? *request.view : automatic_view(request.domain, 1280, 720));
    std::optional<CutPlane> cut;
    if (request.cut) cut = facing(*request.cut, camera);
    std::vector<PreparedLayer> layers;
    for (const auto& layer : request.layers) layers.push_back(prepare(layer, request, camera, cut));
    const DirectionalLight lamp = lamp_of(camera, up_of(request.domain));
    // Opaque layers first: what shines through translucent ones.
    std::stable_sort(layers.begin(), layers.end(), [](const PreparedLayer& a, const PreparedLayer& b) {
        return (a.source->opacity == 1) > (b.source->opacity == 1);
    });
    const bool lit = request.domain.dimensions == 3 && request.lighting == Lighting::shaded;
    const auto casters = lit ? shadow_casters(layers) : std::vector<Sphere>{};
    auto shadows = request.liquid ? request.liquid->view->shadows() : ShadowMap(lamp, casters);
    shadows.add(casters);
    const Camera fine = camera.enlarged(samples);
    std::vector<float> liquid;
    if (request.liquid) {
        for (int row = 0; row < fine.height(); ++row)
            for (int column = 0; column < fine.width(); ++column)
                liquid.push_back(request.liquid->view->at(column, row).depth);
    }
    return {request, camera, fine, palette_of(request.background), lamp, cut, std::move(layers), std::move(shadows),
        std::move(liquid)};
}

void draw_legend(const Scene& scene, Image& image) {
    if (const auto& liquid = scene.request.liquid; liquid && liquid->has_values)
        return draw_colour_bar(image,
            {liquid->title, liquid->map, liquid->range, liquid->has_lower, liquid->has_higher}, scene.palette.ink);
    for (const auto& layer : scene.layers) {
        if (layer.source->values.empty()) continue;
        Legend legend{layer.source->title, layer.source->map, layer.range};
        for (const double value : layer.source->values) {
            legend.has_lower |= value < layer.range.low;
            legend.has_higher |= value > layer.range.high;
        }
        draw_colour_bar(image, legend, scene.palette.ink);
        return;
    }
}
} // namespace

std::string caption_of(const std::string& name, double time, std::size_t particles) {
    char clock[48];
    std::snprintf(clock, sizeof clock, "t = %.3f s", time);
    std::string count = std::to_string(particles);
    for (int index = int(count.size()) - 3; index > 0; index -= 3) count.insert(std::size_t(index), " ");
    return (name.empty() ? "" : name + "    ") + clock + "    " + count + " particles";
}

Rgb8 colour_of_liquid(int number) {
    constexpr Rgb8 colours[] = {
        {214, 128, 24}, {44, 122, 190}, {112, 168, 60}, {168, 60, 92}, {120, 96, 180}, {60, 160, 150}};
    return colours[std::size_t(std::max(number, 0)) % std::size(colours)];
}

Image render_frame(const RenderRequest& request) {
    const Scene scene = set_scene(request);
    const int width = scene.fine.width(), height = scene.fine.height();
    Canvas canvas{width, height, std::vector<Vec3f>(std::size_t(width) * height)};
    DepthBuffer ground(width, height);
    float radius = 0;
    for (const auto& layer : request.layers) radius = std::max(radius, 10 * float(layer.radius));
    if (request.liquid) radius = std::max(radius, 5 * float(request.liquid->spacing));
    paint_ground(scene, ground, canvas, radius);
    std::vector<float> depth = std::move(ground.depth);
    for (const auto& layer : scene.layers)
        composite_spheres(scene, layer, draw_pass(scene, layer, depth), depth, canvas);
    composite_section(scene, depth, canvas);
    if (request.liquid) composite_liquid(scene, depth, canvas);
    if (request.scenery == Scenery::box_and_floor)
        draw_box(scene.fine, request.domain, depth, {scene.palette.lines, float(height) / 720, 0.7f}, canvas);
    Image image = develop(canvas);
    draw_legend(scene, image);
    if (!request.caption.empty()) draw_caption(image, request.caption, scene.palette.ink);
    return image;
}

} // namespace treacle::video
