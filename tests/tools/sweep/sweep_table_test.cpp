#include "tools/sweep/sweep_table.h"

#include <sqlite3.h>

#include "tests/message_of.h"
#include "tests/tools/fixtures.h"
#include "tools/files/shell_word.h"
#include "tools/sweep/slurm.h"
#include "tools/sweep/sqlite_table.h"
#include "tools/sweep/sweep_plot.h"

namespace beampipe::sweep_table_test {

SweepTable sample_table() {
  return {{{"name", "", "a text", true}, {"x", "bytes", "a number"}, {"y", "ms", "another one"}},
          {{"plain", 1, 2.5},
           {"with, comma and \"quotes\"", 10, 0.1},
           {"plain", 10, 40},
           {"plain", 10, 10},
           {"two\nlines", 3, nullptr}},
          0};
}

TEST(SweepTable, SqliteHasRowsAndTheMeaningOfColumns) {
  TemporaryFolder folder;
  write_text(folder / "t.sqlite", sqlite_bytes(sample_table()));
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open_v2((folder / "t.sqlite").c_str(), &database, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  std::string found;
  const auto add = [](void* text, int count, char** values, char**) {
    for (int i = 0; i < count; ++i)
      *static_cast<std::string*>(text) += std::string(values[i] ? values[i] : "NULL") + "|";
    return 0;
  };
  ASSERT_EQ(sqlite3_exec(database, "SELECT name, x, y, typeof(x), typeof(y) FROM cells; SELECT * FROM columns", add,
                         &found, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  EXPECT_EQ(found,
            "plain|1|2.5|integer|real|with, comma and \"quotes\"|10|0.1|integer|real|plain|10|40|integer|integer|"
            "plain|10|10|integer|integer|two\nlines|3|NULL|integer|null|"
            "name||a text|x|bytes|a number|y|ms|another one|");
}

TEST(SweepPlot, LinesGoThroughGeometricMeans) {
  const std::vector<ScatterPlot> plots = sweep_plots(sample_table(), {"x", "y", "name"});
  ASSERT_EQ(plots.size(), 1u);
  const ScatterPlot& plot = plots[0];
  EXPECT_EQ(plot.title, "y by name (geometric means of 2)");
  EXPECT_EQ(plot.x_ticks, (std::vector<double>{1, 10}));
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_EQ(plot.series[0].name, "plain");
  ASSERT_EQ(plot.series[0].points.size(), 2u);
  EXPECT_EQ(plot.series[0].points[0].x, 1);
  EXPECT_NEAR(plot.series[0].points[1].y, 20, 1e-9) << "of 40 and 10";
  EXPECT_EQ(plot.series[0].points[1].label, "plain");
  EXPECT_EQ(plot.x_label, "x (bytes)");
  ASSERT_EQ(plot.notes.size(), 1u);
  EXPECT_EQ(plot.notes[0], "1 rows are not drawn, because x or y is not above 0");
}

TEST(SweepPlot, LargeNumbersAreInLargerUnits) {
  const SweepTable table{{{"memory_system.l2_bytes", "bytes", ""}, {"dram_bytes", "bytes", ""}, {"by", "", "", true}},
                         {{4096, 2500000, "a"}},
                         0};
  const ScatterPlot plot = sweep_plots(table, {"memory_system.l2_bytes", "dram_bytes", "by"}).at(0);
  EXPECT_EQ(plot.x_label, "memory_system.l2_bytes (KiB)");
  EXPECT_EQ(plot.y_label, "dram_bytes (MB)");
  EXPECT_EQ(plot.series.at(0).points.at(0).x, 4);
  EXPECT_NEAR(plot.series.at(0).points.at(0).y, 2.5, 1e-12);
}

// Two traces are alike; implementations are not, and L1 differs only as the hardware does.
TEST(SweepPlot, UnlikeThingsAreNotAveraged) {
  SweepTable table{{{"trace", "", "", true},
                    {"technique", "", "", true},
                    {"memory_system.l1_bytes", "bytes", ""},
                    {"hardware", "", "", true},
                    {"implementation", "", "", true},
                    {"x", "", ""},
                    {"y", "", ""}},
                   {},
                   0};
  for (const char* hardware : {"small", "large"})
    for (const char* implementation : {"shaders", "fixed"})
      for (const char* trace : {"a", "b"})
        for (const int x : {1, 2})
          table.rows.push_back({trace, "beam", hardware == std::string("small") ? 10 : 20, hardware, implementation, x,
                                implementation == std::string("fixed") ? 2 : (trace == std::string("a") ? 10 : 40)});
  const std::vector<ScatterPlot> by_technique = sweep_plots(table, {"x", "y", "technique"});
  ASSERT_EQ(by_technique.size(), 4u);
  EXPECT_EQ(by_technique[0].title, "hardware small, implementation shaders (geometric means of 2)");
  EXPECT_EQ(by_technique[3].name, "y_against_x_by_technique_hardware_large__implementation_fixed");
  EXPECT_NEAR(by_technique[0].series.at(0).points.at(0).y, 20, 1e-9);
  EXPECT_NEAR(by_technique[1].series.at(0).points.at(1).y, 2, 1e-9);
  for (std::vector<Json>& row : table.rows) row[3] = row[3] == "small" ? "a b" : "a:b";
  const std::vector<ScatterPlot> alike = sweep_plots(table, {"x", "y", "technique"});
  EXPECT_NE(alike[0].name, alike[2].name) << "whatever their names have in place of blanks";
  EXPECT_EQ(sweep_plots(table, {"memory_system.l1_bytes", "y", "technique"}).size(), 4u) << "no line joins two GPUs";
  const std::vector<ScatterPlot> by_hardware = sweep_plots(table, {"x", "y", "hardware"});
  ASSERT_EQ(by_hardware.size(), 2u) << "L1 goes with the hardware";
  EXPECT_EQ(by_hardware[1].title, "implementation fixed (geometric means of 2)");
  EXPECT_EQ(by_hardware[1].series.size(), 2u);
}

TEST(SweepPlot, ColumnsMustExistAndHoldNumbers) {
  const std::vector<SweepColumn> columns = sample_table().columns;
  const auto refusal = [&](const std::string& text) {
    return message_of<std::runtime_error>([&] { parse_plot_columns(text, columns); });
  };
  EXPECT_EQ(refusal("x,y,name"), "no error");
  EXPECT_EQ(refusal("x,y"), "--plot x,y: expected X,Y,BY, three columns of the table");
  EXPECT_EQ(refusal("x,y,nam"), "--plot x,y,nam: the table has no column 'nam' (did you mean 'name'?)");
  EXPECT_EQ(refusal("name,y,x"), "--plot name,y,x: expected a column of numbers, found 'name', which holds text");
}

TEST(Slurm, WordsAndArrays) {
  EXPECT_EQ(shell_word("a b"), "'a b'");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word("beam"), "'beam'");
  EXPECT_EQ(short_shell_word("msaa:8,prepass"), "msaa:8,prepass");
  EXPECT_EQ(short_shell_word("a b"), "'a b'");
  EXPECT_EQ(short_shell_word(""), "''");
  EXPECT_EQ(array_text({0, 1, 2, 7}), "0-2,7");
  EXPECT_EQ(array_text({4}), "4");
  EXPECT_EQ(array_text({1, 3, 4}), "1,3-4");
}

}  // namespace beampipe::sweep_table_test
