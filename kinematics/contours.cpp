#include "kinematics/contours.hpp"

#include <algorithm>
#include <utility>

namespace polyglide {
namespace {

/// Joins segments between numbered points at their common points.
std::vector<std::vector<int>> chain(const std::vector<std::pair<int, int>>& segments, int points) {
  std::vector<std::vector<int>> at(static_cast<std::size_t>(points));
  for (std::size_t s = 0; s < segments.size(); ++s) {
    at[segments[s].first].push_back(static_cast<int>(s));
    at[segments[s].second].push_back(static_cast<int>(s));
  }
  std::vector<char> used(segments.size(), 0);
  std::vector<std::vector<int>> chains;
  const auto walk = [&](int start) {
    std::vector<int> chain{start};
    for (bool more = true; more;) {
      more = false;
      for (int s : at[chain.back()]) {
        if (used[s]) continue;
        used[s] = 1;
        chain.push_back(segments[s].first == chain.back() ? segments[s].second : segments[s].first);
        more = true;
        break;
      }
    }
    if (chain.size() > 1) chains.push_back(std::move(chain));
  };
  // Open chains from their ends first, then what is left is closed.
  for (int p = 0; p < points; ++p)
    if (at[p].size() == 1) walk(p);
  for (int p = 0; p < points; ++p) walk(p);
  return chains;
}

std::vector<Contour> chained(const std::vector<std::pair<int, int>>& segments,
                             const std::vector<std::array<double, 2>>& places) {
  std::vector<Contour> list;
  for (const std::vector<int>& points : chain(segments, static_cast<int>(places.size()))) {
    Contour contour;
    for (int p : points) contour.points.push_back(places[p]);
    contour.closed = points.size() > 2 && points.front() == points.back();
    list.push_back(std::move(contour));
  }
  return list;
}

}  // namespace

std::vector<Contour> contours(const std::vector<signed char>& classes, int width,
                              const std::function<void(std::vector<CrossedEdge>&)>& locate) {
  const int height = static_cast<int>(classes.size()) / width;
  const auto at = [&](int i, int j) { return classes[i + static_cast<std::size_t>(width) * j]; };
  std::vector<CrossedEdge> edges;
  std::map<std::array<int, 3>, int> numbers;  // node and direction of an edge
  const auto edge = [&](int i, int j, int way) {
    const auto [place, fresh] = numbers.try_emplace({j, i, way}, static_cast<int>(edges.size()));
    if (fresh) {
      const int k = i + (way == 0), l = j + (way == 1);
      CrossedEdge crossed{{double(i), double(j)}, {double(k), double(l)}};
      if (at(i, j) != 1) std::swap(crossed.one, crossed.other);
      edges.push_back(crossed);
    }
    return place->second;
  };
  std::vector<std::pair<int, int>> segments;
  for (int j = 0; j + 1 < height; ++j)
    for (int i = 0; i + 1 < width; ++i) {
      // Corners anticlockwise from the lower left; edge k joins corner k with the next.
      const std::array<signed char, 4> corner{at(i, j), at(i + 1, j), at(i + 1, j + 1),
                                              at(i, j + 1)};
      if (std::any_of(corner.begin(), corner.end(), [](auto c) { return c != 0 && c != 1; }))
        continue;
      const auto numbered = [&](int k) {
        return k == 0   ? edge(i, j, 0)
               : k == 1 ? edge(i + 1, j, 1)
               : k == 2 ? edge(i, j + 1, 0)
                        : edge(i, j, 1);
      };
      std::vector<int> crossed;
      for (int k = 0; k < 4; ++k)
        if (corner[k] != corner[(k + 1) % 4]) crossed.push_back(k);
      // Of four, those beside a corner of class 1 belong together.
      if (crossed.size() == 4 && corner[0] == 1)
        std::rotate(crossed.begin(), crossed.begin() + 3, crossed.end());
      for (std::size_t k = 0; k + 1 < crossed.size(); k += 2) {
        const int first = numbered(crossed[k]), second = numbered(crossed[k + 1]);
        segments.emplace_back(first, second);
      }
    }
  locate(edges);
  std::vector<std::array<double, 2>> places;
  for (const CrossedEdge& each : edges) places.push_back(each.one);
  return chained(segments, places);
}

std::vector<Contour> contours_through(const std::map<GridEdge, std::array<double, 2>>& points,
                                      int width, int height) {
  std::vector<std::array<double, 2>> places;
  std::map<GridEdge, int> numbers;
  std::map<std::array<double, 2>, int> known;  // a node is on several edges
  for (const auto& [edge, place] : points) {
    const auto [at, fresh] = known.try_emplace(place, static_cast<int>(places.size()));
    if (fresh) places.push_back(place);
    numbers[edge] = at->second;
  }
  std::vector<std::pair<int, int>> segments;
  for (int j = 0; j + 1 < height; ++j)
    for (int i = 0; i + 1 < width; ++i) {
      const std::size_t low = i + static_cast<std::size_t>(width) * j, high = low + width;
      std::vector<int> found;
      for (const GridEdge& side :
           {GridEdge{low, low + 1}, {low + 1, high + 1}, {high, high + 1}, {low, high}})
        if (const auto number = numbers.find(side);
            number != numbers.end() && std::ranges::count(found, number->second) == 0)
          found.push_back(number->second);
      if (found.size() % 2 != 0) continue;
      for (std::size_t k = 0; k < found.size(); k += 2)
        segments.emplace_back(found[k], found[k + 1]);
    }
  return chained(segments, places);
}

}  // namespace polyglide
