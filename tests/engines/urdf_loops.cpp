#include "engines/urdf_loops.hpp"

#include <gtest/gtest.h>

#include <regex>

namespace polyglide::engines {
namespace {

/// Everything between quotes after `key: ` in one of our YAML files.
std::vector<std::string> yaml_strings(const std::string& yaml, const std::string& key) {
  const std::size_t start = yaml.find(key + ": ");
  const std::string line = yaml.substr(start, yaml.find('\n', start) - start);
  const std::regex string("'([^']*)'");
  std::vector<std::string> strings;
  for (std::sregex_iterator it(line.begin(), line.end(), string), end; it != end; ++it)
    strings.push_back((*it)[1]);
  return strings;
}

/// By default MuJoCo melts links without a joint into their parents.
std::string with_links_kept(std::string urdf) {
  return urdf.insert(urdf.find('>', urdf.find("<robot")) + 1,
                     "<mujoco><compiler fusestatic=\"false\"/></mujoco>");
}

}  // namespace

UrdfLoops::UrdfLoops(const UrdfFiles& files)
    : mujoco_(with_links_kept(files.urdf)), columns_(mujoco_.velocities()) {
  const std::vector<std::string> frames = yaml_strings(files.loops, "closed_loop");
  const std::vector<std::string> types = yaml_strings(files.loops, "type");
  EXPECT_EQ(frames.size(), 2 * types.size());
  for (std::size_t i = 0; i < types.size(); ++i)
    close(frames[2 * i], frames[2 * i + 1], types[i] == "6d");
  follow(files.urdf);
  system_.rows = static_cast<int>(system_.residual.size());
  system_.columns = columns_;
  for (int c = 0; c < columns_; ++c) system_.column_is_length.push_back(mujoco_.is_slide(c));
  system_.column_is_driven.assign(columns_, false);
  for (const std::string& drive : yaml_strings(files.loops, "name_mot"))
    system_.column_is_driven[mujoco_.velocity_index(drive)] = true;
}

ConstraintSystem UrdfLoops::system(const std::string& platform) {
  system_.platform = mujoco_.body_jacobian(platform);
  return system_;
}

void UrdfLoops::add_row(bool length, double residual, const std::vector<double>& row) {
  system_.row_is_length.push_back(length);
  system_.residual.push_back(residual);
  system_.jacobian.insert(system_.jacobian.end(), row.begin(), row.end());
}

void UrdfLoops::close(const std::string& a, const std::string& b, bool rigid) {
  const auto ja = mujoco_.body_jacobian(a), jb = mujoco_.body_jacobian(b);
  const auto pa = mujoco_.body_pose(a), pb = mujoco_.body_pose(b);
  for (int r = rigid ? 0 : 3; r < 6; ++r) {
    std::vector<double> row(columns_);
    for (int c = 0; c < columns_; ++c) row[c] = ja[r * columns_ + c] - jb[r * columns_ + c];
    add_row(r >= 3, r >= 3 ? pa[r - 3] - pb[r - 3] : pa[4 + r] - pb[4 + r], row);
  }
}

/// MuJoCo does not know `mimic`.
void UrdfLoops::follow(const std::string& urdf) {
  const std::regex joint(
      "<joint name=\"([^\"]*)\"|<mimic joint=\"([^\"]*)\" multiplier=\"([^\"]*)\"");
  std::string name;
  for (std::sregex_iterator it(urdf.begin(), urdf.end(), joint), end; it != end; ++it) {
    if ((*it)[1].matched) {
      name = (*it)[1];
      continue;
    }
    std::vector<double> row(columns_, 0.0);
    row[mujoco_.velocity_index(name)] = 1;
    row[mujoco_.velocity_index((*it)[2])] = -std::stod((*it)[3]);
    add_row(true, 0, row);
  }
}

}  // namespace polyglide::engines
