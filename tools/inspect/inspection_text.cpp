#include "tools/inspect/inspection_text.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "pipeline/wrapped_text.h"
#include "tools/files/format.h"

namespace beampipe {
namespace {

constexpr std::size_t kColumns = 120;

// A name from a trace, for a terminal: without control characters, and cut at a width, but not within a character.
std::string cut(std::string text, std::size_t width) {
  for (char& c : text)
    if ((c >= 0 && c < ' ') || c == 0x7f) c = '?';
  if (text.size() <= width) return text;
  std::size_t end = width - 3;
  while (end > 0 && (text[end] & 0xc0) == 0x80) --end;
  return text.substr(0, end) + "...";
}

// A line, with the lines that it goes on in.
std::string put_line(const std::string& text, std::size_t indent) { return wrapped(text, kColumns, indent) + "\n"; }

std::string color_text(const glm::dvec3& color) { return format("%.4f %.4f %.4f", color.r, color.g, color.b); }

std::string name_of(std::uint32_t fragment) {
  return fragment == kNobody ? "background" : "#" + std::to_string(fragment);
}

// "#2", "#2 + #5", "#2 + #5 + 7 more".
std::string names_of(const std::vector<std::uint32_t>& fragments) {
  constexpr std::size_t kMost = 6;
  std::string text;
  for (std::size_t i = 0; i < std::min(fragments.size(), kMost); ++i) text += (i ? " + " : "") + name_of(fragments[i]);
  if (fragments.size() > kMost) text += " + " + std::to_string(fragments.size() - kMost) + " more";
  return text.empty() ? "nothing" : text;
}

std::string unit_of(const PixelHistory& history) { return history.has_samples ? "samples" : "positions"; }

std::string list_moves(const std::vector<PositionMove>& moves, const char* of_nobody) {
  std::vector<PositionMove> sorted = moves;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const PositionMove& a, const PositionMove& b) { return a.positions > b.positions; });
  constexpr std::size_t kMost = 8;
  std::string text;
  std::uint32_t rest = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i >= kMost) {
      rest += sorted[i].positions;
      continue;
    }
    text += (i ? ", " : "") + std::to_string(sorted[i].positions) + " " +
            (sorted[i].fragment == kNobody ? of_nobody : "#" + std::to_string(sorted[i].fragment));
  }
  return rest > 0 ? text + ", " + std::to_string(rest) + " others" : text;
}

std::string counted(std::uint32_t count, const PixelHistory& history) {
  return with_noun(count, history.has_samples ? "sample" : "position");
}

// Without the sign of what rounds to 0.
double unsigned_zero(double x) { return std::abs(x) < 5e-6 ? 0.0 : x; }

std::uint32_t count_of(const std::vector<PositionMove>& moves) {
  std::uint32_t count = 0;
  for (const PositionMove& move : moves) count += move.positions;
  return count;
}

// ---- Pictures of positions ----

// Each character stands for a part of the pixel, or for two, one above the other. A part shows the position that is
// nearest to its centre.
constexpr int kPictureColumns = 16, kPictureRows = 8;
constexpr std::size_t kLegible = 62;

char letter_of(std::uint32_t fragment) {
  constexpr const char* kLetters = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  return fragment == kNobody ? '.' : fragment < kLegible ? kLetters[fragment] : '*';
}

std::size_t nearest_position(const PixelHistory& history, glm::vec2 place) {
  std::size_t nearest = 0;
  float least = 9;
  for (std::size_t i = 0; i < history.positions.size(); ++i) {
    const glm::vec2 away = history.positions[i] - place;
    if (const float distance = glm::dot(away, away); distance < least) least = distance, nearest = i;
  }
  return nearest;
}

