#include "tools/report/report_text.h"

#include <algorithm>
#include <set>

#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/measures.h"
#include "tools/files/format.h"

namespace beampipe {
namespace {

const std::set<std::string> kInFirstTable = {"rmse", "bias", "p99", "max"};

// From the lower to the upper end.
std::string range_text(const EquivalentMsaa& emr) {
  const auto text = [](const std::optional<double>& rate) { return rate ? emr_text({*rate, false, false}) : ""; };
  if (!emr.high) return emr.low ? "at least " + text(emr.low) : "";
  return emr.low ? text(emr.low) + ".." + text(emr.high) : "at most " + text(emr.high);
}

std::string number_text(std::string_view key, double value) {
  return format(key == "psnr" ? "%.2f" : key == "rel_mse" ? "%.3g" : "%.6f", value);
}

std::string bytes_text(double bytes) { return format(bytes > 0 && bytes < 1 ? "%.2g" : "%.0f", bytes); }

// The median of the frames' medians. Times of earlier runs are not told.
std::string wall_text(const TechniqueReport& result) {
  std::vector<double> medians;
  for (const FrameReport& frame : result.frames) {
    if (frame.wall_ms.kept) return "kept";
    medians.push_back(frame.wall_ms.median);
  }
  return format("%.1f", wall_time(std::move(medians)).median);
}

std::string pictures(const TechniqueReport& result, const std::string& folder) {
  std::string text = folder + "/" + result.frames.front().picture;
  if (result.frames.size() > 1) text += " and " + std::to_string(result.frames.size() - 1) + " more";
  return text;
}

// The number of characters of a UTF-8 text.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

std::string emr_text(const EquivalentMsaa& emr) {
  if (emr.does_not_converge) return "does not converge";
  const std::string samples = emr.samples < 100 ? format("%.3g", emr.samples) : format("%.0f", emr.samples);
  return (emr.is_lower_bound ? "≥ " : emr.is_upper_bound ? "< " : "") + samples;
}

namespace {

std::string emr_title(const Report& report) {
  return report.metric_ladder.empty() ? "EMR" : std::string("EMR by ") + find_metric(report.metric).title;
}

}  // namespace

std::string table_text(const Report& report, const std::string& folder) {
  const bool compared = !report.results.empty() && report.results.front().error.has_value();
  std::vector<std::vector<std::string>> rows(1);
  rows[0] = {"technique", "B/px on chip", "off chip"};
  if (compared) rows[0].insert(rows[0].end(), {"RMSE", "bias", "p99", "max", emr_title(report)});
  const bool varies = compared && report.results.front().parts.has_value();
  if (varies) rows[0].insert(rows[0].end(), {"visibility", "its EMR", "shading"});
  const bool moves = compared && report.results.front().flicker.has_value();
  if (moves) rows[0].push_back("flicker");
  rows[0].insert(rows[0].end(), {"wall ms", "picture"});
  for (const TechniqueReport& result : report.results) {
    std::vector<std::string>& row = rows.emplace_back();
    row = {result.technique, bytes_text(result.on_chip_bytes_per_pixel()), bytes_text(result.peak_bytes_per_pixel())};
    if (compared) {
      const ErrorStats& error = result.error.value();
      row.insert(row.end(), {format("%.6f", error.rmse), format("%+.6f", error.bias), format("%.5f", error.p99),
                             format("%.5f", error.max),
                             result.technique == kReferenceSpec ? "" : emr_text(result.equivalent_msaa.value())});
    }
    if (varies) {
      const ErrorParts& parts = result.parts.value();
      row.insert(row.end(), {format("%.6f", parts.visibility), emr_text(result.visibility_msaa.value()),
                             format("%.6f", parts.shading)});
    }
    if (moves) row.push_back(format("%.6f", result.flicker.value_or(0.0)));
    row.insert(row.end(), {wall_text(result), pictures(result, folder)});
  }
  return align_columns(rows, {0, rows[0].size() - 1});
}

std::string measures_text(const Report& report) {
  std::vector<std::vector<std::string>> rows(1);
  for (const TechniqueReport& result : report.results) {
    if (!result.error) return "";
    rows.push_back({result.technique, result.equivalent_msaa ? range_text(*result.equivalent_msaa) : ""});
    rows[0] = {"technique", "EMR within"};
    for (const Measure& measure : measures()) {
      if (kInFirstTable.contains(measure.key)) continue;
      const std::optional<double> value = measure.value(*result.error);
      rows[0].push_back(measure.title);
      rows.back().push_back(value ? number_text(measure.key, *value) : "");
    }
  }
  std::string text = "\n" + align_columns(rows, {0});
  if (report.reference_error) text += "RMSE of the reference itself: " + format("%.6f", *report.reference_error) + "\n";
  return text;
}

std::string causes_text(const Report& report) {
  std::vector<std::vector<std::string>> rows(1);
  for (const TechniqueReport& result : report.results) {
    if (result.causes.empty()) continue;
    std::vector<std::string>& row = rows.emplace_back(std::vector{result.technique});
    rows[0] = {"share of the mean square error of visibility"};
    for (const auto& [cause, part] : result.causes) {
      rows[0].push_back(cause);
      row.push_back(format("%.1f %%", 100 * part));
    }
  }
  return rows.size() > 1 ? std::string("\n").append(align_columns(rows, {0})) : std::string();
}

std::string orders_text(const Report& report) {
  std::vector<std::vector<std::string>> rows(1);
  for (const TechniqueReport& result : report.results) {
    if (result.orders.empty()) continue;
    std::vector<std::string>& row = rows.emplace_back(std::vector{result.technique});
    rows[0] = {"RMSE by order of triangles"};
    for (const OrderReport& order : result.orders) {
      rows[0].push_back(order.order);
      row.push_back(format("%.6f", order.rmse));
    }
    rows[0].push_back("largest difference");
    row.push_back(format("%.6f", result.order_difference));
  }
  return rows.size() > 1 ? std::string("\n").append(align_columns(rows, {0})) : std::string();
}

std::vector<std::vector<std::string>> joined_rows(const std::vector<std::vector<std::string>>& rows,
                                                  std::size_t column) {
  std::vector<std::vector<std::string>> joined, keys;  // a key: the row without the column
  for (const std::vector<std::string>& row : rows) {
    std::vector<std::string> key = row;
    key.at(column).clear();
    const auto same = std::ranges::find(keys, key) - keys.begin();
    if (same < std::ssize(keys)) {
      joined[static_cast<std::size_t>(same)][column] += ", " + row[column];
    } else {
      keys.push_back(key);
      joined.push_back(row);
    }
  }
  return joined;
}

std::string align_columns(const std::vector<std::vector<std::string>>& rows, const std::vector<std::size_t>& left) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string blanks(widths[i] - width_of(row[i]), ' ');
      const bool at_left = std::find(left.begin(), left.end(), i) != left.end();
      line += (i > 0 ? "  " : "") + (at_left ? row[i] + blanks : blanks + row[i]);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace beampipe
