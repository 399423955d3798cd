#include "video/drawing/liquid_view.hpp"

#include "base/text/error.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

namespace treacle::video {

namespace {
constexpr double weight_unit = 1 << 20; // of a spline's weight in whole numbers
constexpr double length_unit = 1e-9;    // [m]
constexpr double kernel_width = 1.25;   // of the splines about particles, in spacings; their support is twice that
constexpr float caster_size = 0.5F;     // radius of the balls behind vertices that cast the shadow, in spacings

// Cubic B-spline of a distance in widths.
double spline(double s) {
    const double outer = std::max(0.0, 2 - s), inner = std::max(0.0, 1 - s);
    return (outer * outer * outer - 4 * (inner * inner * inner)) / 6;
}

std::vector<Sphere> corners_of(const Camera& camera, const LiquidScene& scene) {
    const auto& box = scene.domain;
    std::vector<Sphere> corners;
    corners.reserve(8);
    for (int i = 0; i < 8; ++i)
        corners.push_back({single(camera.to_camera({(i & 1) ? box.max[0] : box.min[0],
                               (i & 2) ? box.max[1] : box.min[1], (i & 4) ? box.max[2] : box.min[2]})),
            caster_size * float(scene.spacing)});
    return corners;
}
} // namespace

CutPlane facing(const CutPlane& cut, const Camera& camera) {
    const double size = length(cut.normal);
    if (!(size > 0) || !std::isfinite(size))
        throw InputError({"--cut", "the plane has no direction", "", "give a normal that is not zero"});
    CutPlane out{cut.point, (1 / size) * cut.normal};
    const double side = dot(out.normal, camera.position() - out.point);
    if (!(std::abs(side) > 1e-9 * length(camera.position() - out.point)))
        throw InputError({"--cut", "the camera stands in the plane", "it would see it as a line",
            "move the plane, or choose another camera"});
    if (side < 0) out.normal = -1.0 * out.normal;
    return out;
}

LiquidView::LiquidView(const LiquidScene& scene)
    : dimensions_(scene.domain.dimensions), camera_(scene.view), fine_(camera_.enlarged(samples)),
      spacing_(scene.spacing), range_(scene.range),
      shadows_(lamp_of(camera_, up_of(scene.domain)), corners_of(camera_, scene)),
      samples_(std::size_t(fine_.width()) * std::size_t(fine_.height())) {
    if (dimensions_ == 3) model_.emplace(camera_model(scene.view, "view"));
    if (dimensions_ == 2) {
        cut_normal_ = single(camera_.direction_to_camera({0, 0, 1}));
        cut_offset_ = dot(cut_normal_, single(camera_.to_camera({0, 0, 0})));
    } else if (scene.cut) {
        cut_ = facing(*scene.cut, camera_);
        cut_normal_ = single(camera_.direction_to_camera(cut_->normal));
        cut_offset_ = dot(cut_normal_, single(camera_.to_camera(cut_->point)));
    }
    if (dimensions_ == 2 || cut_) means_.resize(std::size_t(camera_.width()) * std::size_t(camera_.height()));
}

float LiquidView::map_position(double value) const {
    return float(std::clamp((value - range_.low) / (range_.high - range_.low), 0.0, 1.0));
}

bool LiquidView::Sample::hides(const Sample& other) const {
    return std::tie(depth, normal, value, liquid) < std::tie(other.depth, other.normal, other.value, other.liquid);
}

void LiquidView::add(const LiquidMesh& mesh) {
    if (dimensions_ == 3)
        add_space(mesh);
    else
        add_plane(mesh);
}

void LiquidView::add_space(const LiquidMesh& mesh) {
    const scene::Projection projection(*model_, {});
    scene::TriangleRaster raster(projection, samples);
    if (cut_) raster.keep({{cut_normal_[0], cut_normal_[1], cut_normal_[2]}, cut_offset_});
    struct Vertex {
        scene::Seen seen;
        Vec3f normal;
        float value;
    };
    std::vector<Vertex> vertices(mesh.vertices.size() / 3);
    std::vector<Sphere> casters;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        auto& to = vertices[v];
        to.seen = projection.see(&mesh.vertices[3 * v], nullptr);
        to.normal =
            single(fine_.direction_to_camera({mesh.normals[3 * v], mesh.normals[3 * v + 1], mesh.normals[3 * v + 2]}));
        to.value = mesh.values.empty() ? 0 : map_position(mesh.values[v]);
        const auto position = single(to.seen.camera);
        if (!cut_ || dot(cut_normal_, position) <= cut_offset_) {
            const float radius = caster_size * float(spacing_);
            casters.push_back({position - radius * to.normal, radius});
        }
    }
    shadows_.add(casters);
    for (const auto& t : mesh.triangles) {
        const Vertex* corner[3] = {
            &vertices[std::size_t(t[0])], &vertices[std::size_t(t[1])], &vertices[std::size_t(t[2])]};
        raster.draw(corner[0]->seen, corner[1]->seen, corner[2]->seen, [&](const scene::RasterSample& sample) {
            Sample found;
            found.depth = float(sample.depth);
            std::size_t most = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto weight = float(sample.barycentric[k]);
                for (std::size_t c = 0; c < 3; ++c) found.normal[c] += weight * corner[k]->normal[c];
                found.value += weight * corner[k]->value;
                if (sample.barycentric[k] > sample.barycentric[most]) most = k;
            }
            found.liquid = mesh.liquid.empty() ? 0 : mesh.liquid[std::size_t(t[most])];
            auto& to = samples_[std::size_t(sample.row * raster.width() + sample.column)];
            found.crossings = to.crossings + (sample.front ? 1 : -1);
            const auto length = std::llround(sample.depth / length_unit);
            found.thickness = to.thickness + (sample.front ? -length : length);
            if (found.hides(to)) {
                to = found;
            } else {
                to.crossings = found.crossings;
                to.thickness = found.thickness;
            }
        });
    }
}

