#include "tools/inspect/inspection_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "pipeline/stored_colors.h"
#include "tools/files/format.h"
#include "tools/files/image_io.h"
#include "tools/inspect/inspection_text.h"

namespace beampipe {
namespace {

std::string xml_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool is_control = c >= 0 && c < ' ' && c != '\n';  // XML has no such characters
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, is_control ? '?' : c);
  }
  return out;
}

// Everything in px of the SVG.
constexpr double kPictureWidth = 1060, kMargin = 20, kScale = 380,
                 kBorder = 24;  // kScale: of a pixel; kBorder: around it
constexpr double kSquare = kScale + 2 * kBorder, kTextLeft = kMargin + kSquare + 30;
constexpr double kRow = 22, kHead = 62, kBarWidth = 200;
constexpr std::size_t kMostSurfaces = 12, kMostTransfers = 3;

// Colours that most people can tell apart (Okabe and Ito 2008), and lighter ones of the same hues.
constexpr std::array kSurfaceColors = {"#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9",
                                       "#a6761d", "#7570b3", "#66a61e", "#e7298a", "#1b9e77", "#8da0cb"};
constexpr const char* kOther = "#9a9a9a";

// The surfaces with the largest parts of the pixel have colours of their own, the others are gray.
using ColorOf = std::map<std::uint32_t, const char*>;

std::vector<InspectedSurface> largest_first(const PixelInspection& inspection) {
  std::vector<InspectedSurface> surfaces = inspection.surfaces;
  std::stable_sort(surfaces.begin(), surfaces.end(), [](const InspectedSurface& a, const InspectedSurface& b) {
    return a.largest_part() > b.largest_part();
  });
  return surfaces;
}

ColorOf colors_of(const std::vector<InspectedSurface>& surfaces) {
  ColorOf colors;
  for (const InspectedSurface& surface : surfaces)
    if (surface.fragment != kNobody && colors.size() < kSurfaceColors.size())
      colors.emplace(surface.fragment, kSurfaceColors[colors.size()]);
  return colors;
}

const char* color_of(const ColorOf& colors, std::uint32_t fragment) {
  const auto found = colors.find(fragment);
  return found == colors.end() ? kOther : found->second;
}

// Without the sign of what rounds to 0.
double without_small(double part) { return std::abs(part) < 5e-5 ? 0.0 : part; }

std::string css_color(const glm::dvec3& linear) {
  const glm::vec3 color(linear);
  return format("#%02x%02x%02x", srgb_byte(color.r), srgb_byte(color.g), srgb_byte(color.b));
}

