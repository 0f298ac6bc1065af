#include "report/map_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kWide = 560, kLeft = 70, kTop = 50, kLegend = 300;  // pixels
constexpr int kShades = 10;
constexpr const char* kStyle =
    "text{font:12px sans-serif;fill:#222}.t{font-size:15px;font-weight:600}"
    ".c{fill:none;stroke-width:2;stroke-linejoin:round}"
    ".direct{stroke:#c62828}.inverse{stroke:#1565c0;stroke-dasharray:6 3}"
    ".constraint{stroke:#7b1fa2}.reach{stroke:#555;stroke-dasharray:2 3}";

std::string escape(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

/// One axis of the map: its nodes in mm or degrees, and where they are drawn.
struct Scale {
  std::vector<double> nodes;
  std::string title;
  double begin = 0, pixels = 0;  ///< drawn from begin by pixels, which are negative upwards
  double unit = 1;               ///< mm or degrees per metre or radian

  [[nodiscard]] double span() const { return nodes.back() - nodes.front(); }
  [[nodiscard]] double at(double value) const {
    return begin + pixels * (value - nodes.front()) / span();
  }
};

Scale scale_of(const Json& map, const char* nodes, std::size_t axis) {
  const std::string name = map["axes"][axis];
  const bool length = name >= "X";
  Scale scale;
  scale.unit = length ? 1e3 : 180 / std::numbers::pi;
  scale.title = name + (length ? " [mm]" : " [°]");
  for (const double node : map[nodes].get<std::vector<double>>())
    scale.nodes.push_back(node * scale.unit);
  return scale;
}

/// White (0, singular) to deep green (1); paler where a limit stops the machine.
std::string shade(int level, bool limited) {
  const double s = std::sqrt((level + 0.5) / kShades), pale = limited ? 0.75 : 0;
  const auto mix = [&](double dark) {
    const double c = 255 + (dark - 255) * s;
    return static_cast<int>(std::lround(c + (250 - c) * pale));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(0), mix(105), mix(92));
}

/// Rows of equal cells as one rectangle each.
std::string cells(const Json& map, const Scale& u, const Scale& v) {
  std::string out = "<g shape-rendering=\"crispEdges\">\n";
  const auto color = [&](std::size_t i, std::size_t j) -> std::string {
    const Json& value = map["inverse_condition"][j][i];
    if (value.is_null()) return "";
    const int level = std::clamp(static_cast<int>(value.get<double>() * kShades), 0, kShades - 1);
    return shade(level, map["limit"][j][i].get<int>() >= 0);
  };
  const double half_u = u.span() / static_cast<double>(u.nodes.size() - 1) / 2;
  const double half_v = v.span() / static_cast<double>(v.nodes.size() - 1) / 2;
  const auto inside = [](const Scale& s, double value) {
    return s.at(std::clamp(value, s.nodes.front(), s.nodes.back()));
  };
  for (std::size_t j = 0; j < v.nodes.size(); ++j)
    for (std::size_t i = 0; i < u.nodes.size();) {
      const std::string fill = color(i, j);
      const std::size_t first = i;
      while (i < u.nodes.size() && color(i, j) == fill) ++i;
      if (fill.empty()) continue;
      const double left = inside(u, u.nodes[first] - half_u),
                   right = inside(u, u.nodes[i - 1] + half_u);
      const double top = inside(v, v.nodes[j] + half_v), bottom = inside(v, v.nodes[j] - half_v);
      out +=
          fmt::format(R"(<rect x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}" fill="{}"/>)",
                      left, top, right - left, bottom - top, fill) +
          "\n";
    }
  return out + "</g>\n";
}

/// The word of a kind that decides its colour.
std::string color_word(const std::string& kind) {
  for (const char* word : {"direct", "constraint", "inverse"})
    if (kind.find(word) != std::string::npos) return word;
  return "reach";
}

std::string curves(const Json& map, const Scale& u, const Scale& v) {
  std::string out;
  for (const Json& curve : map["curves"]) {
    std::string points;
    for (const Json& point : curve["points"])
      points += fmt::format("{:.2f},{:.2f} ", u.at(point[0].get<double>() * u.unit),
                            v.at(point[1].get<double>() * v.unit));
    out += fmt::format("<polyline class=\"c {}\" points=\"{}\"><title>{}</title></polyline>\n",
                       color_word(curve["kind"]), points, escape(curve["kind"]));
  }
  return out;
}

/// Round values: 1, 2 or 5 times a power of ten, at most 8 of them.
std::vector<double> ticks(const Scale& scale) {
  double step = std::pow(10, std::floor(std::log10(scale.span() / 8)));
  for (double factor : {2.0, 2.5, 2.0})
    if (scale.span() / step > 8) step *= factor;
  std::vector<double> values;
  for (double value = std::ceil(scale.nodes.front() / step) * step;
       value <= scale.nodes.back() + 1e-9 * step; value += step)
    values.push_back(std::abs(value) < 1e-9 * step ? 0 : value);
  return values;
}

