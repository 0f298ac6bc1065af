#include "catalog/reader.hpp"

#include <cmath>

namespace polyglide {
namespace {

using nlohmann::json;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
const Vector3 kNoVector = Vector3::Constant(kNoNumber);

}  // namespace

const json& member(const json& object, const char* key) {
  static const json kNull;
  if (!object.is_object()) return kNull;
  const auto found = object.find(key);
  return found == object.end() ? kNull : *found;
}

std::string text(const json& value, const std::string& otherwise) {
  return value.is_string() ? value.get_ref<const std::string&>() : otherwise;
}

Vector3 unit_vector(const Vector3& vector) {
  const double squared = vector.squaredNorm();
  return std::abs(squared - 1) <= 1e-15 ? vector : Vector3(vector / std::sqrt(squared));
}

double Reader::number(const json& value) const {
  if (value.is_number()) return value.get<double>();
  if (!value.is_string()) return kNoNumber;
  Evaluation result = evaluate(value.get_ref<const std::string&>(), scope_);
  if (!result.error.empty()) problems_.add(value, result.error, result.hint);
  return result.value;
}

double Reader::length(const json& value) const { return number(value) * units_.metres; }

double Reader::angle(const json& value) const { return number(value) * units_.radians; }

double Reader::positive_length(const json& value) const {
  const double result = length(value);
  if (result <= 0) problems_.add(value, "this length must be greater than zero");
  return result;
}

Vector3 Reader::triple(const json& value) const {
  if (!value.is_array() || value.size() != 3) return kNoVector;
  return {number(value[0]), number(value[1]), number(value[2])};
}

Vector3 Reader::point(const json& value, const Compass& compass) const {
  return compass.origin + compass.rotation * triple(value) * units_.metres;
}

Vector3 Reader::offset(const json& value, const Compass& compass) const {
  if (value.is_null()) return Vector3::Zero();
  return compass.rotation * triple(value) * units_.metres;
}

Vector3 Reader::direction(const json& value, const Compass& compass) const {
  if (value.is_string()) return direction_word(value, compass);
  if (value.is_object()) return leaning(value, compass);
  const Vector3 vector = triple(value);
  if (!vector.allFinite()) return kNoVector;
  if (vector.norm() < 1e-12) {
    problems_.add(value, "a direction must have a length greater than zero");
    return kNoVector;
  }
  return unit_vector(compass.rotation * vector);
}

Vector3 Reader::direction_word(const json& value, const Compass& compass) const {
  std::string word = value.get<std::string>();
  const double sign = word.starts_with('-') ? -1 : 1;
  if (sign < 0) word.erase(0, 1);
  if (word == "x") return sign * Vector3::UnitX();
  if (word == "y") return sign * Vector3::UnitY();
  if (word == "z") return sign * Vector3::UnitZ();
  if (word == "radial") return sign * compass.rotation.col(0);
  if (word == "tangential") return sign * compass.rotation.col(1);
  if (word == "guide" && compass.guide) return sign * *compass.guide;
  if (word == "rod" && compass.rod) return sign * *compass.rod;
  if (word == "guide" || word == "rod")
    problems_.add(value, "there is no " + word + " here whose direction could be taken");
  return kNoVector;
}

Vector3 Reader::leaning(const json& value, const Compass& compass) const {
  const double lean = angle(member(value, "lean"));
  Vector3 toward = direction(member(value, "toward"), compass);
  toward.z() = 0;
  if (toward.norm() < 1e-9) {
    problems_.add(member(value, "toward"), "a guide can only lean toward a horizontal direction");
    return kNoVector;
  }
  return unit_vector(std::cos(lean) * toward.normalized() + std::sin(lean) * Vector3::UnitZ());
}

Range Reader::interval(const json& value, double unit) const {
  Range range;
  if (!value.is_array() || value.size() != 2) return range;
  if (!value[0].is_null()) range.min = number(value[0]) * unit;
  if (!value[1].is_null()) range.max = number(value[1]) * unit;
  if (range.min > range.max) problems_.add(value, "the smaller limit must come first");
  return range;
}

}  // namespace polyglide