std::string text_at(double x, double y, const std::string& text, const char* attributes = "") {
  return format("<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, attributes) + xml_text(text) + "</text>\n";
}

std::string rectangle(double x, double y, double width, double height, const std::string& attributes) {
  return format("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" ", x, y, width, height) + attributes +
         "/>\n";
}

// The pixel with a little of its neighbours.
std::string pixel_picture(const PixelInspection& inspection, const ColorOf& colors, double top, std::size_t panel) {
  const PixelHistory& history = inspection.history;
  const auto place = [&](const glm::dvec2& in_pixel) {
    return glm::dvec2(kMargin + kBorder, top + kBorder) + kScale * in_pixel;
  };
  std::string svg = format("<clipPath id=\"square%zu\">", panel) + rectangle(kMargin, top, kSquare, kSquare, "") +
                    format("</clipPath>\n<g clip-path=\"url(#square%zu)\">\n", panel);
  svg += rectangle(kMargin, top, kSquare, kSquare, "fill=\"#f4f4f4\"");
  svg += rectangle(kMargin + kBorder, top + kBorder, kScale, kScale, "fill=\"#ffffff\" stroke=\"#333\"");
  // Those that matter come last, on top.
  std::vector<std::uint32_t> order;
  for (const bool matters : {false, true})
    for (std::uint32_t i = 0; i < history.fragments.size(); ++i)
      if (colors.contains(i) == matters) order.push_back(i);
  for (const std::uint32_t i : order) {
    const bool matters = colors.contains(i);
    svg += "<polygon points=\"";
    for (const glm::dvec2& corner : history.fragments[i].corners) {
      // Far corners would be too much for some viewers. The edges in the pixel change by less than a hair.
      const glm::dvec2 at = place(glm::clamp(corner - glm::dvec2(history.at.x, history.at.y), -1e4, 1e4));
      svg += format("%.2f,%.2f ", at.x, at.y);
    }
    svg += format("\" fill=\"%s\" fill-opacity=\"%s\" stroke=\"%s\" stroke-width=\"%s\"/>\n", color_of(colors, i),
                  matters ? "0.10" : "0", color_of(colors, i), matters ? "1.6" : "0.35");
  }
  const double radius = std::clamp(kScale * 0.32 / std::sqrt(std::max<double>(history.positions.size(), 1)), 1.5, 9.0);
  for (std::size_t i = 0; i < history.positions.size(); ++i) {
    const glm::dvec2 at = place(history.positions[i]);
    const std::uint32_t owner = i < history.owners.size() ? history.owners[i] : kNobody;
    svg += format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" ", at.x, at.y, radius) +
           (owner == kNobody ? std::string("fill=\"#ffffff\" stroke=\"#999999\"")
                             : format("fill=\"%s\" stroke=\"#ffffff\"", color_of(colors, owner))) +
           " stroke-width=\"0.8\"/>\n";
  }
  return svg + "</g>\n";
}

std::string weight_bars(const std::vector<InspectedSurface>& surfaces, const PixelInspection& inspection,
                        const ColorOf& colors, double top) {
  const double bars = kTextLeft + 190;
  double largest = 0;  // what a full bar stands for
  for (const InspectedSurface& surface : surfaces) largest = std::max(largest, surface.largest_part());
  const auto length_of = [&](double part) {
    return largest > 0 ? kBarWidth * std::clamp(part / largest, 0.0, 1.0) : 0.0;
  };
  const bool has_truth =
      std::ranges::any_of(surfaces, [](const InspectedSurface& surface) { return surface.truth.has_value(); });
  std::string svg =
      text_at(kTextLeft, top, "surface", "class=\"dim\"") +
      text_at(bars, top, format("weight (bar)%s; full width %.3g", has_truth ? ", reference (line)" : "", largest),
              "class=\"dim\"");
  for (std::size_t i = 0; i < std::min(surfaces.size(), kMostSurfaces); ++i) {
    const InspectedSurface& surface = surfaces[i];
    const double y = top + 12 + kRow * static_cast<double>(i);
    const bool is_background = surface.fragment == kNobody;
    const char* color = is_background ? "#444444" : color_of(colors, surface.fragment);
    svg +=
        rectangle(kTextLeft, y, 14, 14, format("fill=\"%s\"", is_background ? "#ffffff" : color) + " stroke=\"#666\"");
    const glm::vec3 swatch = shown(inspection.target, glm::vec3(surface.color));
    svg += rectangle(kTextLeft + 18, y, 14, 14, "fill=\"" + css_color(swatch) + "\" stroke=\"#666\"");
    svg += text_at(kTextLeft + 38, y + 12,
                   is_background ? "background"
                                 : format("#%u, triangle %u", surface.fragment,
                                          inspection.history.fragments[surface.fragment].triangle));
    svg += rectangle(bars, y + 1, kBarWidth, 12, "fill=\"#eeeeee\"");
    svg += rectangle(bars, y + 1, length_of(surface.weight), 12, format("fill=\"%s\"", color));
    svg += text_at(bars + kBarWidth + 8, y + 12, format("%.4f", without_small(surface.weight)));
    if (!surface.truth) continue;
    const double truth = bars + length_of(*surface.truth);
    svg += format("<line x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"#000\" stroke-width=\"2\"/>\n", truth,
                  truth, y - 1, y + 15);
    svg += text_at(bars + kBarWidth + 58, y + 12, format("%+.4f", without_small(surface.weight - *surface.truth)),
                   "class=\"dim\"");
  }
  if (surfaces.size() > kMostSurfaces)
    svg += text_at(kTextLeft + 38, top + 24 + kRow * kMostSurfaces,
                   std::to_string(surfaces.size() - kMostSurfaces) + " smaller ones", "class=\"dim\"");
  return svg;
}

std::string colors_text(const PixelInspection& inspection, double y) {
  std::string svg;
  const std::array<std::pair<const char*, glm::dvec3>, 2> colors = {
      {{"picture", glm::dvec3(inspection.picture)}, {"reference", glm::dvec3(inspection.reference)}}};
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const auto& [name, color] = colors[i];
    const double x = kTextLeft + 250 * static_cast<double>(i);
    svg += rectangle(x, y, 30, 30, "fill=\"" + css_color(color) + "\" stroke=\"#666\"");
    svg += text_at(x + 38, y + 12, name, "class=\"dim\"") +
           text_at(x + 38, y + 27, format("%.4f %.4f %.4f", color.r, color.g, color.b));
  }
  return svg;
}

