#include "catalog/architecture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

namespace polyglide {
namespace {

char letter(JointType type) { return "RPHCUSEW"[static_cast<int>(type)]; }

/// Chains between the same two bodies, each read from ends[0] and from ends[1].
struct Bundle {
  std::array<int, 2> ends{};
  std::vector<std::array<std::string, 2>> chains;
  std::size_t first = 0;  ///< its earliest joint in the file
};

/// Equal chains counted, the most frequent first: "3-UPS+UP". @param from index of the end at
/// which reading begins.
std::string listed(const std::vector<std::array<std::string, 2>>& chains, int from) {
  std::vector<std::pair<std::string, int>> kinds;
  for (const auto& chain : chains) {
    const auto same = std::ranges::find(kinds, chain[from], &std::pair<std::string, int>::first);
    if (same == kinds.end())
      kinds.emplace_back(chain[from], 1);
    else
      ++same->second;
  }
  std::ranges::stable_sort(kinds, std::greater{}, &std::pair<std::string, int>::second);
  std::string text;
  for (const auto& [kind, count] : kinds)
    text += (text.empty() ? "" : "+") + (count > 1 ? fmt::format("{}-{}", count, kind) : kind);
  return text;
}

/// A bundle as part of a longer chain: several chains side by side go into brackets.
std::string as_part(const Bundle& bundle, int from) {
  const std::string text = listed(bundle.chains, from);
  return bundle.chains.size() > 1 ? '(' + text + ')' : text;
}

/// The bundle read from `body`.
int end_at(const Bundle& bundle, int body) { return bundle.ends[0] == body ? 0 : 1; }

class Reduction {
 public:
  explicit Reduction(const Mechanism& mechanism) : mechanism_(mechanism) {
    for (std::size_t i = 0; i < mechanism.joints.size(); ++i) {
      const Joint& joint = mechanism.joints[i];
      const std::string word(1, letter(joint.type));
      bundles_.push_back({joint.bodies, {{word, word}}, i});
    }
  }

  std::string run() {
    while (drop_loose() || join_in_series() || merge_side_by_side()) {
    }
    if (bundles_.empty()) return "";
    if (bundles_.size() == 1)
      return listed(bundles_[0].chains, end_at(bundles_[0], mechanism_.base));
    return crossing();
  }

 private:
  [[nodiscard]] bool is_end(int body) const {
    return body == mechanism_.base || body == mechanism_.platform;
  }

  [[nodiscard]] std::vector<std::size_t> at(int body) const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < bundles_.size(); ++i)
      if (std::ranges::find(bundles_[i].ends, body) != bundles_[i].ends.end()) found.push_back(i);
    return found;
  }

  void remove(std::size_t index) {
    bundles_.erase(bundles_.begin() + static_cast<std::ptrdiff_t>(index));
  }

  /// Removes one loop on a single body, or the only bundle of a body that leads nowhere.
  bool drop_loose() {
    for (std::size_t i = 0; i < bundles_.size(); ++i) {
      const auto [a, b] = bundles_[i].ends;
      const auto loose = [&](int body) { return !is_end(body) && at(body).size() == 1; };
      if (a != b && !loose(a) && !loose(b)) continue;
      remove(i);
      return true;
    }
    return false;
  }

  /// Makes one chain of two bundles that alone meet in an inner body.
  bool join_in_series() {
    for (int body = 0; body < static_cast<int>(mechanism_.bodies.size()); ++body) {
      if (is_end(body)) continue;
      const auto meeting = at(body);
      if (meeting.size() != 2) continue;
      const Bundle &one = bundles_[meeting[0]], &other = bundles_[meeting[1]];
      const int far = 1 - end_at(one, body), next = end_at(other, body);
      Bundle joined;
      joined.ends = {one.ends[far], other.ends[1 - next]};
      joined.chains = {{as_part(one, far) + as_part(other, next),
                        as_part(other, 1 - next) + as_part(one, 1 - far)}};
      joined.first = std::min(one.first, other.first);
      bundles_[meeting[0]] = std::move(joined);
      remove(meeting[1]);
      return true;
    }
    return false;
  }

