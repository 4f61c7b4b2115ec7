// The picture that a command draws with gnuplot.
#pragma once

#include <filesystem>
#include <string>

#include "tools/files/interrupt.h"
#include "tools/report/gnuplot.h"

namespace beampipe {

// By the name of the file. Throws UsageError if it ends neither in .svg nor in .png.
PlotFormat plot_format(const std::filesystem::path& file);

void write_plot(const std::filesystem::path& file, const std::string& picture, InterruptGate& gate);

}  // namespace beampipe