std::vector<std::string> owner_picture(const PixelHistory& history) {
  std::vector<std::string> rows(kPictureRows);
  for (int y = 0; y < kPictureRows; ++y)
    for (int x = 0; x < kPictureColumns; ++x)
      rows[y] += letter_of(
          history.owners[nearest_position(history, {(x + 0.5f) / kPictureColumns, (y + 0.5f) / kPictureRows})]);
  return rows;
}

std::vector<std::string> mask_picture(const PixelHistory& history, const std::vector<bool>& mask, bool unicode) {
  const auto covers = [&](int x, float y) {
    return mask[nearest_position(history, {(x + 0.5f) / kPictureColumns, y / kPictureRows})];
  };
  std::vector<std::string> rows(kPictureRows);
  for (int y = 0; y < kPictureRows; ++y) {
    for (int x = 0; x < kPictureColumns; ++x) {
      constexpr const char *kBlocks[] = {"·", "▀", "▄", "█"}, *kAscii[] = {".", "'", ",", "#"};
      rows[y] += (unicode ? kBlocks : kAscii)[covers(x, y + 0.25f) + 2 * covers(x, y + 0.75f)];
    }
  }
  return rows;
}

struct TitledPicture {
  std::string title;
  std::vector<std::string> rows;
};

// Side by side.
std::string pictures_text(const std::vector<TitledPicture>& pictures) {
  constexpr std::size_t kWidth = kPictureColumns + 3, kPerRow = (kColumns - 2) / kWidth;
  std::string text;
  for (std::size_t first = 0; first < pictures.size(); first += kPerRow) {
    const std::size_t last = std::min(first + kPerRow, pictures.size());
    std::string titles = " ";
    for (std::size_t i = first; i < last; ++i) {
      titles += " " + cut(pictures[i].title, kWidth - 1);
      titles.resize(2 + (i + 1 - first) * kWidth - 1, ' ');
    }
    text += titles.substr(0, titles.find_last_not_of(' ') + 1) + "\n";
    for (int y = 0; y < kPictureRows; ++y) {
      text += " ";
      for (std::size_t i = first; i < last; ++i) text += (i > first ? "   " : " ") + pictures[i].rows[y];
      text += "\n";
    }
    text += "\n";
  }
  return text;
}

// ---- Parts of the text ----

std::string head_text(const PixelInspection& inspection, const std::string& trace) {
  const PixelHistory& history = inspection.history;
  std::string text =
      put_line("pixel " + std::to_string(history.at.x) + "," + std::to_string(history.at.y) + " of " + trace +
                   ", frame " + std::to_string(inspection.frame) + ", with " + inspection.technique,
               2);
  const std::size_t touching = history.fragments.size();
  text += with_noun(touching, "triangle") + (touching == 1 ? " touches" : " touch") +
          " it, in this order: " + history.order + ". It has " + std::to_string(history.positions.size()) + " " +
          unit_of(history) + ".\n\n";
  const glm::dvec3 color(inspection.picture), truth(inspection.reference), error = color - truth;
  text += format("  picture     %s   covered %.4f\n", color_text(color).c_str(), history.pixel.a);
  text += format("  reference   %s\n", color_text(truth).c_str());
  text +=
      format("  error      %+.4f %+.4f %+.4f   root mean square %.5f\n", error.r, error.g, error.b, inspection.error);
  if (inspection.visibility_error)
    text += format("  visibility  root mean square %.5f if each triangle had one colour in the pixel\n",
                   *inspection.visibility_error);
  if (const std::string causes = cause_shares_text(inspection); !causes.empty())
    text += put_line("  causes      " + causes, 14);
  return text + "\n";
}

// Has the fragment changed anything, or should it have?
std::vector<bool> fragments_that_matter(const PixelInspection& inspection) {
  const PixelHistory& history = inspection.history;
  std::vector<bool> matters(history.fragments.size());
  for (std::size_t i = 0; i < matters.size(); ++i) matters[i] = !history.fragments[i].taken.empty();
  for (const InspectedSurface& surface : inspection.surfaces)
    if (surface.fragment != kNobody) matters[surface.fragment] = true;
  return matters;
}