  /// Puts the bundles between the same two bodies together, in the order of the file.
  bool merge_side_by_side() {
    std::ranges::stable_sort(bundles_, {}, &Bundle::first);
    for (std::size_t i = 0; i < bundles_.size(); ++i)
      for (std::size_t j = i + 1; j < bundles_.size(); ++j) {
        Bundle &one = bundles_[i], &other = bundles_[j];
        const bool same = one.ends == other.ends;
        if (!same && (one.ends[0] != other.ends[1] || one.ends[1] != other.ends[0])) continue;
        for (auto& chain : other.chains) {
          if (!same) std::swap(chain[0], chain[1]);
          one.chains.push_back(std::move(chain));
        }
        remove(j);
        return true;
      }
    return false;
  }

  /// How many bundles lie between the base and every body.
  [[nodiscard]] std::vector<int> distances() const {
    const int unknown = static_cast<int>(mechanism_.bodies.size());
    std::vector<int> distance(mechanism_.bodies.size(), unknown);
    distance[mechanism_.base] = 0;
    for (bool changed = true; changed;) {
      changed = false;
      for (const Bundle& bundle : bundles_)
        for (int end = 0; end < 2; ++end) {
          int& there = distance[bundle.ends[1 - end]];
          if (distance[bundle.ends[end]] + 1 >= there) continue;
          there = distance[bundle.ends[end]] + 1;
          changed = true;
        }
    }
    return distance;
  }

  [[nodiscard]] std::string crossing() const {
    const std::vector<int> distance = distances();
    std::vector<std::array<std::string, 2>> chains;
    for (const Bundle& bundle : bundles_) {
      const int from = distance[bundle.ends[0]] <= distance[bundle.ends[1]] ? 0 : 1;
      const std::string text = as_part(bundle, from);
      chains.push_back({text, text});
    }
    return '[' + listed(chains, 0) + ']';
  }

  const Mechanism& mechanism_;
  std::vector<Bundle> bundles_;
};

/// The joints of the one loop of a mechanism, from the base on; empty when it is not one loop.
std::string single_loop(const Mechanism& mechanism) {
  std::vector<std::vector<std::size_t>> joints(mechanism.bodies.size());
  for (std::size_t i = 0; i < mechanism.joints.size(); ++i)
    for (const int body : mechanism.joints[i].bodies) joints[body].push_back(i);
  if (std::ranges::any_of(joints, [](const auto& at) { return at.size() != 2; })) return "";
  const auto& first = joints[mechanism.base];
  const bool second_driven =
      mechanism.joints[first[0]].driven.empty() && !mechanism.joints[first[1]].driven.empty();
  std::size_t joint = first[second_driven ? 1 : 0];
  int body = mechanism.base;
  std::string word;
  do {
    const Joint& here = mechanism.joints[joint];
    word += letter(here.type);
    body = here.bodies[here.bodies[0] == body ? 1 : 0];
    joint = joints[body][joints[body][0] == joint ? 1 : 0];
  } while (body != mechanism.base);
  if (word.size() != mechanism.joints.size()) return "";  // two loops apart
  if (word.find_first_not_of(word[0]) != std::string::npos) return word;
  return fmt::format("{}{}", word.size(), word[0]);
}

}  // namespace

std::string architecture(const Mechanism& mechanism) {
  const std::string loop = single_loop(mechanism);
  return loop.empty() ? Reduction(mechanism).run() : loop;
}

std::vector<std::string> limb_words(const std::string& architecture) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : architecture + ' ') {
    if (std::isalpha(static_cast<unsigned char>(c))) {
      word += c;
    } else if (!word.empty()) {
      if (std::ranges::find(words, word) == words.end()) words.push_back(word);
      word.clear();
    }
  }
  return words;
}

}  // namespace polyglide
