#include "cli/print.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <utility>

namespace polyglide {
namespace {

/// Six significant digits [mm or degrees]; rounding errors are 0, and never "-0".
std::string number(double value) {
  if (std::abs(value) < 1e-9) return "0";
  return fmt::format("{:.6g}", value);
}

std::string millimetres(double metres) { return number(metres * 1e3); }

/// Characters shown, not bytes: UTF-8 continuation bytes take no column.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

void print_json(const nlohmann::ordered_json& document) { std::cout << document.dump(2) << '\n'; }

nlohmann::ordered_json one_or_all(std::vector<nlohmann::ordered_json> documents) {
  return documents.size() == 1 ? std::move(documents.front())
                               : nlohmann::ordered_json(std::move(documents));
}

std::string in_mm(double metres) { return millimetres(metres) + " mm"; }

std::string in_degrees(double radians) { return number(radians * 180 / std::numbers::pi) + "°"; }

std::string size_in_mm(const Vector3& metres) {
  return fmt::format("{} x {} x {} mm", millimetres(metres.x()), millimetres(metres.y()),
                     millimetres(metres.z()));
}

std::string point_in_mm(const Vector3& metres) {
  return fmt::format("({}, {}, {}) mm", millimetres(metres.x()), millimetres(metres.y()),
                     millimetres(metres.z()));
}

std::string columns(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width(row[i]));
  }
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      text += row[i];
      if (i + 1 < row.size()) text.append(widths[i] - width(row[i]) + 2, ' ');
    }
    text.erase(text.find_last_not_of(' ') + 1);  // an empty last column
    text += '\n';
  }
  return text;
}

}  // namespace polyglide
