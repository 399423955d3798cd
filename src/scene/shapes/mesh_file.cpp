// Mesh files, and what is refused of them.
#include "base/text/error.hpp"
#include "scene/shapes/mesh.hpp"
#include "scene/shapes/vector_math.hpp"

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace treacle::scene {
namespace {

constexpr double most_rounding = 1e-4; // of the size of a mesh

// Debian's Assimp holds coordinates in 32 bits: far from the origin, as in maps, their rounding shows as stairs.
void require_precision(const TriangleMesh& mesh, const std::string& path, const std::string& where) {
    Vec3 low = mesh.vertices.front(), high = low;
    for (const Vec3& v : mesh.vertices)
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], v[a]);
            high[a] = std::max(high[a], v[a]);
        }
    double farthest = 0;
    Vec3 shift{0, 0, 0};
    for (int a = 0; a < 3; ++a) {
        farthest = std::max({farthest, std::abs(low[a]), std::abs(high[a])});
        const double middle = 0.5 * (low[a] + high[a]),
                     step = std::pow(10.0, std::floor(std::log10(std::max(1.0, std::abs(middle)))) - 2);
        shift[a] = 0 - step * std::round(middle / step);
    }
    const double rounding = 0x1p-24 * farthest, size = length(high - low);
    if (rounding <= most_rounding * size) return;
    std::ostringstream problem, reason, cure;
    problem << "mesh '" << path << "' lies " << farthest << " from the origin, and its size is " << size;
    reason << "coordinates are read in single precision, which rounds them by up to " << rounding
           << " there: " << 100 * rounding / size << " % of its size";
    cure.precision(12);
    cure << "move it to the origin before it is exported, for instance by [" << shift[0] << ", " << shift[1] << ", "
         << shift[2] << "], and domain, bodies and liquids with it";
    throw InputError({where, problem.str(), reason.str(), cure.str()});
}

std::string count(std::size_t n, const std::string& noun) {
    return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}

void reject_defects(const MeshReport& report, const std::string& where) {
    const std::string mesh = "mesh '" + report.path + "' ";
    if (report.duplicates > 0)
        throw InputError({where, mesh + "has " + count(report.duplicates, "duplicate triangle"),
            "what is given twice would count twice",
            "remove them in a mesh editor (MeshLab: Filters, Remove Duplicate Faces; Blender: Mesh, Merge by "
            "Distance)"});
    const std::size_t holes = report.open_edges - report.wall_edges;
    if (holes > 0)
        throw InputError({where,
            mesh + "is not closed: " + std::to_string(report.open_edges) + " open edges around " +
                count(report.holes, "hole") +
                (report.wall_edges > 0
                        ? ", " + std::to_string(report.wall_edges) + " of them where more than two triangles meet"
                        : ""),
            "an open surface has no inside",
            "fill the holes in a mesh editor (MeshLab: Filters, Close Holes; Blender: Mesh, Fill)"});
    if (!report.closed())
        throw InputError({where,
            mesh + "has inner walls: " + count(report.wall_edges, "edge") +
                " where a wall meets the surface from inside",
            "a wall within a solid has no inside of its own",
            "remove the walls in a mesh editor (Blender: Select, Interior Faces, then delete them)"});
    if (report.inwards > 0)
        throw InputError({where, mesh + "has parts whose triangles face inwards", "their inside would count as outside",
            "turn their normals outwards in a mesh editor (Blender: Mesh, Normals, Recalculate Outside)"});
}

} // namespace

TriangleMesh read_mesh(const std::string& path, const std::string& where) {
    Assimp::Importer importer;
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
        aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS | aiComponent_TEXCOORDS);
    const aiScene* file =
        importer.ReadFile(path, aiProcess_RemoveComponent | aiProcess_Triangulate | aiProcess_PreTransformVertices);
    if (file == nullptr)
        throw InputError(
            {where, "mesh '" + path + "' cannot be read", importer.GetErrorString(), "give a PLY, OBJ or STL file"});
    TriangleMesh mesh;
    for (unsigned m = 0; m < file->mNumMeshes; ++m) {
        const aiMesh& part = *file->mMeshes[m];
        const int offset = static_cast<int>(mesh.vertices.size());
        for (unsigned v = 0; v < part.mNumVertices; ++v)
            mesh.vertices.push_back({part.mVertices[v].x, part.mVertices[v].y, part.mVertices[v].z});
        for (unsigned f = 0; f < part.mNumFaces; ++f) {
            const aiFace& face = part.mFaces[f];
            if (face.mNumIndices != 3) continue; // loose points and lines bound nothing
            mesh.triangles.push_back({offset + static_cast<int>(face.mIndices[0]),
                offset + static_cast<int>(face.mIndices[1]), offset + static_cast<int>(face.mIndices[2])});
        }
    }
    if (mesh.triangles.empty())
        throw InputError({where, "mesh '" + path + "' holds no triangle", "a solid needs a surface", ""});
    if (!std::all_of(mesh.vertices.begin(), mesh.vertices.end(), is_finite))
        throw InputError({where, "mesh '" + path + "' holds a coordinate that is not a number", "", ""});
    require_precision(mesh, path, where);
    return mesh;
}

CheckedMesh load_closed_mesh(const std::string& path, const std::string& where) {
    CheckedMesh result = check_mesh(read_mesh(path, where));
    MeshReport& report = result.report;
    report.path = path;
    reject_defects(report, where);
    const Vec3 size = report.bounds.max - report.bounds.min;
    if (!(report.volume > 1e-12 * size[0] * size[1] * size[2]) || !(report.volume > 0))
        throw InputError({where, "mesh '" + path + "' encloses no volume", "a solid has an inside",
            "give the surface a thickness, or orient its triangles outwards"});
    return result;
}

} // namespace treacle::scene