// Rows of samples between the segments that bound the liquid: how often it turns about each.
void LiquidView::add_plane(const LiquidMesh& mesh) {
    const int width = fine_.width(), height = fine_.height();
    std::vector<std::int32_t> change(std::size_t(width + 1) * std::size_t(height), 0);
    const auto see = [&](int v) {
        return fine_.project({mesh.vertices[3 * std::size_t(v)], mesh.vertices[3 * std::size_t(v) + 1], 0});
    };
    for (const auto& segment : mesh.triangles) {
        const auto a = see(segment[0]), b = see(segment[1]);
        const double low = std::min(a.y, b.y), high = std::max(a.y, b.y);
        for (int row = int(std::max(0.0, std::ceil(low - 0.5))); row < height && row + 0.5 < high; ++row) {
            const double x = a.x + (row + 0.5 - a.y) / (b.y - a.y) * (b.x - a.x);
            const int column = int(std::clamp(std::ceil(x - 0.5), 0.0, double(width)));
            change[std::size_t(row) * std::size_t(width + 1) + std::size_t(column)] += a.y < b.y ? 1 : -1;
        }
    }
    for (int row = 0; row < height; ++row) {
        std::int32_t turns = 0;
        for (int column = 0; column < width; ++column) {
            turns += change[std::size_t(row) * std::size_t(width + 1) + std::size_t(column)];
            samples_[std::size_t(row) * std::size_t(width) + std::size_t(column)].crossings += turns;
        }
    }
}

bool LiquidView::section_point(const Camera& camera, int column, int row, Vec3f& point) const {
    const Ray ray = ray_through(camera, float(column) + 0.5F, float(row) + 0.5F);
    const float along = dot(cut_normal_, ray.direction);
    if (along == 0) return false;
    const float depth = (cut_offset_ - dot(cut_normal_, ray.origin)) / along;
    point = ray.origin + depth * ray.direction;
    return depth > float(scene::Projection::near);
}

void LiquidView::add(const LiquidPoints& points) {
    if (means_.empty()) return;
    const float radius = 2 * float(kernel_width * spacing_);
    for (std::size_t i = 0; i < points.positions.size() / 3; ++i) {
        const auto centre = single(
            camera_.to_camera({points.positions[3 * i], points.positions[3 * i + 1], points.positions[3 * i + 2]}));
        if (std::abs(dot(cut_normal_, centre) - cut_offset_) >= radius) continue;
        const PixelBox box = pixels_of(camera_, {centre, radius});
        const double value = points.values.empty() ? 0 : double(map_position(points.values[i]));
        for (int row = box.top; row < box.bottom; ++row)
            for (int column = box.left; column < box.right; ++column) {
                Vec3f point;
                if (!section_point(camera_, column, row, point)) continue;
                const auto apart = point - centre;
                const float square = dot(apart, apart);
                if (square >= radius * radius) continue;
                auto& mean = means_[std::size_t(row) * std::size_t(camera_.width()) + std::size_t(column)];
                const auto weight =
                    std::llround(weight_unit * spline(std::sqrt(double(square)) / (kernel_width * spacing_)));
                mean.weight += weight;
                mean.value += std::llround(double(weight) * value * 1024);
                const int liquid = points.liquid.empty() ? 0 : int(points.liquid[i]);
                if (std::tie(square, liquid) < std::tie(mean.nearest, mean.liquid)) {
                    mean.nearest = square;
                    mean.liquid = liquid;
                }
            }
    }
}

