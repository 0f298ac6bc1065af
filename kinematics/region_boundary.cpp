#include "kinematics/region_boundary.hpp"

namespace polyglide {

Boundary find_boundary(const Probe& probe, const Region& region, int bisections) {
  const NodeGrid& grid = region.grid;
  struct Edge {
    Vector3 in, out;
    int limit;
  };
  std::vector<Edge> edges;
  for (int k = 0; k < grid.count[2]; ++k)
    for (int j = 0; j < grid.count[1]; ++j)
      for (int i = 0; i < grid.count[0]; ++i) {
        if (!region.inside[grid.index(i, j, k)]) continue;
        for (int way = 0; way < 6; ++way) {
          std::array<int, 3> next{i, j, k};
          const int axis = way / 2;
          if (grid.count[axis] == 1) continue;
          next[axis] += way % 2 == 0 ? -1 : 1;
          const Vector3 in = grid.at(i, j, k), out = grid.at(next[0], next[1], next[2]);
          if (next[axis] < 0 || next[axis] >= grid.count[axis]) {
            edges.push_back({in, in, probe.search_box()});
            continue;
          }
          const std::size_t other = grid.index(next[0], next[1], next[2]);
          if (!region.inside[other])
            edges.push_back(
                {in, out, region.limit[other] < 0 ? probe.singularity() : region.limit[other]});
        }
      }
  for (int round = 0; round < bisections; ++round) {
    Points middles;
    for (const Edge& edge : edges) middles.add((edge.in + edge.out) / 2);
    const Probe::Answers answers = probe.ask(middles, false);
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (edges[e].limit == probe.search_box()) continue;
      (answers.inside(e) ? edges[e].in : edges[e].out) = middles[e];
      if (!answers.inside(e)) edges[e].limit = answers.limit[e];
    }
  }
  Boundary boundary{{}, region.extent};
  for (const Edge& edge : edges) {
    boundary.limits[probe.names()[edge.limit]] += 1.0 / static_cast<double>(edges.size());
    boundary.extent.lower = boundary.extent.lower.cwiseMin(edge.in);
    boundary.extent.upper = boundary.extent.upper.cwiseMax(edge.in);
  }
  return boundary;
}

}  // namespace polyglide
