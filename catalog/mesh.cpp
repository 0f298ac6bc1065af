#include "catalog/mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>

namespace polyglide {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHeader = 84, kRecord = 50;  // of a binary STL file

void add_triangle(Mesh& mesh, const std::array<Vector3, 3>& corners) {
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
  mesh.triangles.push_back({first, first + 1, first + 2});
}

bool is_binary_stl(const std::string& content) {
  if (content.size() < kHeader) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, content.data() + 80, 4);
  return content.size() == kHeader + std::size_t{count} * kRecord;
}

/// Little-endian floats, as the machines that this is built for have them.
Mesh read_binary_stl(const std::string& content) {
  static_assert(std::endian::native == std::endian::little);
  Mesh mesh;
  for (std::size_t at = kHeader; at + kRecord <= content.size(); at += kRecord) {
    float numbers[12];
    std::memcpy(numbers, content.data() + at, sizeof numbers);
    std::array<Vector3, 3> corners;
    for (int i = 0; i < 9; ++i) corners[i / 3][i % 3] = numbers[3 + i];
    add_triangle(mesh, corners);
  }
  return mesh;
}

Mesh read_text_stl(const std::string& content) {
  Mesh mesh;
  std::istringstream words(content);
  std::array<Vector3, 3> corners;
  int known = 0;
  for (std::string word; words >> word;) {
    if (word == "facet") known = 0;
    if (word != "vertex" || known > 2) continue;
    Vector3& corner = corners[known];
    if (!(words >> corner[0] >> corner[1] >> corner[2])) return {};
    if (++known == 3) add_triangle(mesh, corners);
  }
  return mesh;
}

/// "7", "7/1/2", "-1": index of a vertex, counted from 1, or back from the last; -1 when wrong.
int vertex_index(const std::string& word, int count) {
  int number = 0;
  try {
    number = std::stoi(word);
  } catch (const std::exception&) {
    return -1;
  }
  const int index = number > 0 ? number - 1 : count + number;
  return number != 0 && index >= 0 && index < count ? index : -1;
}

Mesh read_obj(const std::string& content) {
  Mesh mesh;
  std::istringstream lines(content);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Vector3 vertex;
      if (!(words >> vertex[0] >> vertex[1] >> vertex[2])) return {};
      mesh.vertices.push_back(vertex);
    } else if (word == "f") {
      std::vector<int> corners;
      while (words >> word) {
        corners.push_back(vertex_index(word, static_cast<int>(mesh.vertices.size())));
        if (corners.back() < 0) return {};
      }
      for (std::size_t i = 2; i < corners.size(); ++i)
        mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
  }
  return mesh;
}

std::string ending(const fs::path& file) {
  std::string word = file.extension().string();
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word;
}

std::shared_ptr<const Mesh> read_anew(const fs::path& file, std::string& error) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    error = "there is no such file that could be read: " + file.string();
    return nullptr;
  }
  const std::string content(std::istreambuf_iterator<char>(stream), {});
  const Mesh mesh = ending(file) == ".obj"   ? read_obj(content)
                    : is_binary_stl(content) ? read_binary_stl(content)
                                             : read_text_stl(content);
  const bool finite =
      std::ranges::all_of(mesh.vertices, [](const Vector3& v) { return v.allFinite(); });
  if (mesh.triangles.empty() || !finite) {
    error = "must be an STL or OBJ file with at least one triangle, and all its numbers finite";
    return nullptr;
  }
  return std::make_shared<const Mesh>(mesh);
}

}  // namespace

std::shared_ptr<const Mesh> read_mesh(const fs::path& file, std::string& error) {
  struct Known {
    fs::file_time_type written;
    std::shared_ptr<const Mesh> mesh;
  };
  static std::mutex mutex;
  static std::map<std::string, Known> known;
  if (ending(file) != ".stl" && ending(file) != ".obj") {
    error = "the name of a mesh must end in .stl or .obj";
    return nullptr;
  }
  std::error_code missing;
  const auto written = fs::last_write_time(file, missing);
  const std::lock_guard lock(mutex);
  const auto found = known.find(file.string());
  if (found != known.end() && !missing && found->second.written == written)
    return found->second.mesh;
  auto mesh = read_anew(file, error);
  if (mesh) known[file.string()] = {written, mesh};
  return mesh;
}

Mesh placed(const Mesh& mesh, double scale, double turn, const Vector3& at) {
  Mesh result = mesh;
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(turn, Vector3::UnitZ()).toRotationMatrix() * scale;
  for (Vector3& vertex : result.vertices) vertex = rotation * vertex + at;
  return result;
}

}  // namespace polyglide
