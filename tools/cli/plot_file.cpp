#include "tools/cli/plot_file.h"

#include "tools/cli/command_line.h"
#include "tools/files/output.h"

namespace beampipe {

PlotFormat plot_format(const std::filesystem::path& file) {
  if (file.extension() == ".svg") return PlotFormat::svg;
  if (file.extension() == ".png") return PlotFormat::png;
  throw UsageError("--output " + file.string() + ": expected a name that ends in .svg or .png");
}

void write_plot(const std::filesystem::path& file, const std::string& picture, InterruptGate& gate) {
  OutputFolder output(std::filesystem::absolute(file).parent_path(), gate);
  output.write(file.filename(), picture);
  output.keep();
}

}  // namespace beampipe
