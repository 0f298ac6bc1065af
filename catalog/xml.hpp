#pragma once

#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "catalog/mechanism.hpp"

namespace polyglide {

/// An XML element being built. Attributes keep their order.
struct XmlElement {
  std::string tag;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<XmlElement> children;

  XmlElement& set(std::string name, std::string value);
  /// Appends a child and returns it; the reference holds until the next child is added.
  XmlElement& add(std::string child_tag);
};

/// An indented XML 1.0 document. Attribute values are escaped; characters that XML
/// cannot hold become '_'.
/// @param about a comment at the top, "" for none
[[nodiscard]] std::string to_text(const XmlElement& root, std::string_view about);

/// The shortest decimal that reads back as the same double; 0 for -0.
[[nodiscard]] std::string xml_number(double value);

/// Three such numbers, separated by blanks.
[[nodiscard]] std::string xml_vector(const Vector3& vector);

/// Gives names out once: a name that is taken gets the first of _2, _3, … that is free.
/// Characters that XML cannot hold become '_'.
class UniqueNames {
 public:
  [[nodiscard]] std::string take(std::string_view wish);

 private:
  std::set<std::string> taken_;
};

}  // namespace polyglide
