#pragma once

#include <string>
#include <vector>

#include "kinematics/evaluate.hpp"

namespace polyglide {

/// Name of the first expression limit that a posture breaks, "" when there is none. An expression
/// without a value there (sqrt(-1), 1/0) breaks its limit.
[[nodiscard]] std::string broken_expression(const Model& model, const Posture& posture,
                                            const std::vector<std::string>& ignored);

/// Expression limits of batches of poses. Immutable. About 0.1 µs a pose and limit.
class BatchExpressions {
 public:
  /// @param limit_names of an evaluator, in which the names of the limits are looked up.
  BatchExpressions(const Model& model, const std::vector<std::string>& ignored,
                   const std::vector<std::string>& limit_names);

  [[nodiscard]] bool empty() const { return limits_.empty(); }

  /// Stops poses [first, last) of those that nothing has stopped yet where an expression is
  /// out of bounds. Needs the drives of the result.
  void check(const PoseBatch& poses, std::size_t first, std::size_t last,
             BatchResult& result) const;

 private:
  struct Limit {
    ExpressionLimit limit;
    std::vector<int> columns;  ///< that it uses: x y z a b c, then drives
    int index = 0;
  };

  void check_block(const PoseBatch& poses, const std::vector<std::size_t>& block,
                   BatchResult& result) const;

  std::vector<std::string> words_;
  std::vector<double> units_;  ///< per column: one file unit in SI
  bool degrees_ = true;
  std::vector<Limit> limits_;
};

}  // namespace polyglide