std::string fragments_text(const PixelInspection& inspection) {
  constexpr std::size_t kMost = 40;  // of those that changed nothing
  const PixelHistory& history = inspection.history;
  const std::vector<bool> matters = fragments_that_matter(inspection);
  const auto others = static_cast<std::size_t>(std::count(matters.begin(), matters.end(), false));
  std::map<std::string, std::size_t> left_out;  // by fate
  std::vector<std::uint32_t> owned(history.fragments.size());
  for (const std::uint32_t owner : history.owners)
    if (owner != kNobody) ++owned[owner];
  std::string text = format(
      "Fragments; triangles have the numbers of export-soup\n  %4s %9s  %-20s %9s %10s %10s %7s %6s  %s\n", "#",
      "triangle", "draw", "area", "nearest", "farthest", history.has_samples ? "samples" : "covers", "owns", "fate");
  for (std::size_t i = 0; i < history.fragments.size(); ++i) {
    const HistoryFragment& each = history.fragments[i];
    if (others > kMost && !matters[i]) {
      ++left_out[fate_text(each.fate)];
      continue;
    }
    text += format("  %4zu %9u  %-20s %9.5f %10.6f %10.6f %7td %6s  ", i, each.triangle,
                   cut(inspection.draw_names[i], 20).c_str(), each.area, each.nearest, each.farthest,
                   std::count(each.mask.begin(), each.mask.end(), true),
                   has_owners(history) ? std::to_string(owned[i]).c_str() : "");
    text += fate_text(each.fate) + (each.is_front ? "\n" : ", back face\n");
    if (const std::string moves = moves_text(each, history); !moves.empty()) text += put_line("         " + moves, 11);
  }
  if (!left_out.empty()) {
    std::string list;
    for (const auto& [fate, count] : left_out) list += (list.empty() ? "" : ", ") + std::to_string(count) + " " + fate;
    text += put_line("  " + std::to_string(others) + " others changed nothing and are in --json: " + list + ".", 2);
  }
  return text + "\n";
}

std::string masks_text(const PixelInspection& inspection, bool unicode) {
  constexpr std::size_t kMost = 24;
  const PixelHistory& history = inspection.history;
  std::vector<TitledPicture> pictures;
  if (has_owners(history)) pictures.push_back({"owners", owner_picture(history)});
  std::size_t left_out = 0;
  for (std::uint32_t i = 0; i < history.fragments.size(); ++i) {
    const std::vector<bool>& mask = history.fragments[i].mask;
    if (std::none_of(mask.begin(), mask.end(), [](bool covered) { return covered; })) continue;
    if (pictures.size() > kMost) {
      ++left_out;
      continue;
    }
    pictures.push_back({"#" + std::to_string(i) + (i < kLegible ? std::string(" is ") + letter_of(i) : ""),
                        mask_picture(history, mask, unicode)});
  }
  if (pictures.empty()) return "";
  std::string text = history.has_samples ? "Samples: " : "Positions: ";
  if (has_owners(history))
    text += history.has_samples ? "who has them at the end, and " : "who owns them at the end, and ";
  text += "what each fragment covers\n";
  text += pictures_text(pictures);
  if (left_out > 0) text += format("  %zu more masks are in --json.\n\n", left_out);
  return text;
}

std::string steps_text(const PixelHistory& history) {
  if (history.steps.empty()) return "";
  std::string text = "Steps\n";
  for (const HistoryStep& step : history.steps) text += put_line("  " + step_text(step, history), 6);
  return text + "\n";
}

std::string bar(double part, bool unicode) {
  constexpr int kWidth = 20;
  std::string text;
  const int length = static_cast<int>(std::lround(std::clamp(part, 0.0, 1.0) * kWidth));
  for (int i = 0; i < length; ++i) text += unicode ? "█" : "#";
  return text;
}

