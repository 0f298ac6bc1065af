#pragma once

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "support/run_program.hpp"

// Mechanism files for machines whose coordinates stand in the files of truth, metres and radians.
namespace polyglide::test {

using Eigen::Vector3d;

inline nlohmann::json numbers(const Eigen::VectorXd& v) {
  return std::vector<double>(v.begin(), v.end());
}

inline Vector3d point(const nlohmann::json& v) {
  return {v.at(0).get<double>(), v.at(1).get<double>(), v.size() > 2 ? v.at(2).get<double>() : 0};
}

/// A matrix from rows.
inline Eigen::Matrix3d matrix3(const nlohmann::json& rows) {
  Eigen::Matrix3d matrix;
  for (int i = 0; i < 3; ++i) matrix.row(i) = point(rows.at(i)).transpose();
  return matrix;
}

/// Numbers as one word of the command line, to the last bit.
inline std::string word(const std::vector<double>& numbers) {
  return fmt::format("{:.17g}", fmt::join(numbers, ","));
}

inline nlohmann::json truth(const std::string& file) {
  std::ifstream stream(POLYGLIDE_SOURCE_DIR "/tests/truth/" + file);
  return nlohmann::json::parse(stream);
}

/// A mechanism file in the making. The base is "base", the platform "platform".
class MachineFile {
 public:
  explicit MachineFile(const std::string& name, const Vector3d& tool = Vector3d::Zero())
      : document_{{"format", "polyglide/mechanism/1"},
                  {"name", name},
                  {"title", name},
                  {"source", "the case of truth of this name"},
                  {"units", {{"length", "m"}, {"angle", "rad"}}},
                  {"base", "base"},
                  {"platform", "platform"},
                  {"tool", numbers(tool)},
                  {"joints", nlohmann::json::array()}} {}

  /// A joint; its name can be completed with more words, as in `["drive"] = true`.
  nlohmann::json& joint(const std::string& type, const std::string& first,
                        const std::string& second, const Vector3d& at) {
    auto& joints = document_["joints"];
    joints.push_back({{"name", fmt::format("j{}", joints.size() + 1)},
                      {"type", type},
                      {"between", {first, second}},
                      {"at", numbers(at)}});
    return joints.back();
  }

  void hinge(const std::string& first, const std::string& second, const Vector3d& at,
             const Vector3d& axis, bool driven = false) {
    nlohmann::json& made = joint("revolute", first, second, at);
    made["axis"] = numbers(axis);
    if (driven) made["drive"] = true;
  }

  /// A driven telescope between base and platform; its ends are hinges about an axis, or balls.
  /// @param range of its lengthening, {} for none.
  void strut(const Vector3d& foot, const Vector3d& head,
             const std::vector<Vector3d>& foot_axis = {},
             const std::vector<Vector3d>& head_axis = {}, const std::vector<double>& range = {}) {
    const std::string leg = fmt::format("leg{}", ++limbs_);
    const auto end = [&](const std::string& first, const std::string& second, const Vector3d& at,
                         const std::vector<Vector3d>& axis) {
      if (axis.empty())
        joint("spherical", first, second, at);
      else
        hinge(first, second, at, axis.front());
    };
    end("base", leg + ".lower", foot, foot_axis);
    nlohmann::json& slide = joint("prismatic", leg + ".lower", leg + ".upper", foot);
    slide["axis"] = numbers((head - foot).normalized());
    slide["drive"] = true;
    if (!range.empty()) slide["range"] = range;
    end(leg + ".upper", "platform", head, head_axis);
  }

  /// Writes it. @return its path, as NAME for the program.
  [[nodiscard]] std::string in(const TemporaryFolder& folder) const {
    return folder.write(document_["name"].get<std::string>() + ".json", document_.dump(1));
  }

 private:
  nlohmann::json document_;
  int limbs_ = 0;
};

}  // namespace polyglide::test
