#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "catalog/mechanism.hpp"

namespace polyglide {

/// A surface of triangles. Pure value.
struct Mesh {
  std::vector<Vector3> vertices;
  std::vector<std::array<int, 3>> triangles;  ///< indices of vertices
};

/// Reads an STL file (binary or text) or an OBJ file (vertices and faces; faces with more corners
/// are cut into fans). Coordinates as they stand there. Nothing is read twice: who asks again
/// for a file that has not changed gets what was read before.
/// @param error what is wrong, as a rule for a message, when nullptr is returned.
[[nodiscard]] std::shared_ptr<const Mesh> read_mesh(const std::filesystem::path& file,
                                                    std::string& error);

/// `mesh` turned by `turn` [rad] about the z axis, scaled, then moved.
[[nodiscard]] Mesh placed(const Mesh& mesh, double scale, double turn, const Vector3& at);

}  // namespace polyglide