std::string weights_text(const PixelInspection& inspection, bool unicode) {
  const PixelHistory& history = inspection.history;
  const bool is_encoded = inspection.target == ColorTarget::unorm;
  std::string text = format("Weights: parts of the pixel%s\n  %-10s %9s %10s %9s  %-22s %-20s\n",
                            is_encoded ? ", and colours as the target stores them" : "", "surface", "weight",
                            "reference", "error", "colour", "weight");
  std::vector<InspectedSurface> surfaces = inspection.surfaces;
  std::stable_sort(surfaces.begin(), surfaces.end(), [](const InspectedSurface& a, const InspectedSurface& b) {
    return a.largest_part() > b.largest_part();
  });
  constexpr std::size_t kMost = 40;
  for (std::size_t i = 0; i < std::min(surfaces.size(), kMost); ++i) {
    const InspectedSurface& surface = surfaces[i];
    const std::optional<double>& truth = surface.truth;
    const std::string compared =
        truth ? format("%10.5f %+9.5f", unsigned_zero(*truth), unsigned_zero(surface.weight - *truth)) : "";
    text += format("  %-10s %9.5f %20s  %-22s ", name_of(surface.fragment).c_str(), unsigned_zero(surface.weight),
                   compared.c_str(), color_text(surface.color).c_str()) +
            bar(surface.weight, unicode);
    text = text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
  }
  if (surfaces.size() > kMost) text += format("  %zu smaller ones are in --json.\n", surfaces.size() - kMost);
  if (history.estimates) {
    const PixelEstimates& found = *history.estimates;
    text += format("  analytic estimate %.5f: %s; counted %.5f: %s\n", found.analytic.a,
                   color_text(found.analytic).c_str(), found.counted.a, color_text(found.counted).c_str());
  }
  const glm::dvec3 sum = history.sum(), rest = history.rest();
  text += "  sum of weight x colour  " + color_text(sum) + "\n";
  text += format("  formats and limits     %+.4f %+.4f %+.4f\n", rest.r, rest.g, rest.b);
  const auto put_bits = [&text](const char* name, const auto& color) {
    text += format("  %-23s %.9g %.9g %.9g\n", name, color.r, color.g, color.b);
  };
  if (is_encoded) put_bits("stored, to the bit", history.pixel);
  put_bits(is_encoded ? "linear, to the bit" : "picture, to the bit", inspection.picture);
  return text;
}

}  // namespace

std::string fate_text(Fate fate) {
  switch (fate) {
    case Fate::no_area:
      return "touches, area 0";
    case Fate::cut_out:
      return "below alpha cutoff";
    case Fate::no_sample:
      return "covers no sample";
    case Fate::closed_off:
      return "behind a closed pixel";
    case Fate::hidden:
      return "hidden";
    case Fate::speck:
      return "small fragment, added";
    case Fate::speck_hidden:
      return "small fragment, not added";
    case Fate::owner:
      return "owner";
    case Fate::composed:
      return "composed";
    case Fate::stored:
      return "drawn over what was there";
    case Fate::blended:
      break;
  }
  return "blended";
}

std::string moves_text(const HistoryFragment& fragment, const PixelHistory& history) {
  if (fragment.lost.empty() && fragment.taken.size() == 1 && fragment.taken[0].fragment == kNobody) return "";
  std::string text;
  if (!fragment.taken.empty())
    text += "took " + counted(count_of(fragment.taken), history) + ": " + list_moves(fragment.taken, "empty");
  if (fragment.lost.empty()) return text;
  if (!text.empty()) text += "; ";
  return text + "without " + std::to_string(count_of(fragment.lost)) + ": " + list_moves(fragment.lost, "empty");
}

