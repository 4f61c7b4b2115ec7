#include "tools/report/gnuplot.h"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "tools/report/label_placement.h"

namespace beampipe {
namespace {

constexpr int kWidth = 760, kHeight = 520;                                     // px
constexpr double kLeft = 0.105, kRight = 0.975, kBottom = 0.12, kTop = 0.915;  // the axes, as parts of the picture
constexpr int kFontSize = 12, kLabelHeight = 14;                               // px
constexpr double kCharacterWidth = 6.9;                                        // px, in most fonts of this size
constexpr double kPointRadius = 5;                                             // px
constexpr int kPngScale = 2;                                                   // PNG pixels per px
constexpr int kNoProgram = 127;  // exit code if there is no such program, as in a shell

// In single quotes gnuplot interprets nothing; in double quotes it would run what stands between backquotes. (The name
// is none of the standard library's: std::quoted, which writes double quotes, would be the better match for a string
// that is not const.)
std::string in_single_quotes(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "''" : static_cast<unsigned char>(c) < 0x20 ? " " : std::string(1, c);
  return out + "'";
}

// A field of a data block, without characters that would end it.
std::string quoted_word(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return out + "\"";
}

// A logarithmic axis with some room around the values.
struct LogRange {
  double low = 1, high = 10;

  double place(double value) const {  // 0..1
    return std::clamp(std::log(value / low) / std::log(high / low), 0.0, 1.0);
  }
};

LogRange range_of(const ScatterPlot& plot, double PlotPoint::*value) {
  double low = HUGE_VAL, high = 0;
  for (const PlotSeries& series : plot.series) {
    for (const PlotPoint& point : series.points) {
      low = std::min(low, point.*value);
      high = std::max(high, point.*value);
    }
  }
  if (low > high) return {};
  // Far beyond what anything here measures, and near enough that tics can be counted.
  constexpr double kLeast = 1e-30, kMost = 1e30;
  const double room = std::max(1.15, std::pow(high / low, 0.06));
  return {std::clamp(low / room, kLeast, kMost / 10), std::clamp(high * room, kLeast * 10, kMost)};
}

std::string tics(const std::vector<double>& at) {
  std::ostringstream text;
  for (const double value : at) text << (value == at.front() ? "" : ", ") << value;
  return text.str();
}

// The powers of ten, and on short axes also two and five times these: "1, 2, 5, 10".
std::string tics(const LogRange& range) {
  const bool is_short = std::log10(range.high / range.low) < 2.5;
  std::string text;
  for (int power = static_cast<int>(std::floor(std::log10(range.low))); std::pow(10.0, power) <= range.high; ++power) {
    for (const double times : {1.0, 2.0, 5.0}) {
      const double value = times * std::pow(10.0, power);
      if ((times > 1 && !is_short) || value < range.low || value > range.high) continue;
      std::ostringstream number;
      number << value;
      text += (text.empty() ? "" : ", ") + number.str();
    }
  }
  return text;
}

void write_labels(std::ostream& script, const ScatterPlot& plot, const LogRange& x, const LogRange& y) {
  LabelTask task{.width = kWidth * (kRight - kLeft),
                 .height = kHeight * (kTop - kBottom),
                 .label_height = kLabelHeight,
                 .point_radius = kPointRadius};
  std::vector<std::string> labels, colors;  // lines that lie close are told apart by colour
  const auto pixel_of = [&](const PlotPoint& point) {
    return PixelPoint{x.place(point.x) * task.width, y.place(point.y) * task.height};
  };
  for (const PlotSeries& series : plot.series) {
    for (std::size_t i = 1; series.line && i < series.points.size(); ++i) {
      task.lines.push_back({pixel_of(series.points[i - 1]), pixel_of(series.points[i])});
    }
    for (const PlotPoint& point : series.points) {
      task.points.push_back(pixel_of(point));
      task.label_widths.push_back(kCharacterWidth * static_cast<double>(point.label.size()));
      labels.push_back(point.label);
      colors.push_back(series.line ? series.color : "#404040");
    }
  }
  const std::vector<PixelPoint> centers = place_labels(task);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i].empty()) continue;
    const PixelPoint point = task.points[i], label = centers[i];
    const double dx = std::max(0.0, std::abs(label.x - point.x) - task.label_widths[i] / 2);
    const double dy = std::max(0.0, std::abs(label.y - point.y) - kLabelHeight / 2);
    if (std::hypot(dx, dy) > 2 * kPointRadius) {
      script << "set arrow from graph " << point.x / task.width << "," << point.y / task.height << " to graph "
             << (label.x + std::copysign(std::abs(label.x - point.x) - dx, point.x - label.x)) / task.width << ","
             << (label.y + std::copysign(std::abs(label.y - point.y) - dy, point.y - label.y)) / task.height
             << " nohead back linecolor " << in_single_quotes(colors[i]) << "\n";
    }
    // A label to the right (left) of its point starts (ends) there, however wide the font makes it.
    const int side = label.x > point.x + 1 ? 1 : label.x < point.x - 1 ? -1 : 0;
    script << "set label " << in_single_quotes(labels[i]) << " at graph "
           << (label.x - side * task.label_widths[i] / 2) / task.width << "," << label.y / task.height << " "
           << (side > 0   ? "left"
               : side < 0 ? "right"
                          : "center")
           << " textcolor rgb " << in_single_quotes(colors[i]) << "\n";
  }
}