std::string axes(const Scale& u, const Scale& v) {
  const double bottom = v.begin, right = u.begin + u.pixels, top = v.begin + v.pixels;
  std::string out = fmt::format(
      R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="none" stroke="#222"/>)",
      u.begin, top, u.pixels, bottom - top);
  for (double value : ticks(u))
    out += fmt::format(
        "\n<path d=\"M{0:.1f} {1:.1f}v5\" stroke=\"#222\"/><text x=\"{0:.1f}\" y=\"{2:.1f}\" "
        "text-anchor=\"middle\">{3:g}</text>",
        u.at(value), bottom, bottom + 19, value);
  for (double value : ticks(v))
    out += fmt::format(
        "\n<path d=\"M{0:.1f} {1:.1f}h-5\" stroke=\"#222\"/><text x=\"{2:.1f}\" y=\"{3:.1f}\" "
        "text-anchor=\"end\">{4:g}</text>",
        u.begin, v.at(value), u.begin - 8, v.at(value) + 4, value);
  out += fmt::format("\n<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>",
                     (u.begin + right) / 2, bottom + 38, u.title);
  out += fmt::format(
      "\n<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" "
      "text-anchor=\"middle\">{}</text>\n",
      u.begin - 52, (top + bottom) / 2, v.title);
  return out;
}

/// Breaks a text into lines of at most `width` letters.
std::vector<std::string> lines_of(const std::string& text, std::size_t width) {
  std::vector<std::string> lines{""};
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find(' ', start), text.size());
    const std::string word = text.substr(start, end - start);
    if (!lines.back().empty() && lines.back().size() + word.size() >= width) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
    start = end + 1;
  }
  return lines;
}

/// What the colours mean, and what the platform gains or loses.
std::string legend(const Json& map, double x) {
  std::string out;
  double y = kTop + 10;
  const auto write = [&](const std::string& text, double indent) {
    for (const std::string& line : lines_of(text, 42)) {
      out +=
          fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + indent, y, escape(line));
      y += 16;
    }
  };
  std::vector<std::string> told;
  for (const Json& curve : map["curves"]) {
    const std::string kind = curve["kind"];
    if (std::count(told.begin(), told.end(), kind) > 0) continue;
    told.push_back(kind);
    std::string about = kind == "direct"    ? "direct singularity (type II)"
                        : kind == "inverse" ? "inverse singularity (type I)"
                                            : kind;
    for (const auto& gain : curve["gained"]) about += "; gains: " + gain.get<std::string>();
    for (const auto& loss : curve["lost"]) about += "; bears: " + loss.get<std::string>();
    const auto same = std::count_if(map["curves"].begin(), map["curves"].end(),
                                    [&](const Json& other) { return other["kind"] == kind; });
    if (same > 1) about += fmt::format("; and {} more like it", same - 1);
    out +=
        fmt::format("<path class=\"c {}\" d=\"M{:.1f} {:.1f}h24\"/>\n", color_word(kind), x, y - 4);
    write(about, 32);
  }
  if (told.empty()) write("no singular curve in this slice", 0);
  y += 8;
  for (int i = 0; i < kShades; ++i)
    out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"16\" height=\"12\" fill=\"{}\"/>\n",
                       x + 16 * i, y - 10, shade(i, false));
  y += 18;
  write("1/κ from 0 (singular) to 1; paler: beyond a limit; white: no posture", 0);
  return out;
}

}  // namespace

std::string map_svg(const Json& map) {
  Scale u = scale_of(map, "u", 0), v = scale_of(map, "v", 1);
  const bool same_unit = u.unit == v.unit;
  const double high =
      same_unit ? std::clamp(kWide * v.span() / u.span(), 0.4 * kWide, 1.5 * kWide) : kWide;
  // Equal scales where the units are: the narrower picture of a tall slice.
  const double wide = same_unit ? std::min(kWide, high * u.span() / v.span()) : kWide;
  u.begin = kLeft;
  u.pixels = wide;
  v.begin = kTop + high;
  v.pixels = -high;
  const double width = kLeft + wide + 30 + kLegend, height = kTop + high + 55;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\">\n<style>{2}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      width, height, kStyle);
  const std::string name = map.contains("name") ? map["name"].get<std::string>() : "";
  out += fmt::format("<text class=\"t\" x=\"{:.0f}\" y=\"28\">{}</text>\n", kLeft,
                     escape(name + ": singularities over " + map["slice"].get<std::string>()));
  return out + cells(map, u, v) + curves(map, u, v) + axes(u, v) + legend(map, kLeft + wide + 30) +
         "</svg>\n";
}

}  // namespace polyglide