std::string step_text(const HistoryStep& step, const PixelHistory& history) {
  const auto surface_text = [&](const HeldSurface& surface) {
    return names_of(surface.fragments) + " (" + counted(surface.positions, history) + ", colour " +
           color_text(surface.color) + ")";
  };
  const std::string when = step.after_fragment == kNobody ? "at the end: " : name_of(step.after_fragment) + ": ";
  using enum HistoryStep::Kind;
  switch (step.kind) {
    case merged:
      return when + surface_text(step.before[0]) + " and " + surface_text(step.before[1]) +
             " were merged: " + counted(step.after->positions, history) + ", colour " + color_text(step.after->color);
    case settled:
      return when + "retired: " + surface_text(step.before[0]) + format(", area %.5f", step.before[0].area);
    case composed:
      break;
  }
  return when + format("aggregate of %zu (%u %s, area %.4f, colour %s) became %zu (%u, area %.4f, colour %s)",
                       step.before[0].fragments.size(), step.before[0].positions, unit_of(history).c_str(),
                       step.before[0].area, color_text(step.before[0].color).c_str(), step.after->fragments.size(),
                       step.after->positions, step.after->area, color_text(step.after->color).c_str());
}

std::string cause_shares_text(const PixelInspection& inspection) {
  const double error = inspection.visibility_error.value_or(inspection.error);
  const bool is_explained =
      std::ranges::any_of(inspection.surfaces, [](const auto& each) { return each.truth.has_value(); });
  if (error == 0 || !is_explained) return "";
  std::vector<std::size_t> order(inspection.causes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(inspection.causes[a]) > std::abs(inspection.causes[b]);
  });
  std::string text;
  for (const std::size_t cause : order) {
    const long percent = std::lround(100 * inspection.causes[cause] / error);
    if (percent == 0) continue;
    text += (text.empty() ? "" : ", ") + std::string(kErrorCauses[cause]) + format(" %ld %%", percent);
  }
  return text;
}

std::vector<std::string> transfer_lines(const PixelInspection& inspection, std::size_t most) {
  struct Gain {
    double area = 0, effect = 0;
    std::vector<std::pair<double, std::uint32_t>> from;  // area and loser
  };
  std::map<std::pair<std::size_t, std::size_t>, Gain> gains;  // by gainer and cause
  for (const AreaTransfer& each : inspection.transfers) {
    const InspectedSurface &from = inspection.surfaces[each.from], &to = inspection.surfaces[each.to];
    Gain& gain = gains[{each.to, each.cause}];
    gain.area += each.area;
    gain.effect += each.area * glm::length(to.color - from.color);
    gain.from.emplace_back(each.area, from.fragment);
  }
  std::vector<std::pair<std::pair<std::size_t, std::size_t>, Gain>> sorted(gains.begin(), gains.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second.effect > b.second.effect; });
  std::vector<std::string> lines;
  for (auto& [key, gain] : sorted) {
    if (lines.size() == most) break;
    constexpr std::size_t kMost = 3;
    std::stable_sort(gain.from.begin(), gain.from.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::string from;
    for (std::size_t i = 0; i < std::min(gain.from.size(), kMost); ++i)
      from += (i ? ", " : "") + name_of(gain.from[i].second);
    if (gain.from.size() > kMost) from += " and " + std::to_string(gain.from.size() - kMost) + " more";
    lines.push_back(format("%.5f of the pixel to ", gain.area) + name_of(inspection.surfaces[key.first].fragment) +
                    " from " + from + ": " + kErrorCauses[key.second]);
  }
  return lines;
}

std::string inspection_text(const PixelInspection& inspection, const std::string& trace, bool unicode) {
  std::string text = head_text(inspection, trace);
  if (!inspection.history.fragments.empty()) text += fragments_text(inspection);
  text += masks_text(inspection, unicode) + steps_text(inspection.history) + weights_text(inspection, unicode);
  const std::vector<std::string> transfers = transfer_lines(inspection, 8);
  if (!transfers.empty()) text += "\nWhere the area went\n";
  for (const std::string& line : transfers) text += "  " + line + "\n";
  return text;
}

}  // namespace beampipe