// The pixel's, or that of a neighbour where no particle is near enough.
const LiquidView::Mean& LiquidView::mean_near(int column, int row) const {
    const auto mean = [&](int c, int r) -> const Mean& {
        c = std::clamp(c, 0, camera_.width() - 1);
        r = std::clamp(r, 0, camera_.height() - 1);
        return means_[std::size_t(r) * std::size_t(camera_.width()) + std::size_t(c)];
    };
    for (int ring = 0; ring < 8; ++ring)
        for (int dr = -ring; dr <= ring; ++dr)
            for (int dc = -ring; dc <= ring; ++dc)
                if (mean(column + dc, row + dr).weight > 0) return mean(column + dc, row + dr);
    return mean(column, row);
}

LiquidView::Seen LiquidView::at(int column, int row) const {
    const auto& sample = samples_[std::size_t(row) * std::size_t(fine_.width()) + std::size_t(column)];
    Seen seen;
    seen.thickness = float(double(sample.thickness) * length_unit);
    const bool in_section = dimensions_ == 2 ? sample.crossings != 0 : cut_ && sample.crossings < 0;
    Vec3f point;
    if (in_section && section_point(fine_, column, row, point)) {
        const auto& mean = mean_near(column / samples, row / samples);
        seen.depth = point[2];
        seen.normal = cut_normal_;
        seen.value = mean.weight > 0 ? float(double(mean.value) / (1024.0 * double(mean.weight))) : 0;
        seen.liquid = mean.liquid;
        if (dimensions_ == 3) seen.thickness -= point[2];
        seen.section = true;
        return seen;
    }
    if (dimensions_ == 2 || sample.depth == far_away) return seen;
    seen.depth = sample.depth;
    seen.value = sample.value;
    seen.liquid = sample.liquid;
    // Means of normals may turn away from the camera at the outline.
    const Ray ray = ray_through(fine_, float(column) + 0.5F, float(row) + 0.5F);
    const auto into = normalised(ray.direction);
    const float away = dot(sample.normal, into);
    seen.normal = away > 0 ? sample.normal - away * into : Vec3f(sample.normal);
    const float size = length(seen.normal);
    seen.normal = size > 0 ? (1 / size) * seen.normal : -1.0F * into;
    return seen;
}

namespace {
template <class T>
void put(std::vector<char>& bytes, const T* values, std::size_t count) {
    const auto* from = reinterpret_cast<const char*>(values);
    bytes.insert(bytes.end(), from, from + count * sizeof(T));
}

class Reader {
public:
    explicit Reader(std::span<const char> bytes) : bytes_(bytes) {}
    template <class T>
    void get(T* values, std::size_t count) {
        std::memcpy(values, bytes_.data() + at_, count * sizeof(T));
        at_ += count * sizeof(T);
    }

private:
    std::span<const char> bytes_;
    std::size_t at_ = 0;
};
} // namespace

std::vector<char> LiquidView::pack() const {
    std::vector<char> bytes;
    std::vector<std::uint32_t> pixels;
    for (std::size_t i = 0; i < samples_.size(); ++i)
        if (samples_[i].depth < far_away || samples_[i].crossings != 0) pixels.push_back(std::uint32_t(i));
    const std::uint64_t count = pixels.size();
    put(bytes, &count, 1);
    put(bytes, pixels.data(), pixels.size());
    for (const auto i : pixels) put(bytes, &samples_[i], 1);
    put(bytes, means_.data(), means_.size());
    put(bytes, shadows_.depth().data(), shadows_.depth().size());
    return bytes;
}

void LiquidView::merge(std::span<const char> packed) {
    Reader reader(packed);
    std::uint64_t count = 0;
    reader.get(&count, 1);
    std::vector<std::uint32_t> pixels(count);
    reader.get(pixels.data(), count);
    for (const auto i : pixels) {
        Sample other;
        reader.get(&other, 1);
        auto& to = samples_[i];
        other.crossings += to.crossings;
        other.thickness += to.thickness;
        if (other.hides(to)) {
            to = other;
        } else {
            to.crossings = other.crossings;
            to.thickness = other.thickness;
        }
    }
    for (auto& to : means_) {
        Mean other;
        reader.get(&other, 1);
        to.weight += other.weight;
        to.value += other.value;
        if (std::tie(other.nearest, other.liquid) < std::tie(to.nearest, to.liquid)) {
            to.nearest = other.nearest;
            to.liquid = other.liquid;
        }
    }
    std::vector<float> depth(shadows_.depth().size());
    reader.get(depth.data(), depth.size());
    shadows_.merge(depth);
}

} // namespace treacle::video
