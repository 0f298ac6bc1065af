#pragma once

#include "machines.hpp"
#include "variations.hpp"

namespace polyglide::fixtures {

enum class DriveKind { guide, strut, crank };

/// Three guides, struts or cranks anywhere about home, with strokes, cones and planes.
inline Machine random_machine(std::mt19937_64& random, DriveKind kind) {
  Mechanism mechanism;
  if (kind == DriveKind::strut) {
    std::vector<std::pair<Vector3, Vector3>> limbs;
    for (int i = 0; i < 3; ++i)
      limbs.push_back({variations::uniform_vector(random) - 2 * Vector3::Unit(i),
                       0.2 * variations::uniform_vector(random)});
    mechanism = strutted(limbs, {-0.6, 0.7});
  } else {
    std::vector<Limb> limbs;
    for (int i = 0; i < 3; ++i)
      limbs.push_back(
          {Vector3::Unit(i) * 1.5 + 0.5 * variations::uniform_vector(random),
           (variations::uniform_vector(random) + (i == 0 ? -1 : 1) * Vector3::Unit(i)).normalized(),
           0.2 * variations::uniform_vector(random),
           {-0.3 - 0.2 * variations::uniform(random), 0.5 + 0.2 * variations::uniform(random)}});
    mechanism = guided(limbs);
  }
  if (kind == DriveKind::crank)
    for (Joint& joint : mechanism.joints) {
      if (joint.type != JointType::prismatic) continue;
      joint.type = JointType::revolute;
      joint.at += 0.6 * variations::uniform_vector(random);
      joint.range[0] = {-0.7 - 0.3 * variations::uniform(random),
                        0.8 + 0.3 * variations::uniform(random)};
    }
  for (Joint& joint : mechanism.joints) {
    if (joint.type != JointType::spherical || random() % 2 == 0) continue;
    joint.cone = 0.9 + 0.8 * variations::uniform(random);
    joint.cone_axis = variations::uniform_vector(random).normalized();
  }
  mechanism.limits.push_back({"plane",
                              1,
                              {0.1 * variations::uniform_vector(random)},
                              {{variations::uniform_vector(random).normalized(), 0.5}}});
  if (kind == DriveKind::guide)
    mechanism.limits.push_back({"wall",
                                mechanism.joints[0].bodies[1],
                                {mechanism.joints[0].at},
                                {{variations::uniform_vector(random).normalized(), 3}}});
  return prepare(mechanism, task_of({0, 1, 2}));
}

}  // namespace polyglide::fixtures