// The axes and everything around them. `right` is where the axes end, as a part of the picture's width.
void write_frame(std::ostream& script, const std::string& title, const std::string& y_label, double right) {
  script << "set lmargin at screen " << kLeft << "\nset rmargin at screen " << right << "\nset bmargin at screen "
         << kBottom << "\nset tmargin at screen " << kTop << "\nset title " << in_single_quotes(title)
         << "\nset ylabel " << in_single_quotes(y_label) << " offset 1,0\nset border 3 linecolor '#404040'\n"
         << "set grid linetype 1 linecolor '#e4e4e4'\n";
}

void write_axes(std::ostream& script, const ScatterPlot& plot, const LogRange& x, const LogRange& y) {
  write_frame(script, plot.title, plot.y_label, kRight);
  script << "set xlabel " << in_single_quotes(plot.x_label) << "\nset logscale xy\nset xrange [" << x.low << ":"
         << x.high << "]\nset yrange [" << y.low << ":" << y.high << "]\nset xtics nomirror ("
         << (plot.x_ticks.empty() ? tics(x) : tics(plot.x_ticks)) << ")\nset ytics nomirror (" << tics(y)
         << ")\nset key off\n";
}

// One data block per series and kind of bound, because each has its own marker.
void write_series(std::ostream& script, const ScatterPlot& plot) {
  constexpr int kMarkers[] = {7, 9, 11, 13};  // disc, triangle up (at least), triangle down (at most), diamond (beyond)
  std::ostringstream blocks, plots;
  int block = 0;
  const auto add = [&](const std::vector<PlotPoint>& points, const std::string& style) {
    if (points.empty()) return;
    blocks << "$block" << block << " << END\n";
    for (const PlotPoint& point : points) blocks << point.x << " " << point.y << "\n";
    blocks << "END\n";
    plots << (block > 0 ? ", " : "plot ") << "$block" << block << " with " << style;
    ++block;
  };
  for (const PlotSeries& series : plot.series) {
    const std::string color = " linecolor " + in_single_quotes(series.color);
    if (series.line) add(series.points, "lines linewidth 2" + color);
    if (!series.marks) continue;
    for (const auto bound :
         {PlotPoint::Bound::none, PlotPoint::Bound::lower, PlotPoint::Bound::upper, PlotPoint::Bound::beyond}) {
      std::vector<PlotPoint> points = series.points;
      std::erase_if(points, [&](const PlotPoint& point) { return point.bound != bound; });
      add(points, "points pointtype " + std::to_string(kMarkers[static_cast<int>(bound)]) + color);
    }
  }
  script << blocks.str() << plots.str() << "\n";
}

