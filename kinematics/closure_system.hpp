#pragma once

#include "kinematics/parametric_root.hpp"
#include "kinematics/screw_chain.hpp"

namespace polyglide {

/// Bodies and joints that hang together when base and platform are held, such as one limb: its
/// loops close through both. Variables are the model's freedoms, spherical joints three turns about
/// base z, y, x from home, then x y z a b c of the platform; translations per size.
struct ClosurePart {
  std::vector<ScrewLoop> loops;
  std::vector<int> unknowns;  ///< variables that the loops determine
  std::vector<int> columns;   ///< per variable: index among unknowns, then parameters, or -1
};

/// The loops of a machine with the platform's commanded coordinates as parameters. Fixed; needs
/// UpwardRounding.
class ClosureSystem {
 public:
  /// nullopt where a drive, a limited joint or what a cone or a plane watches moves although the
  /// platform stands still, or a rank is in doubt at home.
  [[nodiscard]] static std::optional<ClosureSystem> make(const Machine& machine);

  [[nodiscard]] const std::vector<ClosurePart>& parts() const { return parts_; }
  /// The platform's coordinates that are commanded, of 0 to 5: the parameters.
  [[nodiscard]] const std::vector<int>& commanded() const { return commanded_; }
  /// The variable of a coordinate of the platform.
  [[nodiscard]] int pose_variable(int coordinate) const {
    return static_cast<int>(model_->freedoms.size()) + coordinate;
  }
  [[nodiscard]] int variables() const { return pose_variable(6); }
  /// The part that determines a variable, -1 for none.
  [[nodiscard]] int part_of(int variable) const { return owner_[variable]; }

  /// Ways of joints from the base to the platform: one per loop through both.
  [[nodiscard]] const std::vector<std::vector<LoopStep>>& limbs() const { return limbs_; }

  /// From the base to a body.
  [[nodiscard]] ScrewChain chain_to(int body) const { return chain_along(paths_[body]); }

  /// The loops of one part.
  [[nodiscard]] Enclosure enclose(const ClosurePart& part, const std::vector<Interval>& unknowns,
                                  const std::vector<Interval>& parameters) const;

 private:
  explicit ClosureSystem(const Machine& machine);
  void find_paths();
  std::vector<int> group_bodies() const;
  void add_loop(int joint, ClosurePart& part);
  bool choose_unknowns(ClosurePart& part, const std::vector<int>& candidates);
  bool harmless(const std::vector<int>& candidates, const Eigen::MatrixXd& idle) const;
  [[nodiscard]] ScrewChain chain_along(const std::vector<LoopStep>& path) const;
  [[nodiscard]] std::vector<int> variables_of(int joint) const;

  const Model* model_;
  std::vector<int> commanded_, followers_;  // coordinates of the platform; the second follow
  ScrewChain pose_;
  std::vector<std::vector<LoopStep>> paths_;  // per body; joint -1 is the platform's pose
  std::vector<int> tree_;                     // per body its joint towards base or platform, or -1
  std::vector<ClosurePart> parts_;
  std::vector<std::vector<LoopStep>> limbs_;
  std::vector<int> owner_;
};

}  // namespace polyglide
