#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catalog/mechanism.hpp"

namespace polyglide {

/// Prints a JSON document on standard output.
void print_json(const nlohmann::ordered_json& document);

/// One document per machine asked for: the document itself when there is one, an
/// array in the order asked when there are several.
[[nodiscard]] nlohmann::ordered_json one_or_all(std::vector<nlohmann::ordered_json> documents);

/// Lengths and angles for people: millimetres and degrees to six significant
/// digits ("256 mm", "0.0125 mm", "70°").
[[nodiscard]] std::string in_mm(double metres);
[[nodiscard]] std::string in_degrees(double radians);

/// "230 x 230 x 140 mm" for a size or "(0, 12.5, -3) mm" for a point.
[[nodiscard]] std::string size_in_mm(const Vector3& metres);
[[nodiscard]] std::string point_in_mm(const Vector3& metres);

/// Rows as text columns, left-aligned, two spaces apart; the last is not padded.
[[nodiscard]] std::string columns(const std::vector<std::vector<std::string>>& rows);

}  // namespace polyglide
