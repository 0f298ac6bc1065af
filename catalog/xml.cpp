#include "catalog/xml.hpp"

#include <fmt/format.h>

namespace polyglide {
namespace {

/// XML 1.0 has no control characters, not even escaped ones.
std::string without_controls(std::string_view text) {
  std::string clean(text);
  for (char& c : clean)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '_';
  return clean;
}

std::string escaped(std::string_view text) {
  std::string result;
  for (char c : without_controls(text)) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

/// A comment may not hold two hyphens in a row.
std::string comment(std::string_view text) {
  std::string clean = without_controls(text);
  for (std::size_t i = 1; i < clean.size(); ++i)
    if (clean[i] == '-' && clean[i - 1] == '-') clean[i] = '_';
  return "<!-- " + clean + " -->\n";
}

void append(std::string& text, const XmlElement& element, int depth) {
  const std::string indent(2 * depth, ' ');
  text += indent + '<' + element.tag;
  for (const auto& [name, value] : element.attributes)
    text += ' ' + name + "=\"" + escaped(value) + '"';
  if (element.children.empty()) {
    text += "/>\n";
    return;
  }
  text += ">\n";
  for (const XmlElement& child : element.children) append(text, child, depth + 1);
  text += indent + "</" + element.tag + ">\n";
}

}  // namespace

XmlElement& XmlElement::set(std::string name, std::string value) {
  attributes.emplace_back(std::move(name), std::move(value));
  return *this;
}

XmlElement& XmlElement::add(std::string child_tag) {
  return children.emplace_back(XmlElement{std::move(child_tag), {}, {}});
}

std::string to_text(const XmlElement& root, std::string_view about) {
  std::string text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n";
  if (!about.empty()) text += comment(about);
  append(text, root, 0);
  return text;
}

std::string xml_number(double value) { return fmt::format("{}", value == 0 ? 0.0 : value); }

std::string xml_vector(const Vector3& vector) {
  return xml_number(vector.x()) + ' ' + xml_number(vector.y()) + ' ' + xml_number(vector.z());
}

std::string UniqueNames::take(std::string_view wish) {
  const std::string clean = without_controls(wish);
  std::string name = clean;
  for (int number = 2; !taken_.insert(name).second; ++number)
    name = clean + '_' + std::to_string(number);
  return name;
}

}  // namespace polyglide