// A file that has no name in any folder, so that it disappears with the program, however the program ends.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(memfd_create("gnuplot", 0)) {
    if (descriptor_ < 0) throw std::runtime_error("cannot make a file in memory");
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int descriptor() const { return descriptor_; }
  void write(const std::string& text) const { std::ofstream(path(), std::ios::binary) << text; }
  std::string read() const {
    std::ifstream file(path(), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

  int descriptor_;
};

// Runs gnuplot and returns what it prints on standard output. It is killed if this program ends.
std::string run_gnuplot(const std::string& script) {
  const MemoryFile input, picture, messages;
  input.write(script);
  const pid_t parent = getpid(), child = fork();
  if (child < 0) throw std::runtime_error("cannot start another process to run gnuplot");
  if (child == 0) {
    dup2(input.descriptor(), STDIN_FILENO);
    dup2(picture.descriptor(), STDOUT_FILENO);
    dup2(messages.descriptor(), STDERR_FILENO);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() == parent) execlp("gnuplot", "gnuplot", nullptr);
    _exit(kNoProgram);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNoProgram) {
    throw std::runtime_error("cannot run the program gnuplot, which draws the plots (Debian package gnuplot-nox)");
  }
  std::string bytes = picture.read();
  if (status != 0 || bytes.empty()) throw std::runtime_error("gnuplot could not draw: " + messages.read());
  return bytes;
}

bool has_negative(const BarPlot& plot) {
  for (const BarPlot::Part& part : plot.parts)
    for (const double value : part.values)
      if (value < 0) return true;
  return false;
}

std::string terminal(PlotFormat format) {
  std::ostringstream text;
  if (format == PlotFormat::svg) {
    text << "set terminal svg noenhanced size " << kWidth << "," << kHeight << " font 'sans-serif," << kFontSize
         << "' background '#ffffff'\n";
  } else {
    text << "set terminal pngcairo noenhanced size " << kPngScale * kWidth << "," << kPngScale * kHeight
         << " font 'sans-serif," << kFontSize * 0.75 << "' fontscale " << kPngScale << " linewidth " << kPngScale
         << " pointscale " << kPngScale << "\n";
  }
  return text.str();
}

}  // namespace

std::string gnuplot_script(const ScatterPlot& plot, PlotFormat format) {
  const LogRange x = range_of(plot, &PlotPoint::x), y = range_of(plot, &PlotPoint::y);
  std::ostringstream script;
  script.precision(9);
  script << terminal(format);
  write_axes(script, plot, x, y);
  write_labels(script, plot, x, y);
  write_series(script, plot);
  return script.str();
}

std::string gnuplot_script(const BarPlot& plot, PlotFormat format) {
  constexpr double kBarsRight = 0.76, kBarsBottom = 0.25;  // room for the key and for slanted names
  std::ostringstream script;
  script.precision(9);
  script << terminal(format);
  write_frame(script, plot.title, plot.y_label, kBarsRight);
  script << "set bmargin at screen " << kBarsBottom << "\nset style data histograms\nset style histogram rowstacked\n"
         << "set style fill solid border linecolor '#ffffff'\nset boxwidth 0.75\nset key at screen 0.99, " << kTop
         << " right top Left reverse invert samplen 1 width -2\nset yrange [" << (has_negative(plot) ? "*" : "0")
         << ":*]\nset ytics nomirror\n"
         << "set xtics nomirror rotate by 40 right scale 0\nset grid noxtics ytics\n$bars << END\n";
  for (std::size_t i = 0; i < plot.categories.size(); ++i) {
    script << quoted_word(plot.categories[i]);
    for (const BarPlot::Part& part : plot.parts) script << " " << part.values[i];
    if (!plot.marks.empty()) script << " " << plot.marks[i];
    script << "\n";
  }
  script << "END\n";
  for (std::size_t i = 0; i < plot.parts.size(); ++i) {
    script << (i > 0 ? ", " : "plot ") << "$bars using " << i + 2 << ":xtic(1) title "
           << in_single_quotes(plot.parts[i].name) << " linecolor " << in_single_quotes(plot.parts[i].color);
  }
  if (!plot.marks.empty())
    script << ", $bars using 0:" << plot.parts.size() + 2 << " with points pointtype 2 linecolor '#000000' title "
           << in_single_quotes(plot.mark_name);
  script << "\n";
  return script.str();
}

std::string draw(const ScatterPlot& plot, PlotFormat format) { return run_gnuplot(gnuplot_script(plot, format)); }
std::string draw(const BarPlot& plot, PlotFormat format) { return run_gnuplot(gnuplot_script(plot, format)); }

}  // namespace beampipe