std::string panel_svg(const PixelInspection& inspection, const std::string& trace, double top, std::size_t panel) {
  const PixelHistory& history = inspection.history;
  const std::vector<InspectedSurface> surfaces = largest_first(inspection);
  const ColorOf colors = colors_of(surfaces);
  std::string svg = text_at(kMargin, top + 24,
                            format("Pixel %u,%u with %s", history.at.x, history.at.y, inspection.technique.c_str()),
                            "class=\"title\"");
  svg +=
      text_at(kMargin, top + 46,
              trace + format(", frame %zu. %zu triangles, %zu %s: dots%s.", inspection.frame, history.fragments.size(),
                             history.positions.size(), history.has_samples ? "samples" : "positions",
                             !has_owners(history) ? "" : " in the colour of the owner, or empty"),
              "class=\"dim\"");
  top += kHead;
  svg += pixel_picture(inspection, colors, top, panel);
  svg += weight_bars(surfaces, inspection, colors, top + 10);
  double y = top + 46 + kRow * static_cast<double>(std::min(surfaces.size(), kMostSurfaces + 1));
  svg += colors_text(inspection, y);
  y += 54;
  svg += text_at(kTextLeft, y, format("error (root mean square) %.5f", inspection.error));
  if (const std::string causes = cause_shares_text(inspection); !causes.empty())
    svg += text_at(kTextLeft, y += 19, "causes: " + causes);
  for (const std::string& line : transfer_lines(inspection, kMostTransfers))
    svg += text_at(kTextLeft, y += 19, line, "class=\"dim\"");
  return svg;
}

constexpr double kPanel = kHead + kSquare + 60;

constexpr const char* kStyle =
    "<style>text { font: 13px sans-serif; fill: #111 } .title { font: bold 17px sans-serif } .dim { fill: #555 }"
    "</style>\n";

std::string svg_of(const std::vector<PixelInspection>& inspections, std::size_t first, std::size_t last,
                   const std::string& trace) {
  const double height = kPanel * static_cast<double>(last - first);
  std::string svg =
      format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\">\n",
             kPictureWidth, height, kPictureWidth, height);
  svg += kStyle + rectangle(0, 0, kPictureWidth, height, "fill=\"#ffffff\"");
  for (std::size_t i = first; i < last; ++i)
    svg += panel_svg(inspections[i], trace, kPanel * static_cast<double>(i - first), i);
  return svg + "</svg>\n";
}

}  // namespace

std::string inspections_svg(const std::vector<PixelInspection>& inspections, const std::string& trace) {
  return svg_of(inspections, 0, inspections.size(), trace);
}

std::string inspections_html(const std::vector<PixelInspection>& inspections, const std::string& trace) {
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + xml_text(trace) +
      " · beampipe inspect</title>\n<style>body { font-family: sans-serif; margin: 1em auto; max-width: 1000px } "
      "svg { max-width: 100%; height: auto } pre { font-size: 11px; overflow-x: auto }</style></head><body>\n";
  for (std::size_t i = 0; i < inspections.size(); ++i)
    page += svg_of(inspections, i, i + 1, trace) + "<details><summary>The history as text</summary><pre>" +
            xml_text(inspection_text(inspections[i], trace, true)) + "</pre></details>\n";
  return page + "</body></html>\n";
}

}  // namespace beampipe
